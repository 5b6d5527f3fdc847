"""What the scripts beside this file share: a quiet gmsh, and STEP files that come out the same every time."""

import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import gmsh


@contextmanager
def quiet_gmsh() -> Iterator[None]:
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    try:
        yield
    finally:
        gmsh.finalize()


def write_step(path: Path) -> None:
    """Write the OpenCASCADE solids; the part takes the name of the file, and the date of writing is left out."""
    gmsh.model.occ.synchronize()
    gmsh.write(str(path))
    text = path.read_text()
    text = re.sub(r"'\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d'", "'2024-01-01T00:00:00'", text)
    path.write_text(re.sub(r"'Open CASCADE STEP translator [\d. ]+'", f"'{path.stem}'", text))


def edges_where(is_wanted: Callable[[list[float]], bool]) -> list[int]:
    """Tags of the edges whose box (x_min, y_min, z_min, x_max, y_max, z_max) is wanted."""
    gmsh.model.occ.synchronize()
    return [tag for _, tag in gmsh.model.getEntities(1) if is_wanted(list(gmsh.model.getBoundingBox(1, tag)))]


def folder_from_command_line() -> Path:
    return Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
