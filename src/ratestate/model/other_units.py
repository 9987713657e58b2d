"""Quantities as which a parameter of the slider may be given too.

K, M, damping and sigma are per area.  A data sheet has them for the whole contact, which has an
area, and a laboratory knows its stiffness as friction per length, K/sigma.
"""

import operator

from .units import has_unit, unit_of

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


def quantity_of(symbol, value):
    """Symbol of the quantity that a value of a parameter is, by its unit: ``"K_over_sigma"``.

    The parameter's own symbol for a value without unit, or with one that fits none.
    """
    others = OTHER_QUANTITIES.get(symbol, {})
    unit = unit_of(value) if others else None
    if unit is None or has_unit(symbol, unit):
        return symbol
    return next((other for other in others if has_unit(other, unit)), symbol)
