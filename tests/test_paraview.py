"""The promise of the main job: a long series of many bodies opens in ParaView, with the right times and bounds."""

import ast
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import rbfem
from rbfem.motion import quaternion
from rbfem.results.series import SeriesWriter

ROCKS = Path(__file__).parents[1] / "cases" / "thrown_rocks"
N_FRAMES, LOOKED_AT = 200, (0, 99, 199)
LOOK = """
import sys
from paraview.simple import PVDReader, UpdatePipeline
reader = PVDReader(FileName=sys.argv[1])
times = list(reader.TimestepValues)
bounds = []
for index in {frames}:
    UpdatePipeline(time=times[index], proxy=reader)
    bounds.append(reader.GetDataInformation().GetBounds())
print("FOUND", repr((times, bounds)))
"""


def bounds(scene, frame):
    """x_min, x_max, y_min, … over the points of all bodies, x + R(q) p."""
    shapes = [scene.parts[part].points for part in scene.part_of]
    placed = [x + quaternion.rotate(q, p) for x, q, p in zip(frame.position, frame.quaternion, shapes, strict=True)]
    points = np.concatenate(placed)
    return np.column_stack([points.min(axis=0), points.max(axis=0)]).ravel()


def test_a_hundred_bodies_in_two_hundred_frames_open_in_paraview_with_their_times_and_bounds(tmp_path):
    if shutil.which("pvbatch") is None:
        pytest.skip("pvbatch is not installed: apt-get install paraview python3-paraview")
    scene = rbfem.load(ROCKS, [f"output.every={1.2 / (N_FRAMES - 1)!r}"])
    expected = {}
    with SeriesWriter(scene, tmp_path) as series:
        for frame in rbfem.simulate(scene, rbfem.plan(scene)):
            series.write(frame)
            if frame.index in LOOKED_AT:
                expected[frame.index] = bounds(scene, frame)
    script = tmp_path / "look.py"
    script.write_text(LOOK.format(frames=LOOKED_AT))
    command = ["pvbatch", str(script), str(tmp_path / "thrown_rocks.pvd")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    if "No module named 'paraview'" in done.stderr:
        pytest.skip("pvbatch has no Python modules: apt-get install python3-paraview")
    found = re.search("FOUND (.*)", done.stdout)
    assert found, done.stdout + done.stderr
    times, found_bounds = ast.literal_eval(found[1])
    np.testing.assert_allclose(times, np.linspace(0.0, 1.2, N_FRAMES), rtol=0, atol=1e-12)
    for index, box in zip(LOOKED_AT, found_bounds, strict=True):
        np.testing.assert_allclose(box, expected[index], rtol=0, atol=1e-6)  # float32 points, metres
