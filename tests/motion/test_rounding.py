"""What a hundred thousand steps round off: next to nothing, since every sum carries what its additions lose."""

import math
from fractions import Fraction

import numpy as np
import pytest
from motion_scenes import GRAVITY, Body, Load, Setting, build, swinging_box
from rotor_reference import exact_turn
from test_rotor import REGIMES, draws

from rbfem.motion import loads as kinds
from rbfem.motion import quaternion
from rbfem.motion.methods import METHODS
from rbfem.motion.model import TRANSLATING
from rbfem.motion.rotor import PANEL
from rbfem.motion.short_turn import is_short, short_turn
from rbfem.motion.state import move

EVALUATIONS, SECONDS = 100_000, 16.0


def asymmetric_top():
    body = Body(1.0, (1.0, 2.0, 2.5), omega=(2.0, -1.0, 1.5), arm=(0.1, -0.05, 0.12), is_held=True)
    return Setting((body,), GRAVITY)


# Farthest from the start, rad. Measured: 2e-16 to 8e-16, and 1e-15 to 3e-15; with plain sums 2e-13 to 4e-13, and 2e-12
# to 7e-12.
RETURNS = {asymmetric_top: 5e-15, swinging_box: 3e-14}


@pytest.mark.parametrize("scene", RETURNS, ids=lambda scene: scene.__name__)
@pytest.mark.parametrize("method", ["kdk", "rkn4", "rkn6", "aba864"])
def test_as_many_steps_back_as_forth_end_where_they_began(method, scene):
    """These methods are their own inverse with the step reversed: whatever is left is rounding."""
    system, start = build(scene())
    n_steps = EVALUATIONS // METHODS[method].evaluations
    there = move(start, SECONDS / n_steps, n_steps, method, system, "serial")
    back = move(there, -SECONDS / n_steps, n_steps, method, system, "serial")
    assert quaternion.angle_between(there.quaternion, start.quaternion)[0] > 0.1
    assert quaternion.angle_between(back.quaternion, start.quaternion)[0] < RETURNS[scene]
    lost = np.linalg.norm(back.angular_momentum - start.angular_momentum)
    assert lost < RETURNS[scene] * np.linalg.norm(start.angular_momentum)


@pytest.mark.parametrize("method", ["kdk", "rkn6", "rk4", "dop853_fixed", "lie_rk4"])
def test_a_parabola_of_many_pieces_is_that_of_one(method):
    """Measured: 4e-16 at most, and 3e-13 without the sums that carry on."""
    velocity, force, mass = np.array([0.1, 0.2, 0.3]), np.array([0.3, 0.7, 0.11]), 2.0
    body = Body(mass, velocity=tuple(velocity), model=TRANSLATING, loads=(Load(kinds.FORCE, tuple(force)),))
    system, start = build(Setting((body,)))
    n_steps = EVALUATIONS // METHODS[method].evaluations
    end = move(start, 10.0 / n_steps, n_steps, method, system, "serial")
    exact = 10.0 * velocity + 50.0 * force / mass
    assert np.abs(end.position[0] / exact - 1.0).max() < 3e-15


@pytest.mark.parametrize("method", ["kdk", "aba864", "lie_rk4"])
def test_a_spin_of_many_pieces_is_that_of_one(method):
    """A ball turns at one rate, which these methods have exactly. Measured: 4e-15 rad, and 2e-12 for `kdk` without."""
    omega = np.array([1.0, 2.0, 3.0])
    system, start = build(Setting((Body(moments=(2.0, 2.0, 2.0), omega=tuple(omega)),)), is_pushed=True)
    n_steps = EVALUATIONS // METHODS[method].evaluations
    end = move(start, 10.0 / n_steps, n_steps, method, system, "serial")
    half = 5.0 * np.linalg.norm(omega)
    exact = np.concatenate([[np.cos(half)], np.sin(half) * omega / np.linalg.norm(omega)])
    assert quaternion.angle_between(end.quaternion, exact[None])[0] < 2e-14
    assert np.linalg.norm(end.quaternion) == pytest.approx(1.0, abs=1e-15)
    assert np.abs(end.angular_momentum - start.angular_momentum).max() < 1e-13


def test_what_is_rounded_off_is_carried_from_call_to_call():
    """Five thousand calls lose no more than one. Measured: 3e-17 apart, and 9e-14 if each call began without rests."""
    system, start = build(asymmetric_top())
    once = move(start, SECONDS / 20_000, 20_000, "kdk", system, "serial")
    state = start
    for _ in range(5000):
        state = move(state, SECONDS / 20_000, 4, "kdk", system, "serial")
    assert quaternion.angle_between(state.quaternion, once.quaternion)[0] < 3e-15


@pytest.mark.parametrize("regime", REGIMES, ids=lambda regime: regime.__name__)
def test_the_changes_of_a_short_turn_are_exact_to_rounding_of_the_turn(regime):
    states, reciprocals, _ = draws(regime, 6, 1.0)
    for state, rates in zip(states, reciprocals, strict=True):
        momentum = state[4:]
        for angle in (PANEL, 0.05, -1e-3, 1e-7):
            duration = 0.999 * angle / (np.linalg.norm(momentum) * rates.max())
            assert is_short(*momentum, *rates, duration)
            _, *turn = short_turn(*momentum, *rates, duration)
            exact = exact_turn((1.0, 0.0, 0.0, 0.0, *momentum), rates, duration)
            wanted = [*exact[1:4], *(x - Fraction(y) for x, y in zip(exact[4:], momentum, strict=True))]
            apart = [float(Fraction(x) - y) for x, y in zip(turn, wanted, strict=True)]
            assert math.hypot(*apart[:3]) < 1e-15 * abs(angle)
            assert math.hypot(*apart[3:]) < 1e-15 * abs(angle) * np.linalg.norm(momentum)
