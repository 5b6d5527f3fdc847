"""What is written is what was computed, wherever the run ends."""

import ast
import dataclasses
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from toy_scene import block_part, corner_part, make_frame, make_scene
from vtkmodules.util.numpy_support import vtk_to_numpy

from rbfem.errors import InputError
from rbfem.mesh.tet_mesh import TetMesh
from rbfem.motion.quaternion import rotate
from rbfem.results.reading import find_series, read_pvd, read_vtu
from rbfem.results.series import SeriesWriter
from rbfem.results.vtu import RESOLUTION


def write_series(scene, directory, n_frames, **frame_options):
    with SeriesWriter(scene, directory) as series:
        for i in range(n_frames):
            series.write(make_frame(scene, i, **frame_options))
    return find_series(directory)


def points(grid):
    return vtk_to_numpy(grid.GetPoints().GetData())


def array(data, name):
    return vtk_to_numpy(data.GetArray(name))


def expected_points(scene, frame):
    """Body after body, corners first, by the formula x + R(q) p."""
    shapes = [scene.parts[part].points for part in scene.part_of]
    pairs = zip(frame.position, frame.quaternion, shapes, strict=True)
    return np.concatenate([x + rotate(q, p) for x, q, p in pairs])


def test_points_follow_their_bodies(scene, tmp_path):
    series = write_series(scene, tmp_path, 4)
    for i, path in enumerate(series.parts):
        found, expected = points(read_vtu(path)), expected_points(scene, make_frame(scene, i))
        assert found.dtype == np.float32
        np.testing.assert_allclose(found, expected, atol=4 * np.finfo(np.float32).eps * np.abs(expected).max())


def test_velocity_of_a_point_is_that_of_the_centre_and_of_the_spin(scene, tmp_path):
    frame = dataclasses.replace(make_frame(scene, 0), angular_velocity=np.array([[1, 2, 3], [0, -5, 1], [2, 0, 0.5]]))
    with SeriesWriter(scene, tmp_path) as series:
        series.write(frame)
    grid = read_vtu(tmp_path / "frames/toy_000000.vtu")
    body = np.repeat([0, 1, 2], [4, 4, 8])
    arm = expected_points(scene, frame) - frame.position[body]
    expected = frame.velocity[body] + np.cross(frame.angular_velocity[body], arm)
    np.testing.assert_allclose(array(grid.GetPointData(), "velocity"), expected, atol=1e-5)


def test_velocity_is_left_out_unless_asked_for(tmp_path):
    series = write_series(make_scene(fields=()), tmp_path, 1)
    assert read_vtu(series.parts[0]).GetPointData().GetArray("velocity") is None


def test_cells_know_their_body_their_material_and_the_names_of_both(scene, tmp_path):
    grid = read_vtu(write_series(scene, tmp_path, 1).parts[0])
    assert array(grid.GetCellData(), "body").tolist() == [0] * 4 + [1] * 4 + [2] * 12
    assert array(grid.GetCellData(), "material").tolist() == [0] * 8 + [1] * 12
    names = {name: grid.GetFieldData().GetAbstractArray(name) for name in ("body_names", "material_names")}
    found = {name: [words.GetValue(i) for i in range(words.GetNumberOfValues())] for name, words in names.items()}
    assert found == {"body_names": ["body.00", "body.01", "body.02"], "material_names": ["brass", "oak & glue"]}


def test_parts_may_be_interleaved_among_the_bodies(scene, tmp_path):
    mixed = dataclasses.replace(scene, part_of=np.array([0, 1, 0]))
    grid = read_vtu(write_series(mixed, tmp_path, 1).parts[0])
    body, cells = array(grid.GetCellData(), "body"), grid.GetCells()
    middle = points(grid)[vtk_to_numpy(cells.GetConnectivityArray()).reshape(-1, 3)].mean(axis=1)
    assert np.abs(middle[:, 0] - 2.0 * body).max() < 0.6
    assert np.bincount(body).tolist() == [4, 12, 4]


