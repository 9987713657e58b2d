"""Named arrays: the axes of a sweep, whether several fit together, and columns of a record."""

import dataclasses
from collections.abc import Mapping

import numpy as np

from ..errors import ParameterError
from .other_units import quantity_of
from .quantities import QUANTITIES, attrs, expected
from .units import is_array, is_integer, to_si

#: longest axis of a sweep
MOST_VALUES = 10_000_000


def logspace(name, start, stop, n):
    """Axis of a sweep with geometric spacing.

    Parameters
    ----------
    name : str
        Symbol of the quantity, for example "M" [kg/m^2] or "V_lp" [m/s]; any other name makes an
        axis of pure numbers.
    start, stop : float, str or pint.Quantity
        First and last value, both > 0 and both kept exactly.  In SI, unless they carry a unit; for
        K, M and sigma one of any kind that `SpringSlider` takes, such as "1e-3/um" for K.
    n : int
        Number of values, at least 2.  Those between are rounded to 15 digits, so that
        ``.sel(M=1000)`` finds the 1000 between 100 and 10000.

    Returns
    -------
    xarray.DataArray
        Shape (n,).  Name, dimension and coordinate are all `name`; the coordinate of a known
        symbol has attributes ``units`` and ``long_name``.

    Raises
    ------
    ParameterError
        A name that is not a str; a value that is not > 0 or has a wrong unit; n that is not an
        integer from 2 to 10,000,000.

    Examples
    --------
    >>> logspace("M", 100, 1e5, 4).values.tolist()
    [100.0, 1000.0, 10000.0, 100000.0]
    """
    import xarray

    if not isinstance(name, str):
        raise ParameterError(f"name = {name!r} must be a symbol in quotes, for example 'M'")
    symbol = quantity_of(name, start) if name in QUANTITIES else "number"
    ends = [
        to_si(symbol, value, label=f"{name} ({which})", bound="> 0")
        for which, value in (("start", start), ("stop", stop))
    ]
    if any(is_array(end) or np.isinf(end) for end in ends):
        raise ParameterError(f"{name}: start and stop must be finite numbers, not arrays")
    if not is_integer(n) or not 2 <= n <= MOST_VALUES:
        raise ParameterError(f"n = {n!r} must be an integer from 2 to {MOST_VALUES:,}, such as 12")
    values = np.array([float(f"{x:.15g}") for x in np.geomspace(ends[0], ends[1], int(n))])
    values[[0, -1]] = ends
    labels = attrs(symbol) if name in QUANTITIES else {}
    # Unit and name sit on the coordinate only: xarray would carry those of the array through
    # arithmetic, and V_lp = np.sqrt(eta * ...) would claim to be a pure number.
    own = {} if symbol in (name, "number") else {"units": labels["units"]}
    return xarray.DataArray(values, {name: (name, values, labels)}, (name,), name, own)


def check_aligned(values):
    """Raise ParameterError where DataArrays of this dict clash along a dimension: size or labels.

    values : symbol -> value; those that are no DataArray are ignored
    """
    seen: dict = {}
    arrays = ((symbol, value) for symbol, value in values.items() if is_array(value))
    for symbol, value in arrays:
        for dim, size in value.sizes.items():
            index = value.indexes.get(dim)
            other, other_size, other_index = seen.get(dim, (symbol, size, index))
            if size != other_size:
                clash = f"have {other_size} and {size} values"
            elif index is not None and other_index is not None and not index.equals(other_index):
                clash = "have different coordinates"
            else:
                if dim not in seen or other_index is None:
                    seen[dim] = (symbol, size, index)
                continue
            raise ParameterError(
                f"{other} and {symbol} {clash} along the dimension {dim!r}; give both the same "
                f"coordinate, or rename one dimension to sweep over all combinations"
            )


