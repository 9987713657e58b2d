"""What commands share: how they end, and how they say what they write."""

import contextlib
import enum
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import typer

from ..errors import RateStateError

FAILED, SOME_FAILED, INTERRUPTED = 2, 3, 130


class Law(enum.StrEnum):
    """Evolution law."""

    slip = "slip"
    aging = "aging"


@contextlib.contextmanager
def ending_well(
    interrupted: Callable[[], str] = lambda: "files already listed are whole",
) -> Iterator[None]:
    """End what can be foreseen with one message on stderr and an exit code.

    interrupted : says after Ctrl-C what is left of the work
    """
    try:
        yield
    except RateStateError as error:
        typer.echo(f"error: {error}", err=True)
        raise typer.Exit(FAILED) from error
    except OSError as error:
        typer.echo(f"error: cannot write: {error}", err=True)
        raise typer.Exit(FAILED) from error
    except KeyboardInterrupt as interrupt:
        typer.echo(f"interrupted; {interrupted()}", err=True)
        raise typer.Exit(INTERRUPTED) from interrupt


def writable(out: Path) -> None:
    """Make the folder, and see whether it takes files: rather now than after minutes of work."""
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryFile(dir=out):
        pass


@contextlib.contextmanager
def reported(what: str) -> Iterator[list[Path]]:
    """Say on stderr what is being made; afterwards how long it took and which files it left."""
    from rich.console import Console

    console = Console(stderr=True, highlight=False)
    console.print(f"[bold]{what}[/bold] ...")
    begin, files = time.monotonic(), list[Path]()
    yield files
    console.print(f"  {time.monotonic() - begin:.1f} s", style="dim")
    for path in files:
        typer.echo(f"  {path}", err=True)
