"""The free rotors against 50 digits, in every regime of the body and of its motion, and against themselves."""

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest
from rotor_reference import exact_long_turn, exact_turn, period_of

from rbfem.compute.loops import loop
from rbfem.motion.jacobi import complete_integrals, elliptic
from rbfem.motion.rotor import turn_by_splitting, turn_freely

TURN = 2.0 * math.pi


def turn_each(states, reciprocals, durations):
    for i in range(len(durations)):
        (
            states[i, 0],
            states[i, 1],
            states[i, 2],
            states[i, 3],
            states[i, 4],
            states[i, 5],
            states[i, 6],
        ) = turn_freely(
            states[i, 0],
            states[i, 1],
            states[i, 2],
            states[i, 3],
            states[i, 4],
            states[i, 5],
            states[i, 6],
            reciprocals[i, 0],
            reciprocals[i, 1],
            reciprocals[i, 2],
            durations[i],
        )


def turn_on_and_on(state, reciprocals, duration, n_calls):
    q0, q1, q2, q3, l1, l2, l3 = state[0], state[1], state[2], state[3], state[4], state[5], state[6]
    r1, r2, r3 = reciprocals[0], reciprocals[1], reciprocals[2]
    for _ in range(n_calls):
        q0, q1, q2, q3, l1, l2, l3 = turn_freely(q0, q1, q2, q3, l1, l2, l3, r1, r2, r3, duration)
    state[0], state[1], state[2], state[3], state[4], state[5], state[6] = q0, q1, q2, q3, l1, l2, l3


def attitude_error(state, exact):
    """Angle between two attitudes, rad, without loss of digits where they are close."""
    (a0, a1, a2, a3), (b0, b1, b2, b3) = [Fraction(float(x)) for x in state[:4]], exact[:4]
    turn = (
        a0 * b1 - a1 * b0 - a2 * b3 + a3 * b2,
        a0 * b2 - a2 * b0 - a3 * b1 + a1 * b3,
        a0 * b3 - a3 * b0 - a1 * b2 + a2 * b1,
    )
    return 2.0 * math.hypot(*(float(x) for x in turn))


def momentum_error(state, exact):
    """Relative to |L|."""
    differences = (Fraction(float(x)) - y for x, y in zip(state[4:], exact[4:], strict=True))
    return math.hypot(*(float(x) for x in differences)) / math.hypot(*(float(x) for x in exact[4:]))


def relative_change(state, start, weights):
    """Of the sum of weight l², in exact numbers: |L|² for weights of one, twice the energy for the reciprocals."""
    sums = [
        sum(Fraction(w) * Fraction(float(x)) ** 2 for w, x in zip(weights, s[4:], strict=True)) for s in (state, start)
    ]
    return float(sums[0] / sums[1] - 1)


# Regimes: each draws principal moments and a momentum.


def any_body(rng):
    moments = np.sort(rng.uniform(1.0, 3.0, 3))
    moments[2] = min(moments[2], moments[0] + moments[1])
    return rng.permutation(moments), rng.normal(size=3)


def spherical(rng):
    return 2.0 * (1.0 + rng.choice([0.0, 2.3e-16, 1e-13, 1e-9], size=3)), rng.normal(size=3)


def symmetric(rng):
    moments, momentum = any_body(rng)
    i, j, _ = rng.permutation(3)
    moments[i] = moments[j]
    return moments, momentum


def near_symmetric(rng):
    moments, momentum = any_body(rng)
    i, j, _ = rng.permutation(3)
    moments[i] = moments[j] * (1.0 + 10.0 ** rng.uniform(-15.9, -4.0))
    return moments, momentum


def separatrix(rng):
    moments = np.sort(any_body(rng)[0])
    low, middle, high = 1.0 / moments
    off = 1.0 + rng.choice([0.0, 1e-15, 1e-12, -1e-8])
    momentum = np.array([math.sqrt(middle - high), rng.normal(), math.sqrt(low - middle) * off]) * rng.choice(
        [-1, 1], 3
    )
    order = rng.permutation(3)
    return moments[order], momentum[order] / np.linalg.norm(momentum)


def near_stable_axis(rng):
    moments, momentum = any_body(rng)
    axis = rng.choice(np.argsort(moments)[[0, 2]])
    momentum[np.arange(3) != axis] *= 10.0 ** rng.uniform(-16.0, -4.0)
    return moments, momentum


def near_unstable_axis(rng):
    moments, momentum = any_body(rng)
    momentum[np.argsort(moments)[[0, 2]]] *= 10.0 ** rng.uniform(-16.0, -4.0)
    return moments, momentum


