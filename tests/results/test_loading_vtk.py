"""Ctrl-C while VTK loads waits until it is loaded, and then counts."""

import subprocess
import sys

CODE = """
import importlib, os, signal, sys
from rbfem.results import vtk_file
plain = importlib.import_module
def interrupted(name):
    os.kill(os.getpid(), signal.SIGINT)
    return plain(name)
vtk_file.importlib.import_module = interrupted
try:
    vtk_file.load_vtk()
except KeyboardInterrupt:
    loaded = "vtkmodules.vtkIOXML" in sys.modules
    print("interrupted", loaded, signal.getsignal(signal.SIGINT) is signal.default_int_handler)
"""


def test_an_interrupt_waits_until_vtk_is_loaded_and_is_then_passed_on():
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["interrupted", "True", "True"]
