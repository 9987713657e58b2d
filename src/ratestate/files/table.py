"""Results as CSV."""

import csv
import io
import itertools

import numpy as np

from .parts import PARTS

#: dimensions of a few numbers each, which make columns of a table, not rows
ACROSS = ("mode", "multiplier")
#: dimension of the loading's own record, which is no part of a table of results
RECORD = "segment"


def csv_text(data):
    """A result as CSV: a header such as ``time [s],V [m/s],mu``, then a row for each time or case.

    Single numbers of a result that has rows, such as ``status`` of a run, are left out; without
    rows they are the one row.  Numbers are exact, what is missing is empty, yes and no are 1 and
    0, a complex number takes two columns, ``NAME.real`` and ``NAME.imag``.
    """
    text = io.StringIO()
    _write(data, text)
    return text.getvalue()


def write_csv(data, path):
    with path.open("w", newline="", encoding="utf-8") as file:
        _write(data, file)


def _write(data, file):
    """Write the table into an open file."""
    rows = [dim for dim in data.sizes if dim not in (*ACROSS, RECORD)]
    shape = tuple(data.sizes[dim] for dim in rows)
    first = {dim: data[dim].variable for dim in rows if dim in data.variables}
    others = {k: v for k, v in data.variables.items() if k not in first}
    columns: dict = {}
    for name, variable in (first | others).items():
        if RECORD in variable.dims or (rows and not set(rows) & set(variable.dims)):
            continue
        for label, part in _columns(name, variable):
            full = part.set_dims({**dict(zip(rows, shape, strict=True)), **part.sizes})
            columns[label] = _cells(full.transpose(*rows).values.ravel())
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*columns.values(), strict=True))


def _columns(name, variable):
    """The columns that a variable makes: (label, real Variable without dimensions `ACROSS`)."""
    unit = variable.attrs.get("units", "1")
    unit = "" if unit == "1" else f" [{unit}]"
    across = [dim for dim in variable.dims if dim in ACROSS]
    for index in itertools.product(*(range(variable.sizes[dim]) for dim in across)):
        one = variable.isel(dict(zip(across, index, strict=True)))
        label = name + "".join(f"[{i}]" for i in index)
        if one.dtype.kind == "c":
            for part, of in PARTS.items():
                yield f"{label}.{part}{unit}", one.copy(data=of(one.values))
        else:
            yield label + unit, one


def _cells(values):
    """Values as they stand in the table."""
    if values.dtype.kind == "b":
        return values.astype(int).tolist()
    if values.dtype.kind == "f" and np.isnan(values).any():
        return ["" if x != x else x for x in values.tolist()]
    return values.tolist()
