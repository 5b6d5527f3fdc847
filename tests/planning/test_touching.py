"""The step that the shortest contact allows."""

import math

import pytest

import rbfem
from rbfem.planning.touching import quickest, restitution_error, step_for

FLOOR = {"name": "floor", "shape": "floor", "material": "water", "fixed": True}
SHAPES = {"floor": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}}
LINEAR = {"between": "any", "law": "linear", "normal_stiffness": 1e5, "restitution": 0.5, "friction": 0.3}
MASS = 1000 * 4 / 3 * math.pi * 0.1**3


@pytest.fixture
def ball_on_floor(scene_of):
    def make(**keys):
        ball = {"shape": "ball", "position": [0, 0, 0.2]}
        return scene_of(ball, FLOOR, shapes=SHAPES, contacts=[LINEAR], gravity=[0, 0, -9.81], **keys)

    return make


def test_a_contact_lasts_half_a_swing_of_the_lightest_pair(scene_of, ball_on_floor):
    assert quickest(ball_on_floor()).duration == pytest.approx(math.pi * math.sqrt(MASS / 1e5))
    balls = [{"shape": "ball", "position": [0, 0, height]} for height in (1, 2)]
    pair = scene_of(*balls, contacts=[LINEAR])
    assert quickest(pair).duration == pytest.approx(math.pi * math.sqrt(0.5 * MASS / 1e5))


def test_hertz_contacts_are_judged_at_the_speed_of_the_fall(scene_of):
    rule = {"between": "any", "restitution": 1, "friction": 0}
    stuff = {"water": {"density": 1000, "young": 1e7, "poisson": 0.25}}
    ball = {"shape": "ball", "position": [0, 0, 0.6]}
    scene = scene_of(ball, FLOOR, shapes=SHAPES, materials=stuff, contacts=[rule], gravity=[0, 0, -9.81])
    speed = math.sqrt(2 * 9.81 * (0.6 + 0.1))
    modulus = 0.5 * 1e7 / (1 - 0.25**2)
    deepest = (15 * MASS * speed**2 / (16 * modulus * math.sqrt(0.1))) ** 0.4
    found = quickest(scene)
    assert found.speed == pytest.approx(speed, rel=0.1)
    assert found.duration == pytest.approx(2.943 * deepest / found.speed, rel=0.1)


def test_the_step_is_the_one_whose_restitution_has_the_error_accepted(ball_on_floor):
    fastest = quickest(ball_on_floor())
    for accuracy in (1e-3, 5e-4):
        assert restitution_error(step_for(accuracy, fastest), fastest) == pytest.approx(accuracy)


def test_a_step_beyond_the_limit_is_refused_and_one_below_is_taken(ball_on_floor):
    limit = quickest(ball_on_floor()).limit
    with pytest.raises(rbfem.InputError, match=r"time\.step.*but the limit of this scene"):
        rbfem.plan(ball_on_floor(time={"end": 1, "step": 1.05 * limit}))
    assert rbfem.plan(ball_on_floor(time={"end": 1, "step": 0.95 * limit})).step.value == 0.95 * limit


def test_another_method_is_refused_where_bodies_touch(ball_on_floor):
    with pytest.raises(rbfem.InputError, match="bodies in contact move by kdk"):
        rbfem.plan(ball_on_floor(time={"end": 1, "method": "rkn4"}))


def test_the_highest_sphere_falls_the_farthest(scene_of):
    balls = [{"shape": "ball", "position": [0, 0, height]} for height in (1, 10)]
    scene = scene_of(*balls, FLOOR, shapes=SHAPES, contacts=[LINEAR], gravity=[0, 0, -9.81])
    assert quickest(scene).speed >= math.sqrt(2 * 9.81 * 9.9)


def test_where_nothing_that_touches_moves_no_contact_is_planned(scene_of):
    post = {"shape": "ball", "position": [0, 0, 0.1], "fixed": True}
    flier = {"shape": "ball", "material": "rubber", "velocity": [1, 0, 0]}
    rule = LINEAR | {"between": ["water", "water"]}
    plan = rbfem.plan(scene_of(post, flier, FLOOR, shapes=SHAPES, contacts=[rule]))
    assert plan.contact.value == "none"
