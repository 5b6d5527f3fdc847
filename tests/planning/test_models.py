"""Each body gets the smallest motion model that its scene needs, for the reason that is said."""

import dataclasses

import numpy as np
import pytest

import rbfem
from rbfem.planning.models import models_of
from rbfem.planning.plan import ModelChoice

SPIN = {"angular_velocity": [1.0, 2.0, -0.5]}
SPRING = {"spring": {"to": [0, 0, 1], "stiffness": 50.0, "rest_length": 0.1}}
ON_A_LEVER = {"spring": {"at": [0.05, 0.02, 0.01], "to": [0, 0, 1], "stiffness": 5.0, "rest_length": 0.1}}
OTHER = {"spring": {"to": {"body": "body1", "at": [0.05, 0, 0]}, "stiffness": 50.0}}
FIELD = {"gravity_gradient": {"rate": 0.1, "normal": [0, 0, 1], "start": [1, 0, 0]}}
AWAY = {"position": [1, 0, 0]}


def only_model(scene):
    (choice,) = rbfem.plan(scene).models
    return choice


@pytest.mark.parametrize(
    ("body", "model", "because"),
    [
        ({"fixed": True}, "fixed", "fixed in the case"),
        ({}, "translating", "never turns"),
        ({"velocity": [1, 0, 0], "loads": [{"force": [1, 0, 0]}]}, "translating", "never turns"),
        ({"loads": [SPRING]}, "translating", "never turns"),
        ({"loads": [{"drag": {"linear": 1.0, "angular": 1.0}}]}, "translating", "never turns"),
        ({"loads": [{"torque": [0, 0, 0]}]}, "translating", "never turns"),
        (SPIN, "rigid", "principal moments differ"),
        ({"loads": [{"torque": [0, 0, 1e-9]}]}, "rigid", "principal moments differ"),
        ({"loads": [{"torque": [0, 0, 1], "frame": "body"}]}, "rigid", "principal moments differ"),
        ({"loads": [{"force": [1, 0, 0], "at": [0, 0.1, 0]}]}, "rigid", "principal moments differ"),
        ({"loads": [{"force": [1, 0, 0], "at": [0, 0.1, 0], "frame": "body"}]}, "rigid", "principal moments differ"),
        ({"loads": [ON_A_LEVER]}, "rigid", "principal moments differ"),
        ({"loads": [FIELD]}, "rigid", "principal moments differ"),
        ({"shape": "ball", "loads": [FIELD]}, "translating", "never turns"),
        ({"shape": "ball"} | SPIN, "spherical", "gyroscopic term is zero"),
        ({"shape": "ball", "loads": [ON_A_LEVER]}, "spherical", "gyroscopic term is zero"),
        ({"shape": "cube"} | SPIN, "spherical", "gyroscopic term is zero"),
        ({"pivot": [0, 0, 1]} | AWAY, "rigid", "held at its pivot"),
        ({"shape": "ball", "pivot": [0, 0, 1]}, "rigid", "held at its pivot"),
        ({"shape": "ball", "pivot": [0, 0, 0]} | SPIN, "spherical", "held at its pivot"),
        ({"pivot": [0, 0, 0]}, "translating", "it stays at rest"),
    ],
)
def test_the_model_is_the_smallest_that_will_do(scene_of, body, model, because):
    choice = only_model(scene_of(body, gravity=[0, 0, -9.81], shapes={"cube": {"box": {"size": [1, 1, 1]}}}))
    assert choice.model == model
    assert because in choice.reason


def test_a_weight_turns_a_held_body_only_where_there_is_gravity(scene_of):
    assert only_model(scene_of({"pivot": [0, 0, 1]})).model == "translating"


def test_the_far_end_of_a_spring_turns_its_body_too(scene_of):
    scene = scene_of({"loads": [OTHER]}, AWAY)
    assert {choice.model: choice.names for choice in rbfem.plan(scene).models} == {
        "translating": ("body0",),
        "rigid": ("body1",),
    }


def test_a_mesh_of_nearly_equal_moments_keeps_its_tensor(scene_of):
    """Only moments that are equal to within the error of the tensor make a body spherical."""
    shapes = {"nearly": {"box": {"size": [1, 1, 1 + 1e-9]}}}
    assert only_model(scene_of({"shape": "nearly"} | SPIN, shapes=shapes)).model == "rigid"


def test_bodies_are_told_in_ranges_with_a_few_names(scene_of):
    place = {"in_box": [[0, 0, 0], [1, 1, 1]]}
    scene = scene_of({"name": "still", "count": 3, "place": place}, SPIN, {"name": "more", "count": 4, "place": place})
    still, spinning = rbfem.plan(scene).models
    assert still == ModelChoice(
        "translating",
        ((0, 2), (4, 7)),
        7,
        ("still.00", "still.01", "still.02", "more.00", "more.01"),
        still.reason,
    )
    assert spinning.bodies == ((3, 3),)
    assert models_of(rbfem.plan(scene).models, 8).tolist() == [1, 1, 1, 3, 1, 1, 1, 1]


@pytest.mark.parametrize("method", ["rk4", "rk4_world", "semi_implicit_euler", "euler"])
@pytest.mark.parametrize(
    "body",
    [
        {"velocity": [1, 2, 3]},
        {"loads": [SPRING, {"drag": {"linear": 0.5}}]} | AWAY,
        {"shape": "ball", "loads": [ON_A_LEVER]} | AWAY | SPIN,
        {"shape": "ball"} | SPIN,
        {"shape": "ball", "pivot": [1, 0, 0]} | AWAY | SPIN,
    ],
    ids=["coasting", "pulled", "sphere_on_a_lever", "spinning_sphere", "held_sphere"],
)
def test_the_smaller_model_moves_as_the_full_one_does(scene_of, run_of, body, method):
    time = {"end": 0.5, "step": 1e-3, "method": method}
    scene = scene_of(body, gravity=[0, 0, -9.81], time=time, output={"every": 0.25})
    small = rbfem.plan(scene)
    (choice,) = small.models
    assert choice.model in ("translating", "spherical")
    full = dataclasses.replace(small, models=(dataclasses.replace(choice, model="rigid"),))
    # rk4_world lets |q| drift, and the full tensor drifts with it, as its source has it; that of a sphere does not
    exact = 1e-7 if method == "rk4_world" else 1e-12
    for ours, general in zip(run_of(scene, small)[1], run_of(scene, full)[1], strict=True):
        for name in ("position", "velocity", "quaternion", "angular_velocity"):
            np.testing.assert_allclose(getattr(ours, name), getattr(general, name), rtol=exact, atol=exact)
        assert ours.balance.energy == pytest.approx(general.balance.energy, rel=exact)
