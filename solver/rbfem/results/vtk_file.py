"""What the series of surfaces and the series of bodies share: arrays handed to VTK, a grid written by VTK's writer."""

import errno
import importlib
import os
import signal
import threading
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rbfem.results.whole_file import whole_file

# VTK reports the system's errno as it is, and its own errors from 20000 on; this one says that the disk is full.
VTK_FIRST_OWN_ERROR = 20000
VTK_OUT_OF_DISK_SPACE = 20007

# Bytes that VTK's writer hands to the system at once. Its own 32 KiB make a frame of 9 MB take half as long again; the
# file is the same, since raw data that is not compressed is not cut into blocks.
BLOCK_SIZE = 1 << 20


def load_vtk() -> None:
    """Import what the frames need of VTK, with Ctrl-C held back: a library interrupted as it loads may crash."""
    if threading.current_thread() is not threading.main_thread():
        return  # only the main thread is ever interrupted, and only it may say what an interrupt does
    interrupts: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, frame: interrupts.append(number))
    try:
        for module in ("util.numpy_support", "vtkCommonDataModel", "vtkIOXML"):
            importlib.import_module(f"vtkmodules.{module}")
    finally:
        signal.signal(signal.SIGINT, before)
    if interrupts:
        raise KeyboardInterrupt


def named_array(name: str, values: NDArray, components: tuple[str, ...] = ()) -> Any:
    """A VTK array on the memory of `values` (C order, kept alive by VTK): renew `values`, then call `Modified()`."""
    from vtkmodules.util.numpy_support import numpy_to_vtk

    array = numpy_to_vtk(values)
    array.SetName(name)
    for i, component in enumerate(components):
        array.SetComponentName(i, component)
    return array


def name_list(name: str, words: Iterable[str]) -> Any:
    """A VTK array of strings."""
    from vtkmodules.vtkCommonCore import vtkStringArray

    array = vtkStringArray()
    array.SetName(name)
    for word in words:
        array.InsertNextValue(word)
    return array


def grid_of_cells(connectivity: NDArray, sizes: NDArray, types: NDArray) -> Any:
    """A vtkUnstructuredGrid of cells without points.

    connectivity : node indices of all cells, one after the other
    sizes, types : (n_cells,) nodes of each cell, and its VTK type
    """
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkUnstructuredGrid

    index = np.int32 if connectivity.size < 2**31 else np.int64
    offsets = np.concatenate([[0], np.cumsum(sizes)]).astype(index)
    cells = vtkCellArray()
    cells.SetData(named_array("offsets", offsets), named_array("connectivity", connectivity.astype(index)))
    grid = vtkUnstructuredGrid()
    grid.SetCells(named_array("types", types.astype(np.uint8)), cells)
    return grid


def set_points(grid: Any, coordinates: NDArray) -> None:
    """Let `grid` have its points on the memory of `coordinates`, (n, 3)."""
    from vtkmodules.vtkCommonCore import vtkPoints

    points = vtkPoints()
    points.SetData(named_array("Points", coordinates))
    grid.SetPoints(points)


def write_grid(grid: Any, path: Path) -> None:
    """Write a vtkUnstructuredGrid as .vtu: appended, raw, not compressed (the quickest to write and to read).

    Raises RunError when the file did not come out whole; VTK's writer notices even a last byte that finds no space.
    """
    with whole_file(path) as temporary:
        _run_writer(_raw_writer(grid, temporary))


def _raw_writer(grid: Any, path: Path) -> Any:
    """A new writer for each file: one that has failed once is not to be trusted again."""
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressorTypeToNone()
    writer.SetHeaderTypeToUInt64()
    writer.SetBlockSize(BLOCK_SIZE)
    return writer


def _run_writer(writer: Any) -> None:
    # An observer keeps VTK from printing the error; it is raised instead.
    for source in (writer, writer.GetExecutive()):
        source.AddObserver("ErrorEvent", lambda *_: None)
    if writer.Write() and not writer.GetErrorCode():
        return
    code = writer.GetErrorCode()
    if code == VTK_OUT_OF_DISK_SPACE:
        code = errno.ENOSPC
    if 0 < code < VTK_FIRST_OWN_ERROR:
        raise OSError(code, os.strerror(code))
    raise OSError(errno.EIO, f"VTK's writer failed with its error {code}")
