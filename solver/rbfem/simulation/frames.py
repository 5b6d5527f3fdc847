"""From a State, in the axes of the stepper, to a Frame, in the axes of its reader."""

import numpy as np
from numpy.typing import NDArray

from rbfem.motion import loads as kinds
from rbfem.motion import quaternion
from rbfem.motion.model import ANGULAR_IMPULSE, FIXED, IMPULSE, WORK
from rbfem.motion.state import State, System, angular_velocity_world
from rbfem.scene.scene import Scene
from rbfem.simulation.frame import Balance, Frame

Array = NDArray[np.float64]


def frame_of(scene: Scene, system: System, state: State, index: int) -> Frame:
    """The frame of a state."""
    unit = quaternion.normalize(state.quaternion)
    omega = angular_velocity_world(state, system.bodies)
    arm = quaternion.rotate(unit, system.bodies.arm)
    position, velocity = state.position + arm, state.velocity + np.cross(omega, arm)
    translation = 0.5 * system.bodies.mass * np.einsum("ij,ij->i", velocity, velocity)
    spin = quaternion.rotate_back(unit, omega)
    about_reference = 0.5 * np.einsum("ij,ij->i", state.angular_momentum, spin)
    held = system.bodies.inverse_mass == 0.0  # the energy about a pivot holds that of the moving centre of mass
    rotation = np.where(held, about_reference - translation, about_reference)
    balance = _balance(scene, system, state, position, velocity, translation, rotation)
    return Frame(
        index=index,
        time=state.time,
        position=position,
        quaternion=quaternion.product(unit, quaternion.conjugate(scene.reference.quaternion)),
        velocity=velocity,
        angular_velocity=omega,
        kinetic_energy=translation + rotation,
        balance=balance,
    )


def _balance(
    scene: Scene, system: System, state: State, position: Array, velocity: Array, translation: Array, rotation: Array
) -> Balance:
    bodies, moves = system.bodies, system.bodies.model != FIXED
    free = bodies.inverse_mass > 0.0
    spin = quaternion.rotate(quaternion.normalize(state.quaternion), state.angular_momentum)
    about_origin = spin + np.where(free, bodies.mass, 0.0)[:, None] * np.cross(position, velocity)
    weight = bodies.mass[moves] * (position[moves] @ system.gravity)
    impulse, angular_impulse = _from_outside(scene, system, state)
    return Balance(
        kinetic=float(translation.sum()),
        rotational=float(rotation.sum()),
        gravity=float(-weight.sum()),
        elastic=_elastic_energy(scene, system, state),
        work=float(state.ledger[:, WORK].sum()),
        momentum=bodies.mass[free] @ velocity[free],
        angular_momentum=about_origin[moves].sum(axis=0),
        impulse=impulse,
        angular_impulse=angular_impulse,
    )


def _from_outside(scene: Scene, system: System, state: State) -> tuple[Array, Array]:
    """Impulse and angular impulse since the start: integrated where loads act, closed forms where only gravity does."""
    ledger = state.ledger.sum(axis=0)
    impulse, angular = ledger[IMPULSE : IMPULSE + 3], ledger[ANGULAR_IMPULSE : ANGULAR_IMPULSE + 3]
    coasting = (system.bodies.inverse_mass > 0.0) & (system.bodies.is_pushed == 0)
    mass, t = system.bodies.mass[coasting], state.time
    lever = mass @ (scene.position[coasting] * t + scene.velocity[coasting] * (0.5 * t * t))
    return impulse + mass.sum() * t * system.gravity, angular + np.cross(lever, system.gravity)


def _elastic_energy(scene: Scene, system: System, state: State) -> float:
    """Σ ½ k (l - L0)²; a spring between two bodies stands twice in the table, once for each."""
    rows = np.flatnonzero(system.loads.kind == kinds.SPRING)
    if not len(rows):
        return 0.0
    owners = np.repeat(np.arange(scene.n_bodies), np.diff(scene.first_load))[rows]
    values, other = system.loads.values[rows], system.loads.other[rows]
    unit = quaternion.normalize(state.quaternion)
    near = state.position[owners] + quaternion.rotate(unit[owners], values[:, 0:3])
    on_body = state.position[other] + quaternion.rotate(unit[other], values[:, 3:6])
    far = np.where(other[:, None] >= 0, on_body, values[:, 3:6])
    length = np.linalg.norm(far - near, axis=1)
    share = np.where(other >= 0, 0.25, 0.5)
    return float((share * values[:, 6] * (length - values[:, 8]) ** 2).sum())
