"""NAME.csv: one row a frame, for plots and for comparing runs."""

import csv
import io
from collections.abc import Iterable, Iterator
from pathlib import Path

from rbfem.results.growing_file import GrowingFile
from rbfem.scene.scene import Scene
from rbfem.simulation.frame import Frame

ENERGIES = ("kinetic", "rotational", "gravity", "elastic", "work", "energy")
LOSSES = ("damping", "friction")  # of contacts, in scenes that have any
SUMS = ("momentum", "angular_momentum")
STATE = {"position": "xyz", "quaternion": "wxyz", "velocity": "xyz", "angular_velocity": "xyz"}

# The state of each body is in the table up to so many bodies; beyond, the series of bodies is the better place.
MOST_BODIES = 16


def column_names(scene: Scene) -> list[str]:
    """Names of the columns: time, energies, momenta, and for a scene of few bodies the state of each.

    A vector takes a column a component: `momentum.x`, `nut.position.x`, `nut.quaternion.w`.
    """
    names = ["time", *_energies(scene), *(f"{name}.{axis}" for name in SUMS for axis in "xyz")]
    for body in scene.names if has_bodies(scene) else ():
        names += [f"{body}.{name}.{axis}" for name, axes in STATE.items() for axis in axes]
    return names


def _energies(scene: Scene) -> tuple[str, ...]:
    return ENERGIES + (LOSSES if scene.can_touch.any() else ())


def has_bodies(scene: Scene) -> bool:
    return scene.n_bodies <= MOST_BODIES


def row_values(frame: Frame, energies: tuple[str, ...], with_bodies: bool) -> Iterator[float]:
    """The numbers of a frame in the order of `column_names`."""
    yield float(frame.time)
    yield from (float(getattr(frame.balance, name)) for name in energies)
    for name in SUMS:
        yield from getattr(frame.balance, name).tolist()
    for i in range(len(frame.position)) if with_bodies else ():
        for name in STATE:
            yield from getattr(frame, name)[i].tolist()


class TableWriter:
    """Writes the table of a scene. Numbers are as short as they can be and still read back to the same bits."""

    def __init__(self, scene: Scene, path: Path):
        self._with_bodies = has_bodies(scene)
        self._energies = _energies(scene)
        self._file = GrowingFile(path, head=_line(column_names(scene)))

    def write(self, frame: Frame) -> None:
        """Add the row of a frame; the file follows as soon as that is cheap. Raises RunError."""
        self._file.append(",".join(map(repr, row_values(frame, self._energies, self._with_bodies))) + "\n")

    def close(self) -> None:
        """Bring the file up to its last row. Raises RunError."""
        self._file.close()


def _line(words: Iterable[str]) -> str:
    line = io.StringIO()
    csv.writer(line, lineterminator="\n").writerow(words)
    return line.getvalue()
