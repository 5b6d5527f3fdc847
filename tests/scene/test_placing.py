"""Where bodies start."""

import numpy as np
import pytest

from rbfem.motion import quaternion

TURN = [0.9, 0.1, -0.3, 0.2]
COPIES = {"name": "rock", "count": 5, "place": {"in_box": [[-1, -2, 3], [1, 2, 4]], "orientation": "random"}}


def test_position_moves_the_origin_of_a_mesh_there_and_not_its_centre(scene_of):
    scene = scene_of({"shape": "bracket", "material": "steel", "position": [1, 2, 3], "quaternion": TURN})
    mesh_zero = scene.position[0] + quaternion.rotate(scene.quaternion[0], scene.parts[0].origin)
    np.testing.assert_allclose(mesh_zero, [1, 2, 3], atol=1e-15)
    assert np.linalg.norm(scene.position[0] - [1, 2, 3]) > 0.01


def test_position_is_the_centre_of_a_primitive(scene_of):
    scene = scene_of({"shape": "brick", "position": [1, 2, 3], "quaternion": TURN})
    np.testing.assert_array_equal(scene.position[0], [1, 2, 3])


def test_the_quaternion_of_the_case_is_scaled_to_length_one(scene_of):
    scene = scene_of({"quaternion": [3, 0, 4, 0]})
    np.testing.assert_allclose(scene.quaternion[0], [0.6, 0, 0.8, 0], rtol=1e-15)


def test_places_put_the_centre_of_mass_of_a_mesh_into_the_box(scene_of):
    copies = COPIES | {"shape": "bracket", "material": "steel", "count": 300}
    scene = scene_of(copies)
    assert (scene.position >= [-1, -2, 3]).all() and (scene.position <= [1, 2, 4]).all()
    assert scene.position[:, 0].max() > 0.9 and scene.position[:, 0].min() < -0.9
    np.testing.assert_allclose(np.linalg.norm(scene.quaternion, axis=1), 1.0, rtol=1e-14)


def test_random_attitudes_prefer_no_direction(scene_of):
    scene = scene_of(COPIES | {"count": 20000})
    axes = quaternion.to_matrix(scene.quaternion)
    assert np.abs(axes.mean(axis=0)).max() < 4 / np.sqrt(3 * 20000)  # four standard deviations of a mean of cosines


def test_places_without_orientation_keep_the_attitude_written(scene_of):
    copies = {"count": 3, "place": {"in_box": [[0, 0, 0], [1, 1, 1]]}, "quaternion": [0, 0, 0, 1]}
    np.testing.assert_array_equal(scene_of(copies).quaternion, [[0, 0, 0, 1]] * 3)


def test_the_same_seed_gives_the_same_places_and_another_seed_others(scene_of):
    first, again, other = scene_of(COPIES, seed=7), scene_of(COPIES, seed=7), scene_of(COPIES, seed=8)
    np.testing.assert_array_equal(first.position, again.position)
    np.testing.assert_array_equal(first.quaternion, again.quaternion)
    assert not np.isin(first.position, other.position).any()


def test_another_body_behind_moves_none_of_the_places(scene_of):
    alone, beside = scene_of(COPIES), scene_of(COPIES, COPIES | {"name": "stone"})
    np.testing.assert_array_equal(alone.position, beside.position[:5])
    assert not np.isin(beside.position[:5], beside.position[5:]).any()


def test_copies_are_numbered_with_as_many_digits_as_the_last_needs(scene_of):
    scene = scene_of({"name": "one"}, COPIES, COPIES | {"name": "many", "count": 101})
    assert scene.names[:3] == ("one", "rock.00", "rock.01")
    assert scene.names[6] == "many.000" and scene.names[-1] == "many.100"
    assert scene.part_of.tolist() == [0] * 107


def test_an_angular_velocity_in_body_axes_is_turned_into_the_world(scene_of):
    scene = scene_of({"quaternion": [1, 0, 0, 1], "angular_velocity_body": [1, 2, 3]})  # a quarter turn about z
    np.testing.assert_allclose(scene.angular_velocity[0], [-2, 1, 3], atol=1e-14)


def test_each_random_copy_spins_about_its_own_axes(scene_of):
    scene = scene_of(COPIES | {"angular_velocity_body": [0, 0, 2]})
    in_body = quaternion.rotate_back(scene.quaternion, scene.angular_velocity)
    np.testing.assert_allclose(in_body, [[0, 0, 2]] * 5, atol=1e-14)
    assert np.ptp(scene.angular_velocity[:, 2]) > 0.1


def test_a_body_held_at_a_pivot_starts_with_the_velocity_that_its_spin_gives_it(scene_of):
    scene = scene_of({"position": [1, 2, 3], "pivot": [1, 2, 5], "angular_velocity": [0.5, 0, 7]})
    assert scene.velocity[0] == pytest.approx([0, 1.0, 0], abs=1e-15)  # (0.5, 0, 7) × (0, 0, -2)


def test_nothing_said_starts_at_the_origin_at_rest(scene_of):
    scene = scene_of({})
    for start in (scene.position, scene.velocity, scene.angular_velocity):
        np.testing.assert_array_equal(start, [[0, 0, 0]])
    np.testing.assert_array_equal(scene.quaternion, [[1, 0, 0, 0]])