def on_an_axis(rng):
    moments, momentum = any_body(rng)
    momentum[rng.permutation(3)[:2]] = 0.0
    return moments, momentum


def flat(rng):
    a, b = rng.uniform(1.0, 2.0, 2)
    return rng.permutation([a, b, a + b]), rng.normal(size=3)


def needle(rng):
    return rng.permutation([1e-3, 1.0, 1.0 + rng.choice([0.0, 5e-4, 1e-3])]), rng.normal(size=3)


REGIMES = (
    any_body,
    spherical,
    symmetric,
    near_symmetric,
    separatrix,
    near_stable_axis,
    near_unstable_axis,
    on_an_axis,
    flat,
    needle,
)


def draws(regime, n, farthest, seed=1):
    """n states, reciprocal moments, and durations of either sign in which the body turns by up to `farthest`, rad."""
    rng = np.random.default_rng(seed)
    states, reciprocals, durations = np.zeros((n, 7)), np.zeros((n, 3)), np.zeros(n)
    for i in range(n):
        moments, momentum = regime(rng)
        attitude = rng.normal(size=4)
        states[i] = np.concatenate([attitude / np.linalg.norm(attitude), momentum])
        reciprocals[i] = 1.0 / moments
        durations[i] = rng.uniform(-farthest, farthest) / np.linalg.norm(momentum / moments)
    return states, reciprocals, durations


# Measured over 60000 draws of each regime: half are below 1.7e-16, 99 in 100 below 5.2e-16, the worst is 1.7e-15; of
# the momentum 99 in 100 are below 3e-16, the worst is 1.4e-15. A needle comes to 3.5e-15 within a turn.
@pytest.mark.parametrize("regime", REGIMES, ids=lambda regime: regime.__name__)
def test_one_call_of_up_to_a_turn_is_exact_to_rounding(regime):
    start, reciprocals, durations = draws(regime, 12, TURN)
    ends = [start.copy(), start.copy()]
    for states, backend in zip(ends, ("python", "serial"), strict=True):
        loop(turn_each, backend)(states, reciprocals, durations)
    for i, duration in enumerate(durations):
        exact = exact_turn(start[i], reciprocals[i], duration)
        for states in ends:
            assert attitude_error(states[i], exact) < (4e-15 if regime is needle else 2e-15)
            assert momentum_error(states[i], exact) < 2e-15
            assert abs(np.linalg.norm(states[i, :4]) - 1.0) < 5e-16


# The worst of half a million random calls of up to a turn, and two that come to 5.3e-15 and 3.9e-15 where the whole
# angle about L is a single float.
WORST = (
    (
        (
            0.7078970237046724,
            -0.02869667677914797,
            -0.49917900724559505,
            -0.4988773629833303,
            -0.11256872253759728,
            -0.6652561787997598,
            0.2823684509927776,
        ),
        (0.38850864383775213, 0.38850864383775213, 0.9069143430320941),
        14.729372978034277,
    ),
    (
        (
            -0.06417771493135109,
            0.4051763295748559,
            0.654978425728788,
            -0.6345995782288835,
            0.7183168345675074,
            -0.3589643962947914,
            0.160936659887492,
        ),
        (0.3645630721402481, 0.9636392306716872, 0.3645922038635034),
        13.958396208876383,
    ),
    (
        (
            -0.5055038098082446,
            0.6097288483132024,
            -0.6099682679352567,
            0.025205989686360696,
            0.7041558948594862,
            0.24927079554223477,
            0.7474245838078257,
        ),
        (0.9525841634684796, 0.45877477802668837, 0.3454883259640557),
        8.088145775569652,
    ),
    (
        (
            -0.5706321773338404,
            -0.752914166563849,
            0.17320559510504083,
            -0.27838641813675796,
            0.0890831023756443,
            -2.769565043738603,
            -0.8571378915598805,
        ),
        (0.8987112873052562, 0.5490810812699864, 0.3408398718586461),
        3.9116504125121816,
    ),
    (
        (
            -0.6621081835776804,
            -0.30861161745373866,
            -0.0970653308781333,
            -0.67598072779745,
            -1.8032374474995525,
            0.45924175249211774,
            0.8372233791396827,
        ),
        (0.9828627467868143, 0.44344293431321413, 0.807985784696444),
        -2.8650754238659677,
    ),
    (
        (
            0.5037076404556409,
            0.0025659348562303845,
            0.032814297336944916,
            0.8632469234322281,
            -2.4810354683871775e-05,
            3.0109105335320316e-05,
            -0.1787230989215279,
        ),
        (0.5575851081598366, 0.35418210525683824, 0.7044028878475389),
        46.35425171979533,
    ),
)


