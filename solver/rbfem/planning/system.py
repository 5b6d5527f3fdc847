"""From a scene and its motion models to the arrays that the stepper reads, and the state it starts from."""

import numpy as np
from numpy.typing import NDArray

from rbfem.compute.rows import each_row
from rbfem.motion.model import FIXED, Bodies, Islands
from rbfem.motion.rotation import cross, multiply, rotate, rotate_back
from rbfem.motion.state import State, System, initial_state, make_islands
from rbfem.planning.models import pushed
from rbfem.scene.scene import Scene


def build_system(scene: Scene, models: NDArray[np.int64]) -> System:
    """Bodies, loads and islands of a scene for the stepper."""
    moves = (models != FIXED) & ~scene.is_held
    bodies = Bodies(
        model=models,
        mass=scene.mass,
        inverse_mass=np.where(moves, 1.0 / scene.mass, 0.0),
        inverse_moments=np.ascontiguousarray(1.0 / scene.reference.moments),
        arm=np.ascontiguousarray(scene.reference.arm),
        first_load=scene.first_load,
        is_pushed=pushed(scene).astype(np.int64),
    )
    return System(bodies, scene.loads, find_islands(scene, models), scene.gravity)


def starting_state(scene: Scene) -> State:
    """The state of a scene at time zero."""
    reference, moves = scene.reference, ~(scene.is_held | scene.is_fixed)
    table = each_row(
        _start,
        scene.position, scene.quaternion, scene.velocity, scene.angular_velocity,
        reference.moments, reference.quaternion, reference.offset, moves,
    )  # fmt: skip
    parts = table[:, 0:3], table[:, 3:7], table[:, 7:10], table[:, 10:13]
    return initial_state(*[np.ascontiguousarray(part) for part in parts])


def _start(position, attitude, velocity, angular_velocity, moments, to_part, offset, moves):
    """One body's state row: position, attitude, velocity and angular momentum of its reference point."""
    unit = multiply(*attitude, *to_part)
    x, y, z = rotate(*attitude, *offset)
    (wx, wy, wz), (q0, q1, q2, q3) = angular_velocity, unit
    vx, vy, vz = cross(wx, wy, wz, x, y, z)
    wx, wy, wz = rotate_back(q0, q1, q2, q3, wx, wy, wz)
    return (
        position[0] + x, position[1] + y, position[2] + z, *unit,
        moves * (velocity[0] + vx), moves * (velocity[1] + vy), moves * (velocity[2] + vz),
        moments[0] * wx, moments[1] * wy, moments[2] * wz,
    )  # fmt: skip


def find_islands(scene: Scene, models: NDArray[np.int64]) -> Islands:
    """Moving bodies that cannot touch, those together that springs join, directly or through others."""
    moving = np.flatnonzero((models != FIXED) & ~scene.can_touch)
    alone = make_islands(moving, np.arange(len(moving) + 1), scene.loads, scene.first_load)
    if not (scene.loads.other >= 0).any():
        return alone
    owners = np.repeat(np.arange(scene.n_bodies), np.diff(scene.first_load))
    joined = (scene.loads.other >= 0) & (models[owners] != FIXED)
    joined[joined] &= models[scene.loads.other[joined]] != FIXED
    if not joined.any():
        return alone
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    pairs = (owners[joined], scene.loads.other[joined])
    graph = coo_array((np.ones(len(pairs[0])), pairs), shape=(scene.n_bodies, scene.n_bodies))
    label = connected_components(graph, directed=False)[1][moving]
    order = np.argsort(label, kind="stable")
    starts = np.flatnonzero(np.diff(label[order], prepend=-1))
    first = np.append(starts, len(moving)).astype(np.int64)
    return make_islands(moving[order], first, scene.loads, scene.first_load)
