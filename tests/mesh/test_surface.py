import numpy as np
import pytest

from rbfem.mesh.geometry import signed_volumes
from rbfem.mesh.read import read_mesh
from rbfem.mesh.surface import boundary_faces, boundary_triangles, enclosed_volume, row_keys


def test_faces_point_out_and_belong_to_their_tets(write, grid):
    points, cells = grid(3)
    mesh = read_mesh(write(points, [("hexahedron", cells)]))
    faces = boundary_faces(mesh)
    assert len(faces.triangles) == 6 * 9 * 2
    corners = mesh.nodes[faces.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inside = mesh.nodes[mesh.tets[faces.tets]].mean(axis=1)
    assert (np.einsum("ki,ki->k", normals, corners[:, 0] - inside) > 0).all()
    assert all(set(triangle) <= set(mesh.tets[tet]) for triangle, tet in zip(faces.triangles, faces.tets, strict=True))
    assert normals.sum(axis=0) == pytest.approx([0, 0, 0], abs=1e-15)


@pytest.mark.parametrize("bend", [0.0, 0.15])
def test_a_curved_boundary_encloses_what_the_tet_holds(write, bend):
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    edges = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])
    middles = corners[edges].mean(axis=1) + bend * np.random.default_rng(1).uniform(-1, 1, (6, 3))
    mesh = read_mesh(write(np.vstack([corners, middles]), [("tetra10", np.arange(10)[None])]))
    assert boundary_triangles(mesh).shape == (4, 6)
    volume = signed_volumes(mesh.nodes, mesh.tets).sum()
    assert enclosed_volume(mesh.nodes, boundary_triangles(mesh)) == pytest.approx(volume, rel=1e-13)
    assert (volume == pytest.approx(1 / 6, rel=1e-14)) == (bend == 0.0)


@pytest.mark.parametrize("n_nodes", [10, 2_000_000, 4_000_000_000])
def test_keys_tell_rows_apart_however_many_nodes_there_are(n_nodes):
    rows = n_nodes - 1 - np.array([[0, 1, 2], [2, 0, 1], [0, 1, 3], [1, 2, 3], [3, 1, 0]])
    keys = row_keys(rows, n_nodes)
    assert keys[0] == keys[1] and keys[2] == keys[4] and len(set(keys.tolist())) == 3
