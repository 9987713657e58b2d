"""The command ``ratestate``, called in this process."""

from typer.testing import CliRunner

from ratestate.interfaces.cli import main


def call(*arguments, **how):
    """The result of a command: exit_code, stdout and stderr; `how`: input, for standard input."""
    return CliRunner().invoke(main, [str(argument) for argument in arguments], **how)


def succeed(*arguments, **how):
    """The result of a command that must end without an error, as of `call`."""
    result = call(*arguments, **how)
    assert result.exit_code == 0, result.output
    return result


def refuse(*arguments, **how):
    """The result of a command that must end with an error, as of `call`."""
    result = call(*arguments, **how)
    assert result.exit_code == 2, result.output
    return result
