"""`rbfem chart`: the work-precision chart of a case."""

from collections.abc import Iterator
from pathlib import Path

import click

from rbfem.cli.options import case_argument, output_option, set_option


@click.command("chart")
@case_argument
@output_option
@set_option
def command(case: Path, directory: Path | None, overrides: tuple[str, ...]) -> None:
    """Show error against cost of every method on CASE, a case.yaml or its folder, and the choice that `run` makes.

    Writes chart.csv, chart.png, chart.svg and chart.html, a page to hover over. Takes one to three minutes.
    """
    from rbfem.results.whole_file import require_writable
    from rbfem.scene.builder import load

    scene = load(case, overrides)
    directory = directory or Path("results") / scene.name
    require_writable(directory)
    from rbfem.cli.progress import progress_of
    from rbfem.cli.tables import paragraph
    from rbfem.study.chart import write_chart
    from rbfem.study.summary import HEAD, notes, rows
    from rbfem.study.work_precision import measure

    _tell_of_compiling()
    with progress_of("parts") as show:
        study = measure(scene, show)
    click.echo(f"Chart of {study.case}: the run of each method with the fewest evaluations within {study.accuracy:g}")
    for line in _aligned([HEAD, *rows(study)]):
        click.echo(line)
    for label, text in notes(study):
        for line in paragraph(label, text):
            click.echo(line)
    for path in write_chart(study, directory):
        click.echo(path)


def _tell_of_compiling() -> None:
    from rbfem.compute.loops import is_cached
    from rbfem.motion.methods import METHODS
    from rbfem.motion.state import kernel_of

    if not all(is_cached(kernel_of(name), "serial") for name in METHODS):
        click.echo("  compiling the kernels, the first time only …", err=True)


def _aligned(table: list[tuple[str, ...]]) -> Iterator[str]:
    """Rows of words in columns, the first to the left and the others to the right.

    >>> list(_aligned([("method", "order"), ("rk4", "4")]))
    ['  method  order', '  rk4         4']
    """
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    for first, *rest in table:
        cells = [f"{cell:>{width}}" for cell, width in zip(rest, widths[1:], strict=True)]
        yield "  " + "  ".join([f"{first:<{widths[0]}}", *cells])
