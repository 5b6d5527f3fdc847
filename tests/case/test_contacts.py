"""What a case may not say of contact: each refusal names the line and the key."""

import pytest

from rbfem.errors import InputError

GLASS = {"glass": {"density": 2500, "young": 7e10, "poisson": 0.2}, "clay": {"density": 1500}}
SHAPES = {"floor": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}}
BALL = {"shape": "ball", "material": "glass", "position": [0, 0, 1]}
FLOOR = {"name": "floor", "shape": "floor", "material": "glass", "fixed": True}
HERTZ = {"between": "any", "restitution": 0.5, "friction": 0.3}


def refusal(scene_of, *bodies, **rule):
    with pytest.raises(InputError) as caught:
        scene_of(*bodies, shapes=SHAPES, materials=GLASS, contacts=[{**HERTZ, **rule}])
    return str(caught.value)


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        ({"restitution": 0}, "restitution: expected a positive number, read 0"),
        ({"restitution": 1.01}, "restitution: expected a number from above 0 to 1, read 1.01"),
        ({"friction": -0.1}, "friction: expected a number that is at least 0, read -0.1"),
        ({"between": ["glass", "clai"]}, "no material 'clai'; did you mean 'clay'?"),
        ({"law": "linear"}, "the linear law needs 'normal_stiffness'"),
        ({"normal_stiffness": 1e5}, "'normal_stiffness' goes with `law: linear`"),
        ({"law": "hertzian"}, "law"),
    ],
)
def test_a_wrong_rule_is_refused_with_its_key(scene_of, rule, message):
    said = refusal(scene_of, BALL, FLOOR, **rule)
    assert "case.yaml:1: contacts" in said
    assert message in said


def test_hertz_needs_the_moduli_of_both_materials(scene_of):
    said = refusal(scene_of, BALL, BALL | {"material": "clay", "position": [0, 0, 2]})
    assert "the law hertz needs 'young' of material 'clay'" in said


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (FLOOR | {"fixed": False}, "a plane is a wall: write `fixed: true`"),
        (FLOOR | {"position": [0, 0, 1]}, "'position' does not go with a plane"),
        (BALL | {"shape": "brick"}, "contact of a box is not in this version"),
        (BALL | {"loads": [{"force": [1, 0, 0]}]}, "a body that touches others takes no loads in this version"),
        (BALL | {"position": [0, 0, 0.05]}, "'body1' and 'floor' overlap by 0.05 m at the start"),
    ],
)
def test_a_body_that_cannot_touch_is_refused_with_its_name(scene_of, body, message):
    floor = [] if body.get("shape") == "floor" else [FLOOR]
    assert message in refusal(scene_of, *floor, body)


def test_spheres_that_overlap_at_the_start_are_named(scene_of):
    said = refusal(scene_of, BALL, BALL | {"position": [0, 0, 1.15]})
    assert "'body0' and 'body1' overlap by 0.05 m" in said


def test_a_scene_of_walls_alone_is_refused(scene_of):
    assert "only walls" in refusal(scene_of, FLOOR)
