"""Opens a file, on disk or in memory, as a table; its first bytes decide the format."""

import io
from pathlib import Path, PurePath
from types import SimpleNamespace
from typing import NamedTuple

from ..kit.processes import read_isolated
from ..messages import reading as sentences
from .stored import read_hdf5, read_mat
from .text import DELIMITERS, read_text

#: format -> its first bytes (maybe after 512 others), the ending of a name that decides, the reader
FORMATS = {
    "HDF5": (b"\x89HDF\r\n\x1a\n", None, read_hdf5),
    "a MAT file": (b"MATLAB 5.0", ".mat", read_mat),
}
#: how files begin that hold tables of another kind
FOREIGN = {
    b"PK\x03\x04": "a spreadsheet or an archive",
    b"\xd0\xcf\x11\xe0": "a spreadsheet of an old kind",
    b"CDF": "NetCDF 3",
    b"%PDF": "a PDF",
    b"\x1f\x8b": "compressed",
}


class MemoryFile(NamedTuple):
    """The contents of a file, with what readers use of a path: its name, size and bytes."""

    name: str  # the ending decides the format, and messages have it
    contents: bytes

    def __str__(self):
        return self.name

    def stat(self):
        """The size, as ``st_size``."""
        return SimpleNamespace(st_size=len(self.contents))

    def open(self, mode="rb"):
        """The contents as a binary file, to be read."""
        return io.BytesIO(self.contents)


def file_of(file):
    """A path, or an open binary file, as a Path or a `MemoryFile`; ParameterError for others.

    A binary file is read from where it stands to its end, and is called "the file" if it has no
    name.  A `MemoryFile` is returned as it is.
    """
    if isinstance(file, MemoryFile):
        return file
    try:
        if not hasattr(file, "read"):
            return Path(file).expanduser()
        contents = file.read()
        if isinstance(contents, bytes):
            name = getattr(file, "name", None)  # maybe a number, or nothing
            return MemoryFile(
                PurePath(name).name if isinstance(name, str) else "the file", contents
            )
    except TypeError:
        pass
    raise sentences.refusal("file.path", path=file)


def open_table(path, delimiters=DELIMITERS, decimal=None):
    """The `Table` in a file, a Path or `MemoryFile`; ParameterError if it is of no known format.

    delimiters, decimal : as of `read_text`
    """
    try:
        if isinstance(path, Path) and not path.is_file():  # a pipe would be waited for
            kind = "folder" if path.is_dir() else "special" if path.exists() else "missing"
            raise sentences.refusal(f"file.{kind}", path=path)
        with path.open("rb") as file:
            head = file.read(1024)
        for kind, (begin, ending, reader) in FORMATS.items():
            begins = head.startswith(begin) or head[512:].startswith(begin)
            if begins or PurePath(path.name).suffix.lower() == ending:
                return read_isolated(reader, path, kind)
        for begin, what in FOREIGN.items():
            if head.startswith(begin):
                raise sentences.refusal("file.foreign", name=path.name, what=what)
        return read_text(path, delimiters, decimal)
    except OSError as error:
        raise sentences.refusal("file.error", path=path, error=error.strerror or error) from None
