"""Results as CSV in SI, and tables of events, steps or holds in um, MPa and GPa/m."""

import itertools

import numpy as np

from ..errors import ParameterError
from ..model.conversion import check_result, in_si
from ..model.names import one_of
from ..model.quantities import QUANTITIES
from ..model.units import unit_factor
from .stored import PARTS

#: dimensions of a few numbers each, which are columns of a table, not rows
COLUMN_DIMS = ("mode", "multiplier")
#: dimension of the loading's own record, which is no part of a table of results
RECORD = "segment"
FORMAT = {"index": False, "lineterminator": "\n"}
#: SI unit -> the unit in a table, whatever the values: so columns of several tables can be joined
UNITS = {"m": "um", "m/s": "um/s", "Pa": "MPa", "Pa/m": "GPa/m", "Pa s/m": "MPa s/m"}
#: lengths that are displacements of the load point, over a whole experiment
LENGTH_UNITS = {"delta_lp": "mm", "step_delta_lp": "mm"}
#: separates the lines of a text in a table
BETWEEN_LINES = " | "


def csv_text(data):
    """Return a result as CSV: a header such as ``time [s],mu``, then a row for each time or case.

    Single numbers, such as ``status`` of a run, are left out.  If a result has only single numbers,
    they are written as one row.  Numbers are exact, in the units of the result.  Missing values are
    empty, and True and False are 1 and 0.  A complex number takes two columns, ``NAME.real`` and
    ``NAME.imag``.  Eigenvalues and multipliers have columns for each, such as ``NAME[0].real``.

    Parameters
    ----------
    data : xarray.Dataset
        A result of any function.  Anything but a Dataset raises ParameterError.

    Returns
    -------
    str
        The table, a line for each row.
    """
    import pandas

    check_result(data)
    rows = [dim for dim in data.sizes if dim not in (*COLUMN_DIMS, RECORD)]
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
    # (with None, whole numbers would turn float)
    return pandas.DataFrame(columns, dtype=object).to_csv(**FORMAT)


def _columns(name, variable):
    """Yield the columns of a variable: (label, real Variable without dimensions `COLUMN_DIMS`)."""
    unit = variable.attrs.get("units", "1")
    unit = "" if unit == "1" else f" [{unit}]"
    across = [dim for dim in variable.dims if dim in COLUMN_DIMS]
    for index in itertools.product(*(range(variable.sizes[dim]) for dim in across)):
        column = variable.isel(dict(zip(across, index, strict=True)))
        label = name + "".join(f"[{i}]" for i in index)
        if column.dtype.kind == "c":
            for part, (_, part_of) in PARTS.items():
                yield f"{label}.{part}{unit}", column.copy(data=part_of(column.values))
        else:
            yield label + unit, column


def laboratory_csv(data, dim, units=None):
    """Return variables along one dimension as CSV, with headings such as ``stress drop (MPa)``.

    A heading is the name of the variable without underscores.  Each quantity has one unit in all
    tables: speeds um/s, stresses MPa, stiffness GPa/m, lengths um, displacements of the load point
    mm, times s.  The next column is its standard error, the variable ``NAME_error``.  Numbers have
    ten digits.  Flags are written as their meanings, and True and False as words.  The lines of a
    text are joined by " | ".  Missing values are empty.

    Parameters
    ----------
    data : xarray.Dataset
        A result with variables along this dimension alone.  All others are left out.
    dim : str
        The dimension: a row for each of its values.
    units : dict, optional
        Name of a variable -> its unit, such as ``{"stress_drop": "kPa"}``.

    Returns
    -------
    str
        The table: a heading, then a line for each row.

    Raises
    ------
    ParameterError
        If data is not a Dataset, no variable lies along the dimension, or a unit belongs to no
        variable or does not fit.
    """
    import pandas

    check_result(data)
    data, units = in_si(data), dict(units or {})
    names = [name for name, variable in data.variables.items() if variable.dims == (dim,)]
    if not names:
        raise ParameterError(f"the result has no variable along {dim!r}", one_of(data.sizes))
    for name in units:
        if name not in names:
            raise ParameterError(
                f"units: the result has no variable {name} along {dim!r}", one_of(names, name)
            )
    columns: dict = {}
    for name in sorted(names, key=lambda name: name != dim):
        if name.removesuffix("_error") in names and name.endswith("_error"):
            continue
        heading, values, unit, size = _column(name, data[name], units)
        columns[_with_unit(heading, unit)] = values
        if f"{name}_error" in names:
            error = data[f"{name}_error"].values / size
            columns[_with_unit(f"{heading} error", unit)] = error
    return pandas.DataFrame(columns).to_csv(float_format="%.10g", **FORMAT)


def _column(name, variable, units):
    """Return the heading, the values in their unit, this unit, and its size in SI."""
    heading = str(name).replace("_", " ")
    if "flag_meanings" in variable.attrs:
        codes = np.atleast_1d(variable.attrs["flag_values"]).tolist()
        meanings = dict(zip(codes, variable.attrs["flag_meanings"].split(), strict=True))
        texts = [meanings[code].replace("_", " ") for code in variable.values.tolist()]
        return heading, texts, "", 1.0
    if variable.dtype.kind not in "fiu":
        texts = [BETWEEN_LINES.join(str(value).splitlines()) for value in variable.values.tolist()]
        return heading, texts, "", 1.0
    si = QUANTITIES[name].unit if name in QUANTITIES else str(variable.attrs.get("units", "1"))
    try:
        unit, size = laboratory_unit(name, si, units.get(name))
    except ValueError as error:
        raise ParameterError(
            str(error), f"Give a unit of {si}.", symbol=name, value=repr(units[name])
        ) from None
    return heading, variable.values / size, unit, size


def laboratory_unit(name, si, unit=None):
    """Return the unit of a quantity in tables, "" for a pure number, and its size in SI.

    By default SI decides.  ValueError if the unit does not fit.
    """
    if unit is None:
        unit = LENGTH_UNITS.get(name, UNITS.get(si, si))
    size = 1.0 if unit == si else float(unit_factor(si, unit))
    return "" if unit == "1" else unit, size


def _with_unit(heading, unit):
    return f"{heading} ({unit})" if unit else heading
