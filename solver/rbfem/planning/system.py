"""From a scene and its motion models to the arrays that the stepper reads, and the state it starts from."""

import numpy as np
from numpy.typing import NDArray

from rbfem.motion import quaternion
from rbfem.motion.model import FIXED, Bodies, Islands
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
    reference = scene.reference
    attitude = quaternion.product(scene.quaternion, reference.quaternion)
    offset = quaternion.rotate(scene.quaternion, reference.offset)
    velocity = scene.velocity + np.cross(scene.angular_velocity, offset)
    velocity[scene.is_held | scene.is_fixed] = 0.0
    spin = quaternion.rotate_back(attitude, scene.angular_velocity)
    return initial_state(scene.position + offset, attitude, velocity, reference.moments * spin)


def find_islands(scene: Scene, models: NDArray[np.int64]) -> Islands:
    """Moving bodies, those together that springs join, directly or through others."""
    moving = np.flatnonzero(models != FIXED)
    owners = np.repeat(np.arange(scene.n_bodies), np.diff(scene.first_load))
    joined = (scene.loads.other >= 0) & (models[owners] != FIXED)
    joined[joined] &= models[scene.loads.other[joined]] != FIXED
    if not joined.any():
        return make_islands(moving, np.arange(len(moving) + 1), scene.loads, scene.first_load)
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    pairs = (owners[joined], scene.loads.other[joined])
    graph = coo_array((np.ones(len(pairs[0])), pairs), shape=(scene.n_bodies, scene.n_bodies))
    label = connected_components(graph, directed=False)[1][moving]
    order = np.argsort(label, kind="stable")
    starts = np.flatnonzero(np.diff(label[order], prepend=-1))
    first = np.append(starts, len(moving)).astype(np.int64)
    return make_islands(moving[order], first, scene.loads, scene.first_load)
