"""What a part weighs, place by place: one number, one per group, one per tet or one per node."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rbfem.errors import InputError
from rbfem.mesh.tet_mesh import TetMesh


@dataclass(frozen=True)
class DensityField:
    """Checked density of a mesh. values: kg/m^3, (1,) for all, (n_tets,), or (n_nodes,) where `is_nodal`."""

    values: NDArray[np.float64]
    is_nodal: bool

    def of_tets(self, mesh: TetMesh) -> NDArray[np.float64]:
        """(n_tets,) density of each tet: its own value, or the mean of its corners'. Not to be written to."""
        if self.is_nodal:
            return self.values[mesh.tets[:, :4]].mean(axis=1)
        return np.broadcast_to(self.values, (mesh.n_tets,))


Density = float | Mapping[str, float] | ArrayLike | DensityField


def density_field(mesh: TetMesh, density: Density) -> DensityField:
    """Read a density in any of its forms against a mesh.

    density : a number; or {group: number} for volume groups that hold each tet once, whatever others there are; or an
              array, one value a tet or one a node (one a tet where a mesh has as many tets as nodes)
    Raises InputError for a density that is not finite and positive, an array of another length, a group that the mesh
    does not have, and a tet that has no group or several.
    """
    if isinstance(density, DensityField):
        return density
    if isinstance(density, Mapping):
        return DensityField(_by_group(mesh, density), is_nodal=False)
    values = np.asarray(density, dtype=float)
    if values.ndim == 0:
        _require_positive(values, mesh)
        return DensityField(values.reshape(1), is_nodal=False)
    if values.shape not in ((mesh.n_tets,), (mesh.n_nodes,)):
        raise InputError(
            f"{mesh.source}: a density of shape {values.shape} fits neither the {mesh.n_tets} tets nor the "
            f"{mesh.n_nodes} nodes of the mesh; give one value a tet or one a node"
        )
    _require_positive(values, mesh)
    return DensityField(np.ascontiguousarray(values), is_nodal=values.shape != (mesh.n_tets,))


def field_of_file(mesh: TetMesh, name: str) -> DensityField:
    """A scalar field of the mesh file, as a density: of the cells if there is one of that name, else of the nodes."""
    for fields, is_nodal in ((mesh.cell_fields, False), (mesh.point_fields, True)):
        if name in fields:
            values = np.ascontiguousarray(fields[name], dtype=float)
            _require_positive(values, mesh)
            return DensityField(values, is_nodal)
    known = sorted({*mesh.cell_fields, *mesh.point_fields})
    raise InputError(f"{mesh.source}: no scalar field '{name}' in the mesh; it has {', '.join(known) or 'none'}")


def groups_of_tets(mesh: TetMesh, names: list[str]) -> NDArray[np.int64]:
    """(n_tets,) which of the named groups each tet is in; groups that are not named do not count.

    Raises InputError unless each tet is in exactly one.
    """
    owner = np.full(mesh.n_tets, -1)
    for index, name in enumerate(names):
        members = mesh.groups[name]
        taken = members[owner[members] >= 0]
        if len(taken):
            raise InputError(
                f"{mesh.source}: {len(taken)} tets are in the group '{names[owner[taken[0]]]}' and in '{name}'; "
                "a density by group needs each tet in exactly one"
            )
        owner[members] = index
    if (owner < 0).any():
        raise InputError(
            f"{mesh.source}: {np.count_nonzero(owner < 0)} of {mesh.n_tets} tets are in none of the groups "
            f"{', '.join(repr(name) for name in names)}; a density by group needs each tet in exactly one, "
            f"and the mesh has the groups {', '.join(mesh.groups) or 'none'}"
        )
    return owner


def _by_group(mesh: TetMesh, density: Mapping[str, float]) -> NDArray[np.float64]:
    unknown = [name for name in density if name not in mesh.groups]
    if unknown:
        named = ", ".join(f"'{name}'" for name in unknown)
        raise InputError(
            f"{mesh.source}: the mesh has no group {named}; its groups are {', '.join(mesh.groups) or 'none'}"
        )
    values = np.array([float(value) for value in density.values()])
    _require_positive(values, mesh)
    return values[groups_of_tets(mesh, list(density))]


def _require_positive(values: NDArray[np.float64], mesh: TetMesh) -> None:
    bad = ~(np.isfinite(values) & (values > 0.0))
    if bad.any():
        first = np.atleast_1d(values)[np.atleast_1d(bad)][0]
        raise InputError(f"{mesh.source}: density {first:g} read, a finite number above zero expected (kg/m^3)")
