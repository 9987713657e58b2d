"""Output folders of commands: checked before the work, their files listed after it."""

import contextlib
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import typer

from .printing import console


def make_writable(out: Path) -> None:
    """Make the folder, and check that files can be written there, before minutes of work."""
    from ...files import writing

    with writing(out):
        out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=out):
            pass


@contextlib.contextmanager
def reporting_files(what: str) -> Iterator[list[Path]]:
    """Report on stderr what is being made, then how long it took and the files in the list."""
    stderr = console(stderr=True)
    stderr.print(f"[bold]{what}[/bold] ...")
    begin, files = time.monotonic(), list[Path]()
    yield files
    stderr.print(f"  {time.monotonic() - begin:.1f} s", style="dim")
    for path in files:
        typer.echo(f"  {path}", err=True)
