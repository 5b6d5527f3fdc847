"""Every kind of load as a row of the load table: its force and torque against the text-book ones."""

import numpy as np
import pytest

from rbfem.fem.surface_loads import pressure_wrench, traction_wrench
from rbfem.motion import loads as kinds
from rbfem.motion import quaternion
from rbfem.motion.loads import load_wrench
from rbfem.motion.state import angular_velocity_world
from rbfem.planning.models import choose_models
from rbfem.planning.system import build_system, starting_state

TURN = [0.9, 0.1, -0.3, 0.2]
START = {"position": [1, 2, 3], "quaternion": TURN}
BRACKET = {"name": "part", "shape": "bracket", "material": "steel", **START}
POINT = [0.01, 0.03, 0.02]  # in the coordinates of the mesh


def wrench_at_start(scene, body=0):
    """Force and torque (world axes, about the reference point) of all loads on a body as the run starts."""
    system = build_system(scene, choose_models(scene))
    state = starting_state(scene)
    rows = np.zeros((scene.n_bodies, 13))
    rows[:, 0:3], rows[:, 3:7], rows[:, 7:10] = state.position, state.quaternion, state.velocity
    omega = angular_velocity_world(state, system.bodies)
    table = range(scene.first_load[body], scene.first_load[body + 1])
    total = [load_wrench(k, body, 0.0, system.bodies, scene.loads, rows, omega)[:6] for k in table]
    return np.sum(total, axis=0)


def world_lever(scene, point, body=0):
    """From the centre of mass of a body to a point in its shape's coordinates, world axes."""
    return quaternion.rotate(scene.quaternion[body], np.array(point) + scene.parts[scene.part_of[body]].origin)


def test_principal_axes_of_the_bracket_are_not_those_of_its_mesh(scene_of):
    """Without this the tests below would see less than they claim."""
    assert quaternion.angle_between(scene_of(BRACKET).reference.quaternion[0], [1, 0, 0, 0]) > 0.1


@pytest.mark.parametrize("frame", ["world", "body"])
def test_a_force_at_a_point_of_the_mesh_has_its_lever_from_the_centre_of_mass(scene_of, frame):
    scene = scene_of(BRACKET | {"loads": [{"force": [3, -2, 1], "at": POINT, "frame": frame}]})
    force = quaternion.rotate(scene.quaternion[0], [3, -2, 1]) if frame == "body" else np.array([3, -2, 1])
    expected = np.concatenate([force, np.cross(world_lever(scene, POINT), force)])
    np.testing.assert_allclose(wrench_at_start(scene), expected, atol=1e-14)


@pytest.mark.parametrize("frame", ["world", "body"])
def test_a_force_without_a_point_acts_at_the_centre_of_mass(scene_of, frame):
    scene = scene_of(BRACKET | {"loads": [{"force": [3, -2, 1], "frame": frame}]})
    force = quaternion.rotate(scene.quaternion[0], [3, -2, 1]) if frame == "body" else [3, -2, 1]
    np.testing.assert_allclose(wrench_at_start(scene), [*force, 0, 0, 0], atol=1e-15)


@pytest.mark.parametrize("frame", ["world", "body"])
def test_a_torque_is_turned_into_the_world_only_if_it_follows_the_body(scene_of, frame):
    scene = scene_of(BRACKET | {"loads": [{"torque": [3, -2, 1], "frame": frame}]})
    torque = quaternion.rotate(scene.quaternion[0], [3, -2, 1]) if frame == "body" else [3, -2, 1]
    np.testing.assert_allclose(wrench_at_start(scene), [0, 0, 0, *torque], atol=1e-14)


@pytest.mark.parametrize("load", [{"pressure": 2e6, "on": "loaded"}, {"traction": [1e5, 2e5, -3e5], "on": "loaded"}])
def test_a_surface_load_is_the_wrench_of_its_nodal_forces_turned_with_the_body(scene_of, load):
    scene = scene_of(BRACKET | {"loads": [load]})
    mesh, center = scene.parts[0].mesh, -scene.parts[0].origin
    if "pressure" in load:
        six = pressure_wrench(mesh, "loaded", 2e6, center)
    else:
        six = traction_wrench(mesh, "loaded", load["traction"], center)
    turned = np.concatenate([quaternion.rotate(scene.quaternion[0], part) for part in (six[:3], six[3:])])
    assert np.abs(six[3:]).max() > 1.0
    np.testing.assert_allclose(wrench_at_start(scene), turned, atol=1e-12 * np.abs(six).max())


