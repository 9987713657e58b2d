"""Conversion of values to SI, and errors on wrong units; quantities.py shows values as text.

Inside ratestate every value is in SI.  `to_si` converts the input of a user (a number, ``"10 um"``,
a pint quantity, a named DataArray) to a float or DataArray in SI, or raises a `ParameterError`
with symbol, value, unit and remedy.  All units of pint are valid, and prefixes are case-sensitive:
2 MPa is 2e6 Pa, and 2 mPa is 2e-3 Pa.
"""

import functools
import re
import reprlib
import sys
from decimal import Decimal

import numpy as np

from ..errors import ParameterError
from .quantities import KINDS, POWERS, PREFIXES, QUANTITIES, attrs, prefixed_unit

#: names of dimensions that only results may have
RESERVED = {"time", "mode", "segment"}
_PREFIXES = {prefix: power for power, prefix in PREFIXES.items()} | {"µ": -6, "μ": -6}
#: units of quantities that data sheets give for the whole contact, in N/m, kg, N or N s/m
_PER_AREA = ("Pa/m", "kg/m^2", "Pa", "Pa s/m")
#: the problem of such a value
OF_WHOLE_CONTACT = "is of the whole contact, and must be divided by its area"
# The number is as long as possible, and no part of another number may follow it ("1e1e1 um").
_NUMBER = re.compile(
    r"\s*((?>[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|inf|nan)))(?![eE]?[-+]?[\d.])"
    r"\s*(.*?)\s*"
)
# Names, powers and operators only: pint would ignore a # and all text after it.
_EXPRESSION = re.compile(
    r"(?:[^\W\d]\w*+(?:-\d++)?|[%\u00b0]|1(?![\d.])"
    r"|(?:\*\*|\^)\s*+\(?\s*+[-+]?\d++(?:\.\d++)?|[*/()\u00b7\s\u207b])++"
)


def is_array(value):
    """Return whether value is an xarray.DataArray, without importing xarray."""
    xarray = sys.modules.get("xarray")
    return xarray is not None and isinstance(value, xarray.DataArray)


def is_plain_array(value):
    """Return whether value is a 1-D array without the name of its dimension."""
    return isinstance(value, np.ndarray) and value.ndim == 1


def is_pint(value):
    """Return whether value is a pint quantity of any registry."""
    return hasattr(value, "magnitude") and hasattr(value, "units")


