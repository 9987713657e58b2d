"""Parameters of a slider in SI and per area, however they are given, and axes of them.

K, M, damping and sigma are per area.  A data sheet has them for the whole contact, which has an
area, and a laboratory knows its stiffness as friction per length, K/sigma.
"""

import operator

import numpy as np

from ..errors import ParameterError
from .arrays import check_aligned
from .quantities import QUANTITIES, attrs
from .units import OF_WHOLE_CONTACT, has_unit, is_array, is_integer, to_si, unit_of

#: parameter -> quantities as which it may be given -> the parameter that makes it the former, and
#: how: with this operator, from the value given and that parameter
OTHER_QUANTITIES = {
    "sigma": {"normal_force": (operator.truediv, "area")},
    "K": {
        "stiffness": (operator.truediv, "area"),
        "K_over_sigma": (operator.mul, "sigma"),
    },
    "M": {"mass": (operator.truediv, "area")},
    "damping": {"dashpot": (operator.truediv, "area")},
}
#: quantity of the whole contact -> the parameter that it is, once divided by the area
WHOLE_CONTACT = {
    name: symbol
    for symbol, others in OTHER_QUANTITIES.items()
    for name, (_, by) in others.items()
    if by == "area"
}
#: longest axis of a sweep
MAX_VALUES = 10_000_000


def quantity_of(symbol, value):
    """Symbol of the quantity that a value of a parameter is, by its unit: ``"K_over_sigma"``.

    The parameter's own symbol for a value without unit, or with one that fits none.
    """
    others = OTHER_QUANTITIES.get(symbol, {})
    unit = unit_of(value) if others else None
    if unit is None or has_unit(symbol, unit):
        return symbol
    return next((other for other in others if has_unit(other, unit)), symbol)


def parameter_to_si(symbol, value, given, *, quantity=None, label=None):
    """A parameter of the slider, like `to_si`, from any quantity of `OTHER_QUANTITIES` too.

    An axis along the parameter's own symbol remains one, of its values in SI, if all cases share
    the area (or sigma) that it is divided (or multiplied) by; else it is renamed as the quantity
    that was given.  ParameterError as from `to_si`, and if an area is needed and not given.

    given : other parameters in SI, symbol -> value
    quantity : the quantity that the value is, if its unit is not to decide
    """
    label = label or symbol
    quantity = quantity or quantity_of(symbol, value)
    if quantity == symbol:
        return to_si(symbol, value, label=label)
    combine, by = OTHER_QUANTITIES[symbol][quantity]
    if by not in given:
        try:
            to_si(symbol, value, label=label)
        except ParameterError as error:
            example = "; give the area too, such as area = '20 cm^2' (in [slider] of a file)"
            message = str(error).replace(OF_WHOLE_CONTACT, OF_WHOLE_CONTACT + example)
            raise ParameterError(message) from None
    x, factor = to_si(quantity, value, label=label), given[by]
    check_aligned({label: x, by: factor})
    coords = {}
    if is_array(x) and _is_own_axis(symbol, x, value):
        x = x.drop_vars(symbol, errors="ignore")
        if is_array(factor) and symbol not in factor.dims:
            coords = {quantity: (quantity, x.values, attrs(quantity))}
            x = x.rename({symbol: quantity})
    result = combine(x, factor)
    result = to_si(symbol, result.drop_attrs() if is_array(result) else result, label=label)
    return result.assign_coords(coords) if coords else result


def _is_own_axis(symbol, x, value):
    """Whether an array lies along its own symbol, labelled, if at all, by its values as given."""
    if x.dims != (symbol,):
        return False
    given = getattr(value.data, "magnitude", value.data)  # of pint
    return symbol not in x.indexes or np.array_equal(x.indexes[symbol], given)


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
    if not is_integer(n) or not 2 <= n <= MAX_VALUES:
        raise ParameterError(f"n = {n!r} must be an integer from 2 to {MAX_VALUES:,}, such as 12")
    values = np.array([float(f"{x:.15g}") for x in np.geomspace(ends[0], ends[1], int(n))])
    values[[0, -1]] = ends
    labels = attrs(symbol) if name in QUANTITIES else {}
    # Unit and name sit on the coordinate only: xarray would carry those of the array through
    # arithmetic, and V_lp = np.sqrt(eta * ...) would claim to be a pure number.
    own = {} if symbol in (name, "number") else {"units": labels["units"]}
    return xarray.DataArray(values, {name: (name, values, labels)}, (name,), name, own)
