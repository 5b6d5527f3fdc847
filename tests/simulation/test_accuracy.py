"""A run by accuracy: it keeps what it promises, begins again where it must, and says where it cannot."""

import dataclasses

import numpy as np
import pytest

import rbfem
from rbfem.motion import quaternion
from rbfem.planning.plan import Choice
from rbfem.simulation import run as run_module

TOP = {"pivot": [0, 0, 0], "position": [0.1, 0, 0.2], "angular_velocity": [1, 2, 9]}
HUNG = {
    "position": [0, 0, -0.8],
    "angular_velocity": [1, 2, 3],
    "loads": [{"spring": {"at": [0.04, 0.02, 0.1], "to": [0.1, 0, 0], "stiffness": 400, "rest_length": 0.6}}],
}
DRAGGED = {
    "angular_velocity": [3, 2, 1],
    "velocity": [1, 0, 0],
    "loads": [{"drag": {"linear": 2.0, "angular": 0.01}}, {"torque": [0.1, 0.05, 0.2], "frame": "body"}],
}
GRAVITY = [0, 0, -9.81]


def apart(scene, frames, others):
    largest = 0.0
    for one, other in zip(frames, others, strict=True):
        distance = np.linalg.norm(one.position - other.position, axis=1) / scene.bounding_radius
        largest = max(largest, distance.max(), quaternion.angle_between(one.quaternion, other.quaternion).max())
    return largest


def reference_frames(scene, plan):
    """By the adaptive method, at a tolerance far below what is asked."""
    fine = dataclasses.replace(
        plan,
        method=Choice("dop853", "reference"),
        step=Choice(1e-3, "reference"),
        tolerance=Choice(1e-13, "reference"),
        verify=Choice(0, "reference"),
        redo=False,
    )
    return list(rbfem.simulate(scene, fine))


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("body", [TOP, HUNG, DRAGGED], ids=["top", "hung", "dragged"])
def test_the_true_error_is_below_the_estimate_and_that_below_what_was_asked(scene_of, run_of, body, accuracy):
    scene = scene_of(body, gravity=GRAVITY, accuracy=accuracy, time={"end": 2}, output={"every": 0.5})
    plan = rbfem.plan(scene)
    run, frames = run_of(scene, plan)
    true = apart(scene, frames, reference_frames(scene, plan))
    assert true <= run.error.estimated <= accuracy
    assert run.unmet == ""


def test_a_run_that_would_miss_begins_again_and_gives_every_frame_once(scene_of, run_of):
    scene = scene_of(HUNG, gravity=GRAVITY, accuracy=1e-7, time={"end": 2}, output={"every": 0.25})
    plan = rbfem.plan(scene)
    careless = dataclasses.replace(plan, step=Choice(8.0 * plan.step.value, "too long on purpose"))
    run, frames = run_of(scene, careless)
    assert run.error.redone > 0 and "begun again" in run.error.how
    assert [frame.index for frame in frames] == list(range(9))
    np.testing.assert_allclose([frame.time for frame in frames], 0.25 * np.arange(9), rtol=1e-15)
    assert apart(scene, frames, reference_frames(scene, plan)) <= run.error.estimated <= 1e-7
    once, _ = run_of(scene, dataclasses.replace(careless, redo=False))
    assert once.error.estimated > 1e-7 and run.cost.evaluations > once.cost.evaluations


def test_a_run_that_blows_up_begins_again_too(scene_of, run_of):
    """A step of four times the limit, in steps enough to leave the numbers that a float can hold."""
    body = {"shape": "ball", "position": [0.3, 0, 0], "loads": [{"spring": {"to": [0, 0, 0], "stiffness": 4e4}}]}
    scene = scene_of(body, accuracy=1e-3, time={"end": 3, "method": "kdk"}, output={"every": 1})
    plan = rbfem.plan(scene)
    careless = dataclasses.replace(plan, step=Choice(4.0 * plan.step_limit.value, "too long on purpose"))
    run, frames = run_of(scene, careless)
    assert run.error.redone > 0 and len(frames) == 4
    assert apart(scene, frames, reference_frames(scene, plan)) <= run.error.estimated <= 1e-3
    with pytest.raises(rbfem.RunError, match="blown up"):
        run_of(scene, dataclasses.replace(careless, redo=False))


def test_a_run_that_has_become_long_goes_on_in_kernels_that_lie_ready(scene_of, monkeypatch):
    scene = scene_of(HUNG, gravity=GRAVITY, accuracy=1e-7, time={"end": 2}, output={"every": 0.5})
    plan = rbfem.plan(scene)
    run = rbfem.simulate(scene, dataclasses.replace(plan, backend=Choice("python", "short, as it seemed")))
    monkeypatch.setattr(run_module, "is_cached", lambda *kernel: True)
    run.cost.wall_seconds = 10.0
    assert run._backend() == "python"  # the plan is followed as long as it holds
    run.error.redone = 1
    assert run._backend() == "serial"
    monkeypatch.setattr(run_module, "is_cached", lambda *kernel: False)
    assert run._backend() == "python"


def test_an_error_that_stays_unknown_is_not_passed_as_met(scene_of, run_of):
    run, _ = run_of(scene_of(HUNG, gravity=GRAVITY, accuracy=1e-3, time={"end": 1}, output={"every": 0.5}))
    assert run.unmet == ""
    run.error.unknown_because = "the companion has blown up"
    assert run.unmet == "the companion has blown up"


def test_many_frames_bring_no_false_alarm(scene_of, run_of):
    scene = scene_of(HUNG, gravity=GRAVITY, accuracy=1e-6, time={"end": 2}, output={"every": 0.005})
    run, _ = run_of(scene)
    assert run.error.redone == 0 and run.unmet == ""


def test_an_accuracy_below_rounding_is_said_to_be_out_of_reach(scene_of, run_of):
    scene = scene_of(HUNG, gravity=GRAVITY, accuracy=1e-15, time={"end": 1}, output={"every": 0.5})
    run, frames = run_of(scene)
    assert "rounding" in run.unmet and run.error.estimated < 1e-10
    assert len(frames) == 3


def test_a_given_step_is_never_changed(scene_of, run_of):
    scene = scene_of(HUNG, gravity=GRAVITY, accuracy=1e-12, time={"end": 1, "step": 0.01}, output={"every": 0.5})
    run, _ = run_of(scene)
    assert run.error.redone == 0 and run.error.estimated > 1e-12 and run.unmet == ""


def test_a_free_body_has_the_error_of_rounding_and_no_step(scene_of, run_of):
    body = {"velocity": [1, 2, 3], "angular_velocity": [5, -3, 1]}
    run, frames = run_of(scene_of(body, time={"end": 1000}, output={"every": 100}))
    assert 0.0 < run.error.estimated < 1e-10
    assert "closed form" in run.error.how
    assert run.cost.steps == len(frames) - 1
    np.testing.assert_allclose(frames[-1].position[0], [1e3, 2e3, 3e3], rtol=1e-15)


def test_the_adaptive_method_reaches_the_accuracy_by_its_tolerance(scene_of, run_of):
    time = {"end": 2, "method": "dop853"}
    scene = scene_of(DRAGGED, gravity=GRAVITY, accuracy=1e-8, time=time, output={"every": 0.5})
    plan = rbfem.plan(scene)
    run, frames = run_of(scene, plan)
    assert apart(scene, frames, reference_frames(scene, plan)) <= run.error.estimated <= 1e-8
