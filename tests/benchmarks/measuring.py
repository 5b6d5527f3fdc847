"""How a benchmark measures, and the row that it reports."""

import importlib
import time
from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType
from typing import Any, NamedTuple

TURN = 0.1  # s that a task is repeated for before the next one has its turn


class Effort(NamedTuple):
    """share: of the full problem sizes, so that a test can ask for tiny ones; rounds: turns that each task has."""

    share: float = 1.0
    rounds: int = 10


@dataclass(frozen=True)
class Row:
    """One line of the table.

    benchmark : what was measured, on what
    rbfem     : what it came to, in words
    reference : what it is held against: a peer, another path of rbfem, or the limit itself
    ratio     : rbfem by reference, smaller is better; None where one of the two is missing
    asked     : the ratio is to be at most this; None where the row only informs
    skipped   : why there is no ratio
    """

    benchmark: str
    rbfem: str
    reference: str = ""
    ratio: float | None = None
    asked: float | None = None
    skipped: str = ""

    @property
    def verdict(self) -> str:
        """
        >>> Row("a", "3 s", "2 s", 1.5, asked=1.3).verdict, Row("a", "3 s", skipped="x is not installed").verdict
        ('missed', 'skipped: x is not installed')
        """
        if self.ratio is None:
            return f"skipped: {self.skipped}"
        if self.asked is None:
            return "for information"
        return "met" if self.ratio <= self.asked else "missed"


def smallest_times(rounds: int, *tasks: Callable[[], Any], between: Callable[[], Any] = lambda: None) -> list[float]:
    """The smallest wall time of each task in seconds.

    The tasks take turns of at least one call and TURN seconds, so that a busy moment of the machine hits all of them
    alike, and a quick task is not always timed with the caches that a slow one left. A first turn, in which kernels are
    compiled and files are read, does not count. `between` is called before each task and is not timed.
    """
    times: list[list[float]] = [[] for _ in tasks]
    for turn in range(rounds + 1):
        for task, taken in zip(tasks, times, strict=True):
            began = time.perf_counter()
            while True:
                between()
                start = time.perf_counter()
                task()
                end = time.perf_counter()
                if turn > 0:
                    taken.append(end - start)
                if turn == 0 or end - began > TURN:
                    break
    return [min(taken) for taken in times]


def peer(name: str) -> ModuleType | None:
    """A library of the extra `peers`, or None where it is not installed."""
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError:
        return None


def missing(name: str) -> str:
    return f"{name} is not installed"


def in_time(seconds: float) -> str:
    """
    >>> in_time(0.0123), in_time(2.5e-8), in_time(1.3)
    ('12.3 ms', '25 ns', '1.3 s')
    """
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"
