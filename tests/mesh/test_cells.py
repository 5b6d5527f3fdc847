import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rbfem.errors import InputError
from rbfem.mesh.cells import CELL_FACES, split
from rbfem.mesh.check import mesh_warnings, summarize
from rbfem.mesh.geometry import signed_volumes
from rbfem.mesh.mesh_file import CellBlock, MeshFile
from rbfem.mesh.read import read_mesh, tet_mesh
from rbfem.mesh.surface import boundary_faces

CUBE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1.0]])
PRISM = CUBE[[0, 1, 3, 4, 5, 7]]
PYRAMID = np.vstack([CUBE[:4], [0.5, 0.5, 1.0]])
SHAPES = {"hexahedron": (CUBE, 1.0, 6), "wedge": (PRISM, 0.5, 3), "pyramid": (PYRAMID, 1 / 3, 2)}


@pytest.mark.parametrize("shape", SHAPES)
@given(seed=st.integers(0, 10_000))
@settings(max_examples=30, deadline=None)
def test_every_numbering_gives_positive_tets_of_the_whole_volume(shape, seed):
    points, volume, n_tets = SHAPES[shape]
    place = np.random.default_rng(seed).permutation(len(points))
    nodes = np.empty_like(points)
    nodes[place] = points
    tets, parents = split(place[None, :], CELL_FACES[shape])
    volumes = signed_volumes(nodes, tets)
    assert len(tets) == n_tets and (parents == 0).all()
    assert (volumes > 0.01).all() and volumes.sum() == pytest.approx(volume, rel=1e-15)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=20, deadline=None)
def test_neighbours_cut_their_common_face_alike(seed):
    """Hexahedra, a wedge and a pyramid that share quadrilaterals, numbered at random: no warning, so closed."""
    points, blocks = stacked_cells()
    place = np.random.default_rng(seed).permutation(len(points))
    shuffled = np.empty_like(points)
    shuffled[place] = points
    file = MeshFile(shuffled, tuple(CellBlock(kind, place[cells]) for kind, cells in blocks))
    mesh = tet_mesh(file, "stack")
    assert mesh_warnings(mesh, "m") == ()
    assert summarize(mesh).volume == pytest.approx(2 + 0.5 + 1 / 3, rel=1e-14)


def stacked_cells():
    """Two cubes, on the upper one a wedge like a roof, beside the lower one a pyramid."""
    points = np.vstack([CUBE, CUBE[4:] + np.array([0, 0, 1]), [[0, 0.5, 3], [1, 0.5, 3]], [[2.0, 0.5, 0.5]]])
    hexahedra = np.array([[0, 1, 2, 3, 4, 5, 6, 7], [4, 5, 6, 7, 8, 9, 10, 11]])
    wedges = np.array([[8, 11, 12, 9, 10, 13]])
    pyramids = np.array([[1, 2, 6, 5, 14]])
    return points, [("hexahedron", hexahedra), ("wedge", wedges), ("pyramid", pyramids)]


def test_splitting_is_said_and_fields_and_groups_follow(write, grid):
    points, cells = grid(2)
    data = {"density": [np.arange(8.0)], "gmsh:physical": [np.repeat([1, 2], 4)]}
    mesh = read_mesh(write(points, [("hexahedron", cells)], cell_data=data))
    assert mesh.repairs == ("8 hexahedra (hexahedron) split into 48 tets",)
    assert mesh.cell_fields["density"].tolist() == np.repeat(np.arange(8.0), 6).tolist()
    assert mesh.groups["physical_2"].tolist() == list(range(24, 48))
    assert mesh.warnings == () and len(boundary_faces(mesh).tets) == 48


def test_hexahedra_that_share_no_nodes_are_still_cut_alike(write, grid):
    """A soup of cells, each with nodes of its own: merged before they are cut."""
    points, cells = grid(2)
    soup = points[cells].reshape(-1, 3)
    mesh = read_mesh(write(soup, [("hexahedron", np.arange(64).reshape(8, 8))]))
    assert mesh.repairs[0] == "37 nodes merged with another at the same place"
    assert mesh.n_nodes == 27 and mesh.warnings == ()


def test_a_quadrilateral_group_becomes_the_triangles_of_the_cut_faces(write, grid):
    points, cells = grid(2)
    floor = cells[np.isclose(points[cells][:, 0, 2], 0.0)][:, :4]
    tags = [np.zeros(8, dtype=int), np.full(4, 5)]
    blocks = [("hexahedron", cells), ("quad", floor)]
    mesh = read_mesh(write(points, blocks, cell_data={"gmsh:physical": tags}))
    assert len(mesh.surfaces["physical_5"]) == 8
    assert (mesh.nodes[mesh.surfaces["physical_5"]][:, :, 2] == 0.0).all()
    assert mesh.warnings == ()


def test_second_order_hexahedra_are_taken_by_their_corners(write):
    pairs = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    middles = np.array([(CUBE[i] + CUBE[j]) / 2 for i, j in pairs])
    mesh = read_mesh(write(np.vstack([CUBE, middles]), [("hexahedron20", np.arange(20)[None])]))
    assert "taken by their corners" in mesh.repairs[0]
    assert mesh.n_nodes == 8 and summarize(mesh).volume == pytest.approx(1.0)


def test_a_wedge_of_vtk_comes_in_right(write):
    mesh = read_mesh(write(PRISM, [("wedge", np.arange(6)[None])], name="part.vtk"))
    assert summarize(mesh).volume == pytest.approx(0.5) and "1 wedges (wedge) split into 3 tets" in mesh.repairs


def test_tet4_beside_tet10_shares_its_mid_nodes(write, corner_tet):
    points, _ = corner_tet
    points = np.vstack([points, [[1, 1, 1]]])
    edges = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]
    middles = np.array([(points[i] + points[j]) / 2 for i, j in edges])
    cells = [("tetra10", np.array([[0, 1, 2, 3, 5, 6, 7, 8, 9, 10]])), ("tetra", np.array([[1, 2, 3, 4]]))]
    mesh = read_mesh(write(np.vstack([points, middles]), cells, point_data={"x": np.r_[points, middles][:, 0]}))
    assert mesh.tets.shape == (2, 10) and mesh.n_nodes == 14  # 5 corners, 9 edges
    assert "1 tet4 among tet10 raised to tet10" in mesh.repairs[0]
    assert mesh.point_fields["x"] == pytest.approx(mesh.nodes[:, 0])
    assert summarize(mesh).volume == pytest.approx(1 / 6 + 1 / 3) and mesh.warnings == ()


def test_cells_of_a_kind_without_tets_are_refused(write, corner_tet):
    points, _ = corner_tet
    path = write(np.vstack([points] * 5), [("tetra20", np.arange(20)[None])], name="part.msh")
    with pytest.raises(InputError, match="cells of kind 'tetra20' cannot be read; expected tetra, tetra10"):
        read_mesh(path)
