"""Parameters of a slider in SI and per area, however they are given."""

import numpy as np

from ..errors import ParameterError
from .arrays import check_aligned
from .other_units import OTHER_QUANTITIES, quantity_of
from .quantities import attrs
from .units import OF_WHOLE_CONTACT, is_array, to_si


def parameter_to_si(symbol, value, given, *, quantity=None, label=None):
    """A parameter of the slider in SI, like `to_si`, from any quantity of `OTHER_QUANTITIES` too.

    An axis along the parameter's own symbol remains one, of its values in SI, if all cases share
    the area (or sigma) that it is divided (or multiplied) by; else it is renamed as the quantity
    that was given.

    Parameters
    ----------
    symbol : str
        Symbol of the parameter.
    value : float, str, pint.Quantity or xarray.DataArray
        As for `to_si`.
    given : dict
        Other parameters of the slider in SI, symbol -> value.
    quantity : str, optional
        The quantity that the value is, if its unit is not to decide.
    label : str, optional
        Name of the value in messages, if not its symbol.

    Returns
    -------
    float or xarray.DataArray
        The value in SI.

    Raises
    ------
    ParameterError
        Wrong type, unit or range; a value of the whole contact, where no area is given.
    """
    label = label or symbol
    quantity = quantity or quantity_of(symbol, value)
    if quantity == symbol:
        return to_si(symbol, value, label=label)
    operator, by = OTHER_QUANTITIES[symbol][quantity]
    if by not in given:
        _refuse_without_area(symbol, value, label)
    x, factor = to_si(quantity, value, label=label), given[by]
    check_aligned({label: x, by: factor})
    coords = {}
    if is_array(x) and _is_own_axis(symbol, x, value):
        x = x.drop_vars(symbol, errors="ignore")
        if is_array(factor) and symbol not in factor.dims:
            coords = {quantity: (quantity, x.values, attrs(quantity))}
            x = x.rename({symbol: quantity})
    result = operator(x, factor)
    result = to_si(symbol, result.drop_attrs() if is_array(result) else result, label=label)
    return result.assign_coords(coords) if coords else result


def _is_own_axis(symbol, x, value):
    """Whether an array lies along its own symbol, labelled, if at all, by its values as given."""
    if x.dims != (symbol,):
        return False
    given = getattr(value.data, "magnitude", value.data)  # of pint
    return symbol not in x.indexes or np.array_equal(x.indexes[symbol], given)


def _refuse_without_area(symbol, value, label):
    """Raise the ParameterError about a value of the whole contact, and say how to give its area."""
    try:
        to_si(symbol, value, label=label)
    except ParameterError as error:
        example = "; give the area too, such as area = '20 cm^2' (in [slider] of a file)"
        message = str(error).replace(OF_WHOLE_CONTACT, OF_WHOLE_CONTACT + example)
        raise ParameterError(message) from None
