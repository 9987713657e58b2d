"""The command line: ``ratestate figures``, ``atlas``, ``sweep`` and ``ratestate --version``.

Nothing heavy is imported before a command needs it, so help and version come at once.
"""

from typing import Annotated

import typer

from .atlas import atlas
from .figures import figures
from .sweep import sweep

main = typer.Typer(
    name="ratestate",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,  # a traceback that can be copied into a report
    context_settings={"help_option_names": ["-h", "--help"]},
)
for command in (figures, atlas, sweep):
    main.command()(command)


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(version("ratestate"))
        raise typer.Exit


@main.callback()
def _ratestate(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_version, is_eager=True, help="Print the version."),
    ] = False,
) -> None:
    """Dynamics of a slider on a spring under rate-and-state friction.

    Example: ratestate figures 2 3 --law slip --out figures
    """
