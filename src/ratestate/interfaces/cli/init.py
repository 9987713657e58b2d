"""``ratestate init``: a scenario file to start from."""

import os
import shlex
from pathlib import Path

import typer

from ...errors import ParameterError
from .. import templates
from .output import print_line


def init(kind: str = "lab", *, out: Path | None = None, listing: bool = False) -> None:
    """Write a commented scenario file to start from, and the data that it needs beside it.

    Example: ratestate init brake
    """
    if listing:
        width = max(map(len, templates.TEMPLATES))
        for each in templates.TEMPLATES:
            print_line(f"{each:{width}}  {templates.description(each)}")
        return
    texts = templates.files_of(kind)
    own = f"{kind}.toml"
    if out == Path("-"):
        print_line(texts[own].rstrip("\n"))
        return
    path = (out or Path(own)).expanduser()
    if path.suffix.lower() != ".toml":
        raise typer.BadParameter(f"{str(path)!r} does not end in .toml", param_hint="--out")
    places = {file: path if file == own else path.with_name(file) for file in texts}
    _write({places[file]: text for file, text in texts.items()})
    print_line(f"wrote {' and '.join(map(str, places.values()))}\nNext:")
    for line in templates.commands(kind):
        for file, place in places.items():
            line = line.replace(f" {file}", f" {shlex.quote(str(place))}")
        print_line(f"  {line}")


def _write(texts: dict[Path, str]) -> None:
    """Write all of these files, or none if one exists or cannot be written."""
    from ...files import checked_path, replace

    for path in texts:
        if os.path.lexists(path):
            other = "name" if path.suffix.lower() == ".toml" else "folder"
            raise ParameterError(f"{path} exists", f"Give another {other} with --out.")
    places = {checked_path(path, (path.suffix.lower(),)): text for path, text in texts.items()}
    made = list[Path]()
    try:
        for path, text in places.items():
            replace(path, lambda partial, text=text: partial.write_text(text, "utf-8"))
            made.append(path)
    except BaseException:
        for path in made:
            path.unlink()
        raise
