from dataclasses import replace

import numpy as np
import pytest
from fem_meshes import ball_mesh, box_mesh, moved, second_order, with_surface

from rbfem.errors import InputError
from rbfem.fem.surface_loads import pressure_forces, pressure_wrench, traction_forces, traction_wrench

SIZE = (1.0, 0.7, 0.4)
RADII = np.array([1.0, 0.8, 0.5])


def is_right(centers):
    return np.abs(centers[:, 0] - SIZE[0]) < 1e-12


def make_box(order):
    mesh = box_mesh(3, SIZE)
    return with_surface(mesh if order == 1 else second_order(mesh), right=is_right, all=lambda c: np.full(len(c), True))


def make_egg(order):
    mesh = ball_mesh(3, tuple(RADII))
    mesh = mesh if order == 1 else second_order(mesh, RADII)
    return with_surface(mesh, all=lambda c: np.full(len(c), True), upper=lambda c: c[:, 2] > 0.0)


both_orders = pytest.mark.parametrize("order", [1, 2])


@both_orders
def test_pressure_on_a_flat_group_is_its_area_times_it_at_its_centroid(order):
    mesh = make_box(order)
    about = np.array([0.3, 0.1, -0.2])
    six = pressure_wrench(mesh, "right", 5.0, about)
    force = np.array([-5.0 * 0.7 * 0.4, 0.0, 0.0])
    assert six[:3] == pytest.approx(force, abs=1e-14)
    assert six[3:] == pytest.approx(np.cross([1.0, 0.35, 0.2] - about, force), abs=1e-14)


@both_orders
@pytest.mark.parametrize("make", [make_box, make_egg])
def test_pressure_all_round_pushes_and_turns_nothing(make, order):
    mesh = moved(make(order), (0.5, 0.2, -0.4))
    assert np.abs(pressure_wrench(mesh, "all", 7.0, np.array([0.1, 0.2, 0.3]))).max() < 1e-14 * 7.0 * 10
    assert np.abs(pressure_forces(mesh, "all", 7.0)).max() > 0.01


@both_orders
def test_nodal_pressures_give_the_volume_back(order):
    # ∮ x · n dA = 3 V.
    mesh = make_box(order)
    forces = pressure_forces(mesh, "all", 1.0)
    assert -(forces * mesh.nodes).sum() == pytest.approx(3 * 1.0 * 0.7 * 0.4, rel=1e-13)


def test_pressure_on_a_curved_cap_is_that_on_its_shadow():
    # The rim of the upper half is where the mesh has it; with second order it follows the ellipse, area π a b.
    mesh = make_egg(2)
    six = pressure_wrench(mesh, "upper", 2.0, np.zeros(3))
    rim = mesh.surfaces["upper"]
    lower = replace(
        mesh, surfaces={"lower": np.array([t for t in mesh.surfaces["all"] if t.tolist() not in rim.tolist()])}
    )
    other = pressure_wrench(lower, "lower", 2.0, np.zeros(3))
    assert six == pytest.approx(-other, abs=1e-14)
    assert six[2] < -0.5 * 2.0 * np.pi * 0.8


def test_a_curved_patch_has_the_force_of_its_own_map():
    # One quadratic triangle over the corner triangle, z = x y bent up: ∫ n dA = ∫ (-z_x, -z_y, 1) dx dy, all by hand.
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]])
    middles = np.array([[0.5, 0, 0], [0.5, 0.5, 0.25], [0, 0.5, 0]])
    mesh = with_patch(np.vstack([corners, middles]))
    force = pressure_wrench(mesh, "patch", 3.0, np.zeros(3))
    assert force[:3] == pytest.approx([3 * 1 / 6, 3 * 1 / 6, -3 * 1 / 2], rel=1e-14)
    # r × n with r = (x, y, xy), n = (-y, -x, 1): (y + x² y, -x y² - x, -x² + y²), integrated over the triangle.
    assert force[3:] == pytest.approx([-3 * (1 / 6 + 1 / 60), 3 * (1 / 60 + 1 / 6), 0.0], rel=1e-13, abs=1e-15)


def with_patch(nodes):
    from rbfem.mesh.tet_mesh import TetMesh

    return TetMesh(nodes, np.zeros((0, 10), dtype=int), surfaces={"patch": np.array([[0, 1, 2, 3, 4, 5]])})


@both_orders
def test_traction_on_a_flat_group_is_its_area_times_it_at_its_centroid(order):
    mesh, about, traction = make_box(order), np.array([0.3, 0.1, -0.2]), np.array([1.0, -2.0, 3.0])
    six = traction_wrench(mesh, "right", traction, about)
    force = 0.28 * traction
    assert six[:3] == pytest.approx(force, rel=1e-13)
    assert six[3:] == pytest.approx(np.cross([1.0, 0.35, 0.2] - about, force), rel=1e-13)


def test_traction_on_a_curved_surface_feels_its_true_area():
    # The area of the ball is 4 π. Measured: curved 1e-4 away from it, flat 1.9e-2.
    ball = with_surface(second_order(ball_mesh(4), np.ones(3)), all=lambda c: np.full(len(c), True))
    flat = with_surface(ball_mesh(4), all=lambda c: np.full(len(c), True))
    areas = [traction_forces(mesh, "all", (0.0, 0.0, 1.0))[:, 2].sum() for mesh in (ball, flat)]
    errors = np.abs(np.array(areas) / (4 * np.pi) - 1.0)
    assert errors[0] < 5e-4 and errors[1] > 20 * errors[0]


@both_orders
def test_nodal_forces_are_consistent_with_the_shape_functions(order):
    # On one flat triangle a uniform load gives a third to each corner, and with second order to each mid-side node.
    mesh = make_box(order)
    triangle = mesh.surfaces["right"][:1]
    one = replace(mesh, surfaces={"one": triangle})
    forces = pressure_forces(one, "one", 1.0)[triangle[0], 0]
    third = forces.sum() / 3
    assert forces == pytest.approx([third] * 3 if order == 1 else [0, 0, 0] + [third] * 3, abs=1e-15)
    assert third < 0.0


@pytest.mark.parametrize("load", [pressure_forces, traction_forces])
def test_a_group_that_is_not_there_is_named_with_those_that_are(load):
    mesh = replace(make_box(1), source="bracket.msh")
    with pytest.raises(InputError, match=r"bracket.msh: no surface group 'left'; it has right, all"):
        load(mesh, "left", 1.0)
    with pytest.raises(InputError, match="it has none"):
        load(replace(mesh, surfaces={}), "left", 1.0)
    with pytest.raises(InputError, match="'left' is empty"):
        load(replace(mesh, surfaces={"left": np.zeros((0, 3), dtype=int)}), "left", 1.0)
