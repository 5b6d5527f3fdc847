"""How far a run is: a bar with the time left on a terminal, a plain line now and then otherwise."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Self

import click

from rbfem.compute.loops import is_cached
from rbfem.planning.plan import Plan
from rbfem.planning.touching import kernel_for
from rbfem.scene.scene import Scene
from rbfem.simulation.frame import Frame

SECONDS_BETWEEN_LINES = 10.0


class Progress:
    """A context manager; `show(frame)` after every frame."""

    def __init__(self, scene: Scene, plan: Plan):
        self._scene, self._plan = scene, plan
        self._is_terminal = sys.stderr is not None and sys.stderr.isatty()
        self._told = time.monotonic()

    def __enter__(self) -> Self:
        backend = str(self._plan.backend.value)
        if backend != "python" and not is_cached(kernel_for(self._scene, str(self._plan.method.value)), backend):
            click.echo("  compiling the kernels, the first time only …", err=True)
        if self._is_terminal:
            from rich.console import Console
            from rich.progress import BarColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
            from rich.progress import Progress as Bar

            columns = (
                TextColumn("  {task.description}"),
                BarColumn(),
                TextColumn("{task.completed:.4g} of {task.total:.4g} s"),
                TimeElapsedColumn(),
                TimeRemainingColumn(),
            )
            self._bar = Bar(*columns, console=Console(stderr=True), transient=True)
            self._task = self._bar.add_task(self._scene.name, total=self._scene.end_time)
            self._bar.start()
        return self

    def show(self, frame: Frame) -> None:
        """Note that a frame is written."""
        if self._is_terminal:
            self._bar.update(self._task, completed=frame.time)
        elif time.monotonic() - self._told > SECONDS_BETWEEN_LINES:
            self._told = time.monotonic()
            share = 100.0 * frame.time / self._scene.end_time
            click.echo(f"  t = {frame.time:.6g} s of {self._scene.end_time:.6g} s ({share:.0f} %)", err=True)

    def tell(self, words: str) -> None:
        """Say what happens between frames."""
        click.echo(f"  {words}", err=True)

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None):
        if self._is_terminal:
            self._bar.stop()


@contextmanager
def progress_of(parts: str) -> Iterator[Callable[[int, int, str], None]]:
    """For work in parts: gives what is to be called with how many are done, of how many, and the one at hand."""
    if sys.stderr is None or not sys.stderr.isatty():
        yield _lines(parts)
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    columns = (TextColumn("  {task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(parts, total=None)
        yield lambda done, total, what: bar.update(task, completed=done, total=total, description=what)


def _lines(parts: str) -> Callable[[int, int, str], None]:
    told = time.monotonic()

    def show(done: int, total: int, what: str) -> None:
        nonlocal told
        if time.monotonic() - told > SECONDS_BETWEEN_LINES:
            told = time.monotonic()
            click.echo(f"  {done} of {total} {parts}: {what}", err=True)

    return show
