"""Named groups of cells, which every format keeps in a different place."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

# Integer cell data that number the groups, and the word for a group without a name: tag 3 becomes "physical_3".
TAG_FIELDS = {
    "gmsh:physical": "physical",
    "medit:ref": "ref",
    "netgen:index": "index",
    "su2:tag": "tag",
    "tetgen:ref": "ref",
    "avsucd:material": "material",
    "ugrid:ref": "ref",
    "nastran:ref": "ref",
    "cell_tags": "family",
}

Groups = dict[str, list[NDArray]]


def marks_groups(field_name: str) -> bool:
    return field_name in TAG_FIELDS


def named_groups(mesh: Any, path: Path) -> tuple[Groups, tuple[str, ...]]:
    """Groups of a meshio mesh, name -> for each block the indices of its cells; and warnings."""
    groups: Groups = {}
    sets, warnings = file_sets(mesh, path)
    for name, k, cells in [*sets, *tagged_cells(mesh)]:
        parts = groups.setdefault(name, [np.zeros(0, dtype=np.int64) for _ in mesh.cells])
        parts[k] = np.union1d(parts[k], cells)
    empty = sorted(name for name, parts in groups.items() if not sum(len(part) for part in parts))
    empty += sorted(name for name in mesh.field_data if name not in groups and has_tag(mesh, name))
    for name in empty:
        groups.pop(name, None)
        warnings += (f"group '{name}' has no cells and is left out",)
    return groups, warnings


def has_tag(mesh: Any, name: str) -> bool:
    """Whether `name` is a physical name with its (tag, dimension) of 2 or 3, not other data of the file."""
    value = np.asarray(mesh.field_data[name])
    return value.shape == (2,) and value.dtype.kind in "iu" and value[1] in (2, 3)


def file_sets(mesh: Any, path: Path) -> tuple[list, tuple[str, ...]]:
    """(name, block, cells) of the sets that meshio reads as sets."""
    sets = [
        (name, k, checked_indices(cells, len(mesh.cells[k]), name))
        for name, parts in mesh.cell_sets.items()
        if not name.startswith("gmsh:")
        for k, cells in zip(range(len(mesh.cells)), parts, strict=False)
    ]
    if path.suffix.lower() != ".inp":
        return sets, ()
    return abaqus_sets(sets, mesh, path)


def checked_indices(cells: Any, n_cells: int, name: str) -> NDArray[np.int64]:
    cells = np.asarray(cells if cells is not None else [])
    if cells.size and (cells.ndim != 1 or cells.dtype.kind not in "iu" or cells.min() < 0 or cells.max() >= n_cells):
        raise ValueError(f"group {name!r} names cells that do not exist")
    return cells.astype(np.int64).reshape(-1)


def tagged_cells(mesh: Any) -> Iterator[tuple[str, int, NDArray]]:
    """(name, block, cells) of the groups that are kept as a number on each cell; 0 means no group."""
    for key in TAG_FIELDS:
        for k, tags in enumerate(mesh.cell_data.get(key, ())):
            tags = np.asarray(tags)
            if tags.ndim != 1 or tags.dtype.kind not in "iuf":
                continue
            for tag in np.unique(tags[tags != 0]):
                for name in names_of_tag(mesh, key, int(tag), mesh.cells[k].dim):
                    yield name, k, np.flatnonzero(tags == tag)


def names_of_tag(mesh: Any, key: str, tag: int, dimension: int) -> list[str]:
    if key == "cell_tags":
        return [name for name in getattr(mesh, "cell_tags", {}).get(tag, []) if name]
    if key in ("gmsh:physical", "netgen:index"):
        named = [name for name in mesh.field_data if has_tag(mesh, name)]
        names = [name for name in named if tuple(mesh.field_data[name]) == (tag, dimension)]
        if names:
            return names
    return [f"{TAG_FIELDS[key]}_{tag}"]


def abaqus_sets(sets: list, mesh: Any, path: Path) -> tuple[list, tuple[str, ...]]:
    """Sets of an Abaqus file, with those that name whole *ELEMENT blocks or other sets put right.

    meshio 5.3.5 puts such a set on the first blocks of the file, whichever it belongs to; so the few lines that say
    which block it is are read again here.
    """
    of_block, references = abaqus_keywords(path)
    if len(of_block) != len(mesh.cells):
        return [], ("the element sets were left out: the file includes others and its blocks cannot be told apart",)
    whole = [(name, k, np.arange(len(mesh.cells[k]))) for k, name in enumerate(of_block) if name]
    listed = [entry for entry in sets if entry[0] not in references and entry[0] not in of_block]
    found = whole + listed
    for name, members in references.items():
        found += [(name, k, cells) for member, k, cells in list(found) if member in members]
    return found, ()


def abaqus_keywords(path: Path) -> tuple[list[str], dict[str, set[str]]]:
    """The ELSET of each *ELEMENT line ('' without one), and the *ELSETs that are made of other sets."""
    of_block: list[str] = []
    references: dict[str, set[str]] = {}
    current = ""
    for line in path.read_text(errors="replace").splitlines():
        if line.startswith("*"):
            keyword, name = keyword_and_set(line)
            current = name if keyword == "ELSET" else ""
            if keyword == "ELEMENT":
                of_block.append(name)
        elif current:
            words = {word.strip() for word in line.split(",")}
            names = {word for word in words if word and not word.lstrip("-").isdigit()}
            if names:
                references.setdefault(current, set()).update(names)
    return of_block, references


def keyword_and_set(line: str) -> tuple[str, str]:
    """Keyword and ELSET name of a line such as '*ELEMENT, type=C3D4, ELSET=steel'."""
    keyword, *parameters = (part.strip() for part in line.lstrip("*").split(","))
    pairs = (part.partition("=") for part in parameters)
    names = [value.strip() for key, _, value in pairs if key.strip().upper() == "ELSET"]
    return keyword.upper(), names[0] if names else ""
