"""What a run says about itself while it goes."""

import numpy as np

import rbfem


def test_a_quaternion_that_drifts_off_length_one_is_told(scene_of, run_of):
    time = {"end": 4, "step": 0.1, "method": "rk4_world"}
    run, frames = run_of(scene_of({"angular_velocity": [3, 4, 5]}, time=time, output={"every": 1}))
    assert any("quaternion" in warning and "rk4_world" in warning for warning in run.warnings)
    assert len(run.warnings) == len(set(run.warnings))
    np.testing.assert_allclose(np.linalg.norm(frames[-1].quaternion, axis=1), 1.0, rtol=1e-14)


def test_a_body_that_comes_to_spin_too_fast_for_the_step_is_told(scene_of, run_of):
    """The plan does not foresee it: a spring flings the body round by its lever."""
    spring = {"at": [0.1, 0, 0], "to": [0, 30, 0], "stiffness": 2.0}
    vane = {"shape": "ball", "angular_velocity": [0, 0, 5], "loads": [{"spring": spring}]}
    scene = scene_of(vane, time={"end": 1, "step": 0.05, "method": "euler"}, output={"every": 0.2})
    assert scene.step < rbfem.plan(scene).step_limit.value
    run, frames = run_of(scene)
    assert np.linalg.norm(frames[0].angular_velocity) * scene.step < 2
    assert any("spin faster than 2/step" in warning for warning in run.warnings)


def test_an_ordinary_run_warns_of_nothing(scene_of, run_of):
    assert (
        run_of(scene_of({"angular_velocity": [3, 4, 5], "pivot": [0, 0, 1]}, gravity=[0, 0, -9.81]))[0].warnings == []
    )


def test_the_cost_counts_steps_of_the_companion_too(scene_of, run_of):
    scene = scene_of(
        {}, {"name": "wall", "fixed": True}, time={"end": 1, "step": 0.01, "method": "rk4"}, output={"every": 1}
    )
    cost = run_of(scene)[0].cost
    assert (cost.steps, cost.body_steps, cost.evaluations) == (150, 150, 600)
    assert cost.wall_seconds > 0


def test_no_frame_shares_its_arrays_with_the_next(scene_of, run_of):
    """Frames can be kept: what was handed out does not change."""
    scene = scene_of({"velocity": [1, 0, 0], "loads": [{"force": [0, 0, 1]}]})
    _, frames = run_of(scene)
    np.testing.assert_allclose([frame.position[0, 0] for frame in frames], [frame.time for frame in frames], atol=1e-12)
