"""What a person waits for at the prompt: whole processes of the command line."""

import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from measuring import Effort, Row, in_time, smallest_times

T_HANDLE = Path(__file__).parents[2] / "cases" / "t_handle"
SECONDS_FOR_HELP = 0.15
SECONDS_FOR_T_HANDLE = 2.0


def start_up(effort: Effort) -> list[Row]:
    """All rows of this file."""
    return [help_row(effort), numpy_row(), t_handle_row(effort)]


def help_row(effort: Effort) -> Row:
    (seconds,) = smallest_times(effort.rounds, process("-m", "rbfem", "--help"))
    limit = f"{in_time(SECONDS_FOR_HELP)} allowed"
    return Row("`rbfem --help`, whole process", in_time(seconds), limit, seconds / SECONDS_FOR_HELP, 1.0)


def numpy_row() -> Row:
    listing = process("-X", "importtime", "-m", "rbfem", "--help")().stderr
    modules = [line.rpartition("|")[2].strip() for line in listing.splitlines() if line.startswith("import time:")]
    of_numpy = [name for name in modules if name.partition(".")[0] == "numpy"]
    share = len(of_numpy) / len(modules)
    return Row("modules of NumPy that it imports", str(len(of_numpy)), f"{len(modules)} modules in all", share, 0.0)


def t_handle_row(effort: Effort) -> Row:
    """The second run and later ones: what the first one compiled is on disk."""
    name = "`rbfem run cases/t_handle`, second time, whole process"
    if not (T_HANDLE / "case.yaml").is_file():
        return Row(name, "", asked=1.0, skipped="cases/t_handle is not there")
    with tempfile.TemporaryDirectory() as folder:
        run = process("-m", "rbfem", "run", str(T_HANDLE), "-o", folder)
        (seconds,) = smallest_times(min(effort.rounds, 5), run)
    limit = f"{in_time(SECONDS_FOR_T_HANDLE)} allowed"
    return Row(name, in_time(seconds), limit, seconds / SECONDS_FOR_T_HANDLE, 1.0)


def process(*arguments: str) -> Callable[[], subprocess.CompletedProcess]:
    return lambda: subprocess.run([sys.executable, *arguments], check=True, capture_output=True, text=True)
