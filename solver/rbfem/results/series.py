"""The time series of a run, readable at every instant: NAME.pvd, NAME_bodies.pvd, NAME.csv and their frames."""

import re
from pathlib import Path
from types import TracebackType
from typing import Self
from xml.sax.saxutils import quoteattr

from rbfem.errors import InputError, RunError
from rbfem.results.bodies import BodiesGrid
from rbfem.results.growing_file import GrowingFile
from rbfem.results.table import TableWriter
from rbfem.results.vtk_file import load_vtk
from rbfem.results.vtu import SceneGrid
from rbfem.results.whole_file import FolderLock, reason, require_writable, temporary_path
from rbfem.scene.scene import Scene
from rbfem.simulation.frame import Frame

FRAMES = "frames"
PVD_HEAD = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n'
PVD_TAIL = "  </Collection>\n</VTKFile>\n"


class SeriesWriter:
    """Writes the frames of a scene to a directory; a context manager.

    DIRECTORY/frames/NAME_000000.vtu, …         the parts where they are, see `SceneGrid`
    DIRECTORY/frames/NAME_bodies_000000.vtu, …  one vertex a body, see `BodiesGrid`
    DIRECTORY/NAME.pvd, NAME_bodies.pvd         their physical times; what ParaView opens
    DIRECTORY/NAME.csv                          one row a frame, see `TableWriter`

    Each file is whole from the moment it has its name, and a frame is in place before a .pvd names it. The .pvd and the
    .csv are brought up to date after a frame whenever that costs less than a hundredth of the run, and at the end.

    What an earlier run of the same case left in the directory is removed first (see `remove_earlier_run`); every other
    file is left alone. Raises InputError if the directory cannot be written to or another run is writing to it,
    RunError if a file cannot be written later on; what was written before then is readable.
    """

    def __init__(self, scene: Scene, directory: Path):
        require_writable(directory)
        require_writable(directory / FRAMES)
        self._lock = FolderLock(directory)
        load_vtk()
        remove_earlier_run(scene.name, directory)
        self._name = scene.name
        self._directory = directory
        self._grids: dict[str, SceneGrid | BodiesGrid] = {
            scene.name: SceneGrid(scene),
            f"{scene.name}_bodies": BodiesGrid(scene),
        }
        self._lists = {name: GrowingFile(directory / f"{name}.pvd", PVD_HEAD, PVD_TAIL) for name in self._grids}
        self._table = TableWriter(scene, directory / f"{scene.name}.csv")

    def write(self, frame: Frame) -> None:
        """Add a frame to the series. Raises RunError."""
        for name, grid in self._grids.items():
            file = f"{FRAMES}/{name}_{frame.index:06d}.vtu"
            grid.move_to(frame)
            grid.write(self._directory / file)
            self._lists[name].append(_pvd_entry(frame.time, file))
        self._table.write(frame)

    def close(self) -> None:
        """Bring the .pvd and .csv files up to date. Raises RunError."""
        for pvd in self._lists.values():
            pvd.close()
        self._table.close()
        self._lock.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None):
        """Close; an error of closing must not hide the one that ended the run."""
        try:
            self.close()
        except RunError:
            if kind is None:
                raise


def remove_earlier_run(name: str, directory: Path) -> None:
    """Remove the results of an earlier run of the case `name`, so that its frames never mix with new ones.

    Removed are NAME.pvd, NAME_bodies.pvd, NAME.csv and report.json, and after them in frames/ the files called
    NAME_<digits>.vtu or NAME_bodies_<digits>.vtu; also what a killed run left half-written under a temporary name.
    Pictures, results of other cases and everything else stay. Raises InputError.
    """
    lists = [directory / file for file in (f"{name}.pvd", f"{name}_bodies.pvd", f"{name}.csv", "report.json")]
    is_frame = re.compile(rf"\.?{re.escape(name)}(_bodies)?_\d{{6,}}(\.part)?\.vtu").fullmatch
    frames = [path for path in (directory / FRAMES).iterdir() if is_frame(path.name)]
    for path in (*lists, *map(temporary_path, lists), *frames):
        try:
            path.unlink(missing_ok=True)
        except OSError as error:
            raise InputError(
                f"{path}: a result of this name cannot be replaced: {reason(error)}; choose another folder with -o"
            ) from error


def _pvd_entry(time: float, file: str) -> str:
    return f'    <DataSet timestep="{float(time)!r}" part="0" file={quoteattr(file)}/>\n'
