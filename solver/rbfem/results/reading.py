"""A written series read back: its times, and a frame of it."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from rbfem.errors import InputError

END_OF_VTU = b"</VTKFile>\n"


@dataclass(frozen=True)
class Series:
    """The results of one case: times [s] and the files of the parts and of the bodies at each, in the order of time."""

    name: str
    times: tuple[float, ...]
    parts: tuple[Path, ...]
    bodies: tuple[Path, ...]

    def nearest(self, time: float) -> int:
        """Index of the frame whose time is closest to `time`."""
        return min(range(len(self.times)), key=lambda i: abs(self.times[i] - time))


def find_series(directory: Path) -> Series:
    """The series that `rbfem run` wrote to `directory`. Raises InputError unless it is one, of one frame at least."""
    if not directory.is_dir():
        raise InputError(f"{directory}: no such folder; give the folder that `rbfem run` wrote its results to")
    names = [path.stem for path in sorted(directory.glob("*.pvd")) if path.with_stem(f"{path.stem}_bodies").exists()]
    if len(names) != 1:
        found = f"those of {', '.join(names)}" if names else "no NAME.pvd with a NAME_bodies.pvd beside it"
        raise InputError(
            f"{directory}: expected the results of one case, found {found}; run each case into its own folder"
        )
    times, parts = read_pvd(directory / f"{names[0]}.pvd")
    body_times, bodies = read_pvd(directory / f"{names[0]}_bodies.pvd")
    # Of a run that is going on or was killed, one list may be a few frames ahead of the other.
    n = min(len(times), len(body_times))
    if n == 0:
        raise InputError(f"{directory / names[0]}.pvd: lists no frames; the run ended before its first output")
    return Series(names[0], times[:n], parts[:n], bodies[:n])


def read_pvd(path: Path) -> tuple[tuple[float, ...], tuple[Path, ...]]:
    """Times and files of a .pvd collection. Raises InputError if it is not one."""
    try:
        entries = ElementTree.parse(path).getroot().findall("./Collection/DataSet")
        times = tuple(float(entry.attrib["timestep"]) for entry in entries)
        return times, tuple(path.parent / entry.attrib["file"] for entry in entries)
    except (OSError, ElementTree.ParseError, KeyError, ValueError) as error:
        raise InputError(
            f"{path}: cannot be read as a ParaView collection (.pvd): {error}; run the case again"
        ) from error


def read_vtu(path: Path) -> Any:
    """A .vtu as a vtkUnstructuredGrid. Raises InputError if it is missing, foreign or cut off."""
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader = vtkXMLUnstructuredGridReader()
    if not path.is_file() or not reader.CanReadFile(str(path)):
        raise InputError(f"{path}: is missing or not a .vtu file; run the case again")
    if not is_complete(path):
        raise InputError(f"{path}: its end is missing; run the case again")
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def is_complete(path: Path) -> bool:
    """Does the file end as VTK's XML files do? One that was cut off does not."""
    with path.open("rb") as file:
        file.seek(-min(len(END_OF_VTU), path.stat().st_size), os.SEEK_END)
        return file.read() == END_OF_VTU
