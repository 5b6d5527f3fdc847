"""Where each body starts: as written, or drawn from the seed."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rbfem.case.schema import Body
from rbfem.motion import quaternion
from rbfem.scene.scene import Part

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Start:
    """Position of the centre of mass, attitude, velocity and angular velocity (world axes) of the copies of a body."""

    position: Array
    attitude: Array
    velocity: Array
    angular_velocity: Array


def place(body: Body, part: Part, seed: int, index: int) -> Start:
    """Start of the copies of the index-th body of the case.

    Each body of the case has its own stream of random numbers, so that adding another moves none of these.
    """
    n = body.count
    attitude = np.tile(quaternion.normalize(body.quaternion), (n, 1))
    if body.place is None:
        position = body.position - quaternion.rotate(attitude, part.origin)
    else:
        random = np.random.default_rng([seed, index])
        low, high = body.place.in_box
        position = random.uniform(low, high, size=(n, 3))
        if body.place.orientation == "random":
            attitude = quaternion.normalize(random.normal(size=(n, 4)))
    spin = np.tile(np.array(body.angular_velocity, dtype=float), (n, 1))
    if body.angular_velocity_body is not None:
        spin = quaternion.rotate(attitude, body.angular_velocity_body)
    velocity = np.tile(np.array(body.velocity, dtype=float), (n, 1))
    if body.pivot is not None:
        velocity = np.cross(spin, position - body.pivot)
    return Start(position, attitude, velocity, spin)