def test_every_triangle_points_out_of_its_body(scene, tmp_path):
    grid = read_vtu(write_series(scene, tmp_path, 4).parts[3])
    corners = points(grid)[vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 3)]
    center = make_frame(scene, 3).position[array(grid.GetCellData(), "body")]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("ij,ij->i", normal, corners.mean(axis=1) - center) > 0).all()


def test_times_are_those_of_the_frames_to_the_last_bit(scene, tmp_path):
    series = write_series(scene, tmp_path, 8)
    assert series.times == tuple(i * (1 / 30) for i in range(8))
    for time, *paths in zip(series.times, series.parts, series.bodies, strict=True):
        for path in paths:
            assert array(read_vtu(path).GetFieldData(), "TimeValue").tolist() == [time]


def test_density_brings_the_tets_of_meshes_and_leaves_primitives_surfaces(tmp_path):
    grid = read_vtu(write_series(make_scene(fields=["density"]), tmp_path, 1).parts[0])
    types = [grid.GetCellType(i) for i in range(grid.GetNumberOfCells())]
    assert types == [10, 10] + [5] * 12
    np.testing.assert_allclose(array(grid.GetCellData(), "density"), [6, 6] + [100] * 12, rtol=1e-6)
    np.testing.assert_allclose(points(grid)[:4], corner_part().points, atol=1e-7)


def test_tets_of_second_order_stay_so(tmp_path):
    corners = corner_part().mesh.nodes
    edges = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]
    nodes = np.concatenate([corners, [corners[list(edge)].mean(axis=0) for edge in edges]])
    part = dataclasses.replace(corner_part(), mesh=TetMesh(nodes=nodes, tets=np.arange(10)[None]))
    scene = make_scene(parts=(part, block_part()), fields=["density"])
    grid = read_vtu(write_series(scene, tmp_path, 1).parts[0])
    assert grid.GetCellType(0) == 24
    np.testing.assert_allclose(points(grid)[:10], nodes - 0.25, atol=1e-7)


@pytest.mark.parametrize(("distance", "dtype"), [(10.0, np.float32), (1e6, np.float64)])
def test_double_precision_is_used_exactly_where_single_would_blur_the_body(scene, tmp_path, distance, dtype):
    series = write_series(scene, tmp_path, 2, centre=(0.0, distance, 0.0))
    found = points(read_vtu(series.parts[1]))
    expected = expected_points(scene, make_frame(scene, 1, centre=(0.0, distance, 0.0)))
    assert found.dtype == dtype
    assert np.abs(found - expected).max() < RESOLUTION * min(part.bounding_radius for part in scene.parts)


def test_a_series_that_leaves_single_precision_is_right_on_both_sides(scene, tmp_path):
    frames = [make_frame(scene, i, centre=(0.0, 10.0 ** (3 * i), 0.0)) for i in range(3)]
    with SeriesWriter(scene, tmp_path) as series:
        for frame in frames:
            series.write(frame)
    for frame, path in zip(frames, find_series(tmp_path).parts, strict=True):
        np.testing.assert_allclose(points(read_vtu(path)), expected_points(scene, frame), atol=RESOLUTION * 0.3)


def test_the_bodies_carry_their_state(scene, tmp_path):
    grid, frame = read_vtu(write_series(scene, tmp_path, 4).bodies[3]), make_frame(scene, 3)
    data = grid.GetPointData()
    assert points(grid).tolist() == frame.position.tolist()
    for name in ("quaternion", "velocity", "angular_velocity", "kinetic_energy"):
        assert array(data, name).tolist() == getattr(frame, name).tolist()
    assert [data.GetArray("quaternion").GetComponentName(i) for i in range(4)] == list("wxyz")
    assert array(data, "body").tolist() == [0, 1, 2]
    assert array(data, "mass").tolist() == [1.0, 1.0, 4.8]
    assert array(data, "radius").tolist() == [scene.parts[i].bounding_radius for i in (0, 0, 1)]
    assert {grid.GetCellType(i) for i in range(grid.GetNumberOfCells())} == {1}


def test_an_interrupted_run_keeps_its_frames_and_passes_the_interrupt_on(scene, tmp_path):
    with pytest.raises(KeyboardInterrupt):
        write_until_interrupted(scene, tmp_path)
    assert len(find_series(tmp_path).times) == 5