def test_a_pressure_pushes_inward_with_pressure_times_area(scene_of):
    load = {"pressure": "2 MPa", "on": "loaded"}
    scene = scene_of({"shape": "bracket", "material": "steel", "loads": [load]})
    np.testing.assert_allclose(wrench_at_start(scene)[:3], [0, 0, -2e6 * 0.04 * 0.03], atol=1e-9)  # pad 40 x 30 mm


def test_a_spring_pulls_its_point_towards_the_world_point(scene_of):
    end, stiffness, damping, rest = np.array([0.5, 2.5, 4.0]), 100.0, 3.0, 0.4
    spring = {"at": POINT, "to": end.tolist(), "stiffness": stiffness, "damping": damping, "rest_length": rest}
    scene = scene_of(BRACKET | {"loads": [{"spring": spring}], "velocity": [1, 0, 2], "angular_velocity": [3, 1, -2]})
    lever = world_lever(scene, POINT)
    span = end - (scene.position[0] + lever)
    length = np.linalg.norm(span)
    velocity = scene.velocity[0] + np.cross(scene.angular_velocity[0], lever)
    force = (stiffness * (length - rest) - damping * velocity @ span / length) * span / length
    np.testing.assert_allclose(wrench_at_start(scene), [*force, *np.cross(lever, force)], atol=1e-11)


def test_a_spring_between_bodies_stands_on_both_with_opposite_forces(scene_of):
    spring = {"at": POINT, "to": {"body": "other", "at": [0.0, 0.1, 0.0]}, "stiffness": 100.0, "damping": 3.0}
    scene = scene_of(
        BRACKET | {"loads": [{"spring": spring}], "velocity": [1, 0, 2]},
        {"name": "other", "position": [2, 2, 2], "quaternion": [0.5, 0.5, -0.5, 0.5], "angular_velocity": [3, 1, -2]},
    )
    near, far = wrench_at_start(scene, 0), wrench_at_start(scene, 1)
    np.testing.assert_allclose(near[:3], -far[:3], atol=1e-12)
    lever = [world_lever(scene, POINT), world_lever(scene, [0, 0.1, 0], 1)]
    np.testing.assert_allclose(near[3:], np.cross(lever[0], near[:3]), atol=1e-12)
    np.testing.assert_allclose(far[3:], np.cross(lever[1], far[:3]), atol=1e-12)
    span = scene.position[1] + lever[1] - scene.position[0] - lever[0]
    assert np.abs(np.cross(span, near[:3])).max() < 1e-11 and near[:3] @ span > 0
    assert scene.loads.is_external.tolist() == [0, 0]


@pytest.mark.parametrize("holding", [{"fixed": True}, {"pivot": [0, 0, 1]}])
def test_a_spring_to_what_the_world_holds_counts_as_a_load_from_outside(scene_of, holding):
    spring = {"to": {"body": "other"}, "stiffness": 100.0}
    scene = scene_of({"loads": [{"spring": spring}]}, {"name": "other", "position": [1, 0, 0]} | holding)
    assert scene.loads.is_external.tolist() == [1, 1]


def test_each_copy_has_its_own_spring_to_the_other_body(scene_of):
    place = {"in_box": [[0, 0, 1], [1, 1, 2]]}
    spring = {"to": {"body": "anchor"}, "stiffness": 100.0}
    scene = scene_of({"name": "anchor"}, {"count": 3, "place": place, "loads": [{"spring": spring}]})
    assert np.diff(scene.first_load).tolist() == [3, 1, 1, 1]
    assert scene.loads.other.tolist() == [1, 2, 3, 0, 0, 0]
    np.testing.assert_allclose(wrench_at_start(scene, 2)[:3], 100 * (scene.position[0] - scene.position[2]), rtol=1e-13)


