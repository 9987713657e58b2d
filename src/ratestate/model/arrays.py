"""Named arrays: checks of a sweep's arrays, columns of a record, and cases as flat arrays."""

import dataclasses
import functools
import math
from collections.abc import Mapping

import numpy as np

from ..machine import check_fits
from .names import refusal
from .quantities import QUANTITIES, attrs
from .units import RESERVED, is_array, is_pint, to_si, unit_of

#: dimension of the rows of swept columns; no dimension of a sweep has this name
ROW = "row of the record"
#: product of parameters that the equations compute -> power of each parameter in it
PRODUCTS = {
    "K Dc/(a sigma)": {"K": 1, "Dc": 1, "a": -1, "sigma": -1},
    "a sigma/(K Dc)": {"a": 1, "sigma": 1, "K": -1, "Dc": -1},
    "M V_lp^2/(a sigma Dc)": {"M": 1, "V_lp": 2, "a": -1, "sigma": -1, "Dc": -1},
    "M V_start^2/(a sigma Dc)": {"M": 1, "V_start": 2, "a": -1, "sigma": -1, "Dc": -1},
    "V_lp^2": {"V_lp": 2},  # computed without mass too
}
#: largest power of 10 of a product: squares and cubes of larger ones overflow
LARGEST_EXPONENT = 100.0


def check_aligned(values):
    """Raise ParameterError if DataArrays differ in size or labels along a dimension.

    values : dict, symbol -> value; values that are not DataArrays are ignored
    """
    first: dict = {}
    arrays = ((symbol, value) for symbol, value in values.items() if is_array(value))
    for symbol, value in arrays:
        for dim, size in value.sizes.items():
            index = value.indexes.get(dim)
            other, other_size, other_index = first.get(dim, (symbol, size, index))
            if size != other_size:
                clash = f"have {other_size} and {size} values"
            elif index is not None and other_index is not None and not index.equals(other_index):
                clash = "have different coordinates"
            else:
                if dim not in first or other_index is None:
                    first[dim] = (symbol, size, index)
                continue
            symbols = f"{other} and {symbol}"
            raise refusal("arrays.clash", both=symbols, clash=clash, dim=dim)


def isel(value, indices):
    """Select cases from DataArrays, also in a slider, tuple, dataclass or dict.

    Other values are returned unchanged.
    indices : dict, dimension -> indices or slice; a DataArray ignores dimensions that it lacks
    """
    if is_array(value):
        return value.isel(indices, missing_dims="ignore")
    if hasattr(value, "parameters") and hasattr(value, "replace"):  # a slider
        return value.replace(**{name: isel(x, indices) for name, x in value.parameters.items()})
    if isinstance(value, tuple):
        return tuple(isel(x, indices) for x in value)
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        parts = {f.name: isel(getattr(value, f.name), indices) for f in dataclasses.fields(value)}
        return dataclasses.replace(value, **parts)
    return {k: isel(v, indices) for k, v in value.items()} if isinstance(value, dict) else value


def column_to_si(symbol, values):
    """Convert a column of a record to SI.

    Returns an ndarray (n,), or a DataArray with the last dimension ``segment`` if an item of a
    sequence is a DataArray with dimensions.  Raises ParameterError for a single number, a text, an
    empty or 2-D array, a value < 0 (whatever bound the symbol has), NaN and a wrong unit.

    values : array of numbers, 1-D DataArray or pint quantity, or sequence of values for `to_si`
    """
    import xarray

    if is_array(values) and values.dims[1:] and values.dims[-1] == "segment":  # from a result
        rows = to_si(symbol, values.rename(segment=ROW), bound=">= 0")
        return rows.rename({ROW: "segment"}).drop_attrs()
    unit = unit_of(values)
    values = values.magnitude if is_pint(values) else values
    if not hasattr(values, "__len__") or isinstance(values, str | Mapping):
        raise refusal("column.none", symbol=symbol, values=values)
    if hasattr(values, "dtype") or all(
        isinstance(value, int | float) and not isinstance(value, bool) for value in values
    ):
        numbers = np.asarray(values)
        if numbers.ndim != 1:
            raise refusal("column.dimensions", symbol=symbol, ndim=numbers.ndim)
        if not numbers.size:
            raise refusal("column.empty", symbol=symbol, wanted=QUANTITIES[symbol].remedy)
        rows = xarray.DataArray(numbers, dims="row", attrs={} if unit is None else {"units": unit})
        return to_si(symbol, rows, bound=">= 0").values
    items = {f"{symbol}[{i}]": value for i, value in enumerate(values)}
    return concat({row: to_si(symbol, v, label=row, bound=">= 0") for row, v in items.items()})


