"""`rbfem run`: the main job."""

from pathlib import Path

import click

from rbfem.cli.options import case_argument, output_option, set_option


@click.command("run")
@case_argument
@output_option
@set_option
@click.option("--beyond-limit", is_flag=True, help="Go on with a step beyond the stability limit.")
@click.pass_context
def command(
    context: click.Context, case: Path, directory: Path | None, overrides: tuple[str, ...], beyond_limit: bool
) -> None:
    """Move the bodies of CASE, a case.yaml or its folder; write a series for ParaView, a table and a report.

    Ends with exit code 1 if an `expect` was missed, or the accuracy was with a step that rbfem chose. A step that the
    case gives is not judged by the accuracy: the report says what it came to.
    """
    from rbfem.cli.progress import Progress
    from rbfem.results.record import record
    from rbfem.results.report import Clock

    clock = Clock()
    with clock.phase("read"):
        from rbfem.scene.builder import load

        scene = load(case, overrides)
    with clock.phase("plan"):
        from rbfem.planning.planner import plan

        made = plan(scene, beyond_limit)
    directory = directory or Path("results") / scene.name
    from rbfem.cli.tables import plan_lines, report_lines

    for line in plan_lines(scene, made):
        click.echo(line)
    with Progress(scene, made) as progress:
        report = record(scene, made, directory, clock, progress.show, progress.tell)
    for line in report_lines(report, directory):
        click.echo(line)
    missed = [expect for expect in report["expect"] if not expect["pass"]]
    context.exit(1 if missed or report["error"]["unmet"] else 0)
