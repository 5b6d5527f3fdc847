"""`rbfem view`."""

from pathlib import Path

import click


@click.command("view")
@click.argument("directory", metavar="DIR", type=click.Path(path_type=Path))
@click.option(
    "-o", "--output", "picture", metavar="PICTURE", type=click.Path(path_type=Path), help="One .png, .gif or .mp4."
)
@click.option("--time", type=float, metavar="SECONDS", help="Which frame a .png shows; the last if not given.")
def command(directory: Path, picture: Path | None, time: float | None) -> None:
    """Draw the results in DIR: a look without ParaView.

    Without -o, the last frame with the paths that led there goes to DIR/NAME.png, and a film to DIR/NAME.gif.
    """
    from rbfem.results.reading import find_series
    from rbfem.results.view import draw

    find_series(directory)
    if picture is None or picture.suffix.lower() != ".png":
        click.echo("drawing; a film takes up to a minute …", err=True)
    for path in draw(directory, picture, time):
        click.echo(path)
