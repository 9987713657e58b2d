"""Printing to stdout: text and tables, in colour on a terminal only."""

import os
import sys
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from rich.console import Console

WIDTH = 140  # of tables, where output does not go to a terminal


def print_line(text: str) -> None:
    """Print a line.  If nobody reads stdout any more, as after ``| head``, output is discarded.

    The work goes on, since there may be files to write.
    """
    try:
        typer.echo(text, color=True)  # `console` has decided about colours
    except BrokenPipeError:
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, sys.stdout.fileno())


def console(stderr: bool = False) -> "Console":
    """A console of rich's, without colours under NO_COLOR or where there is no terminal."""
    from rich.console import Console

    made = Console(
        stderr=stderr,
        highlight=False,
        emoji=False,
        color_system=None if os.environ.get("NO_COLOR") else "auto",
    )
    if not made.is_terminal:
        made.width = WIDTH
    return made


def print_rich(*what: Any) -> None:
    """Print tables and styled text of rich's."""
    from rich.text import Text

    made = console()
    with made.capture() as text:
        for one in what:
            # (text that goes to a file is not wrapped)
            made.print(one, soft_wrap=isinstance(one, Text) and not made.is_terminal)
    print_line(text.get().rstrip("\n"))
