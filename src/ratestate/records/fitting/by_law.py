"""A result of `fit` law by law: its estimates with their errors, and the slider they make."""

import numpy as np
import xarray

from ...dynamics.results import law_of_result, parameter, slider_parameters
from ...friction.laws import law_name
from ...friction.linear_stability import K_c
from ...model.conversion import in_si
from ...model.slider import OPTIONAL, PARAMETERS, SpringSlider
from ..messages import fitting as sentences

#: relative step of a difference
STEP = 1e-5
#: variables that every result of `fit` has
NEEDED = ("law", "parameter", "standard_error", "interval", "friction", "time")


def is_of_steps(result):
    """Whether a result of `fit` is one of steps."""
    return "step" in result.dims


def results_by_law(result):
    """dict law -> that law's part of a result of `fit` (not checked).

    Of one fit without what is all NaN, because only other laws have it.
    """
    if "law" in result.dims:
        parts = {str(law): result.sel(law=law) for law in result["law"].values}
    else:
        parts = {str(result["law"].item()): result}
    return parts if is_of_steps(result) else {law: _own(part) for law, part in parts.items()}


def _own(part):
    empty = [name for name, v in part.data_vars.items() if v.dtype.kind == "f" and v.isnull().all()]
    part = part.drop_vars(empty)
    own = [name for name in part["parameter"].values.tolist() if name in part.data_vars]
    return part.sel(parameter=own, other=own)


def checked_by_law(result, caller):
    """`results_by_law`, or a ParameterError in the name of `caller` if `fit` did not give this."""
    title = result.attrs.get("title") if isinstance(result, xarray.Dataset) else None
    if str(title) != "ratestate fit" or any(name not in result.variables for name in NEEDED):
        raise sentences.refusal("result.not_of_fit", caller=caller)
    return results_by_law(in_si(result))


def warnings_of(part):
    """The warnings (list of str) of one law's part."""
    return str(part["warnings"].item()).splitlines()


def value_of(part, symbol):
    """A parameter [SI] of one law's part (float): its estimate, or the value that was given.

    ParameterError if the result has several values, or has lost the attribute with that given.
    """
    value = part[symbol] if symbol in part.data_vars else parameter(part, symbol)
    if np.ndim(value):
        raise sentences.refusal("result.several_values", symbol=symbol)
    return float(value)


def error_of(part, symbol):
    """Standard error of a parameter [SI]; 0 if it was not estimated, inf if an interval is open.

    Where the interval is from a profile or a posterior: half the width of the 68 % interval.
    """
    if symbol not in part["parameter"].values:
        return 0.0
    row = part.sel(parameter=symbol)
    ends = row["interval"].transpose("level", "side").values
    is_open = ~np.isfinite(ends) | (ends == 0.0)  # (0: of a logarithm)
    if is_open.any():
        return np.inf
    if "interval_kind" not in row or row["interval_kind"] == "covariance":
        return float(row["standard_error"])
    return float(ends[0, 1] - ends[0, 0]) / 2.0


def law_of(part):
    """The friction law of one law's part, with all that it is made of."""
    return law_of_result(part, str(part["law"].item()))


def stiffness_over_critical(part):
    """(K/K_c_qs, its standard error) of one law's part, dimensionless.

    None if K = inf, and under a law with a speed of its own, on which K_c_qs depends.  The ratio is
    inf if K_c_qs <= 0.  The relative errors (`error_of`) of K and of what K_c_qs depends on are
    propagated with their correlation: 0 if none was estimated, inf if one is not finite.
    """
    law, K = law_of(part), value_of(part, "K")
    if law.has_speed_scale:
        return None
    at = {symbol: value_of(part, symbol) for symbol in (*law.symbols, "sigma")}

    def critical(**changes):
        """K_c_qs [Pa/m] with some values changed, at any speed."""
        values = {symbol: np.array(value) for symbol, value in (at | changes).items()}
        return float(K_c(law, np.array(1.0), M=np.array(0.0), **values))

    if critical() <= 0.0:
        return np.inf, 0.0
    if not np.isfinite(K):
        return None
    # symbol -> derivative of ln(K/K_c_qs) by it
    slopes = {"K": 1.0 / K}
    if law.one_length:  # however little is known of a and b: only their difference counts
        slopes |= {"Dc": 1.0 / at["Dc"], "a_minus_b": 1.0 / (at["b"] - at["a"])}
    for symbol in () if law.one_length else law.symbols:
        step = STEP * (abs(at[symbol]) or 1.0)
        above, below = (critical(**{symbol: at[symbol] + h}) for h in (step, -step))
        slopes[symbol] = (np.log(below) - np.log(above)) / (2.0 * step)
    ratio, names = K / critical(), [name for name in slopes if name in part["parameter"].values]
    relative = np.array([slopes[name] * error_of(part, name) for name in names])
    if not np.isfinite(relative).all():
        return ratio, np.inf
    # those of positive parameters are correlations of logarithms, of the same sign
    correlation = part["correlation"].sel(parameter=names, other=names).values
    return ratio, ratio * float(np.sqrt(relative @ correlation @ relative))


def _of_all_steps(result):
    """A result of steps as that of one fit: shared estimates, medians where there are none."""
    values = {}
    for name in result["parameter"].values.tolist():
        each, shared = result[name], result["shared"].sel(parameter=name, drop=True)
        values[name] = shared.fillna(each.median("step")).assign_attrs(each.attrs)
    return result.isel(step=0, drop=True).drop_vars("sigma").assign(values)


def slider_of(result, law=None):
    """The slider that a fit estimated: free parameters and mu0 as fitted, the others as given.

    Of fits of each step: what is shared by all steps, and medians over the steps of the rest.

    Parameters
    ----------
    result : xarray.Dataset
        From `fit`.
    law : str, optional
        Which law, if the fit is under several.

    Returns
    -------
    SpringSlider
        In SI, for `simulate`, `stability` and all else.

    Raises
    ------
    ParameterError
        No result of `fit`; a law that was not fitted; several laws, and none is named.
    """
    if isinstance(result, xarray.Dataset) and is_of_steps(result):
        result = _of_all_steps(in_si(result))
    laws = checked_by_law(result, "slider_of")
    law = law_name(law) if law is not None else next(iter(laws)) if len(laws) == 1 else None
    if law not in laws:
        choices = " or ".join(f"law={name!r}" for name in laws)
        sentence = "several_laws" if law is None else "other_law"
        raise sentences.refusal(f"result.{sentence}", law=law, choices=choices)
    known = slider_parameters(laws[law])
    of_law = (*PARAMETERS, *OPTIONAL, *law_of(laws[law]).parameters)
    values = {s: value_of(laws[law], s) for s in known if s in of_law and s != "friction"}
    if "friction" in known:  # the form of friction, not the record's
        values["friction"] = parameter(laws[law], "friction")
    return SpringSlider(**values, law=law)
