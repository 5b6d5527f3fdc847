"""`rbfem schema`."""

import click


@click.command("schema")
def command() -> None:
    """Print the JSON schema of the case file, for editors."""
    import json

    from rbfem.case.schema import json_schema

    click.echo(json.dumps(json_schema(), indent=2, ensure_ascii=False))
