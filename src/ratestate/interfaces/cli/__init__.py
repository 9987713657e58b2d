"""The command line, ``ratestate``: a command is a function and its table in commands.toml.

The function's docstring is the head of its help.  Nothing heavy is imported before a command needs
it, so help and version come at once.
"""

from typing import Annotated

import typer

from .command import COMMANDS, GROUP_OF, GROUPS, Command, Debug, as_command
from .exits import EXIT_CODES

main = typer.Typer(
    name="ratestate",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,  # a traceback that can be copied into a report
    context_settings={"help_option_names": ["-h", "--help"]},
)
_groups = {name: typer.Typer(no_args_is_help=True, help=text) for name, text in GROUPS.items()}
for function in COMMANDS:
    group = _groups.get(GROUP_OF[function.__name__], main)
    group.command(cls=Command)(as_command(function))
for name, group in _groups.items():
    main.add_typer(group, name=name)


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(version("ratestate"))
        raise typer.Exit


@main.callback(
    help=f"""Dynamics of a slider on a spring under rate-and-state friction.

    Example: ratestate init lab

    {EXIT_CODES}
    """
)
def _ratestate(
    context: typer.Context,
    version: Annotated[
        bool,
        typer.Option("--version", callback=_version, is_eager=True, help="Print the version."),
    ] = False,
    debug: Debug = False,
) -> None:
    context.obj = debug