def write_until_interrupted(scene, directory):
    with SeriesWriter(scene, directory) as series:
        for i in range(5):
            series.write(make_frame(scene, i))
        raise KeyboardInterrupt


def test_an_earlier_run_never_mixes_with_the_new_one(scene, tmp_path):
    write_series(scene, tmp_path, 5)
    (tmp_path / "frames/.toy_000007.part.vtu").write_text("left by a killed run")
    (tmp_path / "report.json").write_text("{}")
    keep = ["notes.txt", "toy.png", "frames/toy_top.vtu", "frames/toys_000001.vtu", "frames/nut_000001.vtu"]
    for name in keep:
        (tmp_path / name).write_text("not ours")
    write_series(scene, tmp_path, 2)
    found = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()}
    frames = {f"frames/toy{kind}_00000{i}.vtu" for kind in ("", "_bodies") for i in (0, 1)}
    assert found == {*keep, *frames, "toy.pvd", "toy_bodies.pvd", "toy.csv"}


@pytest.mark.parametrize("blocked", ["results", "results/frames", "results/toy.pvd/folder"])
def test_a_folder_that_cannot_be_used_is_found_before_the_run(scene, tmp_path, blocked):
    path = tmp_path / blocked
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("in the way")
    with pytest.raises(InputError, match=r"results.*: .*choose another"):
        SeriesWriter(scene, tmp_path / "results")


def test_a_folder_of_the_system_is_refused(scene):
    with pytest.raises(InputError, match=r"/proc/rbfem: results cannot be written to this folder: .*choose another"):
        SeriesWriter(scene, Path("/proc/rbfem"))


def test_paraview_reads_times_bounds_and_names(scene, tmp_path):
    if shutil.which("pvbatch") is None:
        pytest.skip("pvbatch is not installed: apt-get install paraview")
    write_series(scene, tmp_path, 5)
    script = tmp_path / "look.py"
    script.write_text(
        "import sys\n"
        "from paraview.simple import PVDReader, UpdatePipeline\n"
        "from paraview.servermanager import Fetch\n"
        "for path in sys.argv[1:]:\n"
        "    reader = PVDReader(FileName=path)\n"
        "    times = list(reader.TimestepValues)\n"
        "    UpdatePipeline(time=times[-1], proxy=reader)\n"
        "    names = Fetch(reader).GetFieldData().GetAbstractArray('body_names')\n"
        "    print('FOUND', repr((times, reader.GetDataInformation().GetBounds(),\n"
        "        sorted(reader.PointData.keys()), names and names.GetValue(2))))\n"
    )
    paths = [str(tmp_path / f"{name}.pvd") for name in ("toy", "toy_bodies")]
    done = subprocess.run(["pvbatch", str(script), *paths], capture_output=True, text=True, timeout=120, check=False)
    if "No module named 'paraview'" in done.stderr:
        pytest.skip("pvbatch has no Python modules: apt-get install python3-paraview")
    parts, bodies = (ast.literal_eval(line) for line in re.findall("FOUND (.*)", done.stdout))
    frame = make_frame(scene, 4)
    assert parts[0] == bodies[0] == [i * (1 / 30) for i in range(5)]
    expected = expected_points(scene, frame)
    box = np.column_stack([expected.min(axis=0), expected.max(axis=0)]).ravel()
    np.testing.assert_allclose(parts[1], box, atol=1e-6)
    assert parts[2:] == (["velocity"], "body.02")
    assert bodies[2] == sorted(
        ["quaternion", "velocity", "angular_velocity", "kinetic_energy", "body", "mass", "radius"]
    )


def test_writing_needs_no_library_for_drawing_or_meshes():
    heavy = ("pyvista", "matplotlib", "meshio", "vtk")
    code = f"import sys, rbfem.results.series; print([name for name in {heavy} if name in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"


def test_a_pvd_lists_its_frames_in_order(scene, tmp_path):
    write_series(scene, tmp_path, 12)
    times, paths = read_pvd(tmp_path / "toy.pvd")
    assert [path.name for path in paths] == [f"toy_{i:06d}.vtu" for i in range(12)]
    assert list(times) == sorted(times)
