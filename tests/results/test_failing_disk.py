"""A run that is killed, or whose disk is full, leaves whole files and says what happened."""

import errno
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from toy_scene import make_frame

from rbfem.errors import RunError
from rbfem.results import whole_file
from rbfem.results.reading import find_series, is_complete, read_pvd, read_vtu
from rbfem.results.series import SeriesWriter

HERE = str(Path(__file__).parent)

ENDLESS = """
import itertools, sys
from pathlib import Path
sys.path.insert(0, sys.argv[2])
from toy_scene import make_frame, make_scene
from rbfem.results.series import SeriesWriter
scene = make_scene(400, 200)
with SeriesWriter(scene, Path(sys.argv[1])) as series:
    for i in itertools.count():
        series.write(make_frame(scene, i))
"""

# The limit on the size of a file makes the system refuse a write just as a full disk does.
SMALL_DISK = """
import resource, sys
from pathlib import Path
sys.path.insert(0, sys.argv[2])
from toy_scene import make_frame, make_scene
from rbfem.errors import RunError
from rbfem.results.series import SeriesWriter
scene = make_scene(400, 200)
try:
    with SeriesWriter(scene, Path(sys.argv[1])) as series:
        for i in range(3):
            series.write(make_frame(scene, i))
        whole = Path(sys.argv[1], "frames/toy_000000.vtu").stat().st_size
        resource.setrlimit(resource.RLIMIT_FSIZE, (whole - int(sys.argv[3]), resource.RLIM_INFINITY))
        series.write(make_frame(scene, 3))
except RunError as error:
    print(error)
"""


def run_script(script, *arguments):
    return subprocess.run(
        [sys.executable, "-c", script, *map(str, arguments)], capture_output=True, text=True, timeout=60, check=False
    )


def half_written(directory):
    return [path.name for path in directory.rglob("*") if ".part" in path.name]


@pytest.mark.parametrize("delay", [0.0, 0.013, 0.05, 0.171])
def test_every_file_a_killed_run_lists_is_whole(tmp_path, delay):
    run = subprocess.Popen([sys.executable, "-c", ENDLESS, str(tmp_path), HERE])
    give_up = time.monotonic() + 30
    while not (tmp_path / "toy_bodies.pvd").exists() and run.poll() is None and time.monotonic() < give_up:
        time.sleep(0.001)
    time.sleep(delay)
    run.kill()
    assert run.wait() == -signal.SIGKILL
    for name in ("toy.pvd", "toy_bodies.pvd"):
        times, paths = read_pvd(tmp_path / name)
        assert len(times) >= 1
        assert all(read_vtu(path).GetNumberOfPoints() > 0 for path in paths)
    found = [path for path in (tmp_path / "frames").glob("[!.]*.vtu")]
    assert all(is_complete(path) for path in found)


# Bytes that find no space at the end of the file: also when only the writer's last buffer is lost.
@pytest.mark.parametrize("missing", [100_000, 50_000, 500, 1])
def test_a_full_disk_ends_the_run_in_words_and_leaves_what_was_written(tmp_path, missing):
    done = run_script(SMALL_DISK, tmp_path, HERE, missing)
    assert "toy_000003.vtu: could not be written" in done.stdout
    assert done.stderr == ""
    assert done.returncode == 0
    series = find_series(tmp_path)
    assert len(series.times) == 3
    assert all(read_vtu(path).GetNumberOfPoints() > 0 for path in (*series.parts, *series.bodies))
    assert half_written(tmp_path) == []
    assert not (tmp_path / "frames/toy_000003.vtu").exists()


def test_a_device_without_space_is_named(scene, tmp_path, monkeypatch):
    if not Path("/dev/full").exists():
        pytest.skip("/dev/full is a device of Linux")
    with SeriesWriter(scene, tmp_path) as series:
        series.write(make_frame(scene, 0))
        with monkeypatch.context() as full:
            full.setattr(whole_file, "temporary_path", lambda path: full_device(path))
            with pytest.raises(RunError, match=r"toy_000001.vtu: could not be written: no space left on device"):
                series.write(make_frame(scene, 1))
    assert len(find_series(tmp_path).times) == 1


def full_device(path):
    """A name in the folder of `path` behind which no byte finds space."""
    link = path.with_name(".full.part")
    link.symlink_to("/dev/full")
    return link


def test_a_folder_that_vanishes_in_the_run_is_named(scene, tmp_path):
    series = SeriesWriter(scene, tmp_path / "out")
    series.write(make_frame(scene, 0))
    os.rename(tmp_path / "out", tmp_path / "moved")
    with pytest.raises(RunError, match=r"toy_000001.vtu: could not be written: no such file"):
        series.write(make_frame(scene, 1))
    assert len(find_series(tmp_path / "moved").times) == 1


def write_half(path):
    with whole_file.whole_file(path) as part:
        part.write_text("ne")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_text_is_replaced_whole_or_not_at_all(tmp_path):
    path = tmp_path / "report.json"
    whole_file.write_text(path, "old")
    with pytest.raises(RunError, match=r"report.json: could not be written: no space"):
        write_half(path)
    assert path.read_text() == "old"
    assert half_written(tmp_path) == []
