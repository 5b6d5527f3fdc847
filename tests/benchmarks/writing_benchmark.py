"""A frame of a series on disk, against VTK's own raw writer on the very same grid."""

import tempfile
from dataclasses import replace
from itertools import count, cycle
from pathlib import Path

import meshio
from measuring import Effort, Row, in_time, smallest_times
from sheared_block import block_of_tets

import rbfem
from rbfem.results.series import SeriesWriter
from rbfem.results.vtk_file import BLOCK_SIZE
from rbfem.results.vtu import SceneGrid
from rbfem.simulation.frame import Frame

N_BODIES = 100
CELLS = (13, 6, 5)  # 2340 tets a body
SHARE_OF_VTK = 1.3

# `density` is a field of the volume: it makes the tets be written, not only the surface.
CASE = """
rbfem: 1
title: {n} blocks, thrown
seed: 7
shapes:
  block: {{mesh: block.vtu}}
materials:
  stone: {{density: 2650}}
bodies:
  - name: block
    shape: block
    material: stone
    count: {n}
    place: {{in_box: [[-50, -50, -50], [50, 50, 50]], orientation: random}}
    velocity: [0, 0, 5]
    angular_velocity: [1, 2, 3]
gravity: [0, 0, -9.81]
time: {{end: 0.02}}
output: {{every: 0.01, fields: [velocity, density]}}
"""


def writing(effort: Effort) -> list[Row]:
    """All rows of this file."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        scene = thrown_blocks(folder, max(1, round(N_BODIES * effort.share)))
        frames = list(rbfem.simulate(scene, rbfem.plan(scene)))
        return frame_rows(scene, frames, folder, effort)


def frame_rows(scene: rbfem.Scene, frames: list[Frame], folder: Path, effort: Effort) -> list[Row]:
    """VTK's writer gets its arrays marked as new, as those of every frame are: it looks through them for their range.

    Each frame is a new file, as in a run: to write over an old one takes longer.
    """
    grid, series, coming, index = SceneGrid(scene), SeriesWriter(scene, folder / "series"), cycle(frames), count()
    grid.move_to(frames[0])

    def write_frame():
        grid.move_to(next(coming))
        grid.write(folder / "frame.vtu")

    def write_by_vtk():
        grid._mark_as_new()
        vtk_writer(grid._grid, folder / "vtk.vtu").Write()

    def write_in_large_blocks():
        grid._mark_as_new()
        writer = vtk_writer(grid._grid, folder / "blocks.vtu")
        writer.SetBlockSize(BLOCK_SIZE)
        writer.Write()

    def remove_frames():
        for path in folder.rglob("*.vtu"):
            path.unlink()

    def write_series():
        series.write(replace(next(coming), index=next(index)))

    frame, vtk, large_blocks, whole = smallest_times(
        2 * effort.rounds, write_frame, write_by_vtk, write_in_large_blocks, write_series, between=remove_frames
    )
    series.close()
    n_tets = scene.n_bodies * len(scene.parts[0].tet_material)
    name, reference = f"one frame of {scene.n_bodies} bodies, {n_tets} tets", f"{in_time(vtk)} VTK's writer alone"
    tuned = f"{in_time(large_blocks)} VTK's writer alone, with rbfem's size of blocks"
    moved = f"{name}: moved, written, renamed"
    return [
        Row(moved, in_time(frame), reference, frame / vtk, SHARE_OF_VTK),
        Row(moved, in_time(frame), tuned, frame / large_blocks),
        Row(f"{name}, with the bodies' frame, .pvd and .csv", in_time(whole), reference, whole / vtk),
    ]


def thrown_blocks(folder: Path, n_bodies: int) -> rbfem.Scene:
    mesh = block_of_tets(CELLS)
    meshio.write(folder / "block.vtu", meshio.Mesh(mesh.nodes, [("tetra", mesh.tets)]))
    (folder / "case.yaml").write_text(CASE.format(n=n_bodies))
    return rbfem.load(folder / "case.yaml")


def vtk_writer(grid, path: Path):
    """Appended, raw, not compressed, all else as VTK has it."""
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressorTypeToNone()
    return writer