@pytest.mark.parametrize(("start", "reciprocals", "duration"), WORST)
def test_the_worst_calls_of_a_long_search_are_exact_to_rounding(start, reciprocals, duration):
    exact = exact_turn(start, reciprocals, duration)
    compiled = np.array([start])
    loop(turn_each, "serial")(compiled, np.array([reciprocals]), np.array([duration]))
    for state in (turn_freely(*start, *reciprocals, duration), compiled[0]):
        assert attitude_error(state, exact) < 2e-15
        assert momentum_error(state, exact) < 2e-15


def test_a_needle_that_spins_many_turns_keeps_its_attitude():
    # Measured: 9e-14 rad over 200 rad.
    start, reciprocals, durations = draws(needle, 2, 120.0)
    states = start.copy()
    loop(turn_each, "serial")(states, reciprocals, durations)
    errors = [attitude_error(states[i], exact_turn(start[i], reciprocals[i], durations[i])) for i in range(2)]
    assert max(errors) < 3e-13


@pytest.mark.parametrize("moments", list(itertools.permutations((1.0, 1.7, 2.4))))
def test_any_order_of_the_axes_and_any_signs_of_the_momentum(moments):
    # Two motions of each: about the axis of the smallest moment and about that of the largest.
    reciprocals = [1.0 / x for x in moments]
    sizes = ({1.0: 0.9, 1.7: 0.7, 2.4: 0.4}, {1.0: 0.3, 1.7: 0.6, 2.4: 0.9})
    for (size, duration), signs in itertools.product(
        zip(sizes, (2.0, -8.0), strict=True), itertools.product((1.0, -1.0), repeat=3)
    ):
        start = (0.5, -0.5, 0.5, 0.5, *(s * size[x] for s, x in zip(signs, moments, strict=True)))
        exact = exact_turn(start, reciprocals, duration)
        state = turn_freely(*start, *reciprocals, duration)
        assert attitude_error(state, exact) < 2e-15
        assert momentum_error(state, exact) < 2e-15


@pytest.mark.parametrize("factor", [1.0, 1.0 + 2.3e-16, 1.0 + 1e-12])
@pytest.mark.parametrize("axis", range(3))
def test_a_symmetric_body_precesses_as_the_closed_form_says(axis, factor):
    # With two equal moments: q e^(half the turn about L at |L|/I) e^(half the spin about the axis of symmetry).
    moments = [1.5, 1.5 * factor, 0.8]
    moments, momentum = np.roll(moments, axis), np.roll([0.3, -0.8, 1.1], axis)
    symmetry = np.roll([0.0, 0.0, 1.0], axis)
    duration, length = 1.3, np.linalg.norm(momentum)
    about_momentum = duration * length / 1.5
    spin = duration * (1.0 / 0.8 - 1.0 / 1.5) * 1.1
    first = np.concatenate([[math.cos(about_momentum / 2)], math.sin(about_momentum / 2) * momentum / length])
    second = np.concatenate([[math.cos(spin / 2)], math.sin(spin / 2) * symmetry])
    expected = np.concatenate(
        [
            [first[0] * second[0] - first[1:] @ second[1:]],
            first[0] * second[1:] + second[0] * first[1:] + np.cross(first[1:], second[1:]),
        ]
    )
    state = turn_freely(1.0, 0.0, 0.0, 0.0, *momentum.tolist(), *(1.0 / moments).tolist(), duration)
    assert np.abs(state[:4] - expected).max() < max(1e-15, factor - 1.0)


@pytest.mark.parametrize("rotor", [turn_freely, turn_by_splitting])
def test_a_body_at_rest_stays_and_no_time_moves_nothing(rotor):
    at_rest = (0.5, 0.5, -0.5, 0.5, 0.0, 0.0, 0.0)
    assert rotor(*at_rest, 1.0, 0.5, 0.25, 1e9) == at_rest
    moving = (0.5, 0.5, -0.5, 0.5, 1.0, 2.0, 3.0)
    assert rotor(*moving, 1.0, 0.5, 0.25, 0.0) == moving


@pytest.mark.parametrize("regime", REGIMES[:-1], ids=lambda regime: regime.__name__)
def test_a_turn_and_its_reverse_leave_nothing(regime):
    # Measured: 2.0e-15, the sum of two calls.
    start, reciprocals, durations = draws(regime, 100, TURN)
    states = start.copy()
    loop(turn_each, "serial")(states, reciprocals, durations)
    assert np.abs(states - start).max() > 0.1 or regime is near_stable_axis
    loop(turn_each, "serial")(states, reciprocals, -durations)
    for i in range(len(durations)):
        exact = [Fraction(x) for x in start[i]]
        assert attitude_error(states[i], exact) < 6e-15
        assert momentum_error(states[i], exact) < 6e-15


