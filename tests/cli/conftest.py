"""The command line as a user meets it: another process."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SOURCES = str(Path(__file__).parents[2] / "solver")


@pytest.fixture
def command():
    """The words and the environment that start `python -m rbfem`."""

    def words(*arguments, flags=()):
        return [sys.executable, *flags, "-m", "rbfem", *map(str, arguments)], os.environ | {
            "PYTHONPATH": SOURCES + os.pathsep + os.environ.get("PYTHONPATH", "")
        }

    return words


@pytest.fixture
def rbfem(command):
    """Run `python -m rbfem …`; returns the finished process with text in stdout and stderr."""

    def run(*arguments, flags=(), **options):
        line, environment = command(*arguments, flags=flags)
        options = {"capture_output": True, "text": True, "env": environment, "timeout": 100} | options
        return subprocess.run(line, check=False, **options)

    return run