def is_integer(value):
    """Return whether value is an integer; NumPy's time differences are not."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool | np.timedelta64)


def unit_of(value):
    """Return the unit of a value for `to_si` as text; None for any other value."""
    if is_array(value):
        unit = value.data.units if is_pint(value.data) else value.attrs.get("units")
        return None if unit is None else str(unit)
    if is_pint(value):
        return str(value.units)
    match = _NUMBER.fullmatch(value) if isinstance(value, str) else None
    return match[2] if match else None


def has_unit(symbol, unit):
    """Return whether a unit, given as text, fits a quantity."""
    try:
        unit_factor(QUANTITIES[symbol].unit, unit)
    except ValueError:
        return False
    return True


def named(symbol, value):
    """Return a result as float, ndarray, or DataArray with its name and attributes."""
    if is_array(value):
        return value.rename(symbol).assign_attrs(attrs(symbol))
    return value if np.ndim(value) else float(value)


def to_si(symbol, value, *, label=None, bound=None):
    """Convert a value of a quantity to SI, and check it.

    Parameters
    ----------
    symbol : str
        Symbol of the quantity, a key of ``ratestate.QUANTITIES``; others raise KeyError.
    value : float, str, pint.Quantity, DataArray or ndarray
        The value; in SI if it is a number, or has no attribute ``units``.  A 1-D ndarray gets a
        dimension with the name of the symbol; with another label it is refused.
    label : str, optional
        Name of the value in messages; by default the symbol.
    bound : {"", "> 0", ">= 0"}, optional
        Range of the value; by default the bound in ``ratestate.QUANTITIES``.  "" allows all.

    Returns
    -------
    float or DataArray
        The value in SI.  The name of a DataArray is the symbol.  If it has only a dimension of this
        name, its SI values also become the coordinate, unless that coordinate had other values.

    Raises
    ------
    ParameterError
        If type, unit or range are wrong, for NaN, for inf unless the quantity may be infinite, and
        if a dimension has no name or a reserved one.
    """
    label = label or symbol
    if is_plain_array(value) and label == symbol:
        import xarray

        value = xarray.DataArray(value, dims=symbol)
    if is_array(value):
        return _array_to_si(symbol, value, label, bound)
    given, si = repr(value) if isinstance(value, str) else str(value), ""
    if is_pint(value):
        number = _to_float(symbol, value.magnitude, label)
        x = _convert(symbol, repr(number), str(value.units), label, given)
    elif isinstance(value, str):
        match = _NUMBER.fullmatch(value)
        if match is None:
            raise ParameterError(
                "is not a number with a unit", QUANTITIES[symbol].remedy, symbol=label, value=given
            )
        if match[2] or Decimal(match[1]).is_finite():
            x = _convert(symbol, match[1], match[2], label, given)
        else:
            x = float(match[1])  # "inf" is the same in all units
    else:
        x = _to_float(symbol, value, label)
        given, si = f"{x:.6g}", _shown_unit(symbol)
    if problem := _problem(symbol, x, bound):
        raise ParameterError(problem, QUANTITIES[symbol].remedy, symbol=label, value=given, unit=si)
    return x


def one_in_si(symbol, value, *, label=None, bound=None):
    """Convert a single number to SI by `to_si`; ParameterError for array or list."""
    if isinstance(value, list | tuple) or getattr(value, "ndim", 0) > 0:
        raise ParameterError(
            "is an array, but must be one number", QUANTITIES[symbol].remedy, symbol=label or symbol
        )
    return float(to_si(symbol, value, label=label, bound=bound))


def _shown_unit(symbol):
    """Return the SI unit of a quantity, "" for a pure number."""
    unit = QUANTITIES[symbol].unit
    return "" if unit == "1" else unit


def _problem(symbol, x, bound):
    """Return what is wrong with a number, as text; "" if it is valid."""
    quantity = QUANTITIES[symbol]
    bound = quantity.bound if bound is None else bound
    if np.isnan(x):
        return "is not a number"
    if (bound == "> 0" and not x > 0) or (bound == ">= 0" and not x >= 0):
        return f"must be {bound}"
    return "must be finite" if np.isinf(x) and not quantity.may_be_inf else ""


def _to_float(symbol, value, label):
    """Return a real number as a float; ParameterError for any other type."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if is_integer(value) or isinstance(value, float | np.floating | Decimal):
        try:
            return float(value)
        except OverflowError:  # an int beyond 1e308
            return np.inf if value > 0 else -np.inf
    array_hint = ""
    if hasattr(value, "__len__") and not isinstance(value, str | bytes):
        array_hint = f" For many values give xarray.DataArray(values, dims='{symbol}')."
    raise ParameterError(
        f"is of type {type(value).__name__}",
        QUANTITIES[symbol].remedy + array_hint,
        symbol=label,
        value=" ".join(reprlib.repr(value).split()),  # a line break would look like a list
    )


def _convert(symbol, number, unit, label, given):
    """Convert a number and a unit, both texts, to a correctly rounded float in SI."""
    try:
        exact = Decimal(number) * unit_factor(QUANTITIES[symbol].unit, unit)
        value = float(exact)
        if np.isinf(value) and exact.is_finite():
            raise OverflowError
        return value
    except ArithmeticError:  # beyond the exponents of Decimal, or beyond a float
        problem, hint = "is out of range", ""
    except ValueError as error:
        problem, hint = str(error), _hint(symbol, unit)
    raise ParameterError(problem, QUANTITIES[symbol].remedy + hint, symbol=label, value=given)


def _hint(symbol, unit):
    """Return a question after the remedy: the usual unit that differs only in its case."""
    si = QUANTITIES[symbol].unit
    usual = (prefixed_unit(si, power) for power in POWERS.get(si, (0,)))
    plain = unit.replace("^", "").lower()
    near = [known for known in usual if si != "1" and known.replace("^", "").lower() == plain]
    return f" Did you mean {near[0]!r}?" if near else ""


