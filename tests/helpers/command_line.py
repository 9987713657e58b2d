"""The command ``ratestate``, called in this process."""

from typer.testing import CliRunner

from ratestate.interfaces.cli import main


def call(*arguments, **how):
    """The result of a command: exit_code, stdout and stderr; `how`: input, for standard input."""
    return CliRunner().invoke(main, [str(argument) for argument in arguments], **how)
