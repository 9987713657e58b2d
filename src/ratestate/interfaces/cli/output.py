"""Output of commands: text and tables on stdout, folders, and messages on the files made."""

import contextlib
import json
import math
import os
import sys
import time
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from ...errors import RunWarning

if TYPE_CHECKING:
    from rich.console import Console

WIDTH = 140  # of tables, where output does not go to a terminal


def print_line(text: str, err: bool = False) -> None:
    """Print a line; after its reader has gone, as with ``| head``, the work goes on."""
    try:
        # colours of stdout are decided by `_console`, those of stderr by whether it is a terminal
        typer.echo(text, err=err, color=None if err else True)
    except BrokenPipeError:
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, (sys.stderr if err else sys.stdout).fileno())


@contextlib.contextmanager
def warnings_as_lines() -> Iterator[None]:
    """Print warnings on stderr, a line each, without the lines of code that they come from."""
    with warnings.catch_warnings():
        warnings.simplefilter("always", RunWarning)
        warnings.showwarning = lambda text, *_, **__: print_line(f"warning: {text}", err=True)
        yield


def print_json(value: Any) -> None:
    """Print a value as one JSON document, without Python's extensions of JSON.

    Complex numbers become pairs, infinite ones the strings "inf" and "-inf", and NaN null.
    """
    print_line(json.dumps(_json_value(value), allow_nan=False))


def _json_value(value: Any) -> Any:
    """Return a value converted to types that JSON has."""
    if isinstance(value, dict):
        return {str(key): _json_value(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_json_value(item) for item in value]
    if isinstance(value, complex):
        return [_json_value(value.real), _json_value(value.imag)]
    if hasattr(value, "tolist"):  # of NumPy
        return _json_value(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value


def print_rich(*items: Any) -> None:
    """Print tables and styled text of rich's."""
    from rich.text import Text

    console = _console()
    with console.capture() as text:
        for item in items:
            # (text that goes to a file is not wrapped)
            console.print(item, soft_wrap=isinstance(item, Text) and not console.is_terminal)
    print_line(text.get().rstrip("\n"))


def _console(stderr: bool = False) -> "Console":
    """A console of rich's, without colours under NO_COLOR or where there is no terminal."""
    from rich.console import Console

    console = Console(
        stderr=stderr,
        highlight=False,
        emoji=False,
        color_system=None if os.environ.get("NO_COLOR") else "auto",
    )
    if not console.is_terminal:
        console.width = WIDTH
    return console


def write_text(path: Path, text: str) -> Path:
    """Write a text to a file, whole or not at all; the file."""
    from ...files import replace

    return replace(path, lambda partial: partial.write_text(text, "utf-8"))


def names_of(files: Iterable[Path]) -> str:
    """The names of files as a message lists them."""
    return ", ".join(file.name or str(file) for file in files)


@contextlib.contextmanager
def folder(out: Path | None) -> Iterator[None]:
    """A folder as by `make_writable`, if any; what was made of it goes if nothing is written."""
    new_folders = [path for path in (out, *out.parents) if not path.exists()] if out else []
    try:
        if out:
            from ...files.place import make_writable

            make_writable(out)
        yield
    finally:
        for path in new_folders:
            with contextlib.suppress(OSError):  # it has files
                path.rmdir()


@contextlib.contextmanager
def reporting_files(task: str) -> Iterator[list[Path]]:
    """Report on stderr what is being made; if that succeeds, then the time and the files listed."""
    stderr = _console(stderr=True)
    stderr.print(f"[bold]{task}[/bold] ...")
    begin, files = time.monotonic(), list[Path]()
    yield files
    stderr.print(f"  {time.monotonic() - begin:.1f} s", style="dim")
    for path in files:
        print_line(f"  {path}", err=True)
