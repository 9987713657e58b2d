"""Parameters of a slider, converted to SI and to values per area, and axes of sweeps.

Sliders have K, M, damping and sigma per area.  Data sheets give these quantities for the whole
contact, and laboratories often give the stiffness as friction per length, K/sigma.
"""

import operator
from decimal import Decimal

import numpy as np

from ..errors import ParameterError
from .arrays import check_aligned
from .names import refusal
from .quantities import QUANTITIES, attrs
from .units import OF_WHOLE_CONTACT, has_unit, is_array, is_integer, to_si, unit_of

#: parameter -> other quantity in which it may be given -> operator and second parameter, with
#: parameter = operator(given value, second parameter)
OTHER_QUANTITIES = {
    "sigma": {"normal_force": (operator.truediv, "area")},
    "K": {
        "stiffness": (operator.truediv, "area"),
        "K_over_sigma": (operator.mul, "sigma"),
    },
    "M": {"mass": (operator.truediv, "area")},
    "damping": {"dashpot": (operator.truediv, "area")},
}
#: quantity of the whole contact -> the parameter that it gives when divided by the area
WHOLE_CONTACT = {
    name: symbol
    for symbol, others in OTHER_QUANTITIES.items()
    for name, (_, second) in others.items()
    if second == "area"
}
#: quantity per area -> the quantity of the whole contact as which it is shown
OF_CONTACT = {
    **{symbol: name for name, symbol in WHOLE_CONTACT.items()},
    **dict.fromkeys(("K_c", "K_c_qs", "K_stable"), "stiffness"),
    "M_stable": "mass",
    "damping_stable": "dashpot",
}
#: largest number of values of an axis
MAX_VALUES = 10_000_000


def quantity_of(symbol, value):
    """Return the symbol of the quantity that fits the unit: ``"K_over_sigma"``.

    If the value has no unit, or if its unit does not fit, return the parameter's symbol.
    """
    others = OTHER_QUANTITIES.get(symbol, {})
    unit = unit_of(value) if others else None
    if unit is None or has_unit(symbol, unit):
        return symbol
    return next((other for other in others if has_unit(other, unit)), symbol)


def force(stress, area):
    """Return the force [N] of a stress [Pa] on an area [m^2]."""
    return stress * area


def of_contact(symbol, value, area):
    """Return quantity and value [SI] as they are shown: of the whole contact if its area is known.

    This is the inverse of `parameter_to_si`.

    area : [m^2], or None
    """
    name = OF_CONTACT.get(symbol)
    return (symbol, value) if area is None or name is None else (name, value * area)


def shown_name(symbol, area):
    """Return the long name of a quantity as it is shown by `of_contact`."""
    quantity, _ = of_contact(symbol, 1.0, area)
    return QUANTITIES[quantity if WHOLE_CONTACT.get(quantity) == symbol else symbol].long_name


def parameter_to_si(symbol, value, given, *, quantity=None, label=None):
    """Return a slider's parameter in SI, also from a quantity of `OTHER_QUANTITIES`.

    If all cases share the area (or sigma) that the value is divided (or multiplied) by, an axis
    with the parameter's symbol keeps its name and gets the values in SI.  Otherwise it is renamed
    as the given quantity.  Raises ParameterError like `to_si`, and if an area is missing.

    given : dict, symbol -> value in SI of other parameters
    quantity : the quantity of the value; by default its unit decides
    """
    label = label or symbol
    quantity = quantity or quantity_of(symbol, value)
    if quantity == symbol:
        return to_si(symbol, value, label=label)
    combine, second = OTHER_QUANTITIES[symbol][quantity]
    if second not in given:
        try:
            to_si(symbol, value, label=label)
        except ParameterError as error:
            if error.problem == OF_WHOLE_CONTACT:
                error.remedy += " Or give the area too, such as area = '20 cm^2'."
            raise
    x, factor = to_si(quantity, value, label=label), given[second]
    check_aligned({label: x, second: factor})
    coords = {}
    if is_array(x) and _is_axis_of(symbol, x, value):
        x = x.drop_vars(symbol, errors="ignore")
        if is_array(factor) and symbol not in factor.dims:
            coords = {quantity: (quantity, x.values, attrs(quantity))}
            x = x.rename({symbol: quantity})
    result = combine(x, factor)
    result = to_si(symbol, result.drop_attrs() if is_array(result) else result, label=label)
    return result.assign_coords(coords) if coords else result


