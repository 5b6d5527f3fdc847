"""The reference point of a body: its centre of mass, or the pivot that holds it."""

import numpy as np
import pytest

from rbfem.motion import quaternion

TURN = [0.9, 0.1, -0.3, 0.2]


def test_a_free_body_refers_to_its_centre_of_mass(scene_of):
    scene = scene_of({"shape": "bracket", "material": "steel", "quaternion": TURN})
    np.testing.assert_array_equal(scene.reference.moments[0], scene.parts[0].principal_moments)
    np.testing.assert_array_equal(scene.reference.offset, [[0, 0, 0]])
    np.testing.assert_array_equal(scene.reference.arm, [[0, 0, 0]])


def test_moments_about_a_pivot_follow_from_the_parallel_axis_theorem(scene_of):
    body = {
        "shape": "bracket",
        "material": "steel",
        "position": [1, 2, 3],
        "quaternion": TURN,
        "pivot": [1.1, 2.2, 2.7],
    }
    scene = scene_of(body)
    part, reference = scene.parts[0], scene.reference
    arm = quaternion.rotate_back(scene.quaternion[0], scene.position[0] - body["pivot"])
    about = part.inertia + part.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    np.testing.assert_allclose(reference.moments[0], np.linalg.eigvalsh(about), rtol=1e-12)
    axes = quaternion.to_matrix(reference.quaternion[0])
    np.testing.assert_allclose(axes @ np.diag(reference.moments[0]) @ axes.T, about, atol=1e-13 * about.max())


def test_the_arm_leads_from_the_pivot_to_the_centre_of_mass(scene_of):
    body = {"position": [1, 2, 3], "quaternion": TURN, "pivot": [1.1, 2.2, 2.7]}
    scene = scene_of(body)
    axes = quaternion.product(scene.quaternion[0], scene.reference.quaternion[0])
    np.testing.assert_allclose(quaternion.rotate(axes, scene.reference.arm[0]), [-0.1, -0.2, 0.3], atol=1e-14)


def test_only_the_bodies_that_a_pivot_holds_are_held(scene_of):
    scene = scene_of({}, {"pivot": [0, 0, 1]}, {"fixed": True})
    assert scene.is_held.tolist() == [False, True, False]
    assert scene.is_fixed.tolist() == [False, False, True]


def test_a_held_body_keeps_its_pivot_through_a_run(scene_of, run_of):
    body = {"position": [0, 0, 0.3], "quaternion": TURN, "pivot": [0.1, 0, 0], "angular_velocity": [1, 2, 3]}
    scene = scene_of(body, gravity=[0, 0, -9.81], time={"end": 0.5})
    point = quaternion.rotate_back(scene.quaternion[0], np.array(body["pivot"]) - scene.position[0])
    _, frames = run_of(scene)
    for frame in frames:
        held = frame.position[0] + quaternion.rotate(frame.quaternion[0], point)
        np.testing.assert_allclose(held, body["pivot"], atol=1e-14)
        velocity = frame.velocity[0] + np.cross(frame.angular_velocity[0], held - frame.position[0])
        assert np.abs(velocity).max() < 1e-13


def test_the_first_frame_of_a_held_body_is_what_the_case_says(scene_of, run_of):
    body = {"position": [0, 0, 0.3], "quaternion": TURN, "pivot": [0.1, 0, 0], "angular_velocity": [1, 2, 3]}
    scene = scene_of(body, time={"end": 0.01})
    _, frames = run_of(scene)
    np.testing.assert_allclose(frames[0].position, scene.position, atol=1e-15)
    np.testing.assert_allclose(frames[0].velocity, scene.velocity, atol=1e-14)
    np.testing.assert_allclose(frames[0].angular_velocity, [[1, 2, 3]], rtol=1e-13)
    assert quaternion.angle_between(frames[0].quaternion[0], scene.quaternion[0]) < 1e-7


def test_the_energy_of_a_held_body_is_that_of_its_centre_and_of_the_turning_about_it(scene_of, run_of):
    scene = scene_of({"position": [0, 0, 0.3], "pivot": [0.1, 0, 0], "angular_velocity": [1, 2, 3]}, time={"end": 0.01})
    _, frames = run_of(scene)
    part, omega, velocity = scene.parts[0], scene.angular_velocity[0], scene.velocity[0]
    assert frames[0].balance.kinetic == pytest.approx(0.5 * part.mass * velocity @ velocity, rel=1e-13)
    assert frames[0].balance.rotational == pytest.approx(0.5 * omega @ part.inertia @ omega, rel=1e-13)
