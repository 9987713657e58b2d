"""Open a file, on disk or in memory, as a table: detect its format; read HDF5 and MAT files.

NetCDF 4 and MATLAB 7.3 files are HDF5; "MAT" here means the older MATLAB format.
"""

import io
from pathlib import Path, PurePath
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import scipy

from ...errors import MissingFileError
from ..kit.processes import read_isolated
from ..messages import reading as sentences
from .columns import Column, Table, quoted
from .text import DELIMITERS, read_text
from .titles import name_and_units

#: first bytes of files; in HDF5, 512 other bytes may precede them
HDF5, MAT = b"\x89HDF\r\n\x1a\n", b"MATLAB 5.0"
#: first bytes of files that are refused -> what they are
OTHER_FORMATS = {
    b"PK\x03\x04": "a spreadsheet or an archive",
    b"\xd0\xcf\x11\xe0": "a spreadsheet of an old kind",
    b"CDF": "NetCDF 3",
    b"%PDF": "a PDF",
    b"\x1f\x8b": "compressed",
}
#: attributes that may hold the units, and the column names, of an array
UNIT_KEYS = ("units", "unit", "Units", "Unit", "UNITS")
NAME_KEYS = ("columns", "column_names", "names", "labels", "header", "fields")
MIN_ROWS = 2
#: most bytes of data for each byte of a file: deflate compresses by 1,032 times at most
MAX_EXPANSION = 1100


class MemoryFile(NamedTuple):
    """The contents of a file, with the part of the interface of a Path that readers use."""

    name: str  # for messages; a .mat ending decides the format
    contents: bytes

    def __str__(self):
        return self.name

    def stat(self):
        return SimpleNamespace(st_size=len(self.contents))

    def open(self, mode="rb"):
        return io.BytesIO(self.contents)


def as_file(file):
    """Return a Path for a path, or a `MemoryFile` for an open binary file or a `MemoryFile`.

    A binary file is read from its current position to its end.  Without a name, it is called "the
    file".  ParameterError for any other object.
    """
    if isinstance(file, MemoryFile):
        return file
    try:
        if not hasattr(file, "read"):
            return Path(file).expanduser()
        contents = file.read()
        if isinstance(contents, bytes):
            name = getattr(file, "name", None)  # it may be a number or missing
            return MemoryFile(
                PurePath(name).name if isinstance(name, str) else "the file", contents
            )
    except TypeError:
        pass
    raise sentences.refusal("file.path", path=file)


def open_table(path, delimiters=DELIMITERS, decimal=None):
    """Return the `Table` in a Path or `MemoryFile`; ParameterError if its format is unknown.

    delimiters, decimal : as for `read_text`
    """
    try:
        if isinstance(path, Path) and not path.is_file():  # opening a pipe would block
            if not path.exists():
                raise sentences.refusal("file.missing", MissingFileError, path=path)
            raise sentences.refusal("file.folder" if path.is_dir() else "file.special", path=path)
        with path.open("rb") as file:
            head = file.read(1024)
        if HDF5 in (head[: len(HDF5)], head[512 : 512 + len(HDF5)]):
            return read_isolated(read_hdf5, path, "HDF5")
        if head.startswith(MAT) or PurePath(path.name).suffix.lower() == ".mat":
            return read_isolated(read_mat, path, "a MAT file")
        for begin, format_name in OTHER_FORMATS.items():
            if head.startswith(begin):
                raise sentences.refusal("file.foreign", name=path.name, what=format_name)
        return read_text(path, delimiters, decimal)
    except MissingFileError:
        raise
    except OSError as error:
        raise sentences.refusal("file.error", path=path, error=error.strerror or error) from None


def read_hdf5(path):
    """Return the `Table` of all columns of numbers in an HDF5 file, in any group.

    ParameterError if there are none, or if they have more bytes than a file of this size can hold.
    h5py's OSError if it is not an HDF5 file.
    """
    import h5py

    columns: list[Column] = []
    texts: list[str] = []
    size = path.stat().st_size
    remaining = MAX_EXPANSION * size

    def visit(title, item):
        nonlocal remaining
        # MATLAB stores text as numbers, and the contents of cell arrays in a group "#refs#"
        hidden = title.startswith("#") or item.attrs.get("MATLAB_class") == b"char"
        if hidden or not isinstance(item, h5py.Dataset):
            return
        if item.ndim and item.dtype.kind not in "iufV":
            texts.append(title)
            return
        remaining -= item.nbytes
        if remaining < 0:
            values = {"name": path.name, "title": quoted(title), "bytes": item.nbytes}
            raise sentences.refusal("file.damaged", size=size, **values)
        columns.extend(_array_columns(title, item[()], item.attrs))

    with path.open("rb") as stored, h5py.File(stored, "r") as file:
        refuse_other_files(file, path.name)
        file.visititems(visit)
    return _make_table(path, columns, texts)