def _is_axis_of(symbol, x, value):
    """Return whether x lies along `symbol`, with its given values or no labels."""
    if x.dims != (symbol,):
        return False
    given = getattr(value.data, "magnitude", value.data)  # the magnitude of pint data
    return symbol not in x.indexes or np.array_equal(x.indexes[symbol], given)


def logspace(name, start, stop, n):
    """Return an axis of a sweep with geometric spacing.

    Parameters
    ----------
    name : str
        Symbol of the quantity, for example "M" [kg/m^2] or "V_lp" [m/s].  Any other name makes an
        axis of pure numbers.
    start, stop : float, str or pint.Quantity
        First and last value, both > 0, in SI if they have no unit.  Both are kept exactly, and the
        first may be the larger one.  For K, M, sigma and damping, any unit that `SpringSlider`
        takes is allowed, such as "1e-3/um" for K: the values are then in 1/m.
    n : int
        Number of values, at least 2.  Intermediate values are rounded to 15 digits, so that
        ``.sel(M=1000)`` finds the 1000 between 100 and 10000.

    Returns
    -------
    xarray.DataArray
        Array of shape (n,).  Its name, dimension and coordinate are all `name`.  The coordinate of
        a known symbol has the attributes ``units`` and ``long_name``.  The array itself has
        ``units`` only if they are not the SI unit of the symbol.

    Raises
    ------
    ParameterError
        If name is not a str, if a value is not > 0 or has a wrong unit, or if n is not an integer
        from 2 to 10,000,000.

    Examples
    --------
    >>> logspace("M", 100, 1e5, 4).values.tolist()
    [100.0, 1000.0, 10000.0, 100000.0]
    """
    return _axis("logspace", "> 0", name, start, stop, n)


def linspace(name, start, stop, n):
    """Return an axis of a sweep with even spacing.

    Parameters
    ----------
    name : str
        Symbol of the quantity, as for `logspace`.
    start, stop : float, str or pint.Quantity
        First and last value, as for `logspace`, but they may be 0 or negative if the quantity
        allows it.
    n : int
        Number of values, at least 2.  Intermediate values are rounded to 15 digits.

    Returns
    -------
    xarray.DataArray
        Array of shape (n,), as from `logspace`.

    Raises
    ------
    ParameterError
        If name is not a str, if a value is out of the range of its quantity or has a wrong unit, or
        if n is not an integer from 2 to 10,000,000.

    Examples
    --------
    >>> linspace("Dc", "1 um", "3 um", 5).values.tolist()
    [1e-06, 1.5e-06, 2e-06, 2.5e-06, 3e-06]
    """
    return _axis("linspace", None, name, start, stop, n)


def geometrically_spaced(first, last, n):
    """Return n values, the inner ones rounded to 15 digits."""
    values = np.array([float(f"{x:.15g}") for x in np.geomspace(first, last, n)])
    values[[0, -1]] = first, last
    return values


def evenly_spaced(first, last, n):
    """Return n values, the inner ones rounded to 15 digits."""
    # Exact until rounded, so that an axis through 0 contains 0.
    start, stop, m = Decimal(repr(first)), Decimal(repr(last)), n - 1
    between = ((start * (m - i) + stop * i) / m for i in range(1, m))
    return np.array([first, *(float(f"{x:.15g}") for x in between), last])


def _axis(function, bound, name, start, stop, n):
    """Return the axis of `logspace` or `linspace`, whose ends are within a bound."""
    import xarray

    if not isinstance(name, str):
        raise refusal("axis.name", name=name)
    symbol = quantity_of(name, start) if name in QUANTITIES else "number"
    ends = [
        to_si(symbol, value, label=f"{name} ({which})", bound=bound)
        for which, value in (("start", start), ("stop", stop))
    ]
    if any(is_array(end) or np.isinf(end) for end in ends):
        raise refusal("axis.ends", name=name, function=function)
    if not is_integer(n) or not 2 <= n <= MAX_VALUES:
        raise refusal("axis.size", n=n, most=MAX_VALUES)
    spaced = geometrically_spaced if function == "logspace" else evenly_spaced
    values = spaced(ends[0], ends[1], int(n))
    labels = attrs(symbol) if name in QUANTITIES else {}
    # Only the coordinate has a unit and a long name: xarray's arithmetic keeps the attributes of an
    # array, so that V_lp = np.sqrt(eta * ...) would still be a pure number.
    unit = {} if symbol in (name, "number") else {"units": labels["units"]}
    return xarray.DataArray(values, {name: (name, values, labels)}, (name,), name, unit)