def cut(value, places):
    """DataArrays, also in a dataclass or dict, at some places of a sweep; anything else as it is.

    places : dimension -> indices or slice; those that a DataArray lacks do not count
    """
    if is_array(value):
        return value.isel(places, missing_dims="ignore")
    if hasattr(value, "parameters") and hasattr(value, "replace"):  # a slider
        return value.replace(**{name: cut(x, places) for name, x in value.parameters.items()})
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        parts = {f.name: cut(getattr(value, f.name), places) for f in dataclasses.fields(value)}
        return dataclasses.replace(value, **parts)
    return {k: cut(v, places) for k, v in value.items()} if isinstance(value, dict) else value


def column(symbol, values):
    """Column of a record [SI], each value >= 0: ndarray (n,), or DataArray with ``segment`` last.

    DataArray if an item of a sequence is one with dimensions.  ParameterError: a single number or
    text, no values, 2-D, < 0 (the symbol's own bound is not used), NaN, wrong unit.

    values : array of numbers, 1-D DataArray or pint quantity, or sequence of what `to_si` takes
    """
    import xarray

    units = {}
    if is_array(values):
        units = {key: text for key, text in values.attrs.items() if key == "units"}
    elif hasattr(values, "units") and hasattr(values, "magnitude"):
        units, values = {"units": str(values.units)}, values.magnitude
    if not hasattr(values, "__len__") or isinstance(values, str | Mapping):
        raise ParameterError(f"{symbol} = {values!r} is not a column of values; give an array")
    if hasattr(values, "dtype") or all(
        isinstance(value, int | float) and not isinstance(value, bool) for value in values
    ):
        numbers = np.asarray(values)
        if numbers.ndim != 1:
            raise ParameterError(f"{symbol} has {numbers.ndim} dimensions; a column has 1")
        if not numbers.size:
            raise ParameterError(f"{symbol} has no values; {expected(symbol)} in each row")
        rows = xarray.DataArray(numbers, dims="row", attrs=units)
        return to_si(symbol, rows, bound=">= 0").values
    items = {f"{symbol}[{i}]": value for i, value in enumerate(values)}
    return stack({row: to_si(symbol, v, label=row, bound=">= 0") for row, v in items.items()})


def stack(values):
    """Floats and DataArrays (name -> value) in a row: ndarray (n,), or DataArray, ``segment`` last.

    DataArray if one of them is; ParameterError, with their names, where they clash.
    """
    if not any(map(is_array, values.values())):
        return np.array(list(values.values()))
    import xarray

    check_aligned(values)
    arrays = xarray.broadcast(*map(xarray.DataArray, values.values()))
    data = np.stack([array.values for array in arrays], axis=-1)
    return xarray.DataArray(data, arrays[0].coords, (*arrays[0].dims, "segment"))


def running_sum(x):
    """Cumulative sum (new array, shape of x) along the last axis, as if in doubled precision.

    What each addition rounds off can be told exactly (Knuth's two-sum): it is summed as well.
    """
    total = np.cumsum(x, axis=-1)
    before, after = total[..., :-1], total[..., 1:]
    seen = after - before
    lost = (before - (after - seen)) + (x[..., 1:] - seen)
    total[..., 1:] += np.cumsum(lost, axis=-1)
    return total


def appended(column, values, symbol):
    """A column, ``segment`` last, with more values, floats or DataArrays, at its end.

    ParameterError where DataArrays clash; symbol : what the values are
    """
    if not any(map(is_array, (column, *values))):
        return np.append(column, values)
    import xarray

    column = column if is_array(column) else xarray.DataArray(column, dims="segment")
    ends = [xarray.DataArray(value).expand_dims("segment") for value in values]
    named = {f"{symbol} {i}": value for i, value in enumerate(values)}
    check_aligned({f"{symbol} before": column.isel(segment=-1), **named})
    apart = xarray.broadcast(column, *ends, exclude=["segment"])
    parts = [part.transpose(..., "segment") for part in apart]
    data = np.concatenate([part.values for part in parts], axis=-1)
    coords = {name: c for part in parts for name, c in part.coords.items()}
    return xarray.DataArray(data, coords, parts[0].dims)
