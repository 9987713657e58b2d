"""The function `summary`: the `Report` of any result."""

from collections.abc import Mapping

import xarray

from ..dynamics.recipe import attribute_text
from ..errors import ParameterError
from ..model.conversion import check_result, in_si, si_factor
from ..model.names import nearest
from ..model.parameters import of_contact
from ..model.quantities import QUANTITIES
from ..model.units import has_unit
from .report import Report, Row, Title, Units, of_quantities, shown_units


def summary(result: xarray.Dataset, units: Mapping[str, str] | None = None) -> Report:
    """Describe the result of any function of ratestate, to print.

    Parameters
    ----------
    result : xarray.Dataset
        Result of `simulate`, `stability`, `limit_cycle`, `continue_cycle`, `frequency_response`,
        `sweep`, `fit`, `events`, `healing` or `machine_stiffness`, with its attributes and
        variables.  A sweep has the smallest and largest value of each variable.  Of other
        functions, `classify` for example, the single values are listed.
    units : dict, optional
        Units of symbols in tables, such as ``{"V_lp": "mm/s"}``.  By default each value has a unit
        that suits its size.  Units have no effect on results of records.

    Returns
    -------
    Report
        Its `str` is plain text.

    Raises
    ------
    ParameterError
        If result is not such a result, lacks its attributes, or has no values to list.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="1 GPa/m")
    >>> print(str(rs.summary(rs.stability(slider, "1 um/s"))).splitlines()[0])
    Steady sliding at 1 um/s is stable
    """
    check_result(result)
    result = in_si(result)
    name = attribute_text(result, "title").removeprefix("ratestate ")
    if name == "fit":
        from .fits import report_on_fit

        return report_on_fit(result)
    from . import many_cases, single

    shown = shown_units(result, units)
    _check_units(shown)
    if name not in single.TABLES:
        from . import evaluations  # slow: it imports what evaluates records

        if name in evaluations.TABLES:
            return Report(evaluations.TABLES[name](result))
    if many_cases.axes_of(result, name):
        return Report(many_cases.sweep(result, name, shown))
    if name in single.TABLES:
        try:
            return Report(single.TABLES[name](result, shown))
        except AttributeError as lost:
            raise ParameterError(
                f"the result of {name} is incomplete: {lost}", "Give it with all its variables."
            ) from lost
    single_values = {key: x for key, x in result.data_vars.items() if not x.dims}
    rows = [
        Row(str(key), value, text=(str(value.item()) or "-") if value.dtype.kind in "OUT" else "")
        for key, value in single_values.items()
        if key in QUANTITIES
    ]
    if not rows:
        raise ParameterError(
            f"the Dataset with the title {name!r} has no single values to list",
            "Give a Dataset as ratestate returns it, or one case of it.",
        )
    return Report([Title(f"Result of {name}"), of_quantities(rows, shown)])


def _check_units(units: Units) -> None:
    """Raise ParameterError if a symbol is unknown or a unit does not fit."""
    for symbol, unit in units.wanted.items():
        if symbol not in QUANTITIES:
            near = nearest(symbol, QUANTITIES)
            wanted = f"Did you mean {near}?" if near else "Give symbols such as V_lp."
            raise ParameterError("is not a quantity", wanted, symbol=symbol)
        if not has_unit(of_contact(symbol, 1.0, units.area)[0], unit):
            si_factor(symbol, unit)
