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


def results_by_law(result):
    """dict law -> that law's part of a result of `fit` (not checked), without what is all NaN."""
    parts = results_by_law_of_steps(result)
    return {law: _without_empty(part) for law, part in parts.items()}


def is_of_steps(result):
    """Whether a result of `fit` is one of steps."""
    return "step" in result.dims


def results_by_law_of_steps(result):
    """dict law -> that law's part of a result of steps."""
    if "law" not in result.dims:
        return {str(result["law"].item()): result}
    return {str(law): result.sel(law=law) for law in result["law"].values}


def checked_by_law(result, caller):
    """`results_by_law`, or a ParameterError in the name of `caller` if `fit` did not give this."""
    title = result.attrs.get("title") if isinstance(result, xarray.Dataset) else None
    if str(title) != "ratestate fit" or any(name not in result.variables for name in NEEDED):
        raise sentences.refusal("result.not_of_fit", caller=caller)
    return results_by_law(in_si(result))


def _without_empty(part):
    """One law's part without variables that are all NaN: those that only other laws have."""
    empty = [name for name, v in part.data_vars.items() if v.dtype.kind == "f" and v.isnull().all()]
    part = part.drop_vars(empty)
    own = [name for name in part["parameter"].values.tolist() if name in part.data_vars]
    return part.sel(parameter=own, other=own)


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


def critical_stiffness(part):
    """K_c_qs [Pa/m] of one law's part (float); not above 0 where any K is stable.

    None under a law with a speed of its own, on which it depends.
    """
    law = law_of(part)
    values = {symbol: value_of(part, symbol) for symbol in (*law.symbols, "sigma")}
    return None if law.has_speed_scale else _K_c_qs(law, values)


def _K_c_qs(law, values):
    """K_c_qs [Pa/m] (float) of values by symbol, at any speed."""
    of_arrays = {symbol: np.array(value) for symbol, value in values.items()}
    return float(K_c(law, np.array(1.0), M=np.array(0.0), **of_arrays))


def stiffness_over_critical(part):
    """(K/K_c_qs, its standard error), dimensionless; None where K_c_qs <= 0 or K = inf.

    The relative errors (`error_of`) of K, Dc and a - b, or of what else K_c_qs depends on under the
    law, are propagated with their correlation: 0 if none of them was estimated, inf if one is not
    finite.
    """
    K, critical = value_of(part, "K"), critical_stiffness(part)
    if critical is None or not (critical > 0.0 and np.isfinite(K)):
        return None
    free = part["parameter"].values
    weights = {"K": 1.0 / K} | _relative_slopes(part)
    names = [name for name in weights if name in free]
    if not names:
        return K / critical, 0.0
    relative = np.array([weights[name] * error_of(part, name) for name in names])
    if not np.isfinite(relative).all():
        return K / critical, np.inf
    # those of positive parameters are correlations of logarithms, of the same sign
    correlation = part["correlation"].sel(parameter=names, other=names).values
    return K / critical, K / critical * float(np.sqrt(relative @ correlation @ relative))


def _relative_slopes(part):
    """symbol -> derivative of ln(1/K_c_qs) by it, of what K_c_qs depends on."""
    law = law_of(part)
    at = {symbol: value_of(part, symbol) for symbol in (*law.symbols, "sigma")}
    if law.one_length:  # however little is known of a and b: it has only their difference
        return {"Dc": 1.0 / at["Dc"], "a_minus_b": 1.0 / (at["b"] - at["a"])}
    slopes = {}
    for symbol in law.symbols:
        step = STEP * (abs(at[symbol]) or 1.0)
        up, down = (np.log(_K_c_qs(law, at | {symbol: at[symbol] + h})) for h in (step, -step))
        slopes[symbol] = -(up - down) / (2.0 * step)
    return slopes


def _of_all_steps(result):
    """A result of steps as that of one fit: shared estimates, medians where there are none."""
    shared = result["shared"].drop_vars("parameter")
    each = {name: i for i, name in enumerate(result["parameter"].values.tolist())}
    one = {
        name: shared.isel(parameter=i)
        .fillna(result[name].median("step"))
        .assign_attrs(result[name].attrs)
        for name, i in each.items()
    }
    return result.isel(step=0, drop=True).drop_vars("sigma").assign(one)


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
