"""What a fit found as a slider, to go on with."""

import xarray

from ...errors import ParameterError
from ...model.slider import SpringSlider
from .each import each_law, value_of

#: what no result of `fit` is without
NEEDED = ("law", "parameter", "standard_error", "interval", "friction", "time")


def slider_of(result, law=None):
    """The slider that a fit found: free parameters and mu0 as fitted, the others as given.

    Parameters
    ----------
    result : xarray.Dataset
        From `fit`.
    law : {"slip", "aging"}, optional
        Of a fit under several laws, the one that is wanted.

    Returns
    -------
    SpringSlider
        In SI, for `simulate`, `stability` and all else.

    Raises
    ------
    ParameterError
        No result of `fit`; a law under which nothing was fitted, or several and none is named.
    """
    laws = checked_laws(result, "slider_of")
    if law is None and len(laws) == 1:
        (law,) = laws
    if law not in laws:
        listed = " or ".join(f"law={one!r}" for one in laws)
        what = "the fit is under several laws" if law is None else f"no fit is under law = {law!r}"
        raise ParameterError(f"{what}; give {listed}")
    symbols = ("a", "b", "Dc", "sigma", "K", "M", "mu0", "V0")
    return SpringSlider(**{symbol: value_of(laws[law], symbol) for symbol in symbols}, law=law)


def checked_laws(result, who):
    """law -> its part of a result of `fit`; ParameterError, in the name of `who`, if it is none."""
    title = result.attrs.get("title") if isinstance(result, xarray.Dataset) else None
    if str(title) != "ratestate fit" or any(name not in result.variables for name in NEEDED):
        raise ParameterError(f"{who} wants the Dataset that fit gives, whole, with its attributes")
    return each_law(result)
