import numpy as np
import pytest

from rbfem.mesh.check import quality, summarize
from rbfem.mesh.read import read_mesh
from rbfem.mesh.tet_mesh import TetMesh

POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1.0]])


def only_warning(mesh):
    (warning,) = mesh.warnings
    return warning


def test_separate_pieces_are_counted(write):
    mesh = read_mesh(write(np.vstack([POINTS[:4], POINTS[:4] + 3]), [("tetra", np.arange(8).reshape(2, 4))]))
    assert only_warning(mesh) == "the mesh is 2 separate pieces, moved as one rigid body"
    assert summarize(mesh).components == 2


def test_two_tets_on_the_same_side_of_a_face_overlap(write):
    points = np.vstack([POINTS[:4], [[0.5, 0.5, 2.0]]])
    mesh = read_mesh(write(points, [("tetra", np.array([[0, 1, 2, 3], [0, 1, 2, 4]]))]))
    assert "the tets hold 0.5 m^3 but the boundary encloses" in only_warning(mesh)


def test_a_face_of_three_tets_is_said(write):
    points = np.vstack([POINTS, [[0.3, 0.3, -1.0], [2.0, 2.0, -1.0]]])
    mesh = read_mesh(write(points, [("tetra", np.array([[0, 1, 2, 3], [0, 1, 2, 5], [0, 1, 2, 6]]))]))
    assert "1 faces are shared by three or more tets: tets overlap there" in mesh.warnings


def test_two_tets_that_touch_in_an_edge_have_no_simple_boundary(write):
    points = np.vstack([POINTS[:4], [[0, -1, 0], [0, 0, -1.0]]])
    mesh = read_mesh(write(points, [("tetra", np.array([[0, 1, 2, 3], [0, 1, 4, 5]]))]))
    assert "1 of its edges do not join exactly two triangles" in only_warning(mesh)


def test_a_large_box_smells_of_millimetres(write):
    path = write(POINTS[:4] * [30, 10, 10], [("tetra", np.arange(4)[None])])
    assert only_warning(read_mesh(path)) == (
        "the largest side is 30 m: if the mesh was drawn in millimetres, say so with unit: mm"
    )
    assert read_mesh(path, unit="mm").warnings == ()


def test_a_surface_group_inside_the_part_is_left_out(write):
    blocks = [("tetra", np.array([[0, 1, 2, 3], [1, 2, 3, 4]])), ("triangle", np.array([[1, 2, 3], [0, 1, 2]]))]
    inside = {"gmsh:physical": [np.array([0, 0]), np.array([1, 2])]}
    mesh = read_mesh(write(POINTS, blocks, cell_data=inside))
    assert only_warning(mesh) == "surface group 'physical_1' is not on the boundary of the part: left out"
    assert mesh.surfaces["physical_2"].tolist() == [[0, 2, 1]]
    partly = {"gmsh:physical": [np.array([0, 0]), np.array([3, 3])]}
    mesh = read_mesh(write(POINTS, blocks, cell_data=partly))
    assert only_warning(mesh) == "surface group 'physical_3': 1 of its 2 triangles are not on the boundary: left out"


def test_a_tet10_that_folds_over_itself_is_said(write):
    edges = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])
    points = np.vstack([POINTS[:4], POINTS[edges].mean(axis=1)])
    points[4] = [0.9, 0, 0]  # beyond three quarters of edge 01, where det J at corner 1 turns negative
    mesh = read_mesh(write(points, [("tetra10", np.arange(10)[None])]))
    assert "1 tet10 fold over themselves" in only_warning(mesh)
    points[4] = [0.7, 0, 0]
    assert read_mesh(write(points, [("tetra10", np.arange(10)[None])])).warnings == ()


def test_quality_is_one_for_a_regular_tet_and_falls_to_zero():
    height = np.array([1.0, 1e-2, 1e-6])
    nodes = np.array([[[1, 0, 0], [-0.5, 3**0.5 / 2, 0], [-0.5, -(3**0.5) / 2, 0], [0, 0, h * 2**0.5]] for h in height])
    qualities = quality(TetMesh(nodes.reshape(-1, 3), np.arange(12).reshape(3, 4)))
    assert qualities[0] == pytest.approx(1.0, abs=1e-15)
    assert 1e-2 < qualities[1] < 0.1 and qualities[2] < 2e-4


def test_the_summary_counts_what_is_there(write, grid):
    points, cells = grid(2)
    mesh = read_mesh(write(points, [("hexahedron", cells)], cell_data={"gmsh:physical": [np.repeat([0, 1], 4)]}))
    summary = summarize(mesh)
    assert (summary.nodes, summary.tets, summary.order, summary.components) == (27, 48, 1, 1)
    assert summary.groups == {"physical_1": 24} and summary.box.tolist() == [[0, 0, 0], [1, 1, 1]]
    assert summary.volume == pytest.approx(1.0, rel=1e-15)
    assert summary.quality_min == pytest.approx(12 * 0.5 ** (2 / 3) / 10)  # V = h^3/6; edges 3 h^2, 2 (2 h^2), 3 h^2
