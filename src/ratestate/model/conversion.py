"""Results in units of one's own, and brought back to SI."""

from ..errors import ParameterError
from .names import one_of
from .quantities import QUANTITIES, expected
from .units import has_unit, scaled, unit_factor


def in_units(result, /, **units):
    """A result with some of its variables in other units.

    Its attributes, which say how it was made, stay in SI.  Functions that take a result read the
    units of its variables, so they take this one as well.

    Parameters
    ----------
    result : xarray.Dataset
        Result of any function, or a record of `read_lab`; also one from this function.
    **units : str
        Name of a variable or coordinate -> its unit, such as ``V="um/s"``.  ``t`` may stand for
        ``time``.

    Returns
    -------
    xarray.Dataset
        A new Dataset: these variables are converted, and their attribute ``units`` is the string
        given.  All others are as they were.

    Raises
    ------
    ParameterError
        A name that the result does not have; one of no quantity, such as ``status``; a unit that
        is unknown or of another kind.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3000)
    >>> cycle = in_units(rs.limit_cycle(slider, "3.2 mm/s"), V_max="mm/s", period="ms")
    >>> round(float(cycle.period), 2), cycle.period.units
    (19.76, 'ms')
    """
    import xarray

    if not isinstance(result, xarray.Dataset):
        raise ParameterError(f"{type(result).__name__} is no result; give an xarray.Dataset")
    converted = {}
    for given, unit in units.items():
        if not isinstance(unit, str):
            raise ParameterError(f"{given} = {unit!r}: a unit is a str, such as 'um/s'")
        name = find_variable(result, given)
        if name is None:
            quantities = (str(known) for known in result.variables if known in QUANTITIES)
            names = [known for known in quantities if QUANTITIES[known].unit != "1"]
            raise ParameterError(f"the result has no variable {given}; {one_of(names, given)}")
        converted[name] = _convert_variable(name, result.variables[name], unit)
    return result.assign(converted)


def find_variable(result, name):
    """The name under which a result has a variable: ``t`` may stand for ``time``; None if none."""
    names = (name, "time") if name == "t" else (name,)
    return next((one for one in names if one in result.variables), None)


def in_si(result):
    """A result with all quantities in SI: itself, if none is in another unit; others as they are.

    A variable whose name is no quantity's stays as it is, and so does a pure number whose unit is
    that of something else.  ParameterError for a unit that is unknown or of another kind.  What was
    converted may differ from its first value in the last digit.
    """
    converted = {}
    for name, variable in getattr(result, "variables", {}).items():
        si = QUANTITIES[name].unit if name in QUANTITIES else None
        own = variable.attrs.get("units") or si
        # (a ratio may carry the unit of what it is the ratio of: xarray's arithmetic keeps it)
        if si is not None and own != si and (si != "1" or has_unit(name, str(own))):
            converted[name] = _convert_variable(name, variable, si)
    return result.assign(converted) if converted else result


def _convert_variable(name, variable, unit):
    """A Variable in this unit, given as text."""
    own = variable.attrs.get("units")
    is_number = variable.dtype.kind in "iufc" and "flag_values" not in variable.attrs
    if name not in QUANTITIES or own is None or not is_number:
        raise ParameterError(f"{name} is no quantity with a unit; leave it out")
    old, new = (_si_factor(name, str(one)) for one in (own, unit))
    converted = variable.copy(data=scaled(variable.values, old / new))
    converted.attrs["units"] = unit
    return converted


def _si_factor(name, unit):
    """SI units in one unit of a variable (Decimal)."""
    try:
        return unit_factor(QUANTITIES[name].unit, unit)
    except ValueError as error:
        raise ParameterError(f"{name}: {unit!r} {error}; {expected(name)}") from None
