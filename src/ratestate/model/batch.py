"""From named values to a flat batch of cases and back."""

import functools

import numpy as np
import xarray

from ..errors import ParameterError
from ..machine import check_fits
from .arrays import check_aligned
from .quantities import QUANTITIES, attrs
from .units import RESERVED, is_array

#: numbers that the equations hold -> powers of what they consist of
PRODUCTS = {
    "K Dc/(a sigma)": {"K": 1, "Dc": 1, "a": -1, "sigma": -1},
    "a sigma/(K Dc)": {"a": 1, "sigma": 1, "K": -1, "Dc": -1},
    "M V_lp^2/(a sigma Dc)": {"M": 1, "V_lp": 2, "a": -1, "sigma": -1, "Dc": -1},
    "M V_start^2/(a sigma Dc)": {"M": 1, "V_start": 2, "a": -1, "sigma": -1, "Dc": -1},
    "V_lp^2": {"V_lp": 2},  # (computed without mass too)
}
#: of 10, beyond which their squares and cubes overflow
LARGEST_EXPONENT = 100.0


class Batch:
    """Named values broadcast against each other and laid out flat, one value a case.

    values : dict, symbol -> float or DataArray; DataArrays broadcast by dimension name
    own : dict, symbol -> DataArray with a last dimension of its own, kept apart from the sweep
    taken : names of result variables, which no sweep dimension may have

    ParameterError for a dimension of such a name, if arrays clash, and if `PRODUCTS` of the values
    are beyond double precision; the values themselves are not checked.

    Attributes: dims, shape and n, the sweep's dimensions, their sizes, the number of cases; alone,
    whether it is no sweep but a single case, which may take the engine's scalar path.
    """

    def __init__(self, values, own=None, taken=()):
        own = own or {}
        within_sweep = {name: array.isel({array.dims[-1]: 0}) for name, array in own.items()}
        check_aligned({**within_sweep, **values})
        sizes: dict = {}
        for value in [*values.values(), *own.values()]:
            if is_array(value):
                last = value.dims[-1:] if any(value is array for array in own.values()) else ()
                sizes |= {d: n for d, n in value.sizes.items() if d not in last and d not in sizes}
        if clash := [dim for dim in sizes if dim in taken]:
            raise ParameterError(
                f"a dimension called {clash[0]!r} clashes with the result of that name; rename it"
            )
        _check_products(values)
        self.values, self.own, self.sizes = values, own, sizes
        self.dims, self.shape = tuple(sizes), tuple(sizes.values())
        self.n = int(np.prod(self.shape, dtype=int))
        self.alone = not self.dims

    def check_fits(self, numbers, remedy):
        """ParameterError if so many numbers a case are more than this process has memory for."""
        check_fits(8 * numbers * self.n, f"the results of {self.n:,} cases", remedy)

    @functools.cached_property
    def columns(self):
        """dict of the values of all symbols, symbol -> (n,), which nobody may change."""
        return {symbol: self._flat(value) for symbol, value in self.values.items()}

    def flat(self, symbol):
        """(n,) array of the values of one symbol, as in `columns`."""
        return self.columns[symbol]

    def _flat(self, value):
        if not is_array(value):
            return np.full(self.n, value)
        full = value.expand_dims({d: n for d, n in self.sizes.items() if d not in value.dims})
        return np.ascontiguousarray(full.transpose(*self.dims).values.ravel())

    def rows(self, array):
        """A table (rows, m) of the rows of an `own` array, and each case's row number (n,).

        array : (..., m) DataArray, or (m,) ndarray for a row that all share.
        """
        if not is_array(array):
            return np.ascontiguousarray(array, float)[None], np.zeros(self.n, np.int64)
        sweep = array.dims[:-1]
        shape = array.shape[:-1]
        count = int(np.prod(shape, dtype=int))
        number = xarray.DataArray(np.arange(count).reshape(shape), dims=sweep)
        table = np.ascontiguousarray(array.values.reshape(count, -1), float)
        return table, self._flat(number).astype(np.int64)

    def of(self, function, t):
        """Values of a `Loading` method at times t (n, m), as an array (n, m)."""
        if not self.dims:
            return np.asarray(function(t[0]))[None]
        frame = xarray.DataArray(t.reshape(*self.shape, -1), dims=(*self.dims, "time"))
        found = function(frame)
        return found.transpose(*self.dims, "time").values.reshape(self.n, -1)

    def variable(self, flat, symbol, *last):
        """Flat results, (n,) or (n, m) with a last dimension, as a variable in the sweep's dims."""
        shaped = np.asarray(flat).reshape((*self.shape, *np.shape(flat)[1:]))
        return xarray.Variable((*self.dims, *last), shaped, attrs(symbol))

    def coordinates(self, taken):
        """Coordinates of the sweep, by name: those the arrays bring, and the arrays themselves.

        V_lp and frequency are ones even if all cases share them: results say where they hold.

        taken : names that no coordinate may have
        """
        coords: dict = {}
        for symbol in ("V_lp", "frequency"):
            value = self.values.get(symbol)
            if not (value is None or is_array(value) or symbol in self.dims):
                coords[symbol] = ((), value, attrs(symbol))
        taken = RESERVED | set(taken)
        for symbol, value in self.values.items():
            if is_array(value):
                coords |= {
                    k: v.variable for k, v in value.coords.items() if k not in taken | set(coords)
                }
                # (initial values have names of their own, and no place among the coordinates)
                if symbol in QUANTITIES and symbol not in taken | set(self.dims):
                    coords[symbol] = value.variable
        for value in self.own.values():
            kept = set(value.dims[:-1])
            coords |= {
                k: v.variable
                for k, v in value.coords.items()
                if k not in taken | set(coords) and set(v.dims) <= kept
            }
        return coords


def _check_products(values):
    """Raise ParameterError if one of `PRODUCTS` is too large."""
    for name, powers in PRODUCTS.items():
        if not powers.keys() <= values.keys():
            continue
        exponent = sum(_largest_exponent(values[s], power) for s, power in powers.items())
        if exponent > LARGEST_EXPONENT:
            raise ParameterError(
                f"{name} = 10^{exponent:.4g} is beyond double precision. Check the sizes and units "
                f"of {', '.join(powers)}."
            )


def _largest_exponent(value, power):
    """log10 of the largest finite power of a value; -inf if it is 0 or inf throughout."""
    sizes = np.ravel(value)
    return (power * np.log10(sizes[(sizes > 0.0) & (sizes < np.inf)])).max(initial=-np.inf)
