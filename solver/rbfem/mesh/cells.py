"""Cells of every kind into tetrahedra."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rbfem.errors import InputError
from rbfem.mesh.geometry import EDGES
from rbfem.mesh.mesh_file import MeshFile
from rbfem.mesh.repair import coincident_nodes
from rbfem.mesh.surface import row_keys
from rbfem.mesh.tet_mesh import TetMesh

# Faces by corner, normals outward, in the node order of VTK (the wedge: of gmsh, which is what meshio hands out).
CELL_FACES = {
    "pyramid": ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
    "wedge": ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    "hexahedron": ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
}
CORNERS = {"pyramid": 5, "wedge": 6, "hexahedron": 8, "triangle": 3, "quad": 4}
PLURAL = {"pyramid": "pyramids", "wedge": "wedges", "hexahedron": "hexahedra"}
TETS = {"tetra": 4, "tetra4": 4, "tetra10": 10}


def is_volume(kind: str) -> bool:
    solid = ("tetra", "hexa", "wedge", "pyramid", "polyhedron", "penta", "voxel")
    return kind.startswith(solid) or kind.endswith(("TETRAHEDRON", "HEXAHEDRON", "WEDGE", "PYRAMID"))


def shape_of(kind: str) -> str:
    """'hexahedron20' -> 'hexahedron'"""
    return kind.rstrip("0123456789")


def mesh_of_tets(file: MeshFile, source: str) -> TetMesh:
    """All volume cells of a file as tets, with the volume groups and fields carried to them. No surfaces yet.

    raises : InputError if the file has no volume cells, or some of a kind that is not known.
    """
    solid = [k for k, block in enumerate(file.blocks) if is_volume(block.kind) and len(block.nodes)]
    if not solid:
        kinds = ", ".join(sorted({block.kind for block in file.blocks})) or "no cells"
        raise InputError(
            f"{source}: no tetrahedra (nor hexahedra, wedges, pyramids) in it, only {kinds}; "
            "save the volume mesh, or make one with: rbfem mesh"
        )
    parts = [tets_of(file.blocks[k].kind, file.blocks[k].nodes, source) for k in solid]
    repairs = split_repairs(file, solid, parts)
    nodes, tets, point_fields, promoted = joined(file, [part for part, _ in parts])
    cells = [parents for _, parents in parts]
    return TetMesh(
        nodes=nodes,
        tets=tets,
        groups=tet_groups(file, solid, cells),
        cell_fields={name: carried(values, solid, cells) for name, values in file.cell_fields.items()},
        point_fields=point_fields,
        repairs=(*file.repairs, *repairs, *promoted),
        warnings=file.warnings,
        source=source,
    )


def tets_of(kind: str, cells: NDArray, source: str) -> tuple[NDArray, NDArray]:
    """Tets of one block, (k, 4) or (k, 10), and the cell each came from, (k,)."""
    if kind in TETS:
        return cells, np.arange(len(cells))
    shape = shape_of(kind)
    if shape not in CELL_FACES:
        known = "tetra, tetra10, hexahedron, wedge, pyramid (also of second order)"
        raise InputError(
            f"{source}: cells of kind {kind!r} cannot be read; expected {known}. Save the mesh with those."
        )
    return split(cells[:, : CORNERS[shape]], CELL_FACES[shape])


def split(cells: NDArray, faces: tuple) -> tuple[NDArray, NDArray]:
    """Tets of hexahedra, wedges or pyramids: from the corner with the smallest number to every triangle of the faces
    that do not touch it. A quadrilateral is cut from its own smallest corner, so both cells at a face cut it alike.

    cells : (n, corners)    returns : tets (k, 4), parents (k,), ordered by cell
    Source of the rule: Dompierre, Labbé, Vallet, Camarero, How to subdivide pyramids, prisms, and hexahedra into
    tetrahedra, 8th International Meshing Roundtable, 1999.
    """
    smallest = cells.argmin(axis=1)
    tets, parents = [], []
    for corner in range(cells.shape[1]):
        rows = np.flatnonzero(smallest == corner)
        for face in faces:
            if corner in face:
                continue
            for triangle in triangles_of(cells[rows][:, face]):
                tets.append(np.column_stack([cells[rows, corner], triangle]))
                parents.append(rows)
    order = np.argsort(np.concatenate(parents), kind="stable")
    return np.concatenate(tets)[order], np.concatenate(parents)[order]


def triangles_of(faces: NDArray) -> list[NDArray]:
    """Faces of 3 or 4 corners, (n, 3) or (n, 4), as one or two sets of triangles (n, 3)."""
    if faces.shape[1] == 3:
        return [faces]
    turn = (faces.argmin(axis=1)[:, None] + np.arange(4)) % 4
    turned = np.take_along_axis(faces, turn, axis=1)
    return [turned[:, [0, 1, 2]], turned[:, [0, 2, 3]]]


def split_repairs(file: MeshFile, solid: list[int], parts: list) -> list[str]:
    counts: dict[str, list[int]] = {}
    for k, (tets, _) in zip(solid, parts, strict=True):
        count = counts.setdefault(file.blocks[k].kind, [0, 0])
        count[0] += len(file.blocks[k].nodes)
        count[1] += len(tets)
    return [split_words(kind, *count) for kind, count in counts.items() if kind not in TETS]


def split_words(kind: str, n_cells: int, n_tets: int) -> str:
    shape = shape_of(kind)
    curved = ", taken by their corners: curved faces became flat" if kind != shape else ""
    return f"{n_cells} {PLURAL[shape]} ({kind}) split into {n_tets} tets{curved}"


def tet_groups(file: MeshFile, solid: list[int], parents: list[NDArray]) -> dict[str, NDArray]:
    """Volume groups, name -> indices of the tets."""
    groups = {}
    for name, cells in file.groups.items():
        belongs = [np.isin(parent, cells[k]) for k, parent in zip(solid, parents, strict=True)]
        tets = np.flatnonzero(np.concatenate(belongs))
        if len(tets):
            groups[name] = tets
    return groups


def carried(values: list[NDArray], solid: list[int], parents: list[NDArray]) -> NDArray:
    return np.concatenate([values[k][parent] for k, parent in zip(solid, parents, strict=True)])


def joined(file: MeshFile, parts: list[NDArray]) -> tuple[NDArray, NDArray, dict[str, NDArray], list[str]]:
    """Blocks of tets as one array; where both orders occur, the first is raised to the second."""
    fields = dict(file.point_fields)
    if len({tets.shape[1] for tets in parts}) == 1:
        return file.points, np.concatenate(parts), fields, []
    linear = np.concatenate([tets for tets in parts if tets.shape[1] == 4])
    quadratic = np.concatenate([tets for tets in parts if tets.shape[1] == 10])
    mid_nodes, ends = mid_nodes_of(linear, quadratic, len(file.points))
    raised = iter(np.split(np.hstack([linear, mid_nodes]), np.cumsum([len(t) for t in parts if t.shape[1] == 4])[:-1]))
    tets = np.concatenate([next(raised) if part.shape[1] == 4 else part for part in parts])
    nodes, *columns = (
        np.concatenate([x, (x[ends[:, 0]] + x[ends[:, 1]]) / 2]) for x in (file.points, *fields.values())
    )
    words = f"{len(linear)} tet4 among tet10 raised to tet10 with straight edges (bent ones where a tet10 shares them)"
    return nodes, tets, dict(zip(fields, columns, strict=True)), [words]


def mid_nodes_of(linear: NDArray, quadratic: NDArray, n_nodes: int) -> tuple[NDArray, NDArray]:
    """Mid-nodes for tet4 that stand among tet10: the one a tet10 has on the same edge, else a new one.

    returns : (k, 6) node indices, and (m, 2) the ends of the edges of the m new nodes
    """
    wanted = linear[:, EDGES].reshape(-1, 2)
    keys = row_keys(np.concatenate([quadratic[:, EDGES].reshape(-1, 2), wanted]), n_nodes)
    known_keys, first = np.unique(keys[: 6 * len(quadratic)], return_index=True)
    known = quadratic[:, 4:].reshape(-1)[first]
    unique, first, inverse = np.unique(keys[6 * len(quadratic) :], return_index=True, return_inverse=True)
    place = np.minimum(np.searchsorted(known_keys, unique), len(known_keys) - 1)
    is_new = known_keys[place] != unique
    mids = np.where(is_new, n_nodes + np.cumsum(is_new) - 1, known[place])
    return mids[inverse].reshape(-1, 6), wanted[first[is_new]]


def surface_patches(file: MeshFile) -> dict[str, list[NDArray]]:
    """Corners of the faces of each surface group, as arrays (k, 3) and (k, 4)."""
    patches: dict[str, list[NDArray]] = {}
    for name, cells in file.groups.items():
        for block, members in zip(file.blocks, cells, strict=True):
            corners = CORNERS.get(shape_of(block.kind), 0)
            if corners in (3, 4) and len(members):
                patches.setdefault(name, []).append(block.nodes[members, :corners])
    return patches


def with_merged_nodes(file: MeshFile) -> MeshFile:
    """The file with nodes at the same place made one, so that cells meeting there are neighbours.

    Done before cells are split: the diagonal of a face follows from the numbers of its nodes.
    """
    is_used = np.zeros(len(file.points), dtype=bool)
    for block in file.blocks:
        if is_volume(block.kind):
            is_used[block.nodes] = True
    used = np.flatnonzero(is_used)
    target = np.arange(len(file.points))
    target[used] = used[coincident_nodes(file.points[used])]
    merged = int((target != np.arange(len(target))).sum())
    if not merged:
        return file
    torn = [name for name, values in file.point_fields.items() if not np.array_equal(values[target], values)]
    if torn:
        raise InputError(
            f"the point field '{torn[0]}' has two values where nodes lie at the same place: it jumps there; "
            "give it as a cell field"
        )
    blocks = tuple(replace(block, nodes=target[block.nodes]) for block in file.blocks)
    return replace(
        file, blocks=blocks, repairs=(*file.repairs, f"{merged} nodes merged with another at the same place")
    )