def concat(values):
    """Concatenate floats, DataArrays and columns, given as a dict (name -> value).

    Returns an ndarray (n,), or a DataArray with the last dimension ``segment`` if a value is a
    DataArray.  Raises ParameterError, with the names, if DataArrays clash.
    """
    if not any(map(is_array, values.values())):
        return np.hstack(list(values.values()))
    import xarray

    arrays = {name: as_column(value) for name, value in values.items()}
    check_aligned({name: array.isel(segment=0) for name, array in arrays.items()})
    broadcast = xarray.broadcast(*arrays.values(), exclude=["segment"])
    parts = [part.transpose(..., "segment") for part in broadcast]
    data = np.concatenate([part.values for part in parts], axis=-1)
    coords = {name: labels for part in parts for name, labels in part.coords.items()}
    return xarray.DataArray(data, coords, parts[0].dims)


def running_sum(x):
    """Return the cumulative sum along the last axis, as if in doubled precision.

    Knuth's two-sum gives the exact rounding error of each addition.  These errors are summed too.
    """
    total = np.cumsum(x, axis=-1)
    before, after = total[..., :-1], total[..., 1:]
    added = after - before
    errors = (before - (after - added)) + (x[..., 1:] - added)
    total[..., 1:] += np.cumsum(errors, axis=-1)
    return total


def as_column(values):
    """Return a column or single value as a DataArray with the dimension ``segment``."""
    import xarray

    if not is_array(values):
        return xarray.DataArray(np.atleast_1d(values), dims="segment")
    return values if "segment" in values.dims else values.expand_dims("segment")


def as_times(t):
    """Return times as a DataArray; a 1-D array gets the dimension ``time``."""
    import xarray

    return t if is_array(t) else xarray.DataArray(t, dims=["time"][: np.ndim(t)])


