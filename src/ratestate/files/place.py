"""Places for files: found good or bad beforehand, and filled at once."""

import contextlib
import os
import shutil
import tempfile
import uuid
from pathlib import Path

from ..errors import ParameterError

#: group with the checksums of a result's Zarr folder
CHECKSUMS = "checksums"
#: endings of files with pictures
PICTURES = (".png", ".pdf")


def checked_path(path, endings):
    """A Path, ~ expanded, at which a file with one of these endings (".nc", ...) can be put.

    ParameterError: another ending, a folder (but a .zarr result), or no parent folder; OSError: no
    file can be made there, which is tried.  A file that exists is accepted.
    """
    path = Path(path).expanduser()
    ending = path.suffix.lower()
    if ending not in endings:
        raise ParameterError(f"{str(path)!r}: expected a name that ends in {listed(endings)}")
    if path.is_dir() and not (ending == ".zarr" and _is_result(path)):
        what = "a folder that holds no result" if ending == ".zarr" else "a folder"
        raise ParameterError(f"{path} is {what} and is not replaced; give another name")
    if not path.parent.is_dir():
        raise ParameterError(f"{path}: there is no folder {path.parent}; make it first")
    with writing(path), tempfile.TemporaryFile(dir=path.parent):
        pass
    return path


def listed(endings):
    """Endings in a message: ".nc, .csv or .zarr"."""
    return " or ".join(filter(None, [", ".join(endings[:-1]), endings[-1]]))


def replace(path, write):
    """Have `write` make a file or folder beside `path`, and rename it: nobody finds half a file.

    Returns `path`, whose place is not checked here (`checked_path`).  What `write` raises is
    raised, an OSError as one about `path`; what was there before is then as it was.

    write : function of the Path at which to make it
    """
    partial = path.with_name(f".{path.stem}.{uuid.uuid4().hex}.partial{path.suffix}")
    with writing(path):
        try:
            write(partial)
            if path.is_dir():
                old = partial.with_name(f"{partial.name}.old")
                path.rename(old)
                partial.rename(path)
                shutil.rmtree(old)
            else:
                partial.replace(path)
        finally:
            if partial.is_dir():
                shutil.rmtree(partial)
            partial.unlink(missing_ok=True)
    return path


@contextlib.contextmanager
def writing(path):
    """Raise an OSError inside again, as one about `path` and not about a file beside it."""
    try:
        yield
    except OSError as error:
        if error.errno is None:
            raise OSError(f"{path}: cannot be written: {error}") from error
        why = f"cannot be written: {os.strerror(error.errno)}"
        raise OSError(error.errno, why, str(path)) from error


def _is_result(path):
    """Whether a folder is a Zarr group of arrays and checksums: no sweep that can be resumed."""
    inside = {one.parent.name: one.read_text() for one in path.glob("*/zarr.json")}
    groups = {k for k, text in inside.items() if '"node_type":"group"' in "".join(text.split())}
    deeper = any(path.glob("*/*/zarr.json"))
    return (path / "zarr.json").is_file() and groups <= {CHECKSUMS} and not deeper
