"""One function, three ways to run it, and a cache that never gets in the way."""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest

import rbfem
from rbfem.compute import loops
from rbfem.compute.loops import BACKENDS, loop
from rbfem.fem.moments import sum_blocks

SOURCE_ROOT = Path(rbfem.__file__).parents[1]


@pytest.fixture
def source_copy(tmp_path):
    """A copy of the sources, which the cache is named after, that nobody else edits."""
    copy = tmp_path / "copy"
    shutil.copytree(SOURCE_ROOT / "rbfem", copy / "rbfem", ignore=shutil.ignore_patterns("__pycache__"))
    return copy


def run_python(code, source_root=SOURCE_ROOT, **environment):
    """What a fresh interpreter prints."""
    settings = {**os.environ, "PYTHONPATH": str(source_root), **environment}
    done = subprocess.run([sys.executable, "-c", code], env=settings, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def tets(n=300):
    rng = np.random.default_rng(0)
    return rng.normal(size=(40, 3)), rng.integers(0, 40, size=(n, 4)), rng.uniform(1, 2, n)


def sums_by(backend):
    nodes, corners, density = tets()
    sums = np.zeros((5, 12))
    loop(sum_blocks, backend)(nodes, corners, density, 64, sums)
    return sums


@pytest.mark.parametrize("backend", BACKENDS[1:])
def test_a_kernel_gives_what_python_gives(backend):
    expected = sums_by("python")
    assert np.abs(expected).min() > 0.0
    # Contraction of a * b + c saves a rounding; terms of either sign cancel to a hundredth.
    assert np.abs(sums_by(backend) - expected).max() < 1e-13 * np.abs(expected).max()


def test_python_sees_floats_and_not_numpy_scalars():
    seen = []

    def look(values, index):
        seen.extend([type(values[0, 1]), type(index[0])])

    loop(look, "python")(np.zeros((2, 2)), np.zeros(2, dtype=np.int64))
    assert seen == [float, int]


SERIAL_THEN_PARALLEL = """
import numpy as np
from rbfem.compute.loops import compiled
from rbfem.fem.moments import sum_blocks
rng = np.random.default_rng(0)
arguments = rng.normal(size=(40, 3)), rng.integers(0, 40, size=(300, 4)), rng.uniform(1, 2, 300), 64
sums = []
for is_parallel in (False, True):
    kernel = compiled(sum_blocks, parallel=is_parallel)
    sums.append(np.zeros((5, 12)))
    kernel(*arguments, sums[-1])
    print(kernel.__name__, sum(kernel.stats.cache_hits.values()))
print(np.abs(sums[0] - sums[1]).max() < 1e-13)
"""


def test_serial_and_parallel_kernels_of_one_function_do_not_share_a_cache_entry(tmp_path, source_copy):
    # numba issue 6845: the second of the two used to be given the code of the first, silently, also from disk.
    for from_disk in (0, 1):
        lines = run_python(SERIAL_THEN_PARALLEL, source_copy, XDG_CACHE_HOME=str(tmp_path / "cache")).splitlines()
        assert lines == [f"sum_blocks {from_disk}", f"sum_blocks_parallel {from_disk}", "True"]
    spreads = {file.name.split("-")[0]: b"numba_parallel_for" in file.read_bytes() for file in tmp_path.rglob("*.nbc")}
    kernels = {name.rpartition(".")[2]: value for name, value in spreads.items() if "sum_blocks" in name}
    assert kernels == {"sum_blocks": False, "sum_blocks_parallel": True}


def test_a_process_that_loads_the_motion_room_is_clear_of_numba():
    code = """
import sys
import rbfem.motion.state, rbfem.fem.mass_properties
from rbfem.compute.loops import clear_of_numba
print("numba" in sys.modules, "scipy" in sys.modules, clear_of_numba())
import numba
print(clear_of_numba())
"""
    assert run_python(code).split() == ["False", "False", "True", "False"]


def test_python_backend_needs_no_numba():
    code = """
import sys
import numpy as np
from rbfem.compute.loops import loop
from rbfem.fem.moments import sum_blocks
sums = np.zeros((1, 12))
loop(sum_blocks, "python")(np.eye(4, 3), np.array([[0, 1, 2, 3]]), np.ones(1), 64, sums)
print(sums[0, 0] != 0.0, "numba" in sys.modules)
"""
    assert run_python(code).split() == ["True", "False"]


@pytest.fixture
def fresh_folder():
    """`_cache_folder` without what it remembers, before and after."""
    loops._cache_folder.cache_clear()
    yield loops._cache_folder
    loops._cache_folder.cache_clear()


def test_the_cache_lies_in_the_users_cache_folder(fresh_folder, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    assert fresh_folder(sum_blocks).parent == tmp_path / "cache" / "rbfem"


@pytest.fixture
def a_file(tmp_path):
    """A path where no folder can be made, not even by root."""
    path = tmp_path / "file"
    path.write_text("not a folder")
    return path


def test_without_a_writable_home_the_cache_is_a_temporary_folder(fresh_folder, a_file, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(a_file))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    folder = fresh_folder(sum_blocks)
    assert folder.is_dir() and tmp_path in folder.parents


def test_without_a_home_at_all_the_cache_is_a_temporary_folder(fresh_folder, tmp_path, monkeypatch):
    def no_home():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(Path, "home", no_home)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    assert tmp_path in fresh_folder(sum_blocks).parents


def test_where_nothing_is_writable_there_is_no_cache(fresh_folder, a_file, monkeypatch):
    def no_place():
        raise FileNotFoundError("No usable temporary directory found")

    monkeypatch.setenv("XDG_CACHE_HOME", str(a_file))
    monkeypatch.setattr(tempfile, "tempdir", str(a_file))
    assert fresh_folder(sum_blocks) is None and not loops.is_cached(sum_blocks, "serial")
    fresh_folder.cache_clear()
    monkeypatch.setattr(tempfile, "gettempdir", no_place)
    assert fresh_folder(sum_blocks) is None


def test_a_kernel_runs_where_nothing_is_writable(a_file):
    code = f"""
import tempfile
import numpy as np
from rbfem.compute.loops import is_cached, loop
from rbfem.fem.moments import sum_blocks
tempfile.tempdir = {str(a_file)!r}
sums = np.zeros((1, 12))
loop(sum_blocks, "serial")(np.eye(4, 3), np.array([[0, 1, 2, 3]]), np.ones(1), 64, sums)
print(sums[0, 0] != 0.0, is_cached(sum_blocks, "serial"))
"""
    assert run_python(code, XDG_CACHE_HOME=str(a_file)).split() == ["True", "False"]


def test_the_cache_says_which_kernels_it_has(tmp_path, source_copy):
    ask = """
from rbfem.compute.loops import is_cached
from rbfem.fem.moments import sum_blocks
print(is_cached(sum_blocks, "serial"), is_cached(sum_blocks, "parallel"))
"""
    compile_one = """
from rbfem.compute.loops import compiled
from rbfem.fem.moments import sum_blocks
import numpy as np
kernel = compiled(sum_blocks, parallel={})
kernel(np.eye(4, 3), np.array([[0, 1, 2, 3]]), np.ones(1), 64, np.zeros((1, 12)))
"""
    answers = []
    for code in (ask, compile_one.format(False), ask, compile_one.format(True), ask):
        answers.append(run_python(code, source_copy, XDG_CACHE_HOME=str(tmp_path / "cache")))
    assert answers[::2] == ["False False", "True False", "True True"]


ASK_FOLDERS = """
from rbfem.compute.loops import _cache_folder
from rbfem.fem.moments import sum_blocks
from rbfem.motion.runge_kutta import step_by_runge_kutta
print(_cache_folder(sum_blocks).name, _cache_folder(step_by_runge_kutta).name)
"""


def test_another_source_has_another_cache_folder(tmp_path, source_copy):
    """A leaf and a file of constants in the room of a loop count; the room of another loop does not."""

    def names():
        return run_python(ASK_FOLDERS, source_copy, XDG_CACHE_HOME=str(tmp_path / "cache")).split()

    moments, steps = names()
    assert names() == [moments, steps]
    for file in ("rotation.py", "model.py"):
        changed = source_copy / "rbfem" / "motion" / file
        changed.write_text(changed.read_text() + "\n")
        before, (unchanged, steps) = steps, names()
        assert unchanged == moments and steps != before


def test_checked_bounds_have_a_cache_of_their_own(tmp_path, source_copy):
    names = [
        run_python(ASK_FOLDERS, source_copy, XDG_CACHE_HOME=str(tmp_path / "cache"), NUMBA_BOUNDSCHECK=checks)
        for checks in ("0", "1", "0")
    ]
    assert names[0] == names[2] != names[1]


def test_parallel_kernels_may_be_called_from_two_python_threads():
    # One of numba's threading layers aborts the process when two threads are inside; a lock keeps them apart.
    code = """
import threading
import numba
numba.config.THREADING_LAYER = "workqueue"
import numpy as np
from rbfem.compute.loops import loop
from rbfem.fem.moments import sum_blocks
rng = np.random.default_rng(0)
arguments = rng.normal(size=(40, 3)), rng.integers(0, 40, size=(20000, 4)), rng.uniform(1, 2, 20000), 64
run = loop(sum_blocks, "parallel")
results = [np.zeros((313, 12)) for _ in range(4)]
def repeat(sums):
    for _ in range(50):
        run(*arguments, sums)
threads = [threading.Thread(target=repeat, args=(sums,)) for sums in results]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
print(all((sums == results[0]).all() for sums in results), numba.threading_layer())
"""
    assert run_python(code).split() == ["True", "workqueue"]
