"""What an STL file must be before it can be filled: closed, its shells in order."""

import math

import numpy as np
from numpy.typing import NDArray

from rbfem.errors import InputError
from rbfem.mesh.repair import smallest_of_component
from rbfem.mesh.surface import enclosed_volume, occurrences, row_keys

# Sharper edges of an STL become edges of the geometry: gmsh's own tutorial t13 takes 40°.
SHARP = math.radians(40)
SIDES = [[0, 1], [1, 2], [2, 0]]


def check_closed(points: NDArray, triangles: NDArray) -> None:
    edges = triangles[:, SIDES].reshape(-1, 2)
    sharers = occurrences(row_keys(edges, len(points)))
    count = round(float((1.0 / sharers[sharers != 2]).sum()))
    if count:
        raise InputError(
            f"the surface is not closed: {count} of its edges do not join exactly two triangles, so it has no inside; "
            "close the holes in the program that made it"
        )


def volumes_of_shells(points: NDArray, triangles: NDArray, shells: NDArray) -> list[list[int]]:
    """Which shells bound each volume, the outer one first: a shell whose normals point in is a cavity."""
    labels = np.unique(shells[triangles[:, 0]])
    signed = {int(s): enclosed_volume(points, triangles[shells[triangles[:, 0]] == s]) for s in labels}
    outer = [s for s, volume in signed.items() if volume > 0]
    if len(signed) == 1 or len(outer) == len(signed):
        return [[s] for s in signed]
    if len(outer) == 1:
        return [outer + [s for s in signed if s not in outer]]
    raise InputError(
        f"{len(signed)} closed surfaces, {len(outer)} of them with normals out of the solid: which is a hole in which "
        "cannot be told; save each solid in its own file"
    )


def has_only_discs(points: NDArray, triangles: NDArray) -> bool:
    """Whether the sharp edges cut a closed triangulation into pieces with one rim and no holes: V - E + F = 1 each."""
    patches = patches_between(points, triangles)
    return all(euler_characteristic(triangles[patches == patch], len(points)) == 1 for patch in np.unique(patches))


def patches_between(points: NDArray, triangles: NDArray) -> NDArray[np.int64]:
    """The piece of surface each triangle belongs to, sharp edges being the rims. returns : (n_triangles,) labels"""
    order = np.argsort(row_keys(triangles[:, SIDES].reshape(-1, 2), len(points)))
    neighbours = order.reshape(-1, 2) // 3  # each edge joins two triangles, and is listed twice in a row
    normals = np.cross(
        points[triangles[:, 1]] - points[triangles[:, 0]], points[triangles[:, 2]] - points[triangles[:, 0]]
    )
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(float).tiny)
    cosine = np.einsum("ki,ki->k", normals[neighbours[:, 0]], normals[neighbours[:, 1]])
    return smallest_of_component(neighbours[cosine > math.cos(SHARP)], len(triangles))


def euler_characteristic(triangles: NDArray, n_points: int) -> int:
    """V - E + F: 2 for a sphere, 1 for a disc, 0 for a ring."""
    edges = np.unique(row_keys(triangles[:, SIDES].reshape(-1, 2), n_points))
    return len(np.unique(triangles)) - len(edges) + len(triangles)
