"""Volumes of straight and curved tetrahedra."""

import numpy as np
from numpy.typing import NDArray

from rbfem.mesh.shape_functions import EDGES, quadratic_gradients, tet_quadrature

DEGREE_OF_JACOBIAN = 3  # det J of a tet10 is a product of three linear functions

# The ten nodes: where a fold of a second-order tet shows first.
NODE_POINTS = np.vstack([np.eye(4), (np.eye(4)[EDGES[:, 0]] + np.eye(4)[EDGES[:, 1]]) / 2])

# A mid-node this far from the middle of its edge, as a share of the edge, is rounding and not curvature.
STRAIGHT = 1e-14
CHUNK = 50_000


def signed_volumes(nodes: NDArray, tets: NDArray) -> NDArray[np.float64]:
    """Volume of each tet, negative where it is inside out; of curved tet10 the integral of det J.

    V = (x1 - x0) × (x2 - x0) · (x3 - x0) / 6

    nodes : (n, 3)    tets : (k, 4) or (k, 10)    returns : (k,)

    >>> signed_volumes(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 3.0]]), np.array([[0, 1, 2, 3]]))
    array([0.5])
    """
    volumes = corner_volumes(nodes, tets)
    points, weights = tet_quadrature(DEGREE_OF_JACOBIAN)
    for rows in in_chunks(curved(nodes, tets)):
        volumes[rows] = jacobian_determinants(nodes[tets[rows]], points) @ weights
    return volumes


def corner_volumes(nodes: NDArray, tets: NDArray) -> NDArray[np.float64]:
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = edges_from_first(nodes, tets)
    return ((ay * bz - az * by) * cx + (az * bx - ax * bz) * cy + (ax * by - ay * bx) * cz) / 6.0


def edges_from_first(nodes: NDArray, tets: NDArray) -> list[list[NDArray]]:
    """x, y, z of corners 1, 2, 3 seen from corner 0; one array each, for NumPy is fastest on those."""
    axes = [np.ascontiguousarray(axis) for axis in nodes.T]
    corners = [np.ascontiguousarray(corner) for corner in tets[:, :4].T]
    return [[x[corner] - x[corners[0]] for x in axes] for corner in corners[1:]]


def folded(nodes: NDArray, tets: NDArray) -> NDArray[np.int64]:
    """Indices of tet10 whose det J is not positive at one of its nodes or integration points."""
    rows = curved(nodes, tets)
    points = np.vstack([NODE_POINTS, tet_quadrature(DEGREE_OF_JACOBIAN)[0]])
    smallest = [jacobian_determinants(nodes[tets[part]], points).min(axis=1) for part in in_chunks(rows)]
    return rows[np.concatenate([np.zeros(0), *smallest]) <= 0.0]


def curved(nodes: NDArray, tets: NDArray) -> NDArray[np.int64]:
    """Indices of the tet10 with a mid-node off the middle of its edge."""
    if tets.shape[1] == 4:
        return np.zeros(0, dtype=np.int64)
    offset = np.zeros(len(tets))
    digits = 2.0 * np.spacing(np.abs(nodes).max())
    for edge, (start, end) in enumerate(EDGES):
        x, y = nodes[tets[:, start]], nodes[tets[:, end]]
        bend = np.abs(nodes[tets[:, 4 + edge]] - (x + y) / 2).max(axis=1)
        offset = np.maximum(offset, bend - np.maximum(digits, STRAIGHT * np.abs(y - x).max(axis=1)))
    return np.flatnonzero(offset > 0.0)


def in_chunks(rows: NDArray) -> list[NDArray]:
    """Ten nodes at fifteen points make large temporaries: taken a part at a time."""
    return [rows[start : start + CHUNK] for start in range(0, len(rows), CHUNK)]


def jacobian_determinants(corners: NDArray, points: NDArray) -> NDArray[np.float64]:
    """det J of tet10 at barycentric points.

    corners : (k, 10, 3)    points : (q, 4)    returns : (k, q)
    """
    jacobian = np.einsum("qad,kai->kqdi", quadratic_gradients(points), corners, optimize=True)
    return np.linalg.det(jacobian)
