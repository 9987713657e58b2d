"""What commands that fill a folder share."""

import contextlib
import enum
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import typer

from .say import console


class Law(enum.StrEnum):
    """Evolution law."""

    slip = "slip"
    aging = "aging"


def writable(out: Path) -> None:
    """Make the folder, and see whether it takes files: rather now than after minutes of work."""
    from ...files import writing

    with writing(out):
        out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=out):
            pass


@contextlib.contextmanager
def reported(what: str) -> Iterator[list[Path]]:
    """Say on stderr what is being made; afterwards how long it took and which files it left."""
    told = console(stderr=True)
    told.print(f"[bold]{what}[/bold] ...")
    begin, files = time.monotonic(), list[Path]()
    yield files
    told.print(f"  {time.monotonic() - begin:.1f} s", style="dim")
    for path in files:
        typer.echo(f"  {path}", err=True)
