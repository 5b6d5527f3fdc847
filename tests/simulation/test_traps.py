"""Scenes that lead an estimate of the error astray: it says more than the truth there, or that it does not know."""

import dataclasses
import math

import numpy as np
import pytest

import rbfem
from rbfem.errors import RunError
from rbfem.motion.state import initial_state
from rbfem.planning.pilot import difference
from rbfem.planning.plan import Choice
from rbfem.simulation.motion_error import LARGEST_TRUSTED, SAFETY, MotionError

TURN = 2.0 * math.pi
IDLE = [1.0, 0.0, 0.0, 0.0]


def test_a_thrust_that_turns_with_the_body_is_not_sampled_at_whole_turns(scene_of, run_of):
    thrust = {"angular_velocity": [0, 0, 4 * TURN], "loads": [{"force": [1, 0, 0], "frame": "body"}]}
    shapes = {"wheel": {"cylinder": {"radius": 0.5, "height": 0.5}}}
    scene = scene_of(thrust | {"shape": "wheel"}, shapes=shapes, accuracy=1e-2, time={"end": 16}, output={"every": 1})
    _, frames = run_of(scene)
    rate = 4 * TURN
    drifted = np.array([0.0, 16.0 / (rate * scene.mass[0]), 0.0])  # ∫∫ (cos ωt, sin ωt) dt² after whole turns
    assert np.linalg.norm(frames[-1].position[0] - drifted) <= 1e-2 * scene.bounding_radius[0]
    assert frames[-1].balance.kinetic < 1e-6


def test_a_state_that_is_no_number_differs_from_every_other_by_infinity():
    held = [np.zeros((1, 3)), np.array([IDLE]), np.zeros((1, 3)), np.zeros((1, 3))]
    lost = [held[0], np.full((1, 4), np.nan), *held[2:]]
    assert difference(initial_state(*held), initial_state(*lost), np.ones(1)) == math.inf


def test_a_large_difference_is_not_divided_by_a_power_of_the_steps():
    error = MotionError(order=8.0, ratio=2.0, unknown_because="")
    error.note(1.0, 0.0, LARGEST_TRUSTED)
    assert error.of_this_attempt == pytest.approx(SAFETY * LARGEST_TRUSTED / 255.0)
    error.note(2.0, 0.0, 3.0)
    assert error.of_this_attempt == pytest.approx(SAFETY * 3.0)


def test_a_difference_that_jumps_from_one_stop_to_the_next_is_taken_whole():
    error = MotionError(order=4.0, ratio=2.0, unknown_because="")
    for time, apart in ((1.0, 1e-9), (2.0, 8e-9), (3.0, 2.7e-8)):
        error.note(time, apart, 0.0)
    assert not error.has_jumped
    error.note(4.0, 1e-5, 0.0)
    assert error.has_jumped
    assert error.of_this_attempt == pytest.approx(SAFETY * 1e-5)


def test_rounding_grows_with_what_the_scene_makes_of_differences():
    error = MotionError(order=4.0, ratio=2.0, unknown_because="")
    error.note(1.0, 1e-10, 0.0)
    error.note(10.0, 1e-5, 0.0)
    assert error.magnified(10.0) == pytest.approx(1e3)  # 1e5, of which 100 may be secular growth


def test_far_from_the_origin_the_printed_error_holds_the_rounding_of_the_place(scene_of, run_of):
    far = {"position": [7e6 + 1, 0, 0], "loads": [{"spring": {"to": [7e6, 0, 0], "stiffness": 4000}}]}
    scene = scene_of(far | {"shape": "ball"}, accuracy=1e-4, time={"end": 20}, output={"every": 1})
    run, frames = run_of(scene)
    omega = math.sqrt(4000 / scene.mass[0])
    true = max(abs(frame.position[0, 0] - 7e6 - math.cos(omega * frame.time)) / 0.1 for frame in frames)
    assert true <= run.error.estimated


def test_a_decay_that_is_over_in_a_moment_does_not_set_the_step(scene_of, run_of):
    thick = {"velocity": [1, 0, 0], "loads": [{"drag": {"linear": 1e9}}]}
    scene = scene_of(thick, gravity=[0, 0, -9.81], accuracy=1e-3, time={"end": 1}, output={"every": 0.1})
    run, frames = run_of(scene)
    assert run.plan.method.value == "kdk"
    assert run.cost.steps < 1e5
    sunk = -9.81 * scene.mass[0] / 1e9
    assert abs(frames[-1].position[0, 2] - sunk) <= 1e-3 * scene.bounding_radius[0]


def test_what_blows_up_in_plain_python_is_told_in_words(scene_of, run_of):
    top = {"pivot": [0, 0, 0], "position": [0.1, 0, 0.2], "angular_velocity": [0, 3, 60]}
    step = {"end": 30, "step": 0.02, "method": "semi_implicit_euler"}
    scene = scene_of(top, gravity=[0, 0, -9.81], time=step, output={"every": 3})
    plan = rbfem.plan(scene, beyond_limit=True)
    with pytest.raises(RunError, match="no longer finite"):
        run_of(scene, plan)


def test_a_run_that_begins_again_tells_so(scene_of):
    hung = {
        "position": [0, 0, -0.8],
        "angular_velocity": [1, 2, 3],
        "loads": [{"spring": {"at": [0.04, 0.02, 0.1], "to": [0.1, 0, 0], "stiffness": 400, "rest_length": 0.6}}],
    }
    scene = scene_of(hung, gravity=[0, 0, -9.81], accuracy=1e-7, time={"end": 2}, output={"every": 0.25})
    plan = rbfem.plan(scene)
    run = rbfem.simulate(scene, dataclasses.replace(plan, step=Choice(8.0 * plan.step.value, "too long on purpose")))
    told: list[str] = []
    run.tell = told.append
    list(run)
    assert len(told) == run.error.redone > 0
    assert all("begun again" in words for words in told)
