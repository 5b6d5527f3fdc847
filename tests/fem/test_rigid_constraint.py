import numpy as np
import pytest
from fem_meshes import ball_mesh, box_mesh, moved, second_order
from hypothesis import given, settings
from hypothesis import strategies as st

from rbfem.fem.mass_properties import mass_properties
from rbfem.fem.rigid_constraint import consistent_mass, node_velocities, rigid_mass, rigid_modes, wrench
from rbfem.mesh.tet_mesh import TetMesh

vectors = st.tuples(*[st.floats(-3, 3)] * 3).map(np.array)


def part(kind):
    if kind == "curved tet10":
        return second_order(ball_mesh(2, (1.0, 0.8, 0.5)), np.array([1.0, 0.8, 0.5]))
    mesh = moved(box_mesh(3), (0.2, -0.1, 0.3))
    return second_order(mesh) if kind == "straight tet10" else mesh


KINDS = ("tet4", "straight tet10", "curved tet10")


@settings(max_examples=30, deadline=None)
@given(vectors, vectors, vectors)
def test_the_six_columns_are_translations_and_small_rotations(about, shift, angle):
    nodes = np.random.default_rng(0).normal(size=(7, 3))
    moved_nodes = (rigid_modes(nodes, about) @ np.r_[shift, angle]).reshape(-1, 3)
    assert moved_nodes == pytest.approx(shift + np.cross(angle, nodes - about), abs=1e-14)


def test_the_columns_are_written_out_for_one_node():
    columns = rigid_modes(np.array([[1.0, 2.0, 3.0]]), np.zeros(3))
    assert (columns == [[1, 0, 0, 0, 3, -2], [0, 1, 0, -3, 0, 1], [0, 0, 1, 2, -1, 0]]).all()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("density", ["uniform", "by tet", "by node"])
def test_the_constrained_mass_matrix_is_the_mass_properties(kind, density):
    mesh = part(kind)
    rng = np.random.default_rng(3)
    rho = {"uniform": 2.5, "by tet": rng.uniform(1, 2, mesh.n_tets), "by node": rng.uniform(1, 2, mesh.n_nodes)}[
        density
    ]
    body = mass_properties(mesh, rho)
    six = rigid_mass(mesh, rho, body.center_of_mass)
    assert six[:3, :3] == pytest.approx(body.mass * np.eye(3), rel=1e-13, abs=1e-13 * body.mass)
    assert np.abs(six[:3, 3:]).max() < 1e-13 * body.mass * body.radius_of_gyration
    assert np.linalg.norm(six[3:, 3:] - body.inertia) < 1e-13 * np.linalg.norm(body.inertia)


def test_about_another_point_the_static_moment_couples():
    mesh, about = part("tet4"), np.array([1.0, -2.0, 0.5])
    body = mass_properties(mesh, 2.0)
    six = rigid_mass(mesh, 2.0, about)
    x, y, z = body.mass * (body.center_of_mass - about)
    assert six[:3, 3:] == pytest.approx(np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]]), rel=1e-12)
    assert six[3:, 3:] == pytest.approx(body.inertia_about(about), rel=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_the_mass_matrix_is_symmetric_and_holds_the_whole_mass(kind):
    mesh = part(kind)
    matrix = consistent_mass(mesh, 3.0)
    assert np.abs(matrix - matrix.T).max() < 1e-17
    assert matrix.sum() == pytest.approx(mass_properties(mesh, 3.0).mass, rel=1e-13)


def test_one_tet_has_the_mass_matrix_of_the_books():
    corner = TetMesh(np.vstack([np.zeros(3), np.eye(3)]), np.array([[0, 1, 2, 3]]))
    assert consistent_mass(corner, 6.0).toarray() == pytest.approx((np.ones((4, 4)) + np.eye(4)) / 20, rel=1e-14)


def test_nodes_move_with_the_centre_and_about_it():
    rng = np.random.default_rng(0)
    points, center, velocity, omega = rng.normal(size=(5, 3)), *rng.normal(size=(3, 3))
    by_modes = (rigid_modes(points, center) @ np.r_[velocity, omega]).reshape(-1, 3)
    assert node_velocities(points, center, velocity, omega) == pytest.approx(by_modes, abs=1e-14)


def test_the_kinetic_energy_of_the_nodes_is_that_of_the_body():
    mesh = part("curved tet10")
    body = mass_properties(mesh, 2.0)
    velocity, omega = np.array([1.0, -2.0, 0.5]), np.array([0.3, 2.0, -1.0])
    v = node_velocities(mesh.nodes, body.center_of_mass, velocity, omega)
    by_nodes = 0.5 * np.sum(v * (consistent_mass(mesh, 2.0) @ v))
    assert by_nodes == pytest.approx(
        0.5 * body.mass * velocity @ velocity + 0.5 * omega @ body.inertia @ omega, rel=1e-13
    )


@settings(max_examples=30, deadline=None)
@given(vectors)
def test_nodal_forces_add_up_to_a_wrench(about):
    rng = np.random.default_rng(1)
    nodes, forces = rng.normal(size=(2, 9, 3))
    six = wrench(nodes, forces, about)
    assert six[:3] == pytest.approx(forces.sum(axis=0), abs=1e-13)
    assert six[3:] == pytest.approx(np.cross(nodes - about, forces).sum(axis=0), abs=1e-12)