def refuse_other_files(file, name):
    """Raise ParameterError if an open HDF5 file takes data from other files.

    It may do so by an external link, external storage or a virtual dataset, and may then name any
    file of this machine.

    file : h5py.File
    name : file name, for the message
    """
    import h5py

    def other_of_data(title, item):
        if isinstance(item, h5py.Dataset):
            others = [other for other, *_ in item.external or ()]
            sources = item.virtual_sources() if item.is_virtual else []
            others += [x.file_name for x in sources if x.file_name != "."]  # this file
            return (title, others[0]) if others else None

    def other_of_link(title, link):
        return (title, link.filename) if isinstance(link, h5py.ExternalLink) else None

    if reference := file.visititems_links(other_of_link) or file.visititems(other_of_data):
        title, other = map(quoted, reference)
        raise sentences.refusal("file.elsewhere", name=name, title=title, other=other)


def read_mat(path):
    """Return the `Table` of all columns of numbers in a MAT file, including those in structs.

    ParameterError if there are none; SciPy's errors if it cannot read the file.
    """
    with path.open("rb") as stored:
        struct = scipy.io.loadmat(stored, simplify_cells=True)
    return _make_table(path, [*_struct_columns("", struct)])


def _struct_columns(group, struct):
    """Yield the columns of a struct; its field ``units`` may have their units."""
    units: dict = next((struct[key] for key in UNIT_KEYS if isinstance(struct.get(key), dict)), {})
    for name, value in struct.items():
        if name.startswith("__"):
            continue
        title = f"{group}/{name}" if group else name
        if isinstance(value, dict):
            yield from _struct_columns(title, value)
        elif isinstance(value, np.ndarray):
            unit = units.get(name)
            yield from _array_columns(
                title, value, {"units": unit} if isinstance(unit, str) else {}
            )


def _array_columns(title, values, attrs):
    """Yield the columns of an array: a vector, the fields of a table, or a matrix."""
    if not isinstance(values, np.ndarray) or values.size < MIN_ROWS:
        return
    parts = []  # titles, names and values
    if values.dtype.names:
        names = [name for name in values.dtype.names if values.dtype[name].kind in "iuf"]
        parts = [(f"{title}/{name}", name, values[name].ravel()) for name in names]
    elif values.dtype.kind in "iuf":
        values = _unpack(np.squeeze(values), attrs)
        if values.ndim == 1:
            parts = [(title, title.rpartition("/")[2], values)]
        elif values.ndim == 2:
            rows = values if values.shape[0] > values.shape[1] else values.T
            for i, name in enumerate(_texts(_first_of(attrs, NAME_KEYS), rows.shape[1])):
                parts.append((f"{title}/{name}" if name else f"{title}[{i + 1}]", name, rows[:, i]))
    units = _texts(_first_of(attrs, UNIT_KEYS), len(parts))
    for (full_title, name, column), unit in zip(parts, units, strict=True):
        name, unit, other = name_and_units(name, unit)
        yield Column(full_title, name, unit, column.astype(float), other)


def _first_of(attrs, keys):
    return next((attrs[key] for key in keys if key in attrs), "")


def _texts(value, count):
    """Return an attribute as `count` texts; a single text, or "", is repeated."""
    texts = [
        item.decode("utf-8", "replace") if isinstance(item, bytes) else str(item)
        for item in np.atleast_1d(value).tolist()
    ]
    if len(texts) == 1 and count > 1 and "," in texts[0]:
        texts = [text.strip() for text in texts[0].split(",")]
    if len(texts) == count:
        return texts
    return texts * count if len(texts) == 1 and "," not in texts[0] else [""] * count


def _unpack(values, attrs):
    """Apply NetCDF's scale factor, offset and fill value to an array."""
    if not {"scale_factor", "add_offset", "_FillValue"} & set(attrs):
        return values
    numbers = values.astype(float)
    if "_FillValue" in attrs:
        numbers[values == attrs["_FillValue"]] = np.nan
    return numbers * attrs.get("scale_factor", 1.0) + attrs.get("add_offset", 0.0)


def _make_table(path, columns, texts=()):
    table = Table(columns, unread=tuple(texts), name=path.name)
    if not columns:
        raise sentences.refusal("file.no_columns", name=path.name, unread=table.unread_text())
    return table
