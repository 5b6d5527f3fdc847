"""The rigid constraint on a finite element mesh: six columns that leave six degrees of freedom.

The displacement field u = Σ N_i u_i is held to u_i = T(r_i) q, q = (translation, small rotation) about a point. What
the mesh does then follows from the finite element matrices alone: mass TᵀMT, load Tᵀf, and no stiffness at all.
"""

import numpy as np
from numpy.typing import NDArray

from rbfem.fem.density import Density, density_field
from rbfem.mesh.shape_functions import quadratic, quadratic_gradients, tet_quadrature
from rbfem.mesh.tet_mesh import TetMesh

Array = NDArray[np.float64]


def rigid_modes(nodes: Array, about: Array) -> Array:
    """T (3n, 6): the displacements of n nodes under unit translations and unit rotations about a point.

    Node by node T(r) = [E, -[r]×], so that u = t + θ × r with r = x - about (m). The rows are node by node, x, y, z.

    >>> rigid_modes(np.array([[0.0, 2.0, 0.0]]), np.zeros(3))[:, 5]
    array([-2.,  0.,  0.])
    """
    r = nodes - about
    modes = np.zeros((len(nodes), 3, 6))
    modes[:, :, :3] = np.eye(3)
    for axis in range(3):
        modes[:, :, 3 + axis] = np.cross(np.eye(3)[axis], r)
    return modes.reshape(-1, 6)


def consistent_mass(mesh: TetMesh, density: Density = 1.0):
    """M = ∫ ρ N_i N_j dV, a sparse (n, n) matrix of SciPy; each of the three directions has the same one.

    Exact: the straight first-order tet integrates to ρ V/20 (1 + δ_ij), everything else by quadrature.
    """
    from scipy.sparse import coo_array

    field = density_field(mesh, density)
    blocks = _first_order_blocks(mesh, field.values) if _is_simple(mesh, field.is_nodal) else _blocks(mesh, field)
    n = mesh.tets.shape[1]
    rows, columns = np.repeat(mesh.tets, n, axis=1).ravel(), np.tile(mesh.tets, (1, n)).ravel()
    return coo_array((blocks.ravel(), (rows, columns)), shape=(mesh.n_nodes, mesh.n_nodes)).tocsr()


def rigid_mass(mesh: TetMesh, density: Density, about: Array) -> Array:
    """TᵀMT (6, 6): mass, static moments and inertia about a point, from the finite element mass matrix.

    About the centre of mass it is block diagonal, m E and the inertia tensor.
    """
    modes = rigid_modes(mesh.nodes, about).reshape(-1, 18)
    weighted = (consistent_mass(mesh, density) @ modes).reshape(-1, 6)
    return modes.reshape(-1, 6).T @ weighted


def wrench(nodes: Array, forces: Array, about: Array) -> Array:
    """Tᵀf (6,): force (N) and torque (N m) about a point of nodal forces (n, 3), N.

    >>> wrench(np.array([[0.0, 2.0, 0.0]]), np.array([[1.0, 0.0, 0.0]]), np.zeros(3))
    array([ 1.,  0.,  0.,  0.,  0., -2.])
    """
    return rigid_modes(nodes, about).T @ np.asarray(forces, dtype=float).ravel()


def node_velocities(points: Array, center: Array, velocity: Array, angular_velocity: Array) -> Array:
    """v_i = v_cm + ω × (x_i - x_cm), (…, 3) m/s, all in the same axes.

    >>> node_velocities(np.array([[1.0, 0.0, 0.0]]), np.zeros(3), np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, 2.0]))
    array([[0., 2., 1.]])
    """
    return velocity + np.cross(angular_velocity, points - center)


def _is_simple(mesh: TetMesh, is_nodal: bool) -> bool:
    return not mesh.is_second_order and not is_nodal


def _first_order_blocks(mesh: TetMesh, density: Array) -> Array:
    corners = mesh.nodes[mesh.tets]
    volume = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6.0
    return (density * volume)[:, None, None] * (np.ones((4, 4)) + np.eye(4)) / 20.0


def _blocks(mesh: TetMesh, field) -> Array:
    points, weights = tet_quadrature(9)
    values, gradients = quadratic(points), quadratic_gradients(points)
    if not mesh.is_second_order:
        values, gradients = points, np.broadcast_to(np.vstack([-np.ones(3), np.eye(3)]), (len(points), 4, 3))
    jacobian = np.einsum("kia,mic->mkac", gradients, mesh.nodes[mesh.tets], optimize=True)
    density = field.values[mesh.tets] @ values.T if field.is_nodal else field.values[:, None]
    return np.einsum("mk,ki,kj->mij", density * np.linalg.det(jacobian) * weights, values, values, optimize=True)
