"""Tables in a laboratory's units as CSV: a row for each event, step or hold."""

import numpy as np

from ..errors import ParameterError
from ..model.conversion import in_si
from ..model.names import one_of
from ..model.quantities import QUANTITIES
from ..model.units import unit_factor
from .table import FORMAT

#: SI unit -> the unit in a table, whatever the values: so columns of several tables can be joined
UNITS = {"m": "um", "m/s": "um/s", "Pa": "MPa", "Pa/m": "GPa/m", "Pa s/m": "MPa s/m"}
#: lengths that are displacements of the load point, over a whole experiment
LONG = {"delta_lp": "mm", "step_delta_lp": "mm"}
#: between the lines of a text, which has none in a table
BETWEEN_LINES = " | "


def laboratory_csv(data, dim, units=None):
    """Variables along one dimension as CSV, with headings such as ``stress drop (MPa)``.

    Headings are the variables' names.  Each quantity has its unit in all tables: speeds um/s,
    stresses MPa, stiffness GPa/m, lengths um, but displacements of the load point mm, times s.  Its
    standard error, the variable ``NAME_error``, is beside it.  Flags are written as what they mean,
    lines of a text with " | " between them; what is missing is empty.

    Parameters
    ----------
    data : xarray.Dataset
        A result with variables along this dimension alone; all others are left out.
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
        No variable along the dimension; a unit of a variable that is not there, or of another kind.
    """
    import pandas

    data, units = in_si(data), dict(units or {})
    names = [name for name, one in data.variables.items() if one.dims == (dim,)]
    if not names:
        raise ParameterError(f"there is no variable along {dim!r}; {one_of(data.sizes)}")
    for name in units:
        if name not in names:
            raise ParameterError(f"units: no variable {name} along {dim!r}; {one_of(names, name)}")
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
    """Heading, values in its unit, that unit, and its size in SI."""
    heading = str(name).replace("_", " ")
    if "flag_meanings" in variable.attrs:
        meanings = dict(
            zip(
                np.atleast_1d(variable.attrs["flag_values"]).tolist(),
                variable.attrs["flag_meanings"].split(),
                strict=True,
            )
        )
        texts = [meanings[code].replace("_", " ") for code in variable.values.tolist()]
        return heading, texts, "", 1.0
    if variable.dtype.kind not in "fiu":
        texts = [BETWEEN_LINES.join(str(one).splitlines()) for one in variable.values.tolist()]
        return heading, texts, "", 1.0
    si = QUANTITIES[name].unit if name in QUANTITIES else str(variable.attrs.get("units", "1"))
    try:
        unit, size = laboratory_unit(name, si, units.get(name))
    except ValueError as error:
        raise ParameterError(f"{name}: {units[name]!r} {error}") from None
    return heading, variable.values / size, unit, size


def laboratory_unit(name, si, unit=None):
    """The unit of a quantity in tables, "" of a pure number, and its size in SI.

    By default that of its SI unit; ValueError for another that is of another kind.
    """
    if unit is None:
        unit = LONG.get(name, UNITS.get(si, si))
    size = 1.0 if unit == si else float(unit_factor(si, unit))
    return "" if unit == "1" else unit, size


def _with_unit(heading, unit):
    return f"{heading} ({unit})" if unit else heading
