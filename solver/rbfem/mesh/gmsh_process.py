"""The child process that holds gmsh: a request as JSON on its input, an answer as JSON on its output."""

import json
import math
import os
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rbfem.errors import InputError
from rbfem.mesh.geometry import signed_volumes
from rbfem.mesh.primitives import Primitive, is_primitive, parse_primitive
from rbfem.mesh.repair import smallest_of_component
from rbfem.mesh.triangulation import SHARP, check_closed, has_only_discs, volumes_of_shells

DIAGONAL_SHARE = 20
PER_TURN = 20
LINEAR_TET, QUADRATIC_TET, TRIANGLE = 4, 11, 2
VTK_ORDER = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]

Namer = Callable[[int, int, int], str]


def main() -> None:
    # OpenCASCADE prints from C and when it likes: the output is kept for the answer, all else goes to stderr.
    answer = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    request = json.loads(sys.stdin.read())
    reply: dict[str, object]
    try:
        reply = {"answer": JOBS[request.pop("job")](**request)}
    except InputError as error:
        reply = {"wrong_input": str(error)}
    except (ImportError, OSError) as error:
        reply = {"missing_library": str(error)}
    with answer:
        json.dump(reply, answer)


def weigh(source: str, metres: float) -> dict:
    """Volume, centre and tensor about it of each solid, density one, in metres, as OpenCASCADE integrates them."""
    import gmsh

    start_gmsh()
    scale = metres * build(source, metres)[0]
    occ = gmsh.model.occ
    tags = [tag for _, tag in gmsh.model.getEntities(3)]
    return {
        "volumes": [occ.getMass(3, tag) * scale**3 for tag in tags],
        "centers": [[scale * x for x in occ.getCenterOfMass(3, tag)] for tag in tags],
        "tensors": [[scale**5 * x for x in occ.getMatrixOfInertia(3, tag)] for tag in tags],
    }


def start_gmsh() -> None:
    import gmsh

    gmsh.initialize(readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)


def make(source: str, output: str, size: float | None, order: int, metres: float) -> dict:
    """Build the shape, mesh it, write it, and describe what was written; lengths in the unit of the output."""
    import gmsh

    start_gmsh()
    scale, exact_volume, name = build(source, metres)
    if not gmsh.model.getEntities(3):
        raise InputError("no solid in it that could be filled with tets; a closed volume was expected")
    add_groups(name)
    chosen = set_sizes(source, size, scale)
    mesh(order)
    nodes, tets = tet_arrays(order)
    gmsh.option.setNumber("Mesh.ScalingFactor", scale)
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    gmsh.write(output)
    return {
        "nodes": len(np.unique(tets)),
        "tets": len(tets),
        "size": chosen,
        "volume": float(np.abs(signed_volumes(nodes, tets)).sum()) * scale**3,
        "exact_volume": None if exact_volume is None else exact_volume * scale**3,
        "groups": group_names(3),
        "surfaces": group_names(2),
    }


def build(source: str, metres: float) -> tuple[float, float | None, Namer]:
    """Make the geometry. returns : factor from its lengths to those of the output, exact volume, namer of entities."""
    if is_primitive(source):
        return build_primitive(parse_primitive(source))
    suffix = Path(source).suffix.lower()
    if suffix == ".stl":
        build_stl(source)
        return 1.0, None, entity_name
    if suffix == ".geo":
        build_geo(source)
        return 1.0, occ_volume(), entity_name
    build_solids(source)
    # OpenCASCADE converts STEP and IGES to millimetres, its tolerance being made for them; BREP has no unit.
    return (1.0 if suffix == ".brep" else 1e-3 / metres), occ_volume(), entity_name


