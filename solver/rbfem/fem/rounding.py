"""How many digits of an inertia tensor are lost to rounding: predicted from the mesh, not measured."""

import numpy as np
from numpy.typing import NDArray

from rbfem.fem.density import DensityField
from rbfem.fem.moments import Moments
from rbfem.mesh.tet_mesh import TetMesh
from rbfem.motion.rotation import cross

Array = NDArray[np.float64]

UNIT_ROUNDOFF = 2.0**-53
# Rounding of the sums in units of roundoff: a floor for the sums and the shift to the centre of mass, and how many
# roundings a tet's determinant collects. Calibrated in tests/fem/test_inertia_rounding.py, where the prediction must
# lie above the measured error and within 100 times it.
ROUNDING_FLOOR, ROUNDINGS_OF_A_TET = 4.0, 4.0
# A sweep over the faces costs as much as the tensor itself. A larger mesh that lies around its origin is spared it and
# taken for a solid block, of width √12 k along an axis of gyration radius k, whose two faces move by a rounding.
TETS_TO_SHAKE = 20_000
CHUNK = 65_536  # tets at a time, so that the sweep needs little memory beside the mesh


def predicted_rounding(
    mesh: TetMesh, box: Array, density: DensityField, moments: Moments, center: Array, inertia: Array
) -> float:
    """Relative error (Frobenius) of a tensor: rounding of the sums, and of the coordinates as the mesh holds them.

    box : (2, 3) m, smallest and largest coordinates    center : (3,) m, centre of mass    inertia : (3, 3) about it
    returns : 1 where the moments leave no digit.
    """
    if not np.isfinite(inertia).all():
        return 1.0
    offset = moments.first / moments.mass
    inside = moments.second / moments.mass - np.outer(offset, offset)
    mean_squares = np.linalg.eigvalsh(inside)
    if not mean_squares[0] > 0.0:
        return 1.0
    determinants = np.sqrt(moments.determinant_scale) / moments.mass
    summed = UNIT_ROUNDOFF * (ROUNDING_FLOOR + ROUNDINGS_OF_A_TET * determinants)
    largest = np.abs(box).max()
    if mesh.n_tets > TETS_TO_SHAKE and largest <= np.ptp(box, axis=0).max():
        return float(summed + UNIT_ROUNDOFF * largest * np.sum(1.0 / np.sqrt(mean_squares)))
    return float(summed + _shaken(mesh, density, center, inertia))


def _shaken(mesh: TetMesh, density: DensityField, center: Array, inertia: Array) -> float:
    """Relative change of the tensor when each coordinate is off by half its last digit, all in the worst direction.

    A node i that moves by δ adds the mass g_i · δ at its place, g_i = Σ ρ ∂V/∂x_i over its tets, which is zero inside a
    uniform part; a point's tensor has the norm √2 |r|². So thin walls far from the origin are seen for what they are.
    A bound where the nodes of a face round alike; independent roundings stay below it by the root of their number.
    """
    slopes = _mass_slopes(mesh, density.of_tets(mesh))
    half_digits = 0.5 * np.spacing(np.abs(mesh.nodes).max(axis=0))
    gained = np.abs(slopes) @ half_digits
    square = ((mesh.nodes - center) ** 2).sum(axis=1)
    return float(np.sqrt(2.0) * (gained @ square) / np.linalg.norm(inertia))


def _mass_slopes(mesh: TetMesh, density: Array) -> Array:
    """∂m/∂x_i (n_nodes, 3) of straight tets: the area vectors of the faces across from each corner, times ρ/6."""
    axes = np.ascontiguousarray(mesh.nodes.T)
    total = np.zeros((3, mesh.n_nodes))
    for start in range(0, mesh.n_tets, CHUNK):
        corners = np.ascontiguousarray(mesh.tets[start : start + CHUNK, :4].T)
        sixth = density[start : start + CHUNK] / 6.0
        for corner, slope in zip(corners, _volume_slopes(*(axis[corners] for axis in axes)), strict=True):
            for axis in range(3):
                total[axis] += np.bincount(corner, sixth * slope[axis], mesh.n_nodes)
    return total.T


def _volume_slopes(x: Array, y: Array, z: Array) -> list[tuple[Array, ...]]:
    """6 ∂V/∂x_i for the four corners of tets, coordinates (4, k): three components (k,) each."""
    (ux, vx, wx), (uy, vy, wy), (uz, vz, wz) = (axis[1:] - axis[0] for axis in (x, y, z))
    slopes = [cross(vx, vy, vz, wx, wy, wz), cross(wx, wy, wz, ux, uy, uz), cross(ux, uy, uz, vx, vy, vz)]
    return [tuple(-(a + b + c) for a, b, c in zip(*slopes, strict=True)), *slopes]