@pytest.mark.parametrize("regime", [any_body, symmetric, flat, near_symmetric], ids=lambda regime: regime.__name__)
def test_two_long_turns_make_one(regime):
    # Each rounds its angle, of a few thousand radians, to some 1e-16 of it.
    start, reciprocals, durations = draws(regime, 50, 5000.0)
    once, twice = start.copy(), start.copy()
    loop(turn_each, "serial")(once, reciprocals, 1.375 * durations)
    loop(turn_each, "serial")(twice, reciprocals, durations)
    loop(turn_each, "serial")(twice, reciprocals, 0.375 * durations)
    for a, b in zip(once, twice, strict=True):
        assert attitude_error(a, [Fraction(x) for x in b]) < 1e-10


BODIES = {
    "about the smallest moment": ((1.0, 2.0, 3.0), (1.0, 0.5, 0.7)),
    "about the largest moment": ((2.0, 3.0, 1.0), (0.3, 2.0, 0.2)),
    "flat": ((1.2, 2.9, 1.7), (0.8, -0.6, 0.5)),
    "nearly symmetric": ((1.0, 1.0 + 1e-9, 1.6), (0.7, 0.2, -1.1)),
}


@pytest.mark.parametrize("body", BODIES)
def test_a_million_revolutions_in_one_call(body):
    # Measured: 6e-10 rad at most, of four durations.
    moments, momentum = BODIES[body]
    reciprocals, start = [1.0 / x for x in moments], (0.5, 0.5, 0.5, 0.5, *momentum)
    duration = 1e6 * TURN / math.hypot(*(x * r for x, r in zip(momentum, reciprocals, strict=True)))
    state = turn_freely(*start, *reciprocals, duration)
    assert attitude_error(state, exact_long_turn(start, reciprocals, duration)) < 2e-9


@pytest.mark.parametrize("body", ["about the smallest moment", "nearly symmetric"])
def test_a_million_revolutions_in_four_calls_each(body):
    # Measured over fifteen bodies: 2e-8 to 6e-7 rad, the random walk of a momentum that is rounded four million times.
    moments, momentum = BODIES[body]
    reciprocals, start = [1.0 / x for x in moments], (0.5, 0.5, 0.5, 0.5, *momentum)
    quarter = 0.25 * TURN / math.hypot(*(x * r for x, r in zip(momentum, reciprocals, strict=True)))
    state = np.array(start)
    loop(turn_on_and_on, "serial")(state, np.array(reciprocals), quarter, 4_000_000)
    exact = exact_long_turn(start, reciprocals, 4_000_000 * Fraction(quarter))
    assert attitude_error(state, exact) < 1e-6
    assert abs(relative_change(state, start, (1.0, 1.0, 1.0))) < 1e-12
    assert abs(relative_change(state, start, reciprocals)) < 1e-12


def test_the_length_of_the_momentum_of_a_symmetric_body_does_not_creep():
    # The same share of a rounding in every call would come to 1e-11 in a million; a random walk comes to 5e-14.
    start, reciprocals, _ = draws(symmetric, 5, TURN)
    for state, rates in zip(start, reciprocals, strict=True):
        end = state.copy()
        loop(turn_on_and_on, "serial")(end, rates, 1.111, 200_000)
        assert abs(relative_change(end, state, (1.0, 1.0, 1.0))) < 2e-13


def test_on_the_separatrix_the_body_ends_on_its_middle_axis_however_long_the_duration():
    # Reciprocals 1, 2, 3: with equal outer components the energy is exactly that of the middle axis.
    moving = turn_freely(1.0, 0.0, 0.0, 0.0, 0.5, 0.25, 0.5, 1.0, 2.0, 3.0, 1e6)
    length = math.hypot(0.5, 0.25, 0.5)
    assert abs(moving[5]) == pytest.approx(length, rel=1e-15)
    assert abs(moving[4]) + abs(moving[6]) < 1e-15
    # There it turns by |L| r t; composed of two calls it is the same attitude.
    later = turn_freely(*moving, 1.0, 2.0, 3.0, 5e5)
    exact = turn_freely(1.0, 0.0, 0.0, 0.0, 0.5, 0.25, 0.5, 1.0, 2.0, 3.0, 1.5e6)
    assert attitude_error(later, [Fraction(x) for x in exact]) < 1e-8


