"""Results as CSV."""

import itertools

from .netcdf import PARTS

#: dimensions of a few numbers each, which make columns of a table, not rows
ACROSS = ("mode", "multiplier")
#: dimension of the loading's own record, which is no part of a table of results
RECORD = "segment"
FORMAT = {"index": False, "lineterminator": "\n"}


def csv_text(data):
    """A result as CSV: a header such as ``time [s],V [m/s],mu``, then a row for each time or case.

    Single numbers of a result that has rows, such as ``status`` of a run, are left out; without
    rows they are the one row.  Numbers are exact, what is missing is empty, yes and no are 1 and
    0, a complex number takes two columns, ``NAME.real`` and ``NAME.imag``.

    Parameters
    ----------
    data : xarray.Dataset
        A result of any function.

    Returns
    -------
    str
        The table, a line for each row.
    """
    return _frame(data).to_csv(**FORMAT)


def write_csv(data, path):
    """Write `csv_text` of a result; the path is not checked."""
    _frame(data).to_csv(path, **FORMAT)


def _frame(data):
    """The table as a pandas DataFrame."""
    import pandas

    rows = [dim for dim in data.sizes if dim not in (*ACROSS, RECORD)]
    sizes = {dim: data.sizes[dim] for dim in rows}
    first = {dim: data[dim].variable for dim in rows if dim in data.variables}
    others = {k: v for k, v in data.variables.items() if k not in first}
    columns: dict = {}
    for name, variable in (first | others).items():
        if RECORD in variable.dims or (rows and not set(rows) & set(variable.dims)):
            continue
        for label, part in _columns(name, variable):
            values = part.set_dims({**sizes, **part.sizes}).transpose(*rows).values.ravel()
            columns[label] = (values + 0 if values.dtype.kind == "b" else values).tolist()
    return pandas.DataFrame(columns, dtype=object)  # with None, whole numbers would turn float


def _columns(name, variable):
    """The columns that a variable makes: (label, real Variable without dimensions `ACROSS`)."""
    unit = variable.attrs.get("units", "1")
    unit = "" if unit == "1" else f" [{unit}]"
    across = [dim for dim in variable.dims if dim in ACROSS]
    for index in itertools.product(*(range(variable.sizes[dim]) for dim in across)):
        one = variable.isel(dict(zip(across, index, strict=True)))
        label = name + "".join(f"[{i}]" for i in index)
        if one.dtype.kind == "c":
            for part, (_, of) in PARTS.items():
                yield f"{label}.{part}{unit}", one.copy(data=of(one.values))
        else:
            yield label + unit, one
