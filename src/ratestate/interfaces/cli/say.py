"""What goes to stdout: text and tables, in colour on a terminal only, until nobody listens."""

import os
import sys
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from rich.console import Console

WIDTH = 140  # of tables where no terminal says how wide it is


def say(text: str) -> None:
    """Print a line; if the reader is gone, as after ``| head``, this and all that follows is lost.

    The work goes on: there may be files to write.
    """
    try:
        typer.echo(text, color=True)  # whoever coloured it has looked where it goes
    except BrokenPipeError:
        deaf = os.open(os.devnull, os.O_WRONLY)
        os.dup2(deaf, sys.stdout.fileno())


def console(stderr: bool = False) -> "Console":
    """A console that leaves all codes away for NO_COLOR, and where no terminal is."""
    from rich.console import Console

    plain = {"color_system": None} if os.environ.get("NO_COLOR") else {}
    made = Console(stderr=stderr, highlight=False, emoji=False, **plain)  # type: ignore[arg-type]
    if not made.is_terminal:
        made.width = WIDTH
    return made


def show(*what: Any) -> None:
    """Print tables and marked-up text of rich's."""
    from rich.text import Text

    made = console()
    with made.capture() as text:
        for one in what:
            # (text that goes to a file is not cut into lines)
            made.print(one, soft_wrap=isinstance(one, Text) and not made.is_terminal)
    say(text.get().rstrip("\n"))
