"""What changes during a run, and the function that changes it."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rbfem.compute.loops import loop
from rbfem.motion import quaternion
from rbfem.motion.advance import advance
from rbfem.motion.methods import METHODS, Method
from rbfem.motion.model import LEDGER_WIDTH, Bodies, Islands, Loads, scratch_for

Array = NDArray[np.float64]


@dataclass(frozen=True)
class System:
    """What never changes while bodies move: their arrays, their loads, who must step with whom, and gravity (3,)."""

    bodies: Bodies
    loads: Loads
    islands: Islands
    gravity: Array


@dataclass(frozen=True)
class State:
    """Where every body is and how it moves.

    time             : s
    position         : (n, 3) m, reference points: centres of mass, or pivots
    quaternion       : (n, 4) principal axes about the reference point -> world
    velocity         : (n, 3) m/s of the reference points
    angular_momentum : (n, 3) kg m^2/s about the reference points, in principal axes
    ledger           : (n, 7) work, impulse and angular impulse since the start, see `rbfem.motion.model`
    """

    time: float
    position: Array
    quaternion: Array
    velocity: Array
    angular_momentum: Array
    ledger: Array


def initial_state(position: Array, attitude: Array, velocity: Array, angular_momentum: Array) -> State:
    """The state at time zero, with an empty ledger."""
    return State(0.0, position, attitude, velocity, angular_momentum, np.zeros((len(position), LEDGER_WIDTH)))


def move(state: State, dt: float, n_steps: int, method: str, system: System, backend: str) -> State:
    """The state n_steps steps of dt later, by a row of `METHODS`, on a backend of `rbfem.compute`."""
    row = METHODS[method]
    stacked = _stack(state, row, system)
    ledger, scratch = state.ledger, scratch_for(0)  # enough where every body coasts, in local numbers
    if system.bodies.is_pushed.any():
        ledger, scratch = ledger.copy(), scratch_for(len(stacked))
        scratch.stage[:] = stacked
    loop(advance, backend)(
        stacked,
        ledger,
        state.time,
        dt,
        n_steps,
        np.array(row.nodes),
        np.array(row.weights),
        np.array([row.is_world, row.is_symplectic_euler, row.normalizes], dtype=np.int64),
        system.bodies,
        system.loads,
        system.islands,
        system.gravity,
        scratch,
    )
    return _unstack(stacked, replace(state, time=state.time + n_steps * dt, ledger=ledger), row, system)


def angular_velocity_world(state: State, bodies: Bodies) -> Array:
    """ω = R I⁻¹ L, (n, 3) rad/s."""
    unit = quaternion.normalize(state.quaternion)
    return quaternion.rotate(unit, state.angular_momentum * bodies.inverse_moments)


def _stack(state: State, row: Method, system: System) -> Array:
    spin = angular_velocity_world(state, system.bodies) if row.is_world else state.angular_momentum
    return np.concatenate([state.position, state.quaternion, state.velocity, spin], axis=1)


def _unstack(stacked: Array, state: State, row: Method, system: System) -> State:
    position, attitude, velocity, spin = np.split(stacked, [3, 7, 10], axis=1)
    if row.is_world:
        in_body = quaternion.rotate_back(quaternion.normalize(attitude), spin)
        spin = in_body / system.bodies.inverse_moments
    return replace(state, position=position, quaternion=attitude, velocity=velocity, angular_momentum=spin)