def test_drag_acts_at_the_centre_of_mass_also_of_a_held_body(scene_of):
    drag = {"drag": {"linear": 2, "angular": 0.5}}
    body = {"position": [1, 2, 3], "pivot": [1, 2, 5], "angular_velocity": [0.5, 0, 7], "loads": [drag]}
    scene = scene_of(body)
    force = -2 * np.array([0, 1.0, 0])  # the velocity is (0.5, 0, 7) × (0, 0, -2)
    torque = np.cross([0, 0, -2], force) - 0.5 * np.array([0.5, 0, 7])
    np.testing.assert_allclose(wrench_at_start(scene), [*force, *torque], atol=1e-13)


def test_a_gravity_gradient_acts_on_the_tensor_about_the_centre_of_mass(scene_of):
    field = {"rate": 2, "normal": [0, 0, 5], "start": [3, 4, 0]}
    scene = scene_of(BRACKET | {"loads": [{"gravity_gradient": field}]})
    tensor = scene.parts[0].inertia
    away = np.array([0.6, 0.8, 0.0])
    seen = quaternion.rotate_back(scene.quaternion[0], away)
    torque = 12 * quaternion.rotate(scene.quaternion[0], np.cross(seen, tensor @ seen))
    np.testing.assert_allclose(wrench_at_start(scene), [0, 0, 0, *torque], atol=1e-13 * np.abs(tensor).max() * 12)
    assert np.abs(torque).min() > 1e-2 * np.abs(tensor).max()
    assert scene.loads.is_external.tolist() == [1] and scene.load_kinds == (("gravity_gradient",),)


def test_levers_of_a_held_body_start_at_its_pivot(scene_of):
    pivot = np.array([1.1, 2.2, 2.7])
    loads = [{"force": [3, -2, 1], "at": POINT}, {"pressure": 2e6, "on": "loaded"}]
    scene = scene_of(BRACKET | {"pivot": pivot.tolist(), "loads": loads})
    point = scene.position[0] + world_lever(scene, POINT)
    given = np.cross(point - pivot, [3, -2, 1])
    six = pressure_wrench(scene.parts[0].mesh, "loaded", 2e6, -scene.parts[0].origin)
    force, torque = (quaternion.rotate(scene.quaternion[0], part) for part in (six[:3], six[3:]))
    expected = given + torque + np.cross(scene.position[0] - pivot, force)
    np.testing.assert_allclose(wrench_at_start(scene)[3:], expected, rtol=1e-11)


def test_a_ramp_scales_a_load_and_is_stored_once_for_all_that_share_it(scene_of):
    ramp = [[0, 0.25], [1, 1], [2, 0]]
    place = {"in_box": [[0, 0, 0], [1, 1, 1]]}
    loads = [{"force": [4, 0, 0], "ramp": ramp}, {"torque": [0, 8, 0], "ramp": ramp}, {"force": [0, 0, 1]}]
    scene = scene_of(
        {"count": 2, "place": place, "loads": loads}, {"loads": [{"force": [1, 1, 1], "ramp": [[0, 3], [5, 4]]}]}
    )
    assert scene.loads.ramp.tolist() == [0, 0, -1, 0, 0, -1, 1]
    assert scene.loads.ramp_first.tolist() == [0, 3, 5]
    np.testing.assert_allclose(wrench_at_start(scene), [1, 0, 1, 0, 2, 0], atol=1e-15)
    np.testing.assert_allclose(wrench_at_start(scene, 2)[:3], [3, 3, 3], atol=1e-15)


def test_the_table_is_sorted_by_body_in_the_order_of_the_case(scene_of):
    scene = scene_of({"loads": [{"drag": {"linear": 1}}, {"torque": [1, 0, 0]}]}, {}, {"loads": [{"force": [1, 0, 0]}]})
    assert scene.first_load.tolist() == [0, 2, 2, 3]
    assert scene.loads.kind.tolist() == [kinds.DRAG, kinds.COUPLE, kinds.FORCE]
    assert scene.load_kinds == (("drag", "torque"), (), ("force",))
