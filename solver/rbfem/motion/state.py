"""What changes during a run, and the function that changes it."""

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rbfem.compute.loops import loop
from rbfem.motion import loads as kinds
from rbfem.motion import quaternion
from rbfem.motion.adaptive import step_adaptively
from rbfem.motion.lie import step_on_group
from rbfem.motion.methods import METHODS, Method, RungeKutta, Splitting
from rbfem.motion.model import (
    LEDGER_WIDTH,
    POSITION,
    QUATERNION,
    SPIN,
    VELOCITY,
    Bodies,
    Islands,
    Loads,
    Scratch,
    scratch_for,
)
from rbfem.motion.runge_kutta import step_by_runge_kutta
from rbfem.motion.splitting import step_by_splitting

Array = NDArray[np.float64]

_NO_SCRATCH = scratch_for(0, 0)


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
    evaluations      : of the loads of one body, since the start
    rest             : (n, 13) what the sums of pushed bodies have rounded off, in the columns of a stacked row, or None
    """

    time: float
    position: Array
    quaternion: Array
    velocity: Array
    angular_momentum: Array
    ledger: Array
    evaluations: int = 0
    rest: Array | None = None


def initial_state(position: Array, attitude: Array, velocity: Array, angular_momentum: Array) -> State:
    """The state at time zero, with an empty ledger."""
    return State(0.0, position, attitude, velocity, angular_momentum, np.zeros((len(position), LEDGER_WIDTH)))


def make_islands(member: NDArray[np.int64], first: NDArray[np.int64], loads: Loads, first_load: NDArray) -> Islands:
    """Islands of these members, each told whether dampers or drag act in it; first_load : (n + 1,), see `Bodies`."""
    damps = ((loads.kind == kinds.SPRING) & (loads.values[:, 7] != 0.0)) | (loads.kind == kinds.DRAG)
    if not damps.any():
        return Islands(member, first, np.zeros(len(first) - 1, dtype=np.int64))
    dampers = np.diff(np.concatenate([[0], np.cumsum(damps)])[first_load])  # of each body
    total = np.concatenate([[0], np.cumsum(dampers[member])])[first]
    return Islands(member, first, (np.diff(total) > 0).astype(np.int64))


def move(state: State, dt: float, n_steps: int, method: str, system: System, backend: str) -> State:
    """The state n_steps steps of dt later, by a row of `METHODS`, on a backend of `rbfem.compute`."""
    row = METHODS[method]
    stacked, ledger, scratch = _working_memory(state, row, system)
    common = system.bodies, system.loads, system.islands, system.gravity, scratch
    scheme = row.scheme
    if isinstance(scheme, Splitting):
        parts, times = _shares(scheme)
        kernel: Callable = step_by_splitting
        given: tuple[Any, ...] = (parts, times, scheme.begins_with_kick, scheme.rotor)
    elif isinstance(scheme, RungeKutta):
        kernel, given = step_by_runge_kutta, _coefficients(scheme)
    else:
        kernel, given = step_on_group, ()
    try:
        loop(kernel, backend)(stacked, ledger, state.time, dt, n_steps, *given, *common)
    except (
        ArithmeticError,
        ValueError,
    ):  # what has blown up stops plain Python; a kernel goes on with inf and nan
        stacked[:] = np.nan
    evaluations = state.evaluations + _evaluations(row, n_steps)
    end = state.time + n_steps * dt
    return State(end, *_unstack(stacked, row, system), ledger, evaluations, _kept(scratch, row))


def move_to_tolerance(
    state: State,
    span: float,
    first_step: float,
    tolerance: float,
    scale: Array,
    method: str,
    system: System,
    backend: str,
) -> State:
    """The state after `span` by an adaptive row of `METHODS`: local errors at most `tolerance` times `scale`, (n, 13).

    Where even the shortest step does not reach the tolerance the state comes back as no number.
    """
    row = METHODS[method]
    assert isinstance(row.scheme, RungeKutta)
    stacked, ledger, scratch = _working_memory(state, row, system)
    evaluations = np.zeros(len(system.islands.is_damped), dtype=np.int64)
    tableau, nodes, weights, flags = _coefficients(row.scheme)
    loop(step_adaptively, backend)(
        stacked, ledger, state.time, span, first_step, tolerance, tableau, nodes, weights,
        np.array(row.scheme.estimators), flags, scale,
        system.bodies, system.loads, system.islands, system.gravity, scratch, evaluations,
    )  # fmt: skip
    stacked[_members(system.islands, evaluations < 0)] = np.nan
    most = int(evaluations.max(initial=0))
    end, counted = state.time + span, state.evaluations + most
    return State(end, *_unstack(stacked, row, system), ledger, counted, _kept(scratch, row))


def kernel_of(method: str) -> Callable:
    """The loop that moves bodies by this method."""
    scheme = METHODS[method].scheme
    if METHODS[method].is_adaptive:
        return step_adaptively
    if isinstance(scheme, Splitting):
        return step_by_splitting
    return step_by_runge_kutta if isinstance(scheme, RungeKutta) else step_on_group


def _working_memory(state: State, row: Method, system: System) -> tuple[Array, Array, Scratch]:
    """State in rows, ledger and scratch; no scratch where every body flies by itself."""
    stacked = _stack(state, row, system)
    if not system.bodies.is_pushed.any() and (row.flies_exactly or isinstance(row.scheme, RungeKutta)):
        return stacked, state.ledger, _NO_SCRATCH
    scratch = scratch_for(len(stacked), row.evaluations)
    scratch.stage[:] = stacked
    if state.rest is not None:
        scratch.rest[:] = state.rest
    return stacked, state.ledger.copy(), scratch


def _kept(scratch: Scratch, row: Method) -> Array | None:
    """The rests for the next call; those of ω in world axes are none of the angular momentum that a state has."""
    return None if _is_world(row) or not len(scratch.rest) else scratch.rest


@functools.cache
def _shares(scheme: Splitting) -> tuple[Array, Array]:
    return np.array(scheme.parts), np.array(scheme.times)


@functools.cache
def _coefficients(scheme: RungeKutta) -> tuple[Array, Array, Array, NDArray[np.int64]]:
    stages = len(scheme.weights)
    tableau = np.zeros((stages, stages))
    for s, row in enumerate(scheme.tableau):
        tableau[s, : len(row)] = row
    flags = [scheme.is_world, scheme.is_symplectic_euler, scheme.normalizes, scheme.flies_exactly]
    return tableau, np.array(scheme.nodes), np.array(scheme.weights), np.array(flags, dtype=np.int64)


def _evaluations(row: Method, n_steps: int) -> int:
    """Of the loads of one body; a call that begins with a kick also ends with one."""
    begins_with_kick = isinstance(row.scheme, Splitting) and row.scheme.begins_with_kick
    return row.evaluations * n_steps + (1 if begins_with_kick else 0)


def _members(islands: Islands, chosen: NDArray[np.bool_]) -> NDArray[np.int64]:
    return islands.member[np.repeat(chosen, np.diff(islands.first))]


def angular_velocity_world(state: State, bodies: Bodies) -> Array:
    """ω = R I⁻¹ L, (n, 3) rad/s."""
    unit = quaternion.normalize(state.quaternion)
    return quaternion.rotate(unit, state.angular_momentum * bodies.inverse_moments)


def _stack(state: State, row: Method, system: System) -> Array:
    spin = angular_velocity_world(state, system.bodies) if _is_world(row) else state.angular_momentum
    return np.concatenate([state.position, state.quaternion, state.velocity, spin], axis=1)


def _unstack(stacked: Array, row: Method, system: System) -> tuple[Array, Array, Array, Array]:
    """Position, quaternion, velocity and angular momentum, out of their columns."""
    position, attitude = stacked[:, POSITION:QUATERNION], stacked[:, QUATERNION:VELOCITY]
    velocity, spin = stacked[:, VELOCITY:SPIN], stacked[:, SPIN:]
    if _is_world(row):
        in_body = quaternion.rotate_back(quaternion.normalize(attitude), spin)
        spin = in_body / system.bodies.inverse_moments
    return position, attitude, velocity, spin


def _is_world(row: Method) -> bool:
    return isinstance(row.scheme, RungeKutta) and row.scheme.is_world
