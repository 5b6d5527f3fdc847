"""What a plan refuses because nobody would see its end, and torques that do not last."""

import dataclasses

import numpy as np
import pytest

import rbfem
from rbfem.errors import InputError, RunError


@pytest.mark.parametrize(
    ("keys", "key"),
    [
        ({"time": {"end": 1e40}, "output": {"every": 0.1}}, "output.every"),
        ({"time": {"end": 1}, "output": {"every": 1e-12}}, "output.every"),
        ({"time": {"end": 1, "step": 1e-18, "method": "rk4"}}, "time.step"),
    ],
)
def test_a_run_without_an_end_is_refused_before_anything_is_made(scene_of, keys, key):
    with pytest.raises(InputError, match=f"{key}: the run would take .* are the most"):
        rbfem.plan(scene_of({}, **keys))


def test_a_short_pulse_counts_with_what_it_brings_not_with_its_height(scene_of):
    pulse = {"loads": [{"torque": [1, 0, 0], "ramp": [[0, 0], [0.001, 1], [0.002, 0]]}]}
    scene = scene_of(pulse, time={"end": 1000, "step": 0.01, "method": "rk4"})
    assert rbfem.plan(scene).step.value == 0.01
    smallest = scene.reference.moments[0, 0]
    assert rbfem.plan(scene).step_limit.value == pytest.approx(2 / (0.001 / smallest), rel=1e-12)


def test_a_torque_against_drag_spins_no_faster_than_it_settles(scene_of):
    loads = [{"torque": [1, 0, 0]}, {"drag": {"angular": 1.0}}]
    scene = scene_of({"loads": loads}, time={"end": 1000, "method": "dop853_fixed"})
    decay = 0.5 / scene.reference.moments[0, 0]
    assert rbfem.plan(scene).step_limit.value == pytest.approx(min(2 / 1.0, 2 / (2 * decay)), rel=1e-12)


def test_the_plan_of_another_scene_and_a_second_way_through_a_run_are_refused(scene_of):
    scene = scene_of({})
    plan = rbfem.plan(scene)
    with pytest.raises(InputError, match="the plan is for 3 bodies and the scene has 1"):
        rbfem.simulate(scene, dataclasses.replace(plan, n_bodies=3))
    run = rbfem.simulate(scene, plan)
    assert run.error.estimated is None
    list(run)
    with pytest.raises(RunError, match="once"):
        list(run)


def test_a_million_steps_of_falling_round_no_more_than_a_few(scene_of):
    """Under gravity alone the steps are added up in closed form: the position is right to a few roundings."""
    scene = scene_of(
        {"velocity": [1, 0, 0]}, gravity=[0, 0, -9.81], time={"end": 1000, "step": 1e-3}, output={"every": 1000}
    )
    last = list(rbfem.simulate(scene, rbfem.plan(scene)))[-1]
    np.testing.assert_allclose(last.position[0], [1000, 0, -0.5 * 9.81 * 1e6], rtol=1e-12)
