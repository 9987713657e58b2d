"""Results of `fit`, law by law: estimates with their errors, and the estimated slider."""

import numpy as np
import xarray

from ...dynamics.results import law_of_result, parameter, slider_parameters
from ...friction.laws import law_name
from ...friction.linear_stability import K_c
from ...model.conversion import in_si
from ...model.slider import SpringSlider
from ...model.slider_parameters import OPTIONAL, PARAMETERS
from ..messages import fitting as sentences

#: relative step of finite differences
STEP = 1e-5
#: difference of ln(likelihood) or ln(evidence) above which one law fits clearly worse
CLEAR = 5.0
#: variables that every result of `fit` has
NEEDED = ("law", "parameter", "standard_error", "interval", "friction", "time")


def has_steps(result):
    """Return whether a result of `fit` has fits of each step, along ``step``."""
    return "step" in result.dims


def results_by_law(result):
    """Return law -> the part of a result of `fit` under that law, unchecked.

    If the result has no steps, variables and parameters of other laws are left out.
    """
    if "law" in result.dims:
        parts = {str(law): result.sel(law=law) for law in result["law"].values}
    else:
        parts = {str(result["law"].item()): result}
    return parts if has_steps(result) else {law: _trimmed(part) for law, part in parts.items()}


def _trimmed(part):
    empty = [name for name, v in part.data_vars.items() if v.dtype.kind == "f" and v.isnull().all()]
    part = part.drop_vars(empty)
    own = [name for name in part["parameter"].values.tolist() if name in part.data_vars]
    return part.sel(parameter=own, other=own)


def checked_by_law(result, caller):
    """Return `results_by_law`; the caller's ParameterError if it is not of `fit`."""
    title = result.attrs.get("title") if isinstance(result, xarray.Dataset) else None
    if str(title) != "ratestate fit" or any(name not in result.variables for name in NEEDED):
        raise sentences.refusal("result.not_of_fit", caller=caller)
    return results_by_law(in_si(result))


def warnings_of(part):
    """Return the warnings (list of str) of one law's part."""
    return str(part["warnings"].item()).splitlines()


def clearly_worse(result):
    """Return the laws (list of str) of a fit without steps that fit clearly worse than another."""
    if "aic_difference" not in result or has_steps(result):
        return []
    is_worse = (result["aic_difference"] > 2.0 * CLEAR).values
    return result["law"].values[is_worse].astype(str).tolist()


def value_of(part, symbol):
    """Return a parameter [SI] of one law's part: its estimate or its given value."""
    value = part[symbol] if symbol in part.data_vars else parameter(part, symbol)
    if np.ndim(value):
        raise sentences.refusal("result.several_values", symbol=symbol)
    return float(value)


def error_of(part, symbol):
    """Return the standard error of a parameter [SI].

    It is 0 if the parameter was not estimated, and inf if one of its intervals is open.  If the
    interval comes from a profile or a posterior, it is half the width of the 68 % interval.
    """
    if symbol not in part["parameter"].values:
        return 0.0
    row = part.sel(parameter=symbol)
    ends = row["interval"].transpose("level", "side").values
    is_open = ~np.isfinite(ends) | (ends == 0.0)  # 0 is the open lower end of a logarithm
    if is_open.any():
        return np.inf
    if "interval_kind" not in row or row["interval_kind"] == "covariance":
        return float(row["standard_error"])
    return float(ends[0, 1] - ends[0, 0]) / 2.0


def law_of(part):
    """Return the friction law of one law's part, in its form of friction."""
    return law_of_result(part, str(part["law"].item()))


