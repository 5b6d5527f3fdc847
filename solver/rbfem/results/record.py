"""A run on disk: its series while it goes, its report at the end, however it ends."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from rbfem.errors import RunError
from rbfem.planning.plan import Plan
from rbfem.results.report import Clock, make_report, write_report
from rbfem.results.series import SeriesWriter
from rbfem.scene.scene import Scene
from rbfem.simulation.frame import Frame
from rbfem.simulation.run import Run, simulate


def record(
    scene: Scene,
    plan: Plan,
    directory: Path,
    clock: Clock,
    show: Callable[[Frame], None],
    tell: Callable[[str], None] = lambda words: None,
) -> dict[str, Any]:
    """Run a scene and write the series and report.json to a directory; returns the report.

    show : called with every frame once it is written     tell : called with what happens in between, in words
    Raises InputError before the run if the directory cannot be written to; RunError if the run fails or the disk is
    full. Then, and when interrupted, the series up to there is readable and the report says where the run ended.
    """
    run = simulate(scene, plan)
    run.tell = tell
    with SeriesWriter(scene, directory) as series:
        try:
            _write_frames(run, series, clock, show)
        except (KeyboardInterrupt, RunError) as ended:
            run.ended_early = f"the run ended before its time: {str(ended) or 'interrupted'}"
            run.warnings.append(run.ended_early)
            _report_what_there_is(run, directory, clock)
            raise
    report = make_report(run, clock)
    write_report(report, directory)
    return report


def _write_frames(run: Run, series: SeriesWriter, clock: Clock, show: Callable[[Frame], None]) -> None:
    frames = iter(run)
    while True:
        with clock.phase("simulate"):
            frame = next(frames, None)
        if frame is None:
            return
        with clock.phase("write"):
            series.write(frame)
        show(frame)


def _report_what_there_is(run: Run, directory: Path, clock: Clock) -> None:
    """The report of a run cut short; on a full disk there is none."""
    if run.last is None:
        return
    try:
        write_report(make_report(run, clock), directory)
    except RunError as error:
        run.warnings.append(str(error))
