"""What a mesh file holds, in arrays of our own. Only this file and `file_groups` know how meshio puts things."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rbfem.errors import InputError
from rbfem.mesh.containment import contained
from rbfem.mesh.file_groups import marks_groups, named_groups

MADE_BY_RBFEM_MESH = (".stl", ".step", ".stp", ".iges", ".igs", ".brep", ".geo")

FIRST_ORDER = {"vertex": 1, "line": 2, "triangle": 3, "quad": 4, "tetra": 4, "pyramid": 5, "wedge": 6, "hexahedron": 8}


@dataclass(frozen=True)
class CellBlock:
    """Cells of one kind, by the name meshio has for it. nodes : (n_cells, nodes of a cell) int64"""

    kind: str
    nodes: NDArray[np.int64]


@dataclass(frozen=True)
class MeshFile:
    """points       : (n, 3) float64, in the unit of the file
    groups       : name -> for each block the indices of its cells that belong to the group
    cell_fields  : name -> for each block (n_cells,) values
    point_fields : name -> (n,) values
    """

    points: NDArray[np.float64]
    blocks: tuple[CellBlock, ...]
    groups: Mapping[str, list[NDArray]] = field(default_factory=dict)
    cell_fields: Mapping[str, list[NDArray]] = field(default_factory=dict)
    point_fields: Mapping[str, NDArray] = field(default_factory=dict)
    repairs: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


def read_file(path: str | Path) -> MeshFile:
    """Read any file meshio can read, whatever is in it.

    raises : InputError if the file is missing, of an unknown kind, damaged, or at odds with itself.
    """
    path = Path(path)
    size = size_of(path)
    check_extension(path)
    content, failure, printed = contained(lambda: read_with_meshio(path), size)
    said = " ".join(printed.split())[:300]
    if failure:
        raise InputError(f"{path}: not readable as a mesh ({failure}{'; ' + said if said else ''}). {advice(failure)}")
    return content if not said else with_warning(content, f"the reader of the file said: {said}")


def with_warning(content: MeshFile, warning: str) -> MeshFile:
    return replace(content, warnings=(*content.warnings, warning))


def size_of(path: Path) -> int:
    try:
        if path.is_dir():
            raise InputError(f"{path}: is a directory, expected a mesh file")
        if path.exists() and not path.is_file():
            raise InputError(f"{path}: is no ordinary file, expected a mesh file")
        with path.open("rb") as stream:
            size = stream.seek(0, 2)
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; a mesh file was expected there") from None
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be opened ({error}); a readable mesh file was expected") from None
    if size == 0:
        raise InputError(f"{path}: is empty; a mesh file was expected")
    return size


def check_extension(path: Path) -> None:
    name = path.name.lower()
    if name.endswith(MADE_BY_RBFEM_MESH):
        raise InputError(
            f"{path}: a {path.suffix} file holds no tetrahedra that could be read; "
            f"make them first: rbfem mesh {path} -o {path.with_suffix('.msh')}, with the --unit of its numbers"
        )
    import meshio

    if not name.endswith(tuple(meshio.extension_to_filetypes)):
        known = " ".join(sorted(meshio.extension_to_filetypes))
        raise InputError(f"{path}: unknown kind of file {path.suffix!r}; expected one of {known}")


def advice(failure: str) -> str:
    if "gmsh:physical" in failure:
        return (
            "The reader wants every entity in a physical group, or none: in gmsh switch 'Save all elements' "
            "(Mesh.SaveAll) off, or save as format 2.2."
        )
    return "The file may be cut short or damaged: open it in the program that wrote it and save it again."


def read_with_meshio(path: Path) -> MeshFile:
    import meshio

    with np.errstate(all="ignore"):
        mesh = meshio.read(path, file_format="gmsh" if is_gmsh(path) else None)
        groups, warnings = named_groups(mesh, path)
        return MeshFile(
            points=points_in_space(mesh.points),
            blocks=tuple(CellBlock(block.type, integer_rows(block)) for block in mesh.cells),
            groups=groups,
            cell_fields=scalar_cell_fields(mesh),
            point_fields=scalar_point_fields(mesh),
            warnings=warnings,
        )


def is_gmsh(path: Path) -> bool:
    """A .msh file is gmsh's or ANSYS's; meshio would try ANSYS first."""
    with path.open("rb") as stream:
        return path.suffix.lower() == ".msh" and stream.read(40).lstrip().startswith((b"$MeshFormat", b"$Comments"))


def integer_rows(block: Any) -> NDArray[np.int64]:
    if block.type.startswith("polyhedron"):
        return np.zeros((len(block.data), 0), dtype=np.int64)
    rows = np.asarray(block.data)
    if len(rows) and (rows.ndim != 2 or rows.dtype.kind not in "iu"):
        raise ValueError(f"the node numbers of a block of {block.type} are no table of integers")
    if len(rows) and rows.shape[1] != nodes_of(block.type, rows.shape[1]):
        raise ValueError(f"cells of kind {block.type} have {rows.shape[1]} nodes each")
    return np.ascontiguousarray(rows.reshape(len(rows), -1) if len(rows) else np.zeros((0, 1)), dtype=np.int64)


def nodes_of(kind: str, otherwise: int) -> int:
    """How many nodes a cell has by the name of its kind: 'wedge' -> 6, 'tetra10' -> 10."""
    digits = kind[len(kind.rstrip("0123456789")) :]
    return int(digits) if digits else FIRST_ORDER.get(kind, otherwise)


def points_in_space(points: Any) -> NDArray[np.float64]:
    points = np.asarray(points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise ValueError(f"the points are an array of shape {points.shape}, expected (n, 3)")
    padded = np.zeros((len(points), 3))
    padded[:, : points.shape[1]] = points
    return padded


def scalar_cell_fields(mesh: Any) -> dict[str, list[NDArray]]:
    columns = {name: [as_column(part) for part in parts] for name, parts in mesh.cell_data.items() if is_field(name)}
    return {name: parts for name, parts in columns.items() if all(part is not None for part in parts)}


def scalar_point_fields(mesh: Any) -> dict[str, NDArray]:
    columns = {name: as_column(values) for name, values in mesh.point_data.items() if is_field(name)}
    return {name: column for name, column in columns.items() if column is not None}


def is_field(name: str) -> bool:
    """Whether a named array is a quantity, and not the bookkeeping of a mesh generator."""
    return not (marks_groups(name) or "gmsh:" in name or name in ("point_tags", "GLOBAL_ID"))


def as_column(values: Any) -> Any:
    """One number a cell or point as float64, or None."""
    values = np.asarray(values)
    if values.ndim == 2 and values.shape[1] == 1:
        values = values[:, 0]
    return values.astype(np.float64) if values.ndim == 1 and values.dtype.kind in "iuf" else None
