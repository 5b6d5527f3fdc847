"""What can be said of a mesh: its quality, its parts, and what may make an answer wrong."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rbfem.mesh.geometry import EDGES, corner_volumes, folded, signed_volumes
from rbfem.mesh.repair import smallest_of_component
from rbfem.mesh.surface import BoundaryFaces, enclosed_volume, face_sharers, occurrences, row_keys, unshared_faces
from rbfem.mesh.tet_mesh import TetMesh

# Parts drawn in millimetres and read as metres are larger than this; few real parts are.
LARGE_SIDE = 10.0

# Two ways to the volume differ by rounding only, about 1e-13 for a million tets, unless tets overlap.
SAME_VOLUME = 1e-9


@dataclass(frozen=True)
class MeshSummary:
    """What `rbfem inertia` prints of a mesh.

    order    : 1 for tet4, 2 for tet10
    groups   : name -> number of tets          surfaces : name -> number of triangles
    box      : (2, 3) smallest and largest coordinates of the nodes, m
    quality_min, quality_median : mean ratio, 0 (flat) to 1 (regular)
    volume   : m^3
    """

    nodes: int
    tets: int
    order: int
    components: int
    groups: Mapping[str, int]
    surfaces: Mapping[str, int]
    box: NDArray[np.float64]
    quality_min: float
    quality_median: float
    volume: float


def summarize(mesh: TetMesh) -> MeshSummary:
    """Counts, box, quality and volume of a mesh.

    >>> nodes = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 3.0]])
    >>> round(summarize(TetMesh(nodes, np.array([[0, 1, 2, 3]]))).volume, 15)
    0.5
    """
    qualities = quality(mesh)
    return MeshSummary(
        nodes=mesh.n_nodes,
        tets=mesh.n_tets,
        order=2 if mesh.is_second_order else 1,
        components=components(mesh),
        groups={name: len(tets) for name, tets in mesh.groups.items()},
        surfaces={name: len(triangles) for name, triangles in mesh.surfaces.items()},
        box=np.array([mesh.nodes.min(axis=0), mesh.nodes.max(axis=0)]),
        quality_min=float(qualities.min()),
        quality_median=float(np.median(qualities)),
        volume=float(signed_volumes(mesh.nodes, mesh.tets).sum()),
    )


def quality(mesh: TetMesh) -> NDArray[np.float64]:
    """Mean ratio of each tet by its corners: 1 for a regular tet, 0 for a flat one.

    q = 12 (3 V)^(2/3) / Σ l²  over the six edges

    returns : (n_tets,)
    Source: Liu and Joe, BIT Numerical Mathematics 34:268, 1994.

    >>> nodes = np.array([[0, 0, 0], [1, 1, 0], [1, 0, 1], [0, 1, 1.0]])
    >>> quality(TetMesh(nodes, np.array([[0, 2, 1, 3]]))).round(12)
    array([1.])
    """
    volumes = np.abs(corner_volumes(mesh.nodes, mesh.tets))
    squares = np.zeros(mesh.n_tets)
    for start, end in EDGES:
        edge = mesh.nodes[mesh.tets[:, end]] - mesh.nodes[mesh.tets[:, start]]
        squares += np.einsum("ni,ni->n", edge, edge)
    return 12.0 * np.cbrt(3.0 * volumes) ** 2 / squares


def components(mesh: TetMesh) -> int:
    """Number of pieces that share no node with each other."""
    smallest = smallest_of_component(mesh.tets[:, :4], mesh.n_nodes)
    is_first = np.zeros(mesh.n_nodes, dtype=bool)
    is_first[smallest[mesh.tets[:, 0]]] = True
    return int(is_first.sum())


def mesh_warnings(mesh: TetMesh, unit: str) -> tuple[str, ...]:
    """What may make an answer wrong, in words. `unit`: what the file was said to be drawn in.

    Not checked: pieces that share no node and stand in each other; tets that cut through others far away.
    """
    sharers = face_sharers(mesh)
    faces = unshared_faces(mesh, sharers)
    checks = (
        piece_warning(mesh),
        fold_warning(mesh),
        shared_face_warning(sharers),
        open_edge_warning(mesh, faces),
        overlap_warning(mesh, faces),
        size_warning(mesh, unit),
    )
    return tuple(warning for warning in checks if warning)


def piece_warning(mesh: TetMesh) -> str:
    count = components(mesh)
    return f"the mesh is {count} separate pieces, moved as one rigid body" if count > 1 else ""


def fold_warning(mesh: TetMesh) -> str:
    count = len(folded(mesh.nodes, mesh.tets))
    if not count:
        return ""
    return (
        f"{count} tet10 fold over themselves (det J is not positive everywhere): integrals over them are of the signed "
        "volume, fields inside them are not to be trusted; mesh finer where the surface is curved"
    )


def shared_face_warning(sharers: NDArray) -> str:
    count = round(float((1.0 / sharers[sharers > 2]).sum()))
    return f"{count} faces are shared by three or more tets: tets overlap there" if count else ""


def open_edge_warning(mesh: TetMesh, faces: BoundaryFaces) -> str:
    corners = faces.triangles[:, :3]
    edges = corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    sharers = occurrences(row_keys(edges, mesh.n_nodes))
    count = round(float((1.0 / sharers[sharers != 2]).sum()))
    if not count:
        return ""
    return f"the boundary is open or not a simple surface: {count} of its edges do not join exactly two triangles"


def overlap_warning(mesh: TetMesh, faces: BoundaryFaces) -> str:
    by_tets = float(signed_volumes(mesh.nodes, mesh.tets).sum())
    by_boundary = enclosed_volume(mesh.nodes, faces.triangles)
    if abs(by_tets - by_boundary) <= SAME_VOLUME * by_tets:
        return ""
    return (
        f"the tets hold {by_tets:.6g} m^3 but the boundary encloses {by_boundary:.6g} m^3: "
        "tets overlap, or faces of neighbours do not match"
    )


def size_warning(mesh: TetMesh, unit: str) -> str:
    side = float(np.ptp(mesh.nodes, axis=0).max())
    if unit != "m" or side <= LARGE_SIDE:
        return ""
    return f"the largest side is {side:.4g} m: if the mesh was drawn in millimetres, say so with unit: mm"
