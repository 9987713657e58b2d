"""Tables in a laboratory's units as CSV: a row for each event, step or hold."""

import numpy as np

from ..errors import ParameterError
from ..model.conversion import in_si
from ..model.names import one_of
from ..model.quantities import QUANTITIES, power_of, prefixed_unit
from ..model.units import unit_factor
from .table import FORMAT


def laboratory_csv(data, dim, units=None):
    """Variables along one dimension as CSV, with headings such as ``stress drop (MPa)``.

    Headings are the variables' names.  Each quantity is in the prefixed unit that fits its median;
    its standard error, the variable ``NAME_error``, is beside it in the same unit.  Flags are
    written as what they mean; what is missing is empty.

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
    si = QUANTITIES[name].unit if name in QUANTITIES else str(variable.attrs.get("units", "1"))
    if si == "1" or variable.dtype.kind not in "fiu":
        return heading, variable.values, "", 1.0
    if name in units:
        try:
            size = float(unit_factor(si, units[name]))
        except ValueError as error:
            raise ParameterError(f"{name}: {units[name]!r} {error}") from None
        return heading, variable.values / size, units[name], size
    finite = np.abs(variable.values[np.isfinite(variable.values)])
    power = power_of(si, float(np.median(finite))) if finite.size else 0
    size = 10.0**power
    return heading, variable.values / size, prefixed_unit(si, power), size


def _with_unit(heading, unit):
    return f"{heading} ({unit})" if unit else heading
