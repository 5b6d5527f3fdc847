"""Pressure and traction on a named surface group, as consistent nodal forces; the rigid constraint sums them up."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rbfem.errors import InputError
from rbfem.fem.rigid_constraint import wrench
from rbfem.mesh.shape_functions import triangle_quadratic, triangle_quadratic_gradients, triangle_quadrature
from rbfem.mesh.tet_mesh import TetMesh

Array = NDArray[np.float64]


def surface_triangles(mesh: TetMesh, group: str) -> NDArray[np.int64]:
    """The triangles of a surface group. Raises InputError if the mesh has no such group, or an empty one."""
    if group not in mesh.surfaces:
        raise InputError(f"{mesh.source}: no surface group '{group}'; it has {', '.join(mesh.surfaces) or 'none'}")
    triangles = mesh.surfaces[group]
    if len(triangles) == 0:
        raise InputError(f"{mesh.source}: the surface group '{group}' is empty")
    return triangles


def pressure_forces(mesh: TetMesh, group: str, pressure: float) -> Array:
    """Nodal forces (n_nodes, 3), N, of a pressure (Pa, positive pushes inward): f_i = -∫ N_i p n dA."""
    triangles = surface_triangles(mesh, group)
    shape, normals = _shape_and_normals(mesh, triangles)
    return _gather(mesh, triangles, -pressure * np.einsum("ki,mkc->mic", shape, normals, optimize=True))


def traction_forces(mesh: TetMesh, group: str, traction: ArrayLike) -> Array:
    """Nodal forces (n_nodes, 3), N, of a traction (3,) Pa, constant in the mesh's axes: f_i = ∫ N_i t dA."""
    triangles = surface_triangles(mesh, group)
    shape, normals = _shape_and_normals(mesh, triangles)
    area = np.einsum("ki,mk->mi", shape, np.linalg.norm(normals, axis=-1), optimize=True)
    return _gather(mesh, triangles, area[..., None] * np.asarray(traction, dtype=float))


def pressure_wrench(mesh: TetMesh, group: str, pressure: float, about: Array) -> Array:
    """Force and torque (6,) about a point, mesh axes, of a pressure on a group."""
    return wrench(mesh.nodes, pressure_forces(mesh, group, pressure), about)


def traction_wrench(mesh: TetMesh, group: str, traction: ArrayLike, about: Array) -> Array:
    """Force and torque (6,) about a point, mesh axes, of a traction on a group."""
    return wrench(mesh.nodes, traction_forces(mesh, group, traction), about)


def _shape_and_normals(mesh: TetMesh, triangles: NDArray[np.int64]) -> tuple[Array, Array]:
    """Shape functions (k, 3 or 6) at the quadrature points, and weight × n dA there (m, k, 3).

    The integrand of a curved triangle is of degree 2 (shape function) + 2 (normal); of its area, not a polynomial.
    """
    is_second_order = triangles.shape[1] == 6
    points, weights = triangle_quadrature(8 if is_second_order else 1)
    shape = triangle_quadratic(points) if is_second_order else points
    gradients = triangle_quadratic_gradients(points) if is_second_order else np.array([[[-1, -1], [1, 0], [0, 1]]])
    tangents = np.einsum("kia,mic->mkac", gradients, mesh.nodes[triangles], optimize=True)
    return shape, np.cross(tangents[..., 0, :], tangents[..., 1, :]) * weights[:, None]


def _gather(mesh: TetMesh, triangles: NDArray[np.int64], forces: Array) -> Array:
    nodal = np.zeros((mesh.n_nodes, 3))
    np.add.at(nodal, triangles, forces)
    return nodal
