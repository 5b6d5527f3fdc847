"""Mass properties of a tet mesh in memory: time, error and memory, and trimesh on surfaces of the same body."""

import tracemalloc
from collections.abc import Callable

import numpy as np
from measuring import Effort, Row, in_time, missing, peer, smallest_times
from numpy.typing import NDArray
from sheared_block import Surface, block_of_tets, block_surface, cells_for, exact_tensor

import rbfem
from rbfem.mesh.surface import boundary_triangles
from rbfem.mesh.tet_mesh import TetMesh

N_TETS = 1e6
DENSITY = 2650.0
NANOSECONDS_A_TET = 40.0  # on one core
SHARE_OF_TRIMESH = 1.0 / 50.0  # of its time on a surface of as many triangles
LARGEST_ERROR = 1e-14  # relative, of the tensor
LARGEST_MEMORY = 3.0  # times the mesh, the mesh included
FAR = (1e2, 1e6)  # shifts in sizes of the body, which is about 1 m large


def inertia(effort: Effort) -> list[Row]:
    """All rows of this file."""
    mesh = block_of_tets(cells_for(N_TETS * effort.share))
    return [*time_rows(mesh, effort), *error_rows(effort), *memory_rows(effort)]


def time_rows(mesh: TetMesh, effort: Effort) -> list[Row]:
    """On one core; trimesh from arrays to `mass_properties`, without its cleaning of the mesh."""
    n = mesh.n_tets
    many = block_surface(max(1, round((n / 12.0) ** 0.5)))
    own = Surface(mesh.nodes, boundary_triangles(mesh))
    far = block_of_tets(cells_for(n), FAR[0])
    tasks: list[Callable] = [lambda: integrate(mesh, "serial"), lambda: integrate(mesh, "numpy")]
    tasks.append(lambda: integrate(far, "serial"))
    if peer("trimesh"):
        tasks += [lambda: integrate_by_trimesh(many), lambda: integrate_by_trimesh(own)]
    serial, in_numpy, far_away, *theirs = smallest_times(min(effort.rounds, 7), *tasks)
    limit, a_tet = NANOSECONDS_A_TET * 1e-9, f"inertia of {n} tets, one core"
    compiled = f"{in_time(serial / n)} compiled"
    return [
        Row(f"{a_tet}, compiled", f"{in_time(serial / n)} a tet", f"{in_time(limit)} allowed", serial / n / limit, 1.0),
        Row(f"{a_tet}, NumPy", f"{in_time(in_numpy / n)} a tet", compiled, in_numpy / serial),
        Row(f"{a_tet}, moved by {FAR[0]:g} sizes", f"{in_time(far_away / n)} a tet", compiled, far_away / serial),
        trimesh_row(f"inertia of {n} tets", serial, many, theirs[:1], SHARE_OF_TRIMESH),
        trimesh_row(f"inertia of {n} tets", serial, own, theirs[1:], None),
    ]


def trimesh_row(task: str, ours: float, surface: Surface, theirs: list[float], asked: float | None) -> Row:
    name = f"{task} against trimesh on {len(surface.triangles)} triangles of a like body"
    if not theirs:
        return Row(name, in_time(ours), asked=asked, skipped=missing("trimesh"))
    return Row(name, in_time(ours), f"{in_time(theirs[0])} trimesh", ours / theirs[0], asked)


def error_rows(effort: Effort) -> list[Row]:
    """Relative error of the tensor against the closed form, where the body is and far from the origin."""
    cells = cells_for(N_TETS * effort.share)
    per_edge = max(1, round(cells[0] / 2**0.5))
    rows = []
    for shift in (0.0, *FAR):
        body = integrate(block_of_tets(cells, shift), "serial")
        ours, printed = relative_error(body.inertia), body.rounding_error
        where = f"error of the tensor, moved by {shift:g} sizes" if shift else "error of the tensor"
        limit, kind = (printed, "predicted by rbfem") if shift else (LARGEST_ERROR, "allowed")
        rows.append(Row(where, f"{ours:.1e}", f"{limit:.1e} {kind}", ours / limit, 1.0))
        rows.append(trimesh_error_row(where, ours, block_surface(per_edge, shift)))
    return rows


def trimesh_error_row(where: str, ours: float, surface: Surface) -> Row:
    name = f"{where}, against trimesh"
    if not peer("trimesh"):
        return Row(name, f"{ours:.1e}", skipped=missing("trimesh"))
    theirs = relative_error(integrate_by_trimesh(surface).inertia)
    # Either can be exact by luck; below one rounding there is nothing to compare.
    floor = 2.0**-53
    return Row(name, f"{ours:.1e}", f"{theirs:.1e} trimesh", max(ours, floor) / max(theirs, floor))


def memory_rows(effort: Effort) -> list[Row]:
    """Peak of the call, the mesh included, as NumPy's allocations are traced; also where the body is far away."""
    rows = []
    for shift, backend, name in ((0.0, "serial", "compiled"), (0.0, "numpy", "NumPy"), (FAR[0], "serial", "far away")):
        mesh = block_of_tets(cells_for(N_TETS * effort.share), shift)
        size = mesh.nodes.nbytes + mesh.tets.nbytes
        tracemalloc.start()
        integrate(mesh, backend)
        peak = size + tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        name, reference = f"memory for {mesh.n_tets} tets, {name}", f"{size / 1e6:.3g} MB mesh"
        rows.append(Row(name, f"{peak / 1e6:.3g} MB", reference, peak / size, LARGEST_MEMORY))
    return rows


def integrate(mesh: TetMesh, backend: str) -> rbfem.MassProperties:
    return rbfem.mass_properties(mesh, DENSITY, backend=backend)


def integrate_by_trimesh(surface: Surface):
    from trimesh import Trimesh

    mesh = Trimesh(surface.points, surface.triangles, process=False)
    mesh.density = DENSITY
    return mesh.mass_properties


def relative_error(tensor: NDArray[np.float64]) -> float:
    exact = exact_tensor(DENSITY)
    return float(np.linalg.norm(tensor - exact) / np.linalg.norm(exact))