def build_primitive(shape: Primitive) -> tuple[float, float | None, Namer]:
    """Built at the size of one, for OpenCASCADE's tolerance is an absolute 1e-7."""
    import gmsh

    occ, scale = gmsh.model.occ, max(shape.extent)
    a, b, c = shape.scaled(1.0 / scale).extent
    if shape.kind == "box":
        occ.addBox(-a, -b, -c, 2 * a, 2 * b, 2 * c)
    elif shape.kind == "cylinder":
        occ.addCylinder(0, 0, -c, 0, 0, 2 * c, a)
    elif shape.kind == "sphere":
        occ.addSphere(0, 0, 0, a)
    else:
        occ.dilate([(3, occ.addSphere(0, 0, 0, 1))], 0, 0, 0, a, b, c)
    occ.synchronize()
    return scale, shape.volume / scale**3, lambda dimension, tag, k: primitive_name(shape.kind, dimension, tag)


def primitive_name(kind: str, dimension: int, tag: int) -> str:
    """The volume by the name of the shape, faces across an axis by that axis: x_min … z_max."""
    import gmsh

    if dimension == 3:
        return kind
    center = np.array(gmsh.model.occ.getCenterOfMass(2, tag))
    if kind in ("sphere", "ellipsoid"):
        return "surface"
    axis = int(np.abs(center).argmax())
    if abs(center[axis]) < 1e-6:
        return "side"
    return "xyz"[axis] + ("_min" if center[axis] < 0 else "_max")


def build_solids(source: str) -> None:
    """Solids of a STEP, IGES or BREP file, cut where they touch so that their meshes share the nodes there."""
    import gmsh

    gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
    try:
        found = gmsh.model.occ.importShapes(source, highestDimOnly=True)
    except Exception as error:
        raise InputError(f"OpenCASCADE cannot read it ({error}); export it again from the CAD program") from None
    gmsh.model.occ.synchronize()
    solids = [entity for entity in found if entity[0] == 3]
    if len(solids) < 2:
        return
    names = [gmsh.model.getEntityName(*solid) for solid in solids]
    _, children = gmsh.model.occ.fragment(solids, [])
    gmsh.model.occ.synchronize()
    for name, parts in zip(names, children, strict=True):
        for dimension, tag in parts:
            gmsh.model.setEntityName(dimension, tag, name)


def build_geo(source: str) -> None:
    import gmsh

    gmsh.logger.start()
    try:
        gmsh.open(source)
    except Exception as error:
        said = [line for line in gmsh.logger.get() if line.startswith("Error")]
        raise InputError(f"gmsh cannot read it: {' '.join(said) or error}") from None


def build_stl(source: str) -> None:
    """A closed triangulation as the boundary of a volume: classified into faces, then filled."""
    import gmsh

    try:
        gmsh.merge(source)
    except Exception as error:
        raise InputError(f"gmsh cannot read it as STL ({error})") from None
    gmsh.model.mesh.removeDuplicateNodes()
    points, triangles = triangle_arrays()
    check_closed(points, triangles)
    shells = smallest_of_component(triangles, len(points))
    # Cutting faces up for their parametrization goes on for ever in gmsh 4.15 on a few triangles: only where needed.
    cut_up = not has_only_discs(points, triangles)
    gmsh.model.mesh.classifySurfaces(SHARP, True, cut_up, math.pi)
    gmsh.model.mesh.createGeometry()
    faces = [tag for _, tag in gmsh.model.getEntities(2)]
    for loops in volumes_of_shells(points, triangles, shells):
        tags = [gmsh.model.geo.addSurfaceLoop([f for f in faces if shell_of(f, points, shells) == s]) for s in loops]
        gmsh.model.geo.addVolume(tags)
    gmsh.model.geo.synchronize()


def triangle_arrays() -> tuple[NDArray, NDArray]:
    """points (n, 3) and triangles (k, 3), indices from 0, of the surface mesh."""
    import gmsh

    _, corners = gmsh.model.mesh.getElementsByType(TRIANGLE)
    if not len(corners):
        raise InputError("no triangles in it")
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    triangles = np.searchsorted(tags, corners.astype(np.int64), sorter=order)
    return np.asarray(coordinates).reshape(-1, 3)[order], triangles.reshape(-1, 3)


