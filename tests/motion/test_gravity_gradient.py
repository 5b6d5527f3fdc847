"""The torque of a central field against the tensor formula, and the small librations of a satellite."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from motion_reference import matrix_of
from motion_scenes import Body, Load, Setting, build, satellite

from rbfem.motion import loads as kinds
from rbfem.motion.loads import gradient_torque, load_wrench
from rbfem.motion.state import angular_velocity_world, move

quick = settings(max_examples=60, deadline=None)
number = st.floats(-3, 3, allow_subnormal=False)
triples = st.tuples(number, number, number).map(np.array)
attitudes = st.tuples(number, number, number, number).map(np.array).filter(lambda q: np.linalg.norm(q) > 0.1)
rates = st.floats(0.01, 10.0)
NORMAL, START = np.array([0.6, 0.0, 0.8]), np.array([0.48, 0.8, -0.36])


def direction_at(rate, t):
    """From the centre of attraction to the body: `START`, turned by rate t about `NORMAL` (Rodrigues)."""
    K = np.cross(np.eye(3), NORMAL)
    return (np.eye(3) + np.sin(rate * t) * K + (1 - np.cos(rate * t)) * K @ K) @ START


@quick
@given(attitudes, rates, st.floats(-5.0, 5.0))
def test_the_torque_is_the_tensor_formula_and_there_is_no_force(attitude, rate, t):
    body = Body(attitude=tuple(attitude), loads=(Load(kinds.GRADIENT, (rate, *NORMAL, *START)),))
    system, state = build(Setting((body,)))
    rows = np.hstack([state.position, state.quaternion, state.velocity, state.angular_momentum])
    found = load_wrench(0, 0, t, system.bodies, system.loads, rows, angular_velocity_world(state, system.bodies))
    R, away = matrix_of(attitude), direction_at(rate, t)
    torque = 3 * rate**2 * np.cross(away, R @ np.diag(body.moments) @ R.T @ away)
    assert found[:3] == (0.0, 0.0, 0.0)
    np.testing.assert_allclose(found[3:6], torque, atol=1e-13 * rate**2)
    assert found[6:] == found[:6]  # nothing of it has a potential that counts as energy


@quick
@given(triples, triples.map(np.abs))
def test_the_torque_turns_the_axis_of_least_inertia_towards_the_centre(away, moments):
    torque = np.array(gradient_torque(2.0, *away, *moments))
    expected = 12.0 * np.cross(away, moments * away)
    np.testing.assert_allclose(torque, expected, atol=1e-12)
    assert abs(torque @ away) < 1e-11


def libration(rate, moments, tilt):
    """A satellite that turns with its orbit, yaw along the radius and pitch along the normal but for a tilt about the
    normal. Its principal axes are roll, pitch, yaw; stable where yaw is the least moment and pitch the largest."""
    c, s = np.cos(0.5 * tilt), np.sin(0.5 * tilt)
    field = Load(kinds.GRADIENT, (rate, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0))
    return Setting((Body(moments=moments, attitude=(c, 0.0, s, 0.0), omega=(0.0, rate, 0.0), loads=(field,)),))


def pitch_of(state, rate):
    """Angle about the normal between the yaw axis and the radius."""
    w, _, y, _ = state.quaternion[0]
    return np.angle(np.exp(1j * (2 * np.arctan2(y, w) - rate * state.time)))


def test_a_small_libration_in_pitch_has_the_frequency_of_the_books():
    """ω = n √(3 (I_roll - I_yaw)/I_pitch): Hughes, Spacecraft Attitude Dynamics, section 9.1."""
    rate, (roll, pitch, yaw), tilt = 0.7, (2.0, 2.5, 1.0), 1e-4
    omega = rate * np.sqrt(3 * (roll - yaw) / pitch)
    system, state = build(libration(rate, (roll, pitch, yaw), tilt))
    for _ in range(8):
        state = move(state, 0.02, 50, "rkn6", system, "serial")
        # The next term of the swing is of third order in the tilt.
        assert pitch_of(state, rate) == pytest.approx(tilt * np.cos(omega * state.time), abs=10 * tilt**3)


def test_a_satellite_turned_across_its_stable_attitude_falls_away_from_it():
    rate, tilt = 0.7, 1e-4
    system, state = build(libration(rate, (1.0, 2.5, 2.0), tilt))  # the larger moment points along the radius
    omega = rate * np.sqrt(3 * 1.0 / 2.5)
    end = move(state, 0.02, 250, "rkn6", system, "serial")
    assert pitch_of(end, rate) == pytest.approx(tilt * np.cosh(omega * end.time), rel=1e-5)


def test_in_the_frame_of_the_orbit_an_integral_stays():
    """½ ω·Iω - n · L + 3/2 n² r̂·I r̂ with ω the absolute rate: Jacobi's integral (Hughes, section 9.1)."""
    body = satellite().bodies[0]
    rate, inertia = 2.0, np.diag(body.moments)

    def integral(state):
        R, L = matrix_of(state.quaternion[0]), state.angular_momentum[0]
        away = R.T @ direction_at(rate, state.time)
        return 0.5 * L @ np.linalg.solve(inertia, L) - rate * NORMAL @ R @ L + 1.5 * rate**2 * away @ inertia @ away

    system, state = build(satellite())
    values = [integral(state := move(state, 0.01, 100, "rkn6", system, "serial")) for _ in range(5)]
    assert np.ptp([integral(build(satellite())[1]), *values]) < 1e-10
    energies = np.array([0.5 * state.angular_momentum[0] @ np.linalg.solve(inertia, state.angular_momentum[0])])
    assert abs(energies[0] - 0.5 * np.array(body.omega) @ inertia @ body.omega) > 0.1  # the energy itself does not