def stiffness_over_critical(part):
    """Return (K/K_c_qs, its standard error) of one law's part, dimensionless.

    None if K = inf, or if the law has a characteristic speed, on which K_c_qs depends.  The ratio
    is inf if K_c_qs <= 0.  The relative errors (`error_of`) of K and of the parameters of K_c_qs
    are propagated with their correlation.  The error is 0 if none was estimated, and inf if one of
    their errors is not finite.
    """
    law, K = law_of(part), value_of(part, "K")
    if law.has_speed_scale:
        return None
    at = {symbol: value_of(part, symbol) for symbol in (*law.symbols, "sigma")}

    def critical(**changes):
        """Return K_c_qs [Pa/m] with some values changed."""
        values = {symbol: np.array(value) for symbol, value in (at | changes).items()}
        return float(K_c(law, np.array(1.0), M=np.array(0.0), **values))

    if critical() <= 0.0:
        return np.inf, 0.0
    if not np.isfinite(K):
        return None
    # symbol -> derivative of ln(K/K_c_qs) by that parameter
    slopes = {"K": 1.0 / K}
    if law.one_length:  # only b - a matters, which may be known better than a and b
        slopes |= {"Dc": 1.0 / at["Dc"], "a_minus_b": 1.0 / (at["b"] - at["a"])}
    for symbol in () if law.one_length else law.symbols:
        step = STEP * (abs(at[symbol]) or 1.0)
        above, below = (critical(**{symbol: at[symbol] + h}) for h in (step, -step))
        slopes[symbol] = (np.log(below) - np.log(above)) / (2.0 * step)
    ratio, names = K / critical(), [name for name in slopes if name in part["parameter"].values]
    relative = np.array([slopes[name] * error_of(part, name) for name in names])
    if not np.isfinite(relative).all():
        return ratio, np.inf
    # correlations of logarithms have the same sign as correlations of the positive parameters
    correlation = part["correlation"].sel(parameter=names, other=names).values
    return ratio, ratio * float(np.sqrt(relative @ correlation @ relative))


def _combine_steps(result):
    """Return a result with steps as one fit: shared estimates, or else medians."""
    values = {}
    for name in result["parameter"].values.tolist():
        estimates, shared = result[name], result["shared"].sel(parameter=name, drop=True)
        values[name] = shared.fillna(estimates.median("step")).assign_attrs(estimates.attrs)
    return result.isel(step=0, drop=True).drop_vars("sigma").assign(values)


def fitted_slider(result, law=None):
    """Return the slider that a fit estimated.

    Free parameters and mu0 have their estimates.  All others have the values that were given.  If
    each step was fitted, a parameter has its joint estimate.  If it has none, like K and mu0, it
    has the median over the steps.

    Parameters
    ----------
    result : xarray.Dataset
        From `fit`.
    law : str, optional
        One of the fitted laws.  It is required if there are several.

    Returns
    -------
    SpringSlider
        In SI, for `simulate`, `stability` and all other functions.

    Raises
    ------
    ParameterError
        If the Dataset is not a result of `fit`, the law was not fitted, or several laws were fitted
        and none is named.
    """
    laws = checked_by_law(result, "fitted_slider")
    if has_steps(result):
        laws = results_by_law(_combine_steps(in_si(result)))
    law = law_name(law) if law is not None else next(iter(laws)) if len(laws) == 1 else None
    if law not in laws:
        choices = " or ".join(f"law={name!r}" for name in laws)
        sentence = "several_laws" if law is None else "other_law"
        raise sentences.refusal(f"result.{sentence}", law=law, choices=choices)
    known = slider_parameters(laws[law])
    of_law = (*PARAMETERS, *OPTIONAL, *law_of(laws[law]).parameters)
    values = {s: value_of(laws[law], s) for s in known if s in of_law and s != "friction_form"}
    if "friction_form" in known:  # the form of friction, not the friction of the record
        values["friction_form"] = parameter(laws[law], "friction_form")
    return SpringSlider(**values, law=law)


def law_names(laws):
    """Return the laws by name.

    >>> law_names(["mine"]), law_names(["mine", "yours", "theirs"])
    ('mine law', 'mine, yours and theirs laws')
    """
    *others, last = laws
    return f"{', '.join(others)} and {last} laws" if others else f"{last} law"


def rate_dependence_text(laws):
    """Return the name of "a_minus_b": "a - b", if it is that under these laws."""
    return "a - b" if all(law.one_length for law in laws) else "d mu_ss/d ln V"
