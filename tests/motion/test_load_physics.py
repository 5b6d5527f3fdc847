"""Each kind of load against its closed form."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from motion_reference import matrix_of
from motion_scenes import Body, Load, Setting, build, spring_between

from rbfem.motion import loads as kinds
from rbfem.motion.loads import load_wrench, ramp_factor, spring_damper
from rbfem.motion.model import TRANSLATING
from rbfem.motion.state import angular_velocity_world, move

quick = settings(max_examples=40, deadline=None)
number = st.floats(-3, 3, allow_subnormal=False)
vectors = st.tuples(number, number, number).map(np.array)
attitudes = st.tuples(number, number, number, number).map(np.array).filter(lambda q: np.linalg.norm(q) > 0.1)


def act(load, attitude=(1, 0, 0, 0), velocity=(0, 0, 0), omega=(0, 0, 0), position=(0, 0, 0), t=0.0, arm=(0, 0, 0)):
    """Force, torque and power of one load on one body; omega is given in world axes."""
    R = matrix_of(np.array(attitude, dtype=float))
    body = Body(
        position=tuple(position),
        attitude=tuple(attitude),
        velocity=tuple(velocity),
        omega=tuple(R.T @ np.array(omega, dtype=float)),
        loads=(load,),
        arm=tuple(arm),
    )
    system, state = build(Setting((body,)))
    rows = np.hstack([state.position, state.quaternion, state.velocity, state.angular_momentum])
    rates = angular_velocity_world(state, system.bodies)
    all_of_it, lost = wrench_of(load_wrench(0, 0, t, system.bodies, system.loads, rows, rates))
    return all_of_it[:3], all_of_it[3:], lost @ np.hstack([state.velocity, rates])[0]


def wrench_of(numbers):
    """Force and torque, and the share of them that has no potential."""
    return np.array(numbers[:6]), np.array(numbers[6:])


def close(a, b, tolerance=1e-13):
    return np.abs(np.asarray(a) - b).max() <= tolerance * (1.0 + np.abs(np.asarray(b)).max())


@quick
@given(attitudes, vectors, vectors, vectors, vectors)
def test_a_force_keeps_its_direction_and_turns_the_body_by_its_lever(attitude, force, lever, velocity, omega):
    F, torque, power = act(Load(kinds.FORCE, (*force, *lever)), attitude, velocity, omega)
    arm = matrix_of(attitude) @ lever
    assert close(F, force) and close(torque, np.cross(arm, force))
    assert close(power, force @ (velocity + np.cross(omega, arm)), 1e-12)


@quick
@given(attitudes, vectors, vectors)
def test_a_couple_keeps_its_direction_and_pushes_nowhere(attitude, couple, omega):
    F, torque, power = act(Load(kinds.COUPLE, tuple(couple)), attitude, (1, 2, 3), omega)
    assert (F == 0.0).all() and close(torque, couple) and close(power, couple @ omega)


@quick
@given(attitudes, vectors, vectors, vectors, vectors)
def test_a_follower_turns_with_the_body(attitude, force, couple, velocity, omega):
    F, torque, power = act(Load(kinds.WRENCH, (*force, *couple)), attitude, velocity, omega)
    R = matrix_of(attitude)
    assert close(F, R @ force) and close(torque, R @ couple)
    assert close(power, R @ force @ velocity + R @ couple @ omega, 1e-12)


@quick
@given(attitudes, vectors, vectors, vectors)
def test_drag_acts_at_the_centre_of_mass_and_only_takes(attitude, velocity, omega, arm):
    F, torque, power = act(Load(kinds.DRAG, (2.0, 0.5)), attitude, velocity, omega, arm=arm)
    lever = matrix_of(attitude) @ arm
    force = -2.0 * (velocity + np.cross(omega, lever))
    assert close(F, force, 1e-12) and close(torque, np.cross(lever, force) - 0.5 * omega, 1e-12)
    assert close(power, -(force @ force) / 2.0 - 0.5 * omega @ omega, 1e-12)
    assert power <= 0.0


@quick
@given(vectors, vectors, st.floats(0, 3))
def test_a_spring_pulls_along_its_line_and_its_dashpot_against_stretching(reach, velocity, rest):
    length = np.linalg.norm(reach)
    if length < 1e-3:
        return
    six = spring_damper(*reach, *velocity, 5.0, 0.7, rest)
    stretching = velocity @ reach / length
    assert close(six[:3], (5.0 * (length - rest) + 0.7 * stretching) * reach / length, 1e-12)
    assert close(six[3:], 0.7 * stretching * reach / length, 1e-12)


def test_a_spring_of_no_length_gives_only_its_dashpot():
    assert spring_damper(0.0, 0.0, 0.0, 1.0, -2.0, 3.0, 100.0, 2.0, 0.5) == (2.0, -4.0, 6.0, 2.0, -4.0, 6.0)


def test_a_stretched_spring_pulls_and_a_pressed_one_pushes():
    spring = Load(kinds.SPRING, (0.5, 0, 0, 2.5, 0, 0, 10.0, 0.0, 1.0))
    assert act(spring)[0] == pytest.approx((10.0, 0.0, 0.0))
    assert act(spring, position=(1.5, 0, 0))[0] == pytest.approx((-5.0, 0.0, 0.0))
    # Turned a quarter about z, the lever points along y.
    F, torque, _ = act(spring, attitude=(1, 0, 0, 1))
    pull = 10.0 * (1 - 1 / np.hypot(2.5, 0.5)) * np.array([2.5, -0.5, 0.0])
    assert close(F, pull) and close(torque, np.cross([0, 0.5, 0], pull))


def test_a_moving_dashpot_takes_energy_and_the_spring_itself_none():
    taut = Load(kinds.SPRING, (0, 0, 0, 2, 0, 0, 10.0, 3.0, 1.0))
    F, _, power = act(taut, velocity=(-1.0, 5.0, 0.0))
    assert close(F, (13.0, 0.0, 0.0)) and power == pytest.approx(-3.0)
    undamped = Load(kinds.SPRING, (0, 0, 0, 2, 0, 0, 10.0, 0.0, 1.0))
    assert act(undamped, velocity=(-1.0, 5.0, 0.0))[2] == 0.0


def test_a_spring_to_a_moving_body_sees_the_speed_of_its_far_point():
    near, far = spring_between(0, (0, 0, 0), 1, (0, 1, 0), 0.0, 2.0, 0.0)
    spinning = Body(position=(3.0, -1.0, 0.0), velocity=(0.5, 0, 0), omega=(0, 0, -1.0), loads=(far,))
    system, state = build(Setting((Body(loads=(near,)), spinning)))
    rows = np.hstack([state.position, state.quaternion, state.velocity, state.angular_momentum])
    omega = angular_velocity_world(state, system.bodies)
    # The far point is at (3, 0, 0) and moves with 0.5 + 1 along x.
    assert load_wrench(0, 0, 0.0, system.bodies, system.loads, rows, omega)[:3] == pytest.approx((3.0, 0.0, 0.0))
    six, lost = wrench_of(load_wrench(1, 1, 0.0, system.bodies, system.loads, rows, omega))
    assert six == pytest.approx((-3.0, 0, 0, 0, 0, 3.0))
    assert lost @ np.hstack([state.velocity, omega])[1] == pytest.approx(-4.5)


RAMP = ((0.5, 2.0), (1.0, 4.0), (1.0, -1.0), (3.0, 1.0))


@quick
@given(st.floats(-1, 5).filter(lambda t: abs(t - 1.0) > 1e-9))
def test_a_ramp_is_piecewise_linear_and_constant_outside(t):
    times, factors = zip(*RAMP, strict=True)
    expected = np.interp(t, times[2:], factors[2:]) if t > 1.0 else np.interp(t, times[:2], factors[:2])
    assert ramp_factor(t, 0, 4, times, factors) == pytest.approx(expected, abs=1e-14)


@pytest.mark.parametrize("kind", [kinds.FORCE, kinds.COUPLE, kinds.WRENCH])
def test_a_ramp_scales_force_torque_and_power(kind):
    values = (1.0, 2.0, 3.0, 0.4, -0.5, 0.6)
    moving = {"velocity": (1, 1, 2), "omega": (0.3, 0.2, 0.1), "attitude": (1, 1, 0, 2)}
    full = np.hstack(act(Load(kind, values), **moving))
    half = np.hstack(act(Load(kind, values, ((0.0, 0.0), (2.0, 1.0))), t=1.0, **moving))
    assert close(half, 0.5 * full) and np.abs(full).max() > 0.5


def test_the_second_of_two_ramps_is_read_from_its_own_breakpoints():
    first = Load(kinds.FORCE, (1.0, 0, 0), ((0.0, 1.0), (1.0, 2.0), (2.0, 5.0)))
    second = Load(kinds.FORCE, (0, 1.0, 0), ((0.0, 10.0), (2.0, 20.0)))
    system, state = build(Setting((Body(loads=(first, second)),)))
    rows = np.hstack([state.position, state.quaternion, state.velocity, state.angular_momentum])
    forces = [load_wrench(k, 0, 1.5, system.bodies, system.loads, rows, np.zeros((1, 3)))[:3] for k in (0, 1)]
    assert np.sum(forces, axis=0) == pytest.approx((3.5, 17.5, 0.0))


def test_a_dot_in_drag_slows_as_the_exponential():
    dot = Body(2.0, velocity=(3.0, 0.0, 0.0), model=TRANSLATING, loads=(Load(kinds.DRAG, (4.0, 0.0)),))
    system, state = build(Setting((dot,)))
    end = move(state, 1e-3, 1000, "rk4", system, "python")
    assert end.velocity[0, 0] == pytest.approx(3.0 * np.exp(-2.0), rel=1e-12)
    assert end.position[0, 0] == pytest.approx(1.5 * (1 - np.exp(-2.0)), rel=1e-12)


def test_a_mass_on_a_damped_spring_swings_as_the_closed_form():
    m, k, c = 2.0, 50.0, 4.0
    spring = Load(kinds.SPRING, (0, 0, 0, 5.0, 0, 0, k, c, 4.0))
    system, state = build(Setting((Body(m, position=(0.5, 0, 0), model=TRANSLATING, loads=(spring,)),)))
    end = move(state, 5e-4, 2000, "rk4", system, "python")
    decay, omega = c / (2 * m), np.sqrt(k / m - (c / (2 * m)) ** 2)
    swing = np.exp(-decay) * (np.cos(omega) + decay / omega * np.sin(omega))
    assert end.position[0, 0] == pytest.approx(1.0 - 0.5 * swing, abs=1e-11)


@pytest.mark.parametrize(("method", "below", "above"), [("rk4", 2.80, 2.86), ("semi_implicit_euler", 1.98, 2.02)])
def test_an_oscillation_grows_just_beyond_the_limit_of_the_table(method, below, above):
    spring = Load(kinds.SPRING, (0, 0, 0, 2.0, 0, 0, 2.0, 0.0, 1.0))
    system, state = build(Setting((Body(2.0, position=(0.9, 0, 0), model=TRANSLATING, loads=(spring,)),)))
    swings = [abs(move(state, dt, 200, method, system, "python").position[0, 0] - 1.0) for dt in (below, above)]
    assert swings[0] < 1.0 and swings[1] > 1.0
