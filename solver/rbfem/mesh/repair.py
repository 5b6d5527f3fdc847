"""Repairs of a tet mesh. Each takes a mesh and returns one; what was done is said in `repairs`."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rbfem.mesh.geometry import EDGES, signed_volumes
from rbfem.mesh.tet_mesh import TetMesh

# Nodes closer than this share of the box are the same node: far above rounding, far below any element.
SAME_PLACE = 1e-12

# Swapping corners 1 and 2 turns a tet inside out; its edges 01 and 02, 13 and 23 change places.
MIRRORED = np.array([0, 2, 1, 3, 6, 5, 4, 7, 9, 8])

# A direction no mesh generator aligns its nodes with, so that few nodes share a projection.
ODD_DIRECTION = np.array([0.5257311121191336, 0.6180339887498949, 0.5844157192458461])


def repaired(mesh: TetMesh) -> TetMesh:
    """Tets all of positive volume and each once; nothing else changed."""
    volumes = signed_volumes(mesh.nodes, mesh.tets)
    flat = is_flat(mesh, volumes)
    mesh = keep_tets(mesh, ~flat, "tets of zero volume dropped")
    mesh = flip(mesh, volumes[~flat] < 0.0)
    return keep_tets(mesh, first_of_each(mesh.tets[:, :4]), "duplicate tets dropped")


def is_flat(mesh: TetMesh, volumes: NDArray) -> NDArray[np.bool_]:
    """Whether rounding of the coordinates explains the volume: |V| <= 4 ε |x| l², l the longest edge. (n_tets,)"""
    nodes = mesh.nodes[used_nodes(mesh)]
    rounding = 4.0 * np.finfo(float).eps * np.abs(nodes).max()
    diagonal = np.linalg.norm(np.ptp(nodes, axis=0))
    suspects = np.flatnonzero(np.abs(volumes) <= rounding * diagonal**2)
    tets = mesh.tets[suspects]
    edges = mesh.nodes[tets[:, EDGES[:, 1]]] - mesh.nodes[tets[:, EDGES[:, 0]]]
    longest = np.einsum("nei,nei->ne", edges, edges).max(axis=1)
    flat = np.zeros(mesh.n_tets, dtype=bool)
    flat[suspects] = np.abs(volumes[suspects]) <= rounding * longest
    return flat


def keep_tets(mesh: TetMesh, keep: NDArray, words: str) -> TetMesh:
    """The mesh with the tets where `keep` is false left out of its tets, groups and cell fields."""
    dropped = int(len(keep) - keep.sum())
    if not dropped:
        return mesh
    place = np.cumsum(keep) - 1
    groups = {name: place[tets[keep[tets]]] for name, tets in mesh.groups.items()}
    return replace(
        mesh,
        tets=mesh.tets[keep],
        groups={name: tets for name, tets in groups.items() if len(tets)},
        cell_fields={name: values[keep] for name, values in mesh.cell_fields.items()},
        repairs=(*mesh.repairs, f"{dropped} {words}"),
    )


def flip(mesh: TetMesh, inverted: NDArray) -> TetMesh:
    """The mesh with the tets where `inverted` is true turned outside out, second-order nodes included."""
    count = int(inverted.sum())
    if not count:
        return mesh
    tets = mesh.tets.copy()
    tets[inverted] = tets[inverted][:, MIRRORED[: tets.shape[1]]]
    return replace(mesh, tets=tets, repairs=(*mesh.repairs, f"{count} of {mesh.n_tets} tets were inside out: flipped"))


def first_of_each(tets: NDArray) -> NDArray[np.bool_]:
    """True where no earlier tet has the same four corners. tets : (k, 4)    returns : (k,)"""
    corners = np.sort(tets, axis=1)
    order = np.lexsort(corners.T)
    same = (np.diff(corners[order], axis=0) == 0).all(axis=1)
    is_first = np.ones(len(tets), dtype=bool)
    is_first[order[1:][same]] = False
    return is_first


def coincident_nodes(points: NDArray) -> NDArray[np.int64]:
    """For each point the first point at the same place, exactly or within 1e-12 of the box. points : (n, 3), finite

    >>> coincident_nodes(np.array([[0, 0, 0], [1, 0, 0], [0, 0, 0], [1, 0, 1e-14]])).tolist()
    [0, 1, 0, 1]
    """
    centered = points - points.min(axis=0)
    exact = first_equal(centered)
    distinct = np.flatnonzero(exact == np.arange(len(exact)))
    near = np.arange(len(points))
    near[distinct] = distinct[first_near(centered[distinct], SAME_PLACE * np.linalg.norm(np.ptp(points, axis=0)))]
    return near[exact]


def first_equal(points: NDArray) -> NDArray[np.int64]:
    order = np.lexsort(points.T)  # stable, so that the first of a run has the smallest index
    starts = np.r_[True, (np.diff(points[order], axis=0) != 0).any(axis=1)]
    first = np.empty(len(points), dtype=np.int64)
    first[order] = order[starts][np.cumsum(starts) - 1]
    return first


def first_near(points: NDArray, distance: float | np.floating) -> NDArray[np.int64]:
    """For each point the first of the chain of points that lie within `distance` of each other.

    Points are sorted along an odd direction: near points are then near in that order too.
    """
    along = points @ ODD_DIRECTION
    order = np.argsort(along)
    pairs = []
    for lag in range(1, len(points)):
        close = np.flatnonzero(along[order[lag:]] - along[order[:-lag]] <= distance)
        if not len(close):
            break
        one, other = order[close], order[close + lag]
        near = np.linalg.norm(points[one] - points[other], axis=1) <= distance
        pairs.append(np.column_stack([one[near], other[near]]))
    return smallest_of_component(np.concatenate([np.zeros((0, 2), dtype=np.int64), *pairs]), len(points))


def smallest_of_component(cells: NDArray, n_nodes: int) -> NDArray[np.int64]:
    """For each node the smallest node it is connected to, through cells that share nodes.

    cells : (k, m) node indices    returns : (n_nodes,)
    """
    label = np.arange(n_nodes)
    while True:
        smallest = label[cells].min(axis=1) if len(cells) else label[:0]
        lower = label.copy()
        for column in cells.T:
            np.minimum.at(lower, column, smallest)
            np.minimum.at(lower, label[column], smallest)  # hook the whole tree, not the leaf alone
        lower = lower[lower]
        if np.array_equal(lower, label):
            return label
        label = lower


def used_nodes(mesh: TetMesh) -> NDArray[np.bool_]:
    """Whether a tet has the node. returns : (n_nodes,)"""
    used = np.zeros(mesh.n_nodes, dtype=bool)
    used[mesh.tets] = True
    return used


def without_unused_nodes(mesh: TetMesh) -> TetMesh:
    """The mesh without the nodes no tet has, everything renumbered."""
    used = used_nodes(mesh)
    if used.all():
        return mesh
    place = np.cumsum(used) - 1
    return replace(
        mesh,
        nodes=mesh.nodes[used],
        tets=place[mesh.tets],
        surfaces={name: place[triangles] for name, triangles in mesh.surfaces.items()},
        point_fields={name: values[used] for name, values in mesh.point_fields.items()},
        repairs=(*mesh.repairs, f"{int((~used).sum())} nodes that no tet has dropped"),
    )
