"""`rbfem plan`: what would be computed and why."""

from pathlib import Path

import click

from rbfem.cli.options import case_argument, set_option


@click.command("plan")
@case_argument
@set_option
@click.option("--json", "as_json", is_flag=True, help="The whole plan as JSON.")
@click.option("--beyond-limit", is_flag=True, help="Accept a step beyond the stability limit.")
def command(case: Path, overrides: tuple[str, ...], as_json: bool, beyond_limit: bool) -> None:
    """Say what `rbfem run CASE` would compute, why, at what error and cost. Writes nothing."""
    import json

    from rbfem.cli.tables import plan_lines
    from rbfem.planning.planner import plan
    from rbfem.scene.builder import load

    scene = load(case, overrides)
    made = plan(scene, beyond_limit)
    if as_json:
        click.echo(json.dumps(made.to_dict(), indent=2, ensure_ascii=False))
        return
    for line in plan_lines(scene, made):
        click.echo(line)