@functools.lru_cache(maxsize=1000)
def unit_factor(si, unit):
    """Return the exact size of a unit in SI units (Decimal), or raise ValueError."""
    if unit in ("", "1", "dimensionless"):
        if si == "1":
            return Decimal(1)
        raise ValueError("has no unit")
    # Importing pint takes 0.3 s: the usual case, the SI unit with a prefix, does without it.
    prefix = unit.removesuffix(si)
    if unit.endswith(si) and prefix in (_PREFIXES if si in POWERS and si != "m^2" else [""]):
        return Decimal(1).scaleb(_PREFIXES[prefix])
    # "kg/m2" and "m s-1", as in the CF conventions, mean "kg/m**2" and "m s**-1"
    unit = f"1{unit}" if unit.startswith("/") else unit  # "1e-3/um"
    text = re.sub(r"(?<![\w.])([A-Za-z]+)(-?\d)(?![\d.])", r"\1**\2", unit)
    if not _EXPRESSION.fullmatch(unit):
        raise ValueError(f"has an unknown unit {unit!r}")
    try:
        quantity = _registry().Quantity(Decimal(1), text)
        if quantity.is_compatible_with(si):
            return quantity.to(si if si != "1" else "dimensionless").magnitude
        dimension = str(quantity.dimensionality)
    except Exception:  # of many types, AssertionError among them; dB has no linear factor
        raise ValueError(f"has an unknown unit {unit!r}") from None
    if si in _PER_AREA and quantity.is_compatible_with(f"({si}) * m**2"):
        raise ValueError(OF_WHOLE_CONTACT)
    kinds = [KINDS[known][0] for known in KINDS if quantity.is_compatible_with(known)]
    raise ValueError(f"is {kinds[0] if kinds else f'of dimension {dimension}'}")


def scaled(values, factor):
    """Multiply an array by a Decimal; 10 um is 10 / 1e6, rounded once."""
    return values * float(factor) if factor >= 1 else values / float(1 / factor)


@functools.cache
def _registry():
    """Return pint's units in decimal arithmetic: "10 um" is exactly 1e-05."""
    import pint

    return pint.UnitRegistry(non_int_type=Decimal)


def _array_to_si(symbol, array, label, bound):
    unit = array.attrs.get("units")
    if hasattr(array.data, "magnitude"):  # pint inside xarray
        unit, array = str(array.data.units), array.copy(data=array.data.magnitude)
    if array.dtype.kind not in "iuf" or array.size == 0:
        fault = f"of dtype {array.dtype}" if array.size else "without values"
        raise ParameterError(f"is a DataArray {fault}", QUANTITIES[symbol].remedy, symbol=label)
    reserved = RESERVED - {"time"} if symbol in ("t", "time", "times") else RESERVED
    for dim in array.dims:
        if dim in reserved or not re.match(r"(?!dim_\d)[^\W\d]", str(dim)):
            raise ParameterError(
                f"has a dimension called {dim!r}, which cannot be a dimension of a sweep",
                f"Rename it, for example xarray.DataArray(values, dims='{symbol}').",
                symbol=label,
            )
    si = array.astype(float, keep_attrs=False)
    if any(coordinate.attrs for coordinate in si.coords.values()):
        si = si.drop_attrs()
    si = si.rename(symbol).assign_attrs(attrs(symbol))
    if unit is not None:
        try:
            factor = unit_factor(QUANTITIES[symbol].unit, str(unit))
        except ValueError as error:
            raise ParameterError(
                f"has the attribute units = {unit!r}, which {error}",
                f"{QUANTITIES[symbol].remedy} If the values are in SI already, remove this "
                "attribute, which xarray's arithmetic keeps, with .drop_attrs().",
                symbol=label,
            ) from None
        si.data = scaled(si.data, factor)
    if si.ndim == 0:
        return to_si(symbol, float(si), label=label, bound=bound)
    values = si.values
    if any(_problem(symbol, x, bound) for x in (values.min(), values.max())):
        index = next(i for i, x in np.ndenumerate(values) if _problem(symbol, x, bound))
        coordinates = ", ".join(
            f"{dim}[{i}]" + (f" = {si[dim].values[i]}" if dim in si.indexes else "")
            for dim, i in zip(si.dims, index, strict=True)
        )
        raise ParameterError(
            f"at {coordinates} {_problem(symbol, values[index], bound)}",
            QUANTITIES[symbol].remedy,
            symbol=label,
            value=f"{values[index]:.6g}",
            unit=_shown_unit(symbol),
        )
    # the coordinate of an axis is in SI like its values
    if si.dims == (symbol,) and (
        symbol not in si.indexes or np.array_equal(si.indexes[symbol], array.values)
    ):
        si = si.assign_coords({symbol: (symbol, values, attrs(symbol))})
    return si
