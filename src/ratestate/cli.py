"""The command line: ``ratestate figures`` and ``ratestate --version``.

Nothing heavy is imported before a command needs it, so help and version come at once.
"""

import contextlib
import enum
import sys
from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
)

FAILED, INTERRUPTED = 2, 130
#: What ``figures`` can be asked for, beside "all": the paper's six, and one on its scheme.
NAMES = ["1", "2", "3", "4", "5", "6", "scheme"]


class Law(enum.StrEnum):
    """Evolution law."""

    slip = "slip"
    aging = "aging"


def main():
    """Run the command line; Ctrl-C ends it with exit code 130."""
    try:
        app(standalone_mode=False)
    except typer.Exit as end:
        sys.exit(end.exit_code)


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(version("ratestate"))
        raise typer.Exit


@app.callback()
def ratestate(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_version, is_eager=True, help="Print the version."),
    ] = False,
) -> None:
    """Dynamics of a slider on a spring under rate-and-state friction.

    Example:  ratestate figures all --law slip --out figures
    """