def shell_of(face: int, points: NDArray, shells: NDArray) -> int:
    import gmsh

    _, coordinates, _ = gmsh.model.mesh.getNodes(2, face, includeBoundary=True)
    return int(shells[np.linalg.norm(points - coordinates[:3], axis=1).argmin()])


def occ_volume() -> float | None:
    """Volume of all solids as OpenCASCADE integrates it; None if the solids are not its own.

    Measured: exact to rounding for a box, 1e-6 off where cylinders meet, 4e-4 off for an ellipsoid (free-form faces).
    """
    import gmsh

    solids = gmsh.model.occ.getEntities(3)
    return sum(gmsh.model.occ.getMass(*solid) for solid in solids) if solids else None


def entity_name(dimension: int, tag: int, k: int) -> str:
    """The name the file gives an entity, else volume_1, surface_1…"""
    import gmsh

    name = gmsh.model.getEntityName(dimension, tag).rpartition("/")[2].strip()
    # What OpenCASCADE writes for a part without a name.
    if not name or name.startswith("Open CASCADE"):
        return f"{'volume' if dimension == 3 else 'surface'}_{k}"
    return name


def add_groups(name: Namer) -> None:
    """Physical groups for all volumes and the faces on their boundary, unless the file has its own for volumes."""
    import gmsh

    if gmsh.model.getPhysicalGroups(3):
        return
    volumes = gmsh.model.getEntities(3)
    outer = gmsh.model.getBoundary(volumes, combined=True, oriented=False)
    for dimension, entities in ((3, volumes), (2, outer)):
        if gmsh.model.getPhysicalGroups(dimension):
            continue
        groups: dict[str, list[int]] = {}
        for k, (_, tag) in enumerate(entities, start=1):
            groups.setdefault(name(dimension, tag, k), []).append(tag)
        for group, tags in groups.items():
            gmsh.model.addPhysicalGroup(dimension, tags, name=group)


def set_sizes(source: str, size: float | None, scale: float) -> float | None:
    """Tell gmsh the edge length. returns : what was chosen, in the unit of the output."""
    import gmsh

    if size is None and source.lower().endswith(".geo"):
        return None
    option = gmsh.option.setNumber
    if size is None:
        box = np.reshape(gmsh.model.getBoundingBox(-1, -1), (2, 3))
        size = float(np.linalg.norm(box[1] - box[0])) * scale / DIAGONAL_SHARE
        # The curvature of an STL is guessed from its triangles, and far too large where they are fine.
        option("Mesh.MeshSizeFromCurvature", 0 if source.lower().endswith(".stl") else PER_TURN)
    option("Mesh.MeshSizeFromPoints", 0)
    option("Mesh.MeshSizeMax", size / scale)
    return size


def mesh(order: int) -> None:
    import gmsh

    gmsh.option.setNumber("Mesh.ElementOrder", order)
    gmsh.option.setNumber("Mesh.HighOrderOptimize", 1)
    gmsh.model.mesh.generate(3)


def tet_arrays(order: int) -> tuple[NDArray, NDArray]:
    """nodes (n, 3) and tets (k, 4) or (k, 10) in VTK's order, in the lengths of the geometry."""
    import gmsh

    _, members = gmsh.model.mesh.getElementsByType(LINEAR_TET if order == 1 else QUADRATIC_TET)
    if not len(members):
        raise InputError("gmsh made no tets of it; try a smaller size, or repair the shape")
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    by_tag = np.argsort(tags)
    tets = np.searchsorted(tags, members.astype(np.int64), sorter=by_tag).reshape(-1, 4 if order == 1 else 10)
    return np.asarray(coordinates).reshape(-1, 3)[by_tag], tets[:, VTK_ORDER[: tets.shape[1]]]


def group_names(dimension: int) -> list[str]:
    import gmsh

    return [
        gmsh.model.getPhysicalName(*group) or f"physical_{group[1]}"
        for group in gmsh.model.getPhysicalGroups(dimension)
    ]


JOBS: dict[str, Callable[..., dict]] = {"mesh": make, "weigh": weigh}


if __name__ == "__main__":
    main()
