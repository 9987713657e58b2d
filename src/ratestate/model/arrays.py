"""Named arrays: the axes of a sweep, whether several fit together, and columns of a record."""

import dataclasses
from collections.abc import Mapping

import numpy as np

from ..errors import ParameterError
from .quantities import expected
from .units import is_array, to_si


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


def continued(t, columns, pieces, symbol):
    """Times and columns, ``segment`` last, up to the first of some pieces, and then the pieces.

    ParameterError if DataArrays clash.

    t : (S,) starts of segments; pieces : tuples (start, value of each column), floats or DataArrays
    symbol : what the values are
    """
    starts, *added = zip(*pieces, strict=True)
    kept = t < starts[0]
    more = (_appended(x[..., kept], new, symbol) for x, new in zip(columns, added, strict=True))
    return np.concatenate([t[kept], starts]), *more


def _appended(column, values, symbol):
    if not any(map(is_array, (column, *values))):
        return np.append(column, values)
    import xarray

    column = as_column(column)
    ends = [xarray.DataArray(value).expand_dims("segment") for value in values]
    named = {f"{symbol} {i}": value for i, value in enumerate(values)}
    check_aligned({f"{symbol} before": column.isel(segment=-1), **named})
    apart = xarray.broadcast(column, *ends, exclude=["segment"])
    parts = [part.transpose(..., "segment") for part in apart]
    data = np.concatenate([part.values for part in parts], axis=-1)
    coords = {name: c for part in parts for name, c in part.coords.items()}
    return xarray.DataArray(data, coords, parts[0].dims)


def as_column(values):
    """A column as a DataArray along ``segment``, if it is not one already."""
    import xarray

    return values if is_array(values) else xarray.DataArray(values, dims="segment")


def picked(t, k, columns, numbers):
    """Values of columns in the segments k of times t, and numbers of these times, a list.

    All are arrays of the shape of t; or all DataArrays, with ``time`` last, if t or a column is.
    """
    if not any(map(is_array, (t, *columns))):
        return [*(column[k] for column in columns), *numbers]
    import xarray

    frame = t if is_array(t) else xarray.DataArray(k, dims=["time"][: k.ndim])
    found = (as_column(column).isel(segment=frame.copy(data=k)) for column in columns)
    ordered = (values.transpose(..., "time", missing_dims="ignore") for values in found)
    return [*ordered, *(frame.copy(data=values) for values in numbers)]
