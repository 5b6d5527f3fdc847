"""Frames and expectations come at their times to the last digit, and kinks in the loads cost no order."""

import dataclasses

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

import rbfem
from rbfem.motion import quaternion

G = 9.81


def final_of(scene, step):
    scene = dataclasses.replace(scene, step=step, method="rk4")
    *_, last = rbfem.simulate(scene, rbfem.plan(scene))
    return last


@pytest.mark.parametrize("step", [0.1, 0.03, 0.017, 1e-3, 10.0])
def test_output_times_are_hit_exactly_whatever_the_step_is(scene_of, run_of, step):
    scene = scene_of({"velocity": [1, 0, 0]}, time={"end": 1, "step": step}, output={"every": 0.3}, gravity=[0, 0, -G])
    _, frames = run_of(scene)
    times = [frame.time for frame in frames]
    assert times == [0.0, 0.3, 0.6, pytest.approx(0.9, abs=1e-15), 1.0]
    assert [frame.index for frame in frames] == [0, 1, 2, 3, 4]
    for frame in frames:
        np.testing.assert_allclose(frame.position[0], [frame.time, 0, -0.5 * G * frame.time**2], atol=1e-13)


def test_an_expectation_between_outputs_is_checked_at_its_own_time(scene_of, run_of):
    expect = [
        {
            "quantity": "bodies.body0.position",
            "at": at,
            "value": [at, 0, -0.5 * G * at**2],
            "tolerance": 1e-13,
            "source": "parabola",
        }
        for at in (0.0, 0.123456789, 0.5, 0.987654321, 1.0)
    ]
    scene = scene_of({"velocity": [1, 0, 0]}, time={"end": 1}, output={"every": 0.5}, expect=expect, gravity=[0, 0, -G])
    run, frames = run_of(scene)
    assert [frame.time for frame in frames] == [0, 0.5, 1.0]
    assert [result.expectation.time for result in run.expectations] == [0.0, 0.123456789, 0.5, 0.987654321, 1.0]
    assert all(result.passed for result in run.expectations)


def test_two_expectations_at_one_time_are_each_checked_once(scene_of, run_of):
    one = {"quantity": "total.energy", "at": 0.3, "value": 0, "tolerance": 1, "source": "none"}
    run, _ = run_of(scene_of({}, output={"every": 1}, expect=[one, one | {"tolerance": 2}]))
    assert [result.expectation.tolerance for result in run.expectations] == [1, 2]


def test_every_quantity_of_a_body_and_of_the_whole_can_be_expected(scene_of, run_of):
    whole = {"mass": 6, "center_of_mass": [0, 0, 0], "principal_moments": [0.025, 0.05, 0.065]}
    moving = {
        "position": [1, 2, 3],
        "velocity": [4, 5, 6],
        "quaternion": [0, 0, 0, -1],
        "angular_velocity": [-7, 0, 0],
        "angular_velocity_body": [7, 0, 0],
    }
    total = {
        "energy": 3 * 77 + 0.5 * 0.065 * 49,
        "kinetic": 3 * 77,
        "rotational": 0.5 * 0.065 * 49,
        "work": 0,
        "momentum": [24, 30, 36],
        "angular_momentum": [-0.065 * 7 + 6 * (2 * 6 - 3 * 5), 6 * (3 * 4 - 1 * 6), 6 * (1 * 5 - 2 * 4)],
        "center_of_mass": [1, 2, 3],
    }
    known = {f"bodies.it.{key}": value for key, value in (whole | moving).items()}
    known |= {f"total.{key}": value for key, value in total.items()}
    expect = [
        {"quantity": key, "value": value, "at": 0, "tolerance": 1e-12, "source": "by hand"}
        for key, value in known.items()
    ]
    body = {
        "name": "it",
        "position": [1, 2, 3],
        "quaternion": [0, 0, 0, 1],
        "velocity": [4, 5, 6],
        "angular_velocity_body": [7, 0, 0],
    }
    run, _ = run_of(scene_of(body, expect=expect))
    assert {result.expectation.quantity: result.error for result in run.expectations if not result.passed} == {}
    assert len(run.expectations) == len(known)


def test_a_missed_expectation_says_what_was_found_and_how_far_off_it_is(scene_of, run_of):
    expect = [{"quantity": "bodies.body0.velocity", "value": [1, 3, 4], "tolerance": 4.9, "source": "wrong on purpose"}]
    run, _ = run_of(scene_of({"velocity": [1, 0, 0]}, expect=expect))
    (result,) = run.expectations
    assert not result.passed and result.error == pytest.approx(5.0) and result.found.tolist() == [1, 0, 0]


RAMP = [[0.0, 0.0], [0.137, 2.0], [0.391, -1.0], [0.83, 0.5]]


def factor(t):
    return np.interp(t, *np.transpose(RAMP))


def test_a_ramped_force_brings_the_impulse_of_its_integral(scene_of):
    scene = scene_of({"loads": [{"force": [12, 0, 0], "ramp": RAMP}]}, output={"every": 1})
    impulse = quad(lambda t: 12 * factor(t), 0, 1, points=[time for time, _ in RAMP[1:]], epsabs=1e-13)[0]
    last = final_of(scene, 0.07)
    assert last.velocity[0, 0] == pytest.approx(impulse / 6, rel=1e-12)
    assert last.balance.impulse[0] == pytest.approx(impulse, rel=1e-12)


def test_order_four_is_kept_across_the_kinks_of_a_ramp(scene_of):
    """A torque in body axes that changes slope three times: fitted slope of the log of the error over four halvings."""
    loads = [{"torque": [0.05, 0.11, -0.07], "frame": "body", "ramp": RAMP}]
    body = {"angular_velocity": [3, 5, 4], "loads": loads}
    scene = scene_of(body, output={"every": 1})
    moments = np.array([0.065, 0.05, 0.025])

    def rates(t, w):
        return (np.array([0.05, 0.11, -0.07]) * factor(t) - np.cross(w, moments * w)) / moments

    w = np.array([3.0, 5.0, 4.0])
    for start, end in zip([0, *[t for t, _ in RAMP[1:]]], [*[t for t, _ in RAMP[1:]], 1.0], strict=True):
        w = solve_ivp(rates, (start, end), w, method="DOP853", rtol=1e-13, atol=1e-13).y[:, -1]
    steps = [1 / 40, 1 / 80, 1 / 160, 1 / 320, 1 / 640]
    errors = [np.linalg.norm(spin_in_body(final_of(scene, step)) - w) for step in steps]
    slope = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert slope == pytest.approx(4.0, abs=0.3)  # steps are cut to fit the spans, so they do not quite halve


def spin_in_body(frame):
    return quaternion.rotate_back(frame.quaternion[0], frame.angular_velocity[0])
