"""What several commands ask of their user in the same words."""

from pathlib import Path

import click

case_argument = click.argument("case", type=click.Path(path_type=Path))
output_option = click.option(
    "-o", "--output", "directory", metavar="DIR", type=click.Path(path_type=Path), help="Default: results/NAME."
)
set_option = click.option(
    "--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Override a value; bodies by their name."
)
