"""A mesh file into a checked TetMesh in metres."""

from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from rbfem.errors import InputError
from rbfem.mesh.cells import is_volume, mesh_of_tets, surface_patches, with_merged_nodes
from rbfem.mesh.check import mesh_warnings
from rbfem.mesh.mesh_file import MeshFile, read_file
from rbfem.mesh.repair import repaired, without_unused_nodes
from rbfem.mesh.surface import boundary_faces, row_keys
from rbfem.mesh.tet_mesh import TetMesh
from rbfem.mesh.units import metres_per


def read_mesh(path: str | Path, unit: str = "m") -> TetMesh:
    """Read a tetrahedral mesh, check it, repair what has one right answer, and say so.

    path   : any file meshio reads with tets, hexahedra, wedges or pyramids in it
    unit   : what its numbers are drawn in, one of `rbfem.mesh.units.METRES_PER_UNIT`
    returns: a TetMesh in metres; `repairs` says what was changed, `warnings` what may be wrong
    raises : InputError if the file is missing, unreadable or damaged, or the mesh cannot be integrated.

    >>> import meshio, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     points = [[0, 0, 0], [10, 0, 0], [0, 20, 0], [0, 0, 30]]
    ...     meshio.write_points_cells(folder + "/part.vtk", np.array(points, float), {"tetra": [[0, 2, 1, 3]]})
    ...     mesh = read_mesh(folder + "/part.vtk", unit="mm")
    >>> mesh.nodes.max(axis=0)
    array([0.01, 0.02, 0.03])
    >>> mesh.repairs
    ('1 of 1 tets were inside out: flipped',)
    """
    metres = metres_per(unit)
    source = str(path)
    file = read_file(path)
    check_nodes(file, source)
    mesh = tet_mesh(replace(file, points=file.points * metres), source)
    return frozen(replace(mesh, warnings=(*mesh.warnings, *mesh_warnings(mesh, unit))))


def tet_mesh(file: MeshFile, source: str) -> TetMesh:
    """The repaired mesh of a file whose points are in metres; only the checks of the whole are still to come."""
    if any(is_volume(block.kind) and block.nodes.size for block in file.blocks):
        file = with_merged_nodes(file)
    mesh = repaired(mesh_of_tets(file, source))
    check_volume(mesh)
    return without_unused_nodes(with_surfaces(mesh, surface_patches(file)))


def check_nodes(file: MeshFile, source: str) -> None:
    """Refuse node numbers that do not exist and coordinates that are not numbers."""
    n_points = len(file.points)
    for block in file.blocks:
        if block.nodes.size and (block.nodes.min() < 0 or block.nodes.max() >= n_points):
            raise InputError(
                f"{source}: cells of kind {block.kind!r} name nodes {block.nodes.min()} to {block.nodes.max()}, "
                f"but the file has nodes 0 to {n_points - 1}; it is damaged or was cut short"
            )
        x = file.points[block.nodes] if is_volume(block.kind) else np.zeros(0)
        if not np.isfinite(x).all() or (np.abs(x) > 1e75).any():
            raise InputError(
                f"{source}: a node of the mesh has a coordinate that is not a finite number (or beyond 1e75, "
                "where a product of four lengths overflows); the file is damaged, or its writer failed"
            )


def check_volume(mesh: TetMesh) -> None:
    if not mesh.n_tets:
        raise InputError(
            f"{mesh.source}: the volume of the mesh is zero ({'; '.join(mesh.repairs) or 'no tets'}), nothing can be "
            "integrated over it; a mesh of a solid was expected"
        )


def with_surfaces(mesh: TetMesh, patches: dict[str, list[NDArray]]) -> TetMesh:
    """The mesh with its surface groups: those boundary triangles whose corners are in a face of the group."""
    if not patches:
        return mesh
    faces = boundary_faces(mesh)
    surfaces, warnings = {}, []
    for name, parts in patches.items():
        wanted = np.concatenate([corner_triples(part) for part in parts])
        # One call for both: keys of large meshes can only be compared within a call.
        together = row_keys(np.concatenate([faces.triangles[:, :3], wanted]), mesh.n_nodes)
        keys, wanted_keys = np.split(together, [len(faces.triangles)])
        found = np.isin(keys, wanted_keys)
        expected = sum(len(part) * (part.shape[1] - 2) for part in parts)
        if found.any():
            surfaces[name] = faces.triangles[found]
        if found.sum() < expected:
            warnings.append(surface_warning(name, expected, int(found.sum())))
    return replace(mesh, surfaces=surfaces, warnings=(*mesh.warnings, *warnings))


def corner_triples(faces: NDArray) -> NDArray[np.int64]:
    """Any three corners of triangles (k, 3) or quadrilaterals (k, 4): of the four of the latter two are boundary."""
    if faces.shape[1] == 3:
        return faces
    return faces[:, [[0, 1, 2], [0, 2, 3], [0, 1, 3], [1, 2, 3]]].reshape(-1, 3)


def surface_warning(name: str, expected: int, found: int) -> str:
    if not found:
        return f"surface group '{name}' is not on the boundary of the part: left out"
    return f"surface group '{name}': {expected - found} of its {expected} triangles are not on the boundary: left out"


def frozen(mesh: TetMesh) -> TetMesh:
    """The mesh with mappings that cannot be written to and arrays of the promised types."""
    return replace(
        mesh,
        nodes=np.ascontiguousarray(mesh.nodes),
        tets=np.ascontiguousarray(mesh.tets, dtype=np.int64),
        groups=MappingProxyType(dict(mesh.groups)),
        surfaces=MappingProxyType(dict(mesh.surfaces)),
        cell_fields=MappingProxyType(dict(mesh.cell_fields)),
        point_fields=MappingProxyType(dict(mesh.point_fields)),
    )