class Batch:
    """Named values broadcast against each other into flat arrays of cases.

    values : dict, symbol -> float or DataArray; DataArrays broadcast by dimension name
    tables : dict, symbol -> DataArray whose last dimension is not a dimension of the sweep
    reserved : names of result variables; a sweep dimension must not have such a name

    Raises ParameterError for a dimension with a reserved name, for arrays that clash, and for
    `PRODUCTS` beyond double precision.  The values themselves are not checked.

    Attributes: dims, shape and n are the sweep's dimensions, their sizes and the number of cases;
    is_single is True for a single case without dimensions.
    """

    def __init__(self, values, tables=None, reserved=()):
        tables = tables or {}
        within_sweep = {name: array.isel({array.dims[-1]: 0}) for name, array in tables.items()}
        check_aligned({**within_sweep, **values})
        sizes: dict = {}
        for value in [*values.values(), *within_sweep.values()]:
            sizes |= value.sizes if is_array(value) else {}
        if clash := [dim for dim in sizes if dim in reserved]:
            raise refusal("arrays.result_name", dim=clash[0])
        _check_products(values)
        self.values, self.tables, self.sizes = values, tables, sizes
        self.dims, self.shape = tuple(sizes), tuple(sizes.values())
        self.n = int(np.prod(self.shape, dtype=int))
        self.is_single = not self.dims
        self._at_reference = {}

    def check_fits(self, numbers, remedy):
        """Raise ParameterError if this many numbers per case do not fit into memory."""
        check_fits(8 * numbers * self.n, f"the results of {self.n:,} cases", remedy)

    @functools.cached_property
    def columns(self):
        """Values of all symbols, a dict symbol -> array (n,); do not change the arrays."""
        return {symbol: self._flat(value) for symbol, value in self.values.items()}

    def flat(self, symbol):
        """Return the values of one symbol in all cases, array (n,), as in `columns`."""
        return self.columns[symbol]

    def _flat(self, value):
        if not is_array(value):
            return np.full(self.n, value)
        expanded = value.expand_dims({d: n for d, n in self.sizes.items() if d not in value.dims})
        return np.ascontiguousarray(expanded.transpose(*self.dims).values.ravel())

    def at_reference(self, law):
        """Return mu_ref (n,) and the law's coefficients, arrays (n,) too, at V_ref = V0."""
        if law not in self._at_reference:
            V0 = self.flat("V0")
            mu_ref = law.reference_friction(V0, self.columns)
            self._at_reference[law] = mu_ref, law.coefficient_arrays(V0, self.columns)
        return self._at_reference[law]

    def rows(self, array):
        """Return a table (rows, m) of an array, and the row number of each case (n,).

        array : DataArray (..., m), or ndarray (m,) for one row that all cases share
        """
        if not is_array(array):
            return np.ascontiguousarray(array, float)[None], np.zeros(self.n, np.int64)
        first = array.isel({array.dims[-1]: 0})
        number = first.copy(data=np.arange(first.size).reshape(first.shape))
        table = np.ascontiguousarray(array.values.reshape(first.size, -1), float)
        return table, self._flat(number).astype(np.int64)

    def evaluate(self, function, t):
        """Evaluate a function of time, such as `loading.V_load`, at t (n, m); array (n, m)."""
        if not self.dims:
            return np.asarray(function(t[0]))[None]
        import xarray

        times = xarray.DataArray(t.reshape(*self.shape, -1), dims=(*self.dims, "time"))
        values = function(times)
        return values.transpose(*self.dims, "time").values.reshape(self.n, -1)

    def variable(self, flat, symbol, *last):
        """Return flat results, (n,) or (n, m) with a last dimension, as a Variable."""
        import xarray

        shaped = np.asarray(flat).reshape((*self.shape, *np.shape(flat)[1:]))
        return xarray.Variable((*self.dims, *last), shaped, attrs(symbol))

    def coordinates(self, reserved):
        """Return the coordinates of the sweep: coordinates of its arrays, and the arrays.

        V_lp and frequency are coordinates even if all cases share them: a result holds at these.

        reserved : names that a coordinate must not have
        """
        coords: dict = {}
        for symbol in ("V_lp", "frequency"):
            value = self.values.get(symbol)
            if not (value is None or is_array(value) or symbol in self.dims):
                coords[symbol] = ((), value, attrs(symbol))
        reserved = RESERVED | set(reserved)
        arrays = [(symbol, x, x.dims) for symbol, x in self.values.items() if is_array(x)]
        for symbol, array, dims in [*arrays, *(("", x, x.dims[:-1]) for x in self.tables.values())]:
            coords |= {
                k: v.variable
                for k, v in array.coords.items()
                if k not in reserved | set(coords) and set(v.dims) <= set(dims)
            }
            # the names of initial values are not quantities: they do not become coordinates
            if symbol in QUANTITIES and symbol not in reserved | set(self.dims):
                coords[symbol] = array.variable
        return coords


def _check_products(values):
    for name, powers in PRODUCTS.items():
        if not powers.keys() <= values.keys():
            continue
        exponent = sum(_largest_exponent(values[s], power) for s, power in powers.items())
        if exponent > LARGEST_EXPONENT:
            factors = ", ".join(powers)
            raise refusal("arrays.product", name=name, exponent=exponent, factors=factors)


def _largest_exponent(value, power):
    """Return log10 of the largest finite value to this power; -inf if there is none."""
    if isinstance(value, float):  # ten times as fast as with arrays
        return power * math.log10(value) if 0.0 < value < math.inf else -math.inf
    sizes = np.ravel(value)
    return (power * np.log10(sizes[(sizes > 0.0) & (sizes < np.inf)])).max(initial=-np.inf)
