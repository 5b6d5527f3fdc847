"""Sums of tet moments over a mesh: in NumPy, chunk by chunk, or in a compiled loop; one text of the physics."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rbfem.compute.loops import clear_of_numba, loop, parallel_range
from rbfem.fem.density import DensityField
from rbfem.fem.tet_moments import tet_moments, tet_volume, total, weighted_first_moment, weighted_second_moment
from rbfem.mesh.geometry import curved
from rbfem.mesh.shape_functions import quadratic, quadratic_gradients, tet_quadrature
from rbfem.mesh.tet_mesh import TetMesh

Array = NDArray[np.float64]

CHUNK = 8192  # tets whose temporaries stay in the second-level cache
CURVED_CHUNK = 256
BLOCK = 512  # tets summed one after the other in the compiled loop, so that rounding does not grow with the mesh
# Tets from which the compiled loop is quicker in all: from a cold start of numba, and with numba already at work.
TETS_TO_START_NUMBA, TETS_WITH_NUMBA = 5_000_000, 200_000
# Degree of the integrand on a curved tet: Jacobian 3, two coordinates 2 + 2, and a nodal density 2 more.
DEGREE_CURVED, DEGREE_CURVED_NODAL = 7, 9

# Columns of a row of sums.
MASS, VOLUME, SCALE, FIRST, SECOND, WIDTH = 0, 1, 2, 3, 6, 12


@dataclass(frozen=True)
class Moments:
    """∫ρ, ∫1, ∫ρ r, ∫ρ r⊗r about a point, and Σ ρ² (|u||v||w|/6)² over the edges of each tet, the scale of rounding."""

    mass: float
    volume: float
    first: Array
    second: Array
    determinant_scale: float


def mesh_moments(mesh: TetMesh, density: DensityField, center: Array, backend: str = "auto") -> Moments:
    """Moments of a mesh about `center` (3,), coordinates taken relative to it before anything else is done."""
    nodes = mesh.nodes - center
    is_curved = _needs_quadrature(mesh, density)
    rows = []
    if not is_curved.all():
        rows.append(_straight_sums(nodes, mesh.tets, density, ~is_curved, backend))
    if is_curved.any():
        by_tet = density.of_tets(mesh)[is_curved]
        rows.append(_curved_sums(nodes, mesh.tets[is_curved], density, by_tet))
    sums = np.ascontiguousarray(np.vstack(rows).T).sum(axis=1)  # by pairs, so that rounding does not grow
    xx, yy, zz, xy, xz, yz = sums[SECOND:]
    second = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return Moments(float(sums[MASS]), float(sums[VOLUME]), sums[FIRST:SECOND], second, float(sums[SCALE]))


def sum_blocks(nodes, tets, density, block, sums):
    """Sums (n_blocks, 12) of the moments of `block` straight tets each, with one density a tet, or (1,) for all."""
    each = 0 if len(density) == 1 else 1
    for i in parallel_range(len(sums)):
        m, v, s, x, y, z = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        xx, yy, zz, xy, xz, yz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for t in range(i * block, min((i + 1) * block, len(tets))):
            a, b, c, d = tets[t, 0], tets[t, 1], tets[t, 2], tets[t, 3]
            ax, ay, az = nodes[a, 0], nodes[a, 1], nodes[a, 2]
            bx, by, bz = nodes[b, 0], nodes[b, 1], nodes[b, 2]
            cx, cy, cz = nodes[c, 0], nodes[c, 1], nodes[c, 2]
            dx, dy, dz = nodes[d, 0], nodes[d, 1], nodes[d, 2]
            volume, scale = tet_volume(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz)
            rho = density[each * t]
            mass = rho * volume
            p = tet_moments(mass, ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz)
            m, v, s = m + mass, v + volume, s + rho * rho * scale
            x, y, z = x + p[0], y + p[1], z + p[2]
            xx, yy, zz = xx + p[3], yy + p[4], zz + p[5]
            xy, xz, yz = xy + p[6], xz + p[7], yz + p[8]
        sums[i, 0], sums[i, 1], sums[i, 2], sums[i, 3], sums[i, 4], sums[i, 5] = m, v, s, x, y, z
        sums[i, 6], sums[i, 7], sums[i, 8], sums[i, 9], sums[i, 10], sums[i, 11] = xx, yy, zz, xy, xz, yz


def _straight_sums(nodes: Array, tets: NDArray, density: DensityField, chosen: NDArray, backend: str) -> Array:
    values = density.values
    if not chosen.all():
        tets = tets[chosen]
        values = values if len(values) == 1 else values[chosen]  # no straight tet10 has a nodal density
    if backend == "auto":
        enough = len(tets) >= (TETS_TO_START_NUMBA if clear_of_numba() else TETS_WITH_NUMBA)
        backend = "serial" if enough and not density.is_nodal else "numpy"
    if backend == "numpy" or density.is_nodal:
        axes = np.ascontiguousarray(nodes.T)
        return np.array([_chunk_sums(axes, tets, values, density.is_nodal, i) for i in range(0, len(tets), CHUNK)])
    sums = np.zeros((-(-len(tets) // BLOCK), WIDTH))
    loop(sum_blocks, backend, reorders_sums=True)(nodes, tets, values, BLOCK, sums)
    return sums


def _chunk_sums(axes: Array, tets: NDArray, values: Array, is_nodal: bool, start: int) -> list[float]:
    corners = np.ascontiguousarray(tets[start : start + CHUNK, :4].T)
    x, y, z = axes[0][corners], axes[1][corners], axes[2][corners]
    components = [axis[i] for i in range(4) for axis in (x, y, z)]
    volume, scale = tet_volume(*components)
    if is_nodal:
        corner_density = values[corners]
        density = 0.25 * total(corner_density)
        mass = volume * density
        first = [weighted_first_moment(volume, corner_density, a) for a in (x, y, z)]
        pairs = ((x, x), (y, y), (z, z), (x, y), (x, z), (y, z))
        rest = first + [weighted_second_moment(volume, corner_density, a, b) for a, b in pairs]
    else:
        density = values if len(values) == 1 else values[start : start + CHUNK]
        mass = volume * density
        rest = list(tet_moments(mass, *components))
    return [float(np.sum(column)) for column in (mass, volume, density * density * scale, *rest)]


def _needs_quadrature(mesh: TetMesh, density: DensityField) -> NDArray[np.bool_]:
    """(n_tets,) curved tets, and all second-order ones where the density is quadratic inside."""
    if mesh.is_second_order and density.is_nodal:
        return np.ones(mesh.n_tets, dtype=bool)
    chosen = np.zeros(mesh.n_tets, dtype=bool)
    chosen[curved(mesh.nodes, mesh.tets)] = True
    return chosen


def _curved_sums(nodes: Array, tets: NDArray, density: DensityField, by_tet: Array) -> Array:
    degree = DEGREE_CURVED_NODAL if density.is_nodal else DEGREE_CURVED
    points, weights = tet_quadrature(degree)
    values, gradients = quadratic(points), quadratic_gradients(points)
    rows = []
    for start in range(0, len(tets), CURVED_CHUNK):
        chunk = tets[start : start + CURVED_CHUNK]
        corners = nodes[chunk]  # (m, 10, 3)
        position = np.einsum("ki,mic->mkc", values, corners, optimize=True)
        jacobian = np.einsum("kia,mic->mkac", gradients, corners, optimize=True)
        volume = np.linalg.det(jacobian) * weights
        rho = density.values[chunk] @ values.T if density.is_nodal else by_tet[start : start + CURVED_CHUNK, None]
        rows.append(_quadrature_sums(position, volume, rho * volume))
    return np.array(rows)


def _quadrature_sums(position: Array, volume: Array, mass: Array) -> Array:
    first = np.einsum("mk,mkc->c", mass, position)
    second = np.einsum("mk,mka,mkb->ab", mass, position, position, optimize=True)
    upper = second[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    return np.concatenate([[mass.sum(), volume.sum(), (mass.sum(axis=1) ** 2).sum()], first, upper])
