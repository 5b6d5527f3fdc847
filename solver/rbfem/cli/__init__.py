"""The command line: one file a command; each parses, calls and prints. Nothing heavy is imported before one runs."""

import sys

import click

from rbfem import __version__
from rbfem.cli.chart import command as chart
from rbfem.cli.inertia import command as inertia
from rbfem.cli.mesh import command as mesh
from rbfem.cli.plan import command as plan
from rbfem.cli.run import command as run
from rbfem.cli.schema import command as schema
from rbfem.cli.stability import command as stability
from rbfem.cli.view import command as view
from rbfem.errors import RbfemError

INTERRUPTED = 130


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, prog_name="rbfem")
def commands() -> None:
    """How a part given as a tetrahedral mesh moves, at the error you accept.

    Exit codes: 0 done, 1 the run failed or an expectation was missed, 2 the case, mesh or command is wrong, 3 a system
    library is missing, 130 interrupted.
    """


for command in (run, plan, chart, stability, inertia, mesh, view, schema):
    commands.add_command(command)


def main(arguments: list[str] | None = None) -> None:
    """Run a command and exit with its code."""
    try:
        code = commands.main(arguments, standalone_mode=False)
    except RbfemError as error:
        code = _told(f"rbfem: {error}", error.exit_code)
    except click.ClickException as error:
        error.show()
        code = error.exit_code
    except (KeyboardInterrupt, click.Abort):
        code = _told("rbfem: interrupted", INTERRUPTED)
    except BrokenPipeError:
        sys.stderr.close()  # the reader of a pipe has had enough; say nothing more
        code = 1
    except OSError as error:
        code = _told(f"rbfem: {error.strerror or error}", 1)
    sys.exit(code or 0)


def _told(message: str, code: int) -> int:
    click.echo(message, err=True)
    return code
