"""`rbfem stability`: the longest stable step of each method on a case."""

import time
from collections.abc import Callable
from pathlib import Path

import click

SECONDS_BETWEEN_LINES = 10.0


@click.command("stability")
@click.argument("case", type=click.Path(path_type=Path))
@click.option(
    "-o", "--output", "directory", metavar="DIR", type=click.Path(path_type=Path), help="Default: results/NAME."
)
@click.option("--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Override a value; bodies by their name.")
def command(case: Path, directory: Path | None, overrides: tuple[str, ...]) -> None:
    """Find the step at which each method fails on CASE, a case.yaml or its folder, beside what theory says.

    Writes stability.csv, stability.png and stability.svg, with a map over step, damping and spin. Takes about a minute.
    """
    from rbfem.results.whole_file import require_writable
    from rbfem.scene.builder import load

    scene = load(case, overrides)
    directory = directory or Path("results") / scene.name
    require_writable(directory)
    from rbfem.cli.tables import paragraph
    from rbfem.study.stability import measure, notes, table
    from rbfem.study.stability_picture import write_stability

    study = measure(scene, _lines())
    if not study.limits:
        click.echo(f"{study.case}: nothing limits the step: nothing swings, is damped or spins")
        return
    click.echo(f"Stability on {study.case}")
    for line in table(study):
        click.echo(line)
    for note in notes(study):
        for line in paragraph("", note):
            click.echo(line)
    for path in write_stability(study, directory):
        click.echo(path)


def _lines() -> Callable[[int, int, str], None]:
    """A line now and then."""
    told = time.monotonic()

    def show(done: int, total: int, what: str) -> None:
        nonlocal told
        if time.monotonic() - told > SECONDS_BETWEEN_LINES:
            told = time.monotonic()
            click.echo(f"  {done} of {total} methods: {what}", err=True)

    return show
