"""The boundary of a tet mesh: faces that one tet has to itself."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rbfem.mesh.shape_functions import triangle_quadratic, triangle_quadratic_gradients, triangle_quadrature
from rbfem.mesh.tet_mesh import TetMesh

# Faces of a positive tet with their normals outward; then the second-order nodes on the edges 01, 12, 20 of the face.
FACES = np.array([[0, 2, 1, 6, 5, 4], [0, 1, 3, 4, 8, 7], [1, 2, 3, 5, 9, 8], [0, 3, 2, 7, 9, 6]])

DEGREE_OF_FLUX = 4  # x · (x_ξ × x_η) of a six-node triangle


@dataclass(frozen=True)
class BoundaryFaces:
    """triangles : (k, 3) or (k, 6) node indices, normals out of the part, second-order nodes on the edges 01, 12, 20
    tets      : (k,) the tet each triangle belongs to
    """

    triangles: NDArray[np.int64]
    tets: NDArray[np.int64]


def boundary_faces(mesh: TetMesh) -> BoundaryFaces:
    """Faces that belong to exactly one tet, ordered by that tet.

    Not checked: that they close (`rbfem.mesh.check` does). A face shared by three or more tets is not among them.

    >>> nodes = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> boundary_faces(TetMesh(nodes, np.array([[0, 1, 2, 3]]))).triangles.tolist()
    [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    """
    return unshared_faces(mesh, face_sharers(mesh))


def unshared_faces(mesh: TetMesh, sharers: NDArray) -> BoundaryFaces:
    """`boundary_faces`, given how many tets share each face."""
    single = np.flatnonzero(sharers == 1)
    tets, faces = np.divmod(single, 4)
    width = 6 if mesh.is_second_order else 3
    return BoundaryFaces(mesh.tets[tets[:, None], FACES[faces, :width]], tets)


def boundary_triangles(mesh: TetMesh) -> NDArray[np.int64]:
    """Node indices of `boundary_faces`, (k, 3) or (k, 6), normals out of the part."""
    return boundary_faces(mesh).triangles


def face_sharers(mesh: TetMesh) -> NDArray[np.int64]:
    """How many tets share each face; face 4 t + f is face f of tet t. returns : (4 n_tets,)"""
    return occurrences(row_keys(mesh.tets[:, FACES[:, :3]].reshape(-1, 3), mesh.n_nodes))


def row_keys(rows: NDArray, n_nodes: int) -> NDArray[np.int64]:
    """One integer for each row of node indices, the same whatever the order in the row.

    rows : (k, 2) or (k, 3), each index below n_nodes    returns : (k,)
    """
    columns = sorted_columns([np.ascontiguousarray(column, dtype=np.int64) for column in rows.T])
    keys, bound = columns[0], n_nodes
    for column in columns[1:]:
        if bound * n_nodes >= 2**63:
            keys = np.unique(keys, return_inverse=True)[1]
            bound = len(keys)
        keys = keys * n_nodes + column
        bound *= n_nodes
    return keys


def sorted_columns(columns: list[NDArray]) -> list[NDArray]:
    """Two or three columns, each row in ascending order: five times as fast as np.sort along short rows."""
    low, high = np.minimum(columns[0], columns[1]), np.maximum(columns[0], columns[1])
    if len(columns) == 2:
        return [low, high]
    middle = np.maximum(low, np.minimum(high, columns[2]))
    return [np.minimum(low, columns[2]), middle, np.maximum(high, columns[2])]


def occurrences(keys: NDArray) -> NDArray[np.int64]:
    """How often each key occurs among all. keys : (k,)    returns : (k,)"""
    order = np.argsort(keys)
    ordered = keys[order]
    starts = np.flatnonzero(np.r_[True, ordered[1:] != ordered[:-1]]) if len(keys) else np.zeros(0, dtype=np.int64)
    lengths = np.diff(np.r_[starts, len(keys)])
    counts = np.empty(len(keys), dtype=np.int64)
    counts[order] = np.repeat(lengths, lengths)
    return counts


def enclosed_volume(nodes: NDArray, triangles: NDArray) -> float:
    """Volume inside a closed surface by the divergence theorem, V = ⅓ ∮ x · n dA, about the centre of its box.

    nodes : (n, 3)    triangles : (k, 3), or (k, 6) integrated with their curvature

    >>> nodes = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 3.0]])
    >>> round(enclosed_volume(nodes, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])), 15)
    0.5
    """
    used = nodes[triangles]
    used = used - (used.min(axis=(0, 1)) + used.max(axis=(0, 1))) / 2
    if triangles.shape[1] == 3:
        return float(np.einsum("ki,ki->", used[:, 0], np.cross(used[:, 1], used[:, 2]))) / 6.0
    points, weights = triangle_quadrature(DEGREE_OF_FLUX)
    at = np.einsum("qa,kai->kqi", triangle_quadratic(points), used, optimize=True)
    tangents = np.einsum("qad,kai->kqdi", triangle_quadratic_gradients(points), used, optimize=True)
    flux = np.einsum("kqi,kqi->q", at, np.cross(tangents[..., 0, :], tangents[..., 1, :]))
    return float(flux @ weights) / 3.0
