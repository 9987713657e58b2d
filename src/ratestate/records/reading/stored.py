"""Columns in HDF5 files (NetCDF 4 and MATLAB 7.3 among them) and in older MAT files."""

import numpy as np

from ..messages import reading as sentences
from .columns import Column, Table, quoted
from .titles import name_and_units

#: attributes in which units, and names of columns of an array, are kept
UNITS = ("units", "unit", "Units", "Unit", "UNITS")
NAMES = ("columns", "column_names", "names", "labels", "header", "fields")
SMALLEST = 2  # rows
#: bytes that a byte of a file can hold: deflate packs 1,032 of them into one at most
UNPACKED = 1100


def read_hdf5(path):
    """The `Table` of all columns of numbers in an HDF5 file, wherever they are in it.

    ParameterError if there are none, or more bytes than a file of its size can hold; h5py's OSError
    if it is no HDF5.
    """
    import h5py

    columns: list[Column] = []
    texts: list[str] = []
    size = path.stat().st_size
    remaining = UNPACKED * size

    def visit(title, item):
        nonlocal remaining
        # MATLAB keeps texts as numbers, and what cells refer to in a group of its own
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
        columns.extend(_columns(title, item[()], item.attrs))

    with path.open("rb") as stored, h5py.File(stored, "r") as file:
        refuse_other_files(file, path.name)
        file.visititems(visit)
    return _table(path, columns, texts)


def refuse_other_files(file, name):
    """Raise ParameterError if an open HDF5 file takes data from other files: it may name any.

    By an external link, external storage or a virtual dataset.

    file : h5py.File
    name : of the file, for the message
    """
    import h5py

    def other_of_data(title, item):
        if isinstance(item, h5py.Dataset):
            others = [other for other, *_ in item.external or ()]
            sources = item.virtual_sources() if item.is_virtual else []
            others += [one.file_name for one in sources if one.file_name != "."]  # this file
            return (title, others[0]) if others else None

    def other_of_link(title, link):
        return (title, link.filename) if isinstance(link, h5py.ExternalLink) else None

    if found := file.visititems_links(other_of_link) or file.visititems(other_of_data):
        title, other = map(quoted, found)
        raise sentences.refusal("file.elsewhere", name=name, title=title, other=other)


def read_mat(path):
    """The `Table` of all columns of numbers in a MAT file, those in structs among them.

    ParameterError if there are none; SciPy's own errors for a file that it cannot read.
    """
    from scipy.io import loadmat

    with path.open("rb") as stored:
        return _table(path, list(_in_struct("", loadmat(stored, simplify_cells=True))))


def _in_struct(group, struct):
    """The columns of a struct, whose field ``units`` may have a unit for each."""
    units: dict = next((struct[key] for key in UNITS if isinstance(struct.get(key), dict)), {})
    for name, value in struct.items():
        if name.startswith("__"):
            continue
        title = f"{group}/{name}" if group else name
        if isinstance(value, dict):
            yield from _in_struct(title, value)
        elif isinstance(value, np.ndarray):
            unit = units.get(name)
            yield from _columns(title, value, {"units": unit} if isinstance(unit, str) else {})


def _columns(title, values, attrs):
    """The columns that an array is: one, the fields of a table, or those of a matrix."""
    if not isinstance(values, np.ndarray) or values.size < SMALLEST:
        return
    parts = []  # titles, names and values
    if values.dtype.names:
        names = [name for name in values.dtype.names if values.dtype[name].kind in "iuf"]
        parts = [(f"{title}/{name}", name, values[name].ravel()) for name in names]
    elif values.dtype.kind in "iuf":
        values = _unpacked(np.squeeze(values), attrs)
        if values.ndim == 1:
            parts = [(title, title.rpartition("/")[2], values)]
        elif values.ndim == 2:
            rows = values if values.shape[0] > values.shape[1] else values.T
            for i, name in enumerate(_texts(_first(attrs, NAMES), rows.shape[1])):
                parts.append((f"{title}/{name}" if name else f"{title}[{i + 1}]", name, rows[:, i]))
    units = _texts(_first(attrs, UNITS), len(parts))
    for (own_title, name, column), unit in zip(parts, units, strict=True):
        name, unit, other = name_and_units(name, unit)
        yield Column(own_title, name, unit, column.astype(float), other)


def _first(attrs, keys):
    return next((attrs[key] for key in keys if key in attrs), "")


def _texts(value, count):
    """An attribute as so many texts: one each, or the same (or nothing) for all."""
    texts = [
        item.decode("utf-8", "replace") if isinstance(item, bytes) else str(item)
        for item in np.atleast_1d(value).tolist()
    ]
    if len(texts) == 1 and count > 1 and "," in texts[0]:
        texts = [text.strip() for text in texts[0].split(",")]
    if len(texts) == count:
        return texts
    return texts * count if len(texts) == 1 and "," not in texts[0] else [""] * count


def _unpacked(values, attrs):
    """Values with the scale, offset and mark for missing ones that NetCDF knows."""
    if not {"scale_factor", "add_offset", "_FillValue"} & set(attrs):
        return values
    numbers = values.astype(float)
    if "_FillValue" in attrs:
        numbers[values == attrs["_FillValue"]] = np.nan
    return numbers * attrs.get("scale_factor", 1.0) + attrs.get("add_offset", 0.0)


def _table(path, columns, texts=()):
    table = Table(columns, unread=tuple(texts), name=path.name)
    if not columns:
        raise sentences.refusal("file.no_columns", name=path.name, unread=table.unread_text())
    return table
