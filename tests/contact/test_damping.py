"""The damping ratio and the restitution that comes of it, against an integration of the impact itself."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from rbfem.contact.damping import damping_ratio_for, restitution_of
from rbfem.contact.laws import damping_coefficient, normal_stiffness
from rbfem.contact.model import HERTZ, LINEAR

RATIOS = [0.05, 0.25, 0.7, 0.999, 1.0, 1.3, 2.5]


def impact(law, ratio, speed, mass=0.7, modulus=3.0, radius=0.4):
    """Speed of departure by that of approach, of an impact followed until its force would pull."""

    def forces(overlap, approach):
        stiffness = normal_stiffness(law, modulus, max(overlap, 0.0), radius)
        return stiffness * overlap + damping_coefficient(law, ratio, stiffness, mass, overlap, 0.0, 0.0) * approach

    def push(_, state):
        return forces(*state) if state[1] < 0.0 else math.inf  # the end is looked for on the way out alone

    push.terminal = True
    start = [1e-12 * speed, speed]
    found = solve_ivp(
        lambda _, state: [state[1], -forces(*state) / mass], (0.0, 1e4), start, events=push, rtol=1e-11, atol=1e-15
    )
    return -found.y_events[0][0, 1] / speed


@pytest.mark.parametrize("ratio", RATIOS)
def test_the_restitution_of_a_linear_spring_that_never_pulls_is_the_formula(ratio):
    assert impact(LINEAR, ratio, 0.3) == pytest.approx(restitution_of(ratio), rel=3e-9)  # measured 8e-10


@pytest.mark.parametrize("speed", [0.01, 10.0])
@pytest.mark.parametrize("ratio", [0.05, 0.25, 0.7, 1.3])
def test_hertz_s_contact_has_the_same_restitution_at_every_speed(ratio, speed):
    assert impact(HERTZ, ratio, speed) == pytest.approx(restitution_of(ratio), rel=3e-6)  # measured 1e-6


def test_no_damping_gives_everything_back_and_much_damping_nearly_nothing():
    assert restitution_of(0.0) == 1.0
    assert damping_ratio_for(1.0) == 0.0
    assert restitution_of(50.0) == pytest.approx(1.0 / 100.0**2, rel=5e-3)  # 1/(2 ζ)² + O(log ζ/ζ⁴)


def test_the_restitution_does_not_jump_where_the_swing_becomes_a_creep():
    assert restitution_of(1.0 - 1e-9) == pytest.approx(restitution_of(1.0), rel=1e-8)
    assert restitution_of(1.0 + 1e-9) == pytest.approx(restitution_of(1.0), rel=1e-8)


@given(st.floats(1e-4, 1.0))
def test_the_damping_ratio_found_for_a_restitution_gives_it_back(restitution):
    assert restitution_of(damping_ratio_for(restitution)) == pytest.approx(restitution, rel=1e-10)


@given(st.floats(0.0, 5.0), st.floats(1e-3, 1.0))
def test_more_damping_leaves_less_speed(ratio, more):
    assert restitution_of(ratio + more) < restitution_of(ratio)
