"""What theory says of the longest stable step: a method on the damped oscillator, as a matrix."""

import numpy as np
from numpy.typing import NDArray

from rbfem.motion.free_flight import CONSTANT_RATE
from rbfem.motion.methods import METHODS, RungeKutta, Splitting

Array = NDArray[np.float64]

FINEST, LONGEST = 2e-3, 12.0  # steps tried, times the fastest rate: no method of the table stands the longest
GROWS = 1e-7  # above one: a double eigenvalue on the unit circle is found to the root of the rounding only


def stable_step(method: str, oscillation: float, decay: float) -> float:
    """The step up to which the oscillator x'' = -ω² x - 2β x' does not grow, s; infinite if it never does.

    The largest eigenvalue of the matrix of a step has size one there. Without damping that is the method's own limit,
    2/ω for one kick a step. With a dashpot that is computed with the old velocity the limit of one kick a step becomes
    2 (√(1 + ζ²) - ζ)/ω, ζ = β/ω; with one by the implicit midpoint rule it stays 2/ω. Both follow from Jury's
    criterion, 1 + trace + determinant > 0.

    oscillation : ω, rad/s    decay : β, 1/s    Spin is not in it.

    >>> round(stable_step("kdk", 10.0, 0.0), 3), round(stable_step("kdk", 10.0, 5.0), 3)
    (0.2, 0.2)
    >>> round(stable_step("spiral", 10.0, 5.0), 2), stable_step("euler", 10.0, 0.0)
    (0.12, 0.0)
    """
    rate = max(oscillation, decay)
    if rate == 0.0:
        return np.inf
    steps = np.arange(FINEST, LONGEST, FINEST) / rate
    size = np.abs(np.linalg.eigvals(step_matrix(method, steps, oscillation, decay))).max(axis=1)
    unstable = np.flatnonzero(size > 1.0 + GROWS)
    if not len(unstable):
        return np.inf
    return float(steps[unstable[0] - 1]) if unstable[0] else 0.0


def step_matrix(method: str, steps: Array, oscillation: float, decay: float) -> Array:
    """(k, 2, 2) what one step of each length makes of (x, x') of the oscillator of `stable_step`."""
    scheme = METHODS[method].scheme
    if isinstance(scheme, Splitting):
        return _of_splitting(scheme, steps, oscillation, decay)
    if isinstance(scheme, RungeKutta) and scheme.is_symplectic_euler:
        return _flight(steps) @ _explicit_kick(steps, oscillation, decay)
    # On a vector space the method on the group is the classical one.
    return _of_runge_kutta(scheme if isinstance(scheme, RungeKutta) else _classical(), steps, oscillation, decay)


def _classical() -> RungeKutta:
    scheme = METHODS["rk4"].scheme
    assert isinstance(scheme, RungeKutta)
    return scheme


def _of_runge_kutta(scheme: RungeKutta, steps: Array, oscillation: float, decay: float) -> Array:
    rate = steps[:, None, None] * np.array([[0.0, 1.0], [-(oscillation**2), -2.0 * decay]])
    slopes: list[Array] = []
    for row in scheme.tableau:
        slopes.append(rate @ (np.eye(2) + sum(a * slope for a, slope in zip(row, slopes, strict=False))))
    return np.eye(2) + sum(b * slope for b, slope in zip(scheme.weights, slopes, strict=True))


def _of_splitting(scheme: Splitting, steps: Array, oscillation: float, decay: float) -> Array:
    """The last part of a step and the first of the next are done as one, as in a run."""
    kick = _explicit_kick if scheme.rotor == CONSTANT_RATE else _midpoint_kick
    shares = [*scheme.parts[1:-1], scheme.parts[-1] + scheme.parts[0]]
    matrix = np.broadcast_to(np.eye(2), (len(steps), 2, 2))
    for i, share in enumerate(shares, start=1):
        part = kick(share * steps, oscillation, decay) if scheme.is_kick(i) else _flight(share * steps)
        matrix = part @ matrix
    return matrix


def _flight(steps: Array) -> Array:
    """x + h v, v"""
    return _rows(1.0, steps, 0.0, 1.0)


def _explicit_kick(steps: Array, oscillation: float, decay: float) -> Array:
    """x, v - h (ω² x + 2β v)"""
    return _rows(1.0, 0.0, -steps * oscillation**2, 1.0 - 2.0 * steps * decay)


def _midpoint_kick(steps: Array, oscillation: float, decay: float) -> Array:
    """x, V with V = v - h (ω² x + β (v + V))"""
    implicit = 1.0 + steps * decay
    return _rows(1.0, 0.0, -steps * oscillation**2 / implicit, (1.0 - steps * decay) / implicit)


def _rows(a, b, c, d) -> Array:
    """(k, 2, 2) of its entries, each a number or (k,)."""
    a, b, c, d = np.broadcast_arrays(a, b, c, d)
    return np.stack([np.stack([a, b], axis=-1), np.stack([c, d], axis=-1)], axis=-2)
