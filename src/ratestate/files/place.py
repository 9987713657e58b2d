"""Check that files can be written, before the work begins, and write each as a whole."""

import contextlib
import json
import os
import shutil
import stat
import tempfile
import uuid
from pathlib import Path

from ..errors import ParameterError

#: attribute of a result with the digests of its variables
DIGESTS = "sha256"
#: file of Zarr with the attributes of a folder
METADATA = "zarr.json"
#: endings of files with pictures
PICTURES = (".png", ".pdf")


def checked_path(path, endings):
    """Check that a file can be written at a path, before the work for it begins.

    Parameters
    ----------
    path : str or Path
        The file, which may exist.
    endings : tuple of str
        Endings that its name may have, such as ".nc".

    Returns
    -------
    Path
        The path, with ~ expanded.

    Raises
    ------
    ParameterError
        If the name has another ending, if its parent folder does not exist, or if the path is a
        folder that `write` did not make.
    OSError
        If a file cannot be made there.
    """
    path = Path(path).expanduser()
    ending = path.suffix.lower()
    if ending not in endings:
        raise ParameterError(
            f"the name {str(path)!r} has an unsupported ending",
            f"Give a name that ends in {listed(endings)}.",
        )
    if path.is_dir() and not (ending == ".zarr" and _is_replaceable(path)):
        problem = "holds files that are not of one result" if ending == ".zarr" else "is a folder"
        raise ParameterError(f"{path} {problem}, and is not replaced", "Give another name.")
    if ending == ".zarr" and path.is_file():
        raise ParameterError(
            f"{path} is a file and not a folder", "Remove it, or give another name."
        )
    folder = _real(path).parent
    if not folder.is_dir():
        raise ParameterError(f"the folder of {path} does not exist", f"Make {folder} first.")
    with writing(path), tempfile.TemporaryFile(dir=folder):
        pass
    return path


def make_writable(folder):
    """Make the folder, parents too, and check that files can be written there; else OSError."""
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()


def listed(endings):
    """Return endings for a message, such as ".nc, .csv or .zarr"."""
    return " or ".join(filter(None, [", ".join(endings[:-1]), endings[-1]]))


def replace(path, write):
    """Write a file or folder next to `path` and rename it, so that nobody finds half a file.

    If `write` fails, the previous file stays.  The new file has the permissions of the previous
    one.  If the path is a link, it stays, and the file that it points to is replaced.

    Parameters
    ----------
    path : Path
        The file or folder, which is not checked (see `checked_path`).
    write : callable
        Function of a Path that makes the file or folder there.  If it raises an OSError, the
        message names `path`.

    Returns
    -------
    Path
        The path.
    """
    place = _real(path)
    partial = place.with_name(f".{path.stem}.{uuid.uuid4().hex}.partial{path.suffix}")
    with writing(path):
        try:
            write(partial)
            if place.exists():
                partial.chmod(stat.S_IMODE(place.stat().st_mode))
            if place.is_dir():
                _exchange(partial, place)
            else:
                partial.replace(place)
        finally:
            if partial.is_dir():
                shutil.rmtree(partial)
            partial.unlink(missing_ok=True)
    return path


def _exchange(new, folder):
    """Replace a folder by a new one; restore it if that fails."""
    replaced = new.with_name(f"{new.name}.old")
    folder.rename(replaced)
    try:
        new.rename(folder)
    except BaseException:
        replaced.rename(folder)
        raise
    shutil.rmtree(replaced)


def _real(path):
    """Return the path, or the target of a link, which need not exist."""
    return Path(os.path.realpath(path)) if path.is_symlink() else path


@contextlib.contextmanager
def writing(path):
    """Make an OSError inside name `path`, and not a temporary file."""
    try:
        yield
    except OSError as error:
        if error.errno is None:
            raise OSError(f"{path}: cannot be written: {error}") from error
        why = f"cannot be written: {os.strerror(error.errno)}"
        raise OSError(error.errno, why, str(path)) from error


def _is_replaceable(path):
    """Return whether a folder holds nothing, or only the files of a result that `write` made."""
    if not any(path.iterdir()):
        return True
    try:
        names = json.loads(json.loads((path / METADATA).read_text())["attributes"][DIGESTS])
    except (OSError, ValueError, KeyError, TypeError):
        return False
    files = (file for file in path.rglob("*") if file.is_symlink() or not file.is_dir())
    return all(_is_of_result(file.relative_to(path).parts, names) for file in files)


def _is_of_result(parts, names):
    """Return whether a path (tuple) is metadata of the folder, or a variable's metadata or data."""
    if parts == (METADATA,):
        return True
    variable, *inside = parts
    is_data = inside[:1] == ["c"] and all(part.isdecimal() for part in inside[1:])
    return variable in names and (is_data or inside == [METADATA])
