"""A result of `fit` law by law, and what its estimates imply."""

import numpy as np

from ...dynamics.results import parameter
from ...errors import ParameterError
from ...friction.stability import K_c_qs


def each_law(result):
    """law -> that law's part of a result of `fit`."""
    if "law" not in result.dims:
        return {str(result["law"].item()): _part(result.drop_vars("law"))}
    parts = {str(law): result.sel(law=law, drop=True) for law in result["law"].values}
    return {law: _part(part) for law, part in parts.items()}


def warnings_of(part):
    """The warnings (list of str) of one law's part."""
    return str(part["warnings"].item()).splitlines()


def _part(part):
    """One law's part, without what other laws have, or nothing in it."""
    absent = [
        name for name, v in part.data_vars.items() if v.dtype.kind == "f" and v.isnull().all()
    ]
    return part.drop_vars(absent)


def value_of(part, symbol):
    """A parameter [SI] of one law's part: as it was found, or as it was given."""
    value = part[symbol] if symbol in part.data_vars else parameter(part, symbol)
    if np.ndim(value):
        raise ParameterError(f"{symbol} has several values in the Dataset, where a fit has one")
    return float(value)


def error_of(part, symbol):
    """Its standard error [SI]; 0 for one that was given.

    Of an interval that a profile or a posterior has in place of the covariance: half of its 68 %,
    and inf if either level is open.
    """
    if symbol not in part["parameter"].values:
        return 0.0
    one = part.sel(parameter=symbol)
    if "interval_kind" not in one or one["interval_kind"] == "covariance":
        return float(one["standard_error"])
    ends = one["interval"].transpose("level", "side").values
    is_open = ~np.isfinite(ends) | (ends == 0.0)  # (0: of a logarithm)
    return np.inf if is_open.any() else float(ends[0, 1] - ends[0, 0]) / 2.0


def stiffness_over_critical(part):
    """K/K_c_qs of one law's part and its error; None where K_c_qs is not positive.

    Errors (`error_of`) are carried on as relative ones, with their correlation.
    """
    a, b, Dc, sigma, K = (value_of(part, symbol) for symbol in "a b Dc sigma K".split())
    critical = K_c_qs(a=a, b=b, Dc=Dc, sigma=sigma)
    if not (critical > 0.0 and np.isfinite(K)):
        return None
    weights = {"K": 1.0 / K, "Dc": 1.0 / Dc}
    if "a_minus_b" in part["parameter"].values:
        weights["a_minus_b"] = 1.0 / (b - a)
    else:
        weights |= {"a": 1.0 / (b - a), "b": -1.0 / (b - a)}
    known = [name for name in weights if name in part["parameter"].values]
    if not known:
        return K / critical, 0.0
    relative = np.array([weights[name] * error_of(part, name) for name in known])
    if not np.isfinite(relative).all():
        return K / critical, np.inf
    correlation = part["correlation"].sel(parameter=known, other=known).values
    return K / critical, K / critical * float(np.sqrt(relative @ correlation @ relative))
