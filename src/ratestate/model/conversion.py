"""Conversion of results to other units, and back to SI."""

from ..errors import ParameterError
from .names import one_of
from .quantities import QUANTITIES
from .units import has_unit, scaled, unit_factor


def in_units(result, /, **units):
    """Return a result with some of its variables in other units.

    The attributes of the result, which say how it was made, stay in SI.  All functions that take a
    result read the units of its variables, so they accept a converted result.

    Parameters
    ----------
    result : xarray.Dataset
        Result of any function, a record of `read_lab`, or a result of this function.
    **units : str
        The unit of each variable or coordinate, such as ``V="um/s"``.  ``t`` may stand for
        ``time``.

    Returns
    -------
    xarray.Dataset
        A new Dataset.  The attribute ``units`` of each converted variable is the given string.
        The other variables are unchanged.

    Raises
    ------
    ParameterError
        If the result has no variable of this name, if the variable is not a quantity with a unit
        (``status``, or the gains and phases of `frequency_response`), or if a unit is unknown or
        does not fit the quantity.  A pure number may become "%".

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3000)
    >>> cycle = in_units(rs.limit_cycle(slider, "3.2 mm/s"), V_max="mm/s", period="ms")
    >>> round(float(cycle.period), 2), cycle.period.units
    (19.76, 'ms')
    """
    check_result(result)
    converted = {}
    for given, unit in units.items():
        if not isinstance(unit, str):
            raise ParameterError(
                "is not a str", "Give a unit such as 'um/s'.", symbol=given, value=repr(unit)
            )
        name = find_variable(result, given)
        if name is None:
            quantities = (str(known) for known in result.variables if known in QUANTITIES)
            names = [known for known in quantities if QUANTITIES[known].unit != "1"]
            raise ParameterError(f"the result has no variable {given}", one_of(names, given))
        converted[name] = _convert_variable(name, result.variables[name], unit)
    return result.assign(converted)


def check_result(result):
    """Raise ParameterError if a result is not a Dataset."""
    import xarray

    if not isinstance(result, xarray.Dataset):
        raise ParameterError(
            f"a {type(result).__name__} is not a result", "Give an xarray.Dataset."
        )


def find_variable(result, name):
    """Return a variable's name in a result, or None; ``t`` may stand for ``time``."""
    names = (name, "time") if name == "t" else (name,)
    return next((known for known in names if known in result.variables), None)


def in_si(result):
    """Return a result with all quantities in SI; the result itself if they all are.

    A variable that is not a quantity stays unchanged, and so does a pure number with the unit of
    another quantity.  Raises ParameterError for a unit that is unknown or does not fit.  A value
    converted to another unit and back may differ in its last digit.
    """
    converted = {}
    for name, variable in getattr(result, "variables", {}).items():
        si = QUANTITIES[name].unit if name in QUANTITIES else None
        unit = variable.attrs.get("units") or si
        # xarray's arithmetic keeps attributes: a ratio may still have the unit of its numerator
        if si is not None and unit != si and (si != "1" or has_unit(name, str(unit))):
            converted[name] = _convert_variable(name, variable, si)
    return result.assign(converted) if converted else result


def _convert_variable(name, variable, unit):
    old_unit = variable.attrs.get("units")
    is_number = variable.dtype.kind in "iufc" and "flag_values" not in variable.attrs
    if name not in QUANTITIES or old_unit is None or not is_number:
        raise ParameterError("is not a quantity with a unit", "Leave it out.", symbol=name)
    old_factor, new = (si_factor(name, str(unit_text)) for unit_text in (old_unit, unit))
    converted = variable.copy(data=scaled(variable.values, old_factor / new))
    converted.attrs["units"] = unit
    return converted


def si_factor(name, unit):
    """Return the size of a unit of this variable, in its SI unit (Decimal)."""
    try:
        return unit_factor(QUANTITIES[name].unit, unit)
    except ValueError as error:
        raise ParameterError(
            str(error), QUANTITIES[name].remedy, symbol=name, value=repr(unit)
        ) from None
