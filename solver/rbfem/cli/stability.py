"""`rbfem stability`: the longest stable step of each method on a case."""

from pathlib import Path

import click

from rbfem.cli.options import case_argument, output_option, set_option


@click.command("stability")
@case_argument
@output_option
@set_option
def command(case: Path, directory: Path | None, overrides: tuple[str, ...]) -> None:
    """Find the step at which each method fails on CASE, a case.yaml or its folder, beside what theory says.

    Writes stability.csv, stability.png and stability.svg, with a map over step, damping and spin. Takes about a minute.
    """
    from rbfem.results.whole_file import require_writable
    from rbfem.scene.builder import load

    scene = load(case, overrides)
    directory = directory or Path("results") / scene.name
    require_writable(directory)
    from rbfem.cli.progress import progress_of
    from rbfem.cli.tables import paragraph
    from rbfem.study.stability import measure, notes, table
    from rbfem.study.stability_picture import write_stability

    with progress_of("methods") as show:
        study = measure(scene, show)
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
