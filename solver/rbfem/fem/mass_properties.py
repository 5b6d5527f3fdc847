"""Mass, centre of mass and inertia tensor of a tetrahedral mesh, and how wrong they can be.

The integrals are exact for what the mesh describes; what remains is rounding, which is predicted here, and the distance
between mesh and part, which only a second mesh or the exact shape can tell (`rbfem.fem.inertia_error`).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rbfem.errors import InputError
from rbfem.fem.density import Density, density_field
from rbfem.fem.moments import mesh_moments
from rbfem.fem.principal import principal_axes
from rbfem.fem.rounding import UNIT_ROUNDOFF, predicted_rounding
from rbfem.mesh.tet_mesh import TetMesh
from rbfem.motion import quaternion

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MassProperties:
    """What a rigid body needs to know of its shape.

    mass (kg), volume (m^3), center_of_mass (3,) m
    inertia           : (3, 3) kg m^2 about the centre of mass, I = ∫ ρ (|r|² E - r ⊗ r) dV, so that L = I ω
    principal_moments : (3,) kg m^2, ascending
    principal_axes    : (3, 3), columns are unit vectors, right-handed, see `rbfem.fem.principal`
    rounding_error    : predicted relative error of the tensor by rounding, the mesh's coordinates included
    """

    mass: float
    volume: float
    center_of_mass: Array
    inertia: Array
    principal_moments: Array
    principal_axes: Array
    rounding_error: float

    @property
    def principal_quaternion(self) -> Array:
        """(4,) unit quaternion that turns principal axes into the mesh's axes."""
        return quaternion.from_matrix(self.principal_axes)

    @property
    def radius_of_gyration(self) -> float:
        """√(tr I / 2m), metres: the rms distance of the mass from its centre."""
        return float(np.sqrt(np.trace(self.inertia) / (2.0 * self.mass)))

    def inertia_about(self, point: ArrayLike) -> Array:
        """Tensor (3, 3) about another point (m, mesh axes), by Steiner: I + m (|d|² E - d ⊗ d).

        >>> ball = from_tensor(2.0, 1.0, np.zeros(3), np.eye(3))
        >>> np.diag(ball.inertia_about([0, 0, 3]))
        array([19., 19.,  1.])
        """
        return self.inertia + self.mass * point_inertia(np.asarray(point, dtype=float) - self.center_of_mass)


def mass_properties(mesh: TetMesh, density: Density = 1.0, backend: str = "auto") -> MassProperties:
    """Integrate a density over a mesh.

    density : kg/m^3; a number, {group: number}, or an array of one value a tet or one a node (linear, and on a
              second-order tet quadratic, between its nodes)
    backend : "numpy", "serial" (compiled), or "auto": compiled where the tets are enough to pay for its start
    Raises InputError for a bad density and for a tensor that is not positive definite.

    >>> from rbfem.mesh.tet_mesh import TetMesh
    >>> corner = TetMesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]), np.array([[0, 1, 2, 3]]))
    >>> body = mass_properties(corner, 6.0)
    >>> float(body.mass), body.center_of_mass, np.diag(body.inertia).round(12)
    (1.0, array([0.25, 0.25, 0.25]), array([0.075, 0.075, 0.075]))
    """
    axes = np.ascontiguousarray(mesh.nodes.T)
    center = axes.mean(axis=1)
    field = density_field(mesh, density)
    moments = mesh_moments(mesh, field, center, backend)
    offset = moments.first / moments.mass
    about_center = np.trace(moments.second) * np.eye(3) - moments.second
    inertia = about_center - moments.mass * point_inertia(offset)
    box = np.array([axes.min(axis=1), axes.max(axis=1)])
    rounding = predicted_rounding(mesh, box, field, moments, center + offset, inertia)
    try:
        return from_tensor(moments.mass, moments.volume, center + offset, inertia, rounding)
    except InputError as error:
        raise InputError(f"{mesh.source}: {error}") from None


def from_tensor(
    mass: float, volume: float, center_of_mass: Array, inertia: Array, rounding_error: float = UNIT_ROUNDOFF
) -> MassProperties:
    """Mass properties from a tensor about the centre of mass. Raises InputError if no body can have it."""
    inertia = 0.5 * (inertia + inertia.T)
    if not np.isfinite(inertia).all():
        raise InputError("the inertia tensor is not finite; look for lengths or densities beyond any part's")
    moments, axes = principal_axes(inertia, tolerance=10.0 * rounding_error)
    if not moments[0] > 0.0 or not moments[0] + moments[1] > (1.0 - 1e-9) * moments[2]:
        raise InputError(
            f"the inertia tensor has principal moments {moments[0]:.6g}, {moments[1]:.6g}, {moments[2]:.6g} kg m^2; "
            "a body has three above zero, none larger than the sum of the others"
        )
    return MassProperties(mass, volume, center_of_mass, inertia, moments, axes, rounding_error)


def composed(parts: Iterable[MassProperties]) -> MassProperties:
    """Mass properties of parts welded together, each given in the same axes.

    >>> half = from_tensor(1.0, 1.0, np.array([0.0, 0, 1]), np.eye(3))
    >>> other = from_tensor(1.0, 1.0, np.array([0.0, 0, -1]), np.eye(3))
    >>> np.diag(composed([half, other]).inertia)
    array([4., 4., 2.])
    """
    parts = list(parts)
    mass = sum(part.mass for part in parts)
    center = np.sum([part.mass * part.center_of_mass for part in parts], axis=0) / mass
    inertia = np.sum([part.inertia_about(center) for part in parts], axis=0)
    rounding = max(part.rounding_error for part in parts) + UNIT_ROUNDOFF
    return from_tensor(mass, sum(part.volume for part in parts), center, inertia, rounding)


def particle_sum(masses: ArrayLike, positions: ArrayLike) -> MassProperties:
    """Mass properties of point masses: I = Σ m_i (|r_i|² E - r_i ⊗ r_i) about their centre of mass; volume zero.

    masses (n,) kg, positions (n, 3) m. The limit of ever finer particles is the integral; no mesh is needed.
    Points on a line have one moment of zero.

    >>> points = particle_sum([1, 1, 1, 1, 1, 1], np.vstack([np.eye(3), -np.eye(3)]))
    >>> np.diag(points.inertia)
    array([4., 4., 4.])
    """
    m, r = np.asarray(masses, dtype=float), np.asarray(positions, dtype=float)
    center = m @ r / m.sum()
    inertia = np.einsum("i,ijk->jk", m, point_inertia(r - center))
    rounding = float(np.sqrt(len(m)) * UNIT_ROUNDOFF)
    moments, axes = principal_axes(inertia, tolerance=10.0 * rounding)
    return MassProperties(float(m.sum()), 0.0, center, inertia, moments, axes, rounding)


def point_inertia(r: Array) -> Array:
    """|r|² E - r ⊗ r for vectors (…, 3): the tensor of a unit mass at r.

    >>> point_inertia(np.array([0.0, 0.0, 2.0]))[0, 0]
    np.float64(4.0)
    """
    square = np.einsum("...i,...i->...", r, r)
    return square[..., None, None] * np.eye(3) - r[..., :, None] * r[..., None, :]
