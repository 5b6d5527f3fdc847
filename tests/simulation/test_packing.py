"""Many spheres: what they keep together, and that every way of computing them is one."""

import dataclasses

import numpy as np
import pytest

import rbfem
from rbfem.planning.plan import Choice

RULE = {"between": "any", "law": "linear", "normal_stiffness": 1e4, "restitution": 0.5, "friction": 0.5}
SHAPES = {"ball": {"sphere": {"radius": 0.01}}, "floor": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}}
FLOOR = {"name": "floor", "shape": "floor", "material": "water", "fixed": True}
BOX = [[0.0, 0.0, 0.02], [0.08, 0.08, 0.1]]


@pytest.fixture
def cloud(scene_of):
    def make(count, end, walls=(FLOOR,), **keys):
        balls = {"shape": "ball", "count": count, "place": {"in_box": BOX}, "angular_velocity": [3, 9, 1]}
        case = {"gravity": [0, 0, -9.81], "time": {"end": end}, "output": {"every": end}} | keys
        return scene_of(balls, *walls, shapes=SHAPES, contacts=[RULE], **case)

    return make


def run_on(scene, backend="serial"):
    plan = dataclasses.replace(rbfem.plan(scene), backend=Choice(backend, "test"))
    run = rbfem.simulate(scene, plan)
    return run, list(run)


def test_random_places_do_not_overlap(cloud):
    position = cloud(60, 0.1).position
    apart = np.linalg.norm(position[:, None] - position[None, :], axis=2) + np.eye(60)
    assert apart.min() >= 0.02
    assert position[:, 2].min() >= 0.01


def test_a_kernel_does_what_plain_python_does(cloud):
    scene = cloud(12, 0.08)
    (_, kernel), (_, python) = run_on(scene), run_on(scene, "python")
    np.testing.assert_allclose(kernel[-1].position, python[-1].position, rtol=0, atol=1e-12)
    np.testing.assert_allclose(kernel[-1].angular_velocity, python[-1].angular_velocity, rtol=0, atol=1e-9)


def test_two_runs_give_the_same_bits(cloud):
    scene = cloud(60, 0.2)
    (_, one), (_, other) = run_on(scene), run_on(scene)
    np.testing.assert_array_equal(one[-1].position, other[-1].position)
    np.testing.assert_array_equal(one[-1].quaternion, other[-1].quaternion)


def test_momentum_closes_to_rounding_with_walls_weight_and_friction(cloud):
    run, frames = run_on(cloud(60, 0.3))
    size = 60 * frames[0].balance.momentum.size * 9.81 * 0.3 * 4.2e-3
    assert frames[-1].balance.friction > 0.0
    assert run.largest_drift["momentum"] < 1e-13 * size
    assert run.largest_drift["angular_momentum"] < 1e-13 * size


def test_what_a_packing_loses_is_what_damping_and_friction_take(cloud):
    """Of second order in the step; measured 4e-4 and 3e-5 of what was taken."""
    shares = []
    for step in (4e-5, 1e-5):
        run, frames = run_on(cloud(60, 0.3, time={"end": 0.3, "step": step}))
        shares.append(run.largest_drift["energy"] / (frames[-1].balance.damping + frames[-1].balance.friction))
    assert shares[0] < 2e-3
    assert shares[1] < shares[0] / 4.0


def test_materials_without_a_rule_pass_through_each_other(scene_of):
    ghost = {"material": "rubber", "shape": "ball", "position": [0, 0, 0.05], "velocity": [0, 0, -1]}
    solid = {"shape": "ball", "position": [0.1, 0, 0.05]}
    rule = RULE | {"between": ["water", "water"]}
    scene = scene_of(ghost, solid, FLOOR, shapes=SHAPES, contacts=[rule], time={"end": 0.2}, output={"every": 0.2})
    _, frames = run_on(scene)
    assert frames[-1].position[0, 2] == pytest.approx(-0.15)


def test_a_sphere_so_fast_that_it_could_miss_another_ends_the_run_in_words(scene_of):
    balls = [{"shape": "ball", "position": [x, 0, 0], "velocity": [v, 0, 0]} for x, v in ((0, 1e5), (1, 0))]
    scene = scene_of(*balls, shapes=SHAPES, contacts=[RULE], time={"end": 1e-3, "step": 1e-4}, output={"every": 1e-3})
    with pytest.raises(rbfem.RunError, match="contacts could be missed"):
        run_on(scene)
