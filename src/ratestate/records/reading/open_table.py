"""Opens a file as a table; its first bytes decide the format."""

from pathlib import Path

from ..messages import reading as sentences
from .isolated import read_isolated
from .memory_file import MemoryFile, read_into_memory
from .stored import read_hdf5, read_mat
from .text import DELIMITERS, read_text

#: what a file is -> its first bytes (those behind 512 others count too), the ending of its name
#: where that decides, and its reader; a file of no such kind is text
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


def file_of(file):
    """A path, or an open binary file, as a Path or a `MemoryFile`; ParameterError if it is none.

    A `MemoryFile` is returned as it is.
    """
    if isinstance(file, MemoryFile):
        return file
    try:
        return read_into_memory(file) if hasattr(file, "read") else Path(file).expanduser()
    except TypeError:
        raise sentences.refusal("file.path", path=file) from None


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
            if (
                head.startswith(begin)
                or head[512:].startswith(begin)
                or path.suffix.lower() == ending
            ):
                return read_isolated(reader, path, kind)
        for begin, what in FOREIGN.items():
            if head.startswith(begin):
                raise sentences.refusal("file.foreign", name=path.name, what=what)
        return read_text(path, delimiters, decimal)
    except OSError as error:
        raise sentences.refusal("file.error", path=path, error=error.strerror or error) from None