def test_the_middle_axis_itself_holds_a_spin_for_ever():
    state = turn_freely(1.0, 0.0, 0.0, 0.0, 0.0, 0.25, 0.0, 1.0, 2.0, 3.0, 1e6)
    assert state[4:] == (0.0, 0.25, 0.0)
    assert attitude_error(state, [Fraction(x) for x in (math.cos(2.5e5), 0.0, math.sin(2.5e5), 0.0)]) < 1e-10


@pytest.mark.parametrize("rotor", [turn_freely, turn_by_splitting])
@pytest.mark.parametrize("size", [math.inf, math.nan, 1e200, 1e30])
def test_what_is_no_motion_any_more_gives_no_attitude_and_ends(rotor, size):
    # Numba's inlined text is the same; that it ends there too is what this would hang on.
    assert all(map(math.isnan, rotor(1.0, 0.0, 0.0, 0.0, size, 1.0, 2.0, 1.0, 0.5, 0.25, 1.0)[:4]))
    if rotor is turn_freely:
        states = np.array([[1.0, 0.0, 0.0, 0.0, size, 1.0, 2.0]])
        loop(turn_each, "serial")(states, np.array([[1.0, 0.5, 0.25]]), np.ones(1))
        assert np.isnan(states[0, :4]).all()


@pytest.mark.parametrize("scale", [1e-24, 1e18])
def test_the_unit_of_mass_does_not_matter(scale):
    start, reciprocals, durations = draws(any_body, 5, TURN)
    for state, rates, duration in zip(start.tolist(), reciprocals.tolist(), durations.tolist(), strict=True):
        plain = turn_freely(*state, *rates, duration)
        scaled = turn_freely(*state[:4], *(scale * x for x in state[4:]), *(x / scale for x in rates), duration)
        assert attitude_error(scaled, [Fraction(x) for x in plain]) < 4e-15


def splitting_error(n_steps, start, reciprocals, duration, exact):
    state = start
    for _ in range(n_steps):
        state = turn_by_splitting(*state, *reciprocals, duration / n_steps)
    return attitude_error(state, exact)


def test_the_split_rotor_is_of_second_order():
    start, reciprocals, duration = (1.0, 0.0, 0.0, 0.0, 0.9, 0.7, 0.4), (1.0, 0.6, 0.45), 3.0
    exact, steps = exact_turn(start, reciprocals, duration), (40, 80, 160, 320)
    errors = [splitting_error(n, start, reciprocals, duration, exact) for n in steps]
    assert -np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(2.0, abs=0.02)


def test_a_split_step_back_undoes_a_split_step():
    start = (0.5, 0.5, -0.5, 0.5, 0.9, 0.7, 0.4)
    there = turn_by_splitting(*start, 1.0, 0.6, 0.45, 0.8)
    back = turn_by_splitting(*there, 1.0, 0.6, 0.45, -0.8)
    assert np.abs(np.subtract(back, start)).max() < 1e-15
    assert np.abs(np.subtract(there, start)).max() > 0.1


def test_the_elliptic_functions_and_integrals_of_a_full_modulus_range_agree_with_scipy():
    from scipy import special

    for modulus in (0.0, 0.3, 0.9, 1.0 - 1e-9):
        s, c, d = elliptic(0.4, 4.0, 4.0 * modulus)
        sn, cn, dn, _ = special.ellipj(0.8, modulus)
        assert (2.0 * s, c, d) == pytest.approx((sn, cn, dn), rel=3e-15)
        first, third = complete_integrals(2.0, 2.0 * math.sqrt(1.0 - modulus), 1.6, 1.0, 1.0)
        assert first == pytest.approx(0.5 * special.ellipkm1(1.0 - modulus), rel=2e-15)
        # Π(n, k) by Carlson's forms.
        legendre = special.elliprf(0, 1 - modulus, 1) - 0.2 * special.elliprj(0, 1 - modulus, 1, 1.6)
        assert third == pytest.approx(0.5 * legendre, rel=4e-15)


def test_the_reference_over_many_periods_is_the_reference_step_by_step():
    start, reciprocals, duration = (0.5, 0.5, 0.5, 0.5, 1.0, 0.5, -1.3), (1.0, 0.5, 0.3), 30.0
    plain, by_periods = exact_turn(start, reciprocals, duration), exact_long_turn(start, reciprocals, duration)
    assert duration > 2 * period_of(start[4:], reciprocals)
    assert max(abs(float(abs(x) - abs(y))) for x, y in zip(plain, by_periods, strict=True)) < 1e-48
