"""Tets from STL, STEP, .geo and primitives. gmsh does the work, in a process of its own."""

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from rbfem.errors import InputError, MissingLibraryError, RunError
from rbfem.mesh.primitives import PRIMITIVES, is_primitive, parse_primitive, usage
from rbfem.mesh.units import metres_per

CAD = (".step", ".stp", ".iges", ".igs")
GEOMETRY = (".stl", *CAD, ".brep", ".geo")
SYSTEM_LIBRARIES = (
    "apt-get install -y --no-install-recommends "
    "libglu1-mesa libgl1 libegl1 libxrender1 libxcursor1 libxft2 libxinerama1 libgomp1"
)


@dataclass(frozen=True)
class GeneratedMesh:
    """A mesh that was written.

    unit         : what the numbers of the file are in: read it back with this unit
    size         : edge length asked for, in `unit`; None where the .geo file decides
    volume       : of the mesh, unit^3
    exact_volume : of the shape itself, unit^3: in closed form for primitives, else as OpenCASCADE integrates it
                   (measured: 1e-6 off where cylinders meet, 4e-4 with free-form faces); None without a solid of its own
    groups, surfaces : names of the physical groups
    """

    path: Path
    unit: str
    nodes: int
    tets: int
    order: int
    size: float | None
    volume: float
    exact_volume: float | None
    groups: tuple[str, ...]
    surfaces: tuple[str, ...]


def generate(
    source: str | Path, output: str | Path, size: float | None = None, order: int = 1, unit: str = "m"
) -> GeneratedMesh:
    """Fill a shape with tetrahedra and write them as .msh (format 4.1), with physical groups.

    source : a closed .stl; the solids of a .step, .iges or .brep file; a .geo script; or a primitive in words:
             sphere:radius=  box:size=x,y,z  cylinder:radius=,height=  ellipsoid:radii=x,y,z
    output : the .msh file; it appears under its name only when it is whole
    size   : edge length, in `unit`; by default a twentieth of the diagonal, finer where the surface is curved
             (but in an STL, whose curvature is a guess); a .geo file has sizes of its own
    order  : 1 for tet4, 2 for tet10 with nodes on the curved surface
    unit   : what the numbers of `output` are in. A STEP or IGES file states its own unit and is converted to this one.
             STL, BREP, .geo and primitives state none: their numbers are taken to be in `unit` and stay as they are.
             Either way `read_mesh(output, unit)` gives the part in metres.
    raises : InputError, MissingLibraryError if gmsh cannot be loaded, RunError if gmsh breaks down.

    gmsh runs in a child process: what it prints stays there, Ctrl-C ends it, and a crash in it is an error here.
    """
    output = Path(output)
    partial = temporary_name(output)
    request = {
        "job": "mesh",
        "source": checked_source(str(source)),
        "output": str(partial),
        "size": checked_size(size),
        "order": checked_order(order),
        "metres": metres_per(unit),
    }
    check_output(output)
    try:
        reply = ask_gmsh(request)
        os.replace(partial, output)
    finally:
        partial.unlink(missing_ok=True)
    reply["groups"], reply["surfaces"] = tuple(reply["groups"]), tuple(reply["surfaces"])
    return GeneratedMesh(path=output, unit=unit, order=order, **reply)


def solid_moments(source: str | Path) -> dict[str, list]:
    """Volumes (k,), centres (k, 3) and tensors (k, 9) about them, density one, of the k solids of a STEP or IGES file.

    In metres, whatever the unit of the file; as OpenCASCADE integrates them, which is not exact everywhere, see
    `GeneratedMesh`. Raises InputError, MissingLibraryError.
    """
    if Path(source).suffix.lower() not in CAD:
        shapes = ", ".join(usage(kind) for kind in PRIMITIVES)
        raise InputError(f"{source}: expected a file ending in {' '.join(CAD)}, which state their unit, or {shapes}")
    solids = ask_gmsh({"job": "weigh", "source": checked_source(str(source)), "metres": 1.0})
    if not solids["volumes"]:
        raise InputError(f"{source}: no solid in it, only surfaces or curves")
    return solids


def checked_source(source: str) -> str:
    if is_primitive(source):
        parse_primitive(source)
        return source
    path = Path(source)
    if not path.suffix or path.suffix.lower() not in GEOMETRY:
        examples = "  ".join(usage(kind) for kind in PRIMITIVES)
        raise InputError(f"{source}: expected a file ending in {' '.join(GEOMETRY)}, or one of {examples}")
    if not path.is_file():
        raise InputError(f"{source}: no such file; a shape to be filled with tets was expected there")
    return str(path.resolve())


def checked_size(size: float | None) -> float | None:
    if size is not None and not 0.0 < size < float("inf"):
        raise InputError(f"size: read {size}, expected a length above zero")
    return size


def checked_order(order: int) -> int:
    if order not in (1, 2):
        raise InputError(f"order: read {order}, expected 1 (tet4) or 2 (tet10)")
    return order


def check_output(output: Path) -> None:
    """Refuse, before an hour of meshing and not after, what could not be written."""
    if output.suffix.lower() != ".msh":
        raise InputError(f"{output}: meshes are written as .msh; name the output {output.stem or 'part'}.msh")
    if output.is_dir():
        raise InputError(f"{output}: is a directory, expected the name of a file")
    folder = output.parent
    if not folder.is_dir():
        raise InputError(f"{output}: there is no directory {folder}; make it first")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError(f"{output}: the directory {folder} cannot be written to; choose another")


def temporary_name(output: Path) -> Path:
    """In the same directory, so that renaming is one step; ending in .msh, from which gmsh takes the format."""
    return output.absolute().parent / f".{output.stem}.{os.getpid()}.partial.msh"


def ask_gmsh(request: dict) -> dict:
    """The answer of the child process `rbfem.mesh.gmsh_process`."""
    solver = str(Path(__file__).parents[2])
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([solver, *filter(None, sys.path)])}
    child = subprocess.run(
        [sys.executable, "-m", "rbfem.mesh.gmsh_process"],
        input=json.dumps(request),
        capture_output=True,
        text=True,
        errors="replace",
        env=environment,
    )
    reply = json.loads(child.stdout) if child.stdout and child.returncode == 0 else {"broke_down": child.stderr}
    return answer(reply, request["source"], child.returncode)


def answer(reply: dict, source: str, code: int) -> dict:
    if "answer" in reply:
        return reply["answer"]
    if "wrong_input" in reply:
        raise InputError(f"{source}: {reply['wrong_input']}")
    if "missing_library" in reply:
        raise MissingLibraryError(
            f"gmsh cannot be loaded: {reply['missing_library']}. Only making meshes needs it. "
            f"Install what it misses with:\n{SYSTEM_LIBRARIES}"
        )
    last = " ".join(reply["broke_down"].strip().splitlines()[-1:])[:300]
    ended = f"gmsh was ended by signal {-code}" if code < 0 else "gmsh broke down"
    raise RunError(f"{source}: {ended} ({last or 'it said nothing'}); try another size, or repair the shape")
