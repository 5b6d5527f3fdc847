"""A body whose tensor is known in closed form, as tets or as a surface, of any number of cells.

The block x = A u, u in the unit cube about the origin, has ∫ x xᵀ dV = |det A| A Aᵀ / 12. A turns and shears the cube,
so that no coordinate is a round number and no face lies along an axis.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rbfem.mesh.tet_mesh import TetMesh

Array = NDArray[np.float64]

A = np.array([[1.0, 0.2, 0.1], [-0.3, 1.2, 0.2], [0.1, -0.1, 0.7]])

# Six tets of a cell around its diagonal 0-7; corner 4 i + 2 j + k of the cell is at (i, j, k).
TETS_OF_A_CELL = np.array([[0, 7, 3, 1], [0, 7, 2, 3], [0, 7, 6, 2], [0, 7, 4, 6], [0, 7, 5, 4], [0, 7, 1, 5]])


@dataclass(frozen=True)
class Surface:
    """points (p, 3) m; triangles (t, 3) with normals outward; every point once, so that the surface is closed."""

    points: Array
    triangles: NDArray[np.int64]


def exact_tensor(density: float) -> Array:
    """(3, 3) kg m^2 about the centre: I = tr(C) E - C, C = ρ |det A| A Aᵀ / 12."""
    second = density * abs(np.linalg.det(A)) * (A @ A.T) / 12.0
    return np.trace(second) * np.eye(3) - second


def block_of_tets(cells: tuple[int, int, int], shift: float = 0.0) -> TetMesh:
    """6 · cells tets; the centre lies at (shift, shift, shift)."""
    points = tuple(n + 1 for n in cells)
    first = np.ravel_multi_index(np.indices(cells), points).ravel()
    corner = np.ravel_multi_index(np.indices((2, 2, 2)).reshape(3, -1), points)
    axes = [np.linspace(-0.5, 0.5, n) for n in points]
    unit = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return TetMesh(unit @ A.T + shift, (first[:, None, None] + corner[TETS_OF_A_CELL]).reshape(-1, 4))


def block_surface(per_edge: int, shift: float = 0.0) -> Surface:
    """12 · per_edge² triangles; the centre lies at (shift, shift, shift)."""
    lattice, triangles = [], []
    i, j = np.indices((per_edge + 1, per_edge + 1)).reshape(2, -1)
    first = np.ravel_multi_index(np.indices((per_edge, per_edge)), (per_edge + 1, per_edge + 1)).ravel()
    halves = np.array([[0, per_edge + 1, per_edge + 2], [0, per_edge + 2, 1]])
    for face in range(6):
        axis, is_far = divmod(face, 2)
        side = np.empty((len(i), 3), dtype=np.int64)
        side[:, axis], side[:, (axis + 1) % 3], side[:, (axis + 2) % 3] = is_far * per_edge, i, j
        order = [0, 1, 2] if is_far else [0, 2, 1]
        triangles.append((first[:, None, None] + halves[:, order]).reshape(-1, 3) + face * len(i))
        lattice.append(side)
    keys = np.ravel_multi_index(np.concatenate(lattice).T, (per_edge + 1,) * 3)
    used, where = np.unique(keys, return_inverse=True)
    unit = np.stack(np.unravel_index(used, (per_edge + 1,) * 3), axis=1) / per_edge - 0.5
    return Surface(unit @ A.T + shift, where[np.concatenate(triangles)])


def cells_for(n_tets: float) -> tuple[int, int, int]:
    """A cube of cells with about that many tets."""
    edge = max(1, round((n_tets / 6.0) ** (1.0 / 3.0)))
    return (edge, edge, edge)
