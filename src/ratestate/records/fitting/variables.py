"""The variables of a fit's Dataset: estimates, intervals, curves, statistics, notes."""

import numpy as np
import xarray

from ...model.quantities import attrs
from .estimates import LEVELS, ROOTS, SIDES
from .unknowns import START


def estimate_variables(estimates):
    """The variables of `Estimates`: a scalar for each, and tables along ``parameter``."""
    variables: dict[str, tuple] = {
        name: ((), float(value), attrs(name))
        for name, value in zip(estimates.names, estimates.values, strict=True)
    }
    tables: dict[str, tuple] = {
        "standard_error": (("parameter",), estimates.errors),
        "interval": (("parameter", "level", "side"), estimates.intervals),
        "correlation": (("parameter", "other"), estimates.correlation),
        "interval_kind": (("parameter",), list(estimates.kinds)),
    }
    names = list(estimates.names)
    coords = {
        "parameter": names,
        "other": names,
        "level": list(LEVELS),
        "side": list(SIDES),
    }
    variables |= {name: (dims, values, attrs(name)) for name, (dims, values) in tables.items()}
    return xarray.Dataset(variables, coords)


def profile_variables(profiles, quantities):
    """Points of the profiles: ``profile_value`` [SI] and ``profile_deviance``, padded with NaN."""
    if not profiles:
        return xarray.Dataset()
    size = max(profile.values.size for profile in profiles.values())
    table = np.full((2, len(quantities), size), np.nan)
    for i, quantity in enumerate(quantities):
        if quantity.name in profiles:
            profile = profiles[quantity.name]
            columns = quantity.si(profile.values), profile.deviance
            table[:, i, : profile.values.size] = columns
    dims = ("parameter", "profile_point")
    names = ("profile_value", "profile_deviance")
    variables = {n: (dims, part, attrs(n)) for n, part in zip(names, table, strict=True)}
    coords = {"parameter": [q.name for q in quantities], "profile_point": np.arange(size)}
    return xarray.Dataset(variables, coords)


def posterior_variables(posterior, quantities):
    """Samples of equal weight, and the sampler's diagnostics."""
    if posterior is None:
        return xarray.Dataset()
    samples = np.stack([q.si(posterior.samples_of(q)) for q in quantities], axis=1)
    values = {
        "log_evidence": posterior.log_evidence,
        "log_evidence_error": posterior.log_evidence_error,
        "posterior_evaluations": posterior.evaluations,
        "effective_samples": posterior.effective,
        "posterior_efficiency": posterior.efficiency,
    }
    variables: dict[str, tuple] = {n: ((), value, attrs(n)) for n, value in values.items()}
    variables["posterior"] = (("sample", "parameter"), samples, attrs("posterior"))
    return xarray.Dataset(variables, {"parameter": [q.name for q in quantities]})


def curves(solution):
    """The variables along time: recorded and fitted friction, residual, error and 95 % band."""
    record = solution.problem.record
    error = np.sqrt(
        np.maximum(
            np.einsum("mi,ij,mj->m", solution.jacobian, solution.covariance, solution.jacobian), 0.0
        )
    )
    reach = ROOTS[-1] * np.hypot(error, solution.noise.level)
    values = {
        "friction": record.friction,
        "friction_fit": solution.fitted_friction,
        "fit_error": error,
    }
    variables: dict[str, tuple] = {n: ("time", value, attrs(n)) for n, value in values.items()}
    labels = {"units": "1", "long_name": "recorded less fitted friction"}
    variables["residual"] = ("time", record.friction - solution.fitted_friction, labels)
    band = solution.fitted_friction[:, None] + reach[:, None] * np.array([-1.0, 1.0])
    variables["band"] = (("time", "side"), band, attrs("band"))
    variables["delta_lp"] = ("time", record.loading.delta_lp(record.t), attrs("delta_lp"))
    coords = {"time": ("time", record.time, attrs("time")), "side": list(SIDES)}
    return xarray.Dataset(variables, coords)


def statistics(solution):
    """The misfit, the noise and the information criteria; the start, if that was free."""
    residual = solution.problem.record.friction - solution.fitted_friction
    noise = solution.noise
    k = len(solution.point) + (3 if noise.red else 1)
    successive = np.var(np.diff(residual)) / 2.0
    values = {
        "rms": np.sqrt(np.mean(residual**2)),
        "noise_white": noise.white,
        "noise_red": noise.red,
        "noise_time": noise.time if noise.red else 0.0,
        "chi2_white": np.mean(residual**2) / successive,
        "log_likelihood": solution.log_likelihood,
        "aic": 2.0 * k - 2.0 * solution.log_likelihood,
        "bic": k * np.log(residual.size) - 2.0 * solution.log_likelihood,
        "samples": residual.size,
        "evaluations": solution.evaluations,
    }
    if START[0] in solution.unknowns.names:
        forward = solution.problem.forward
        at = {name: float(value[0]) for name, value in forward.values(solution.point[None]).items()}
        v, psi = (at[name] for name in START)
        values["V_start"] = forward.V0 * np.exp(v)
        values["theta_start"] = at["Dc"] / forward.V0 * np.exp(psi)
    return xarray.Dataset({name: ((), value, attrs(name)) for name, value in values.items()})


def text_variables(identifiability, warnings):
    """The notes on a fit: what is determined; and the warnings, one on each line."""
    texts = {"identifiability": identifiability, "warnings": "\n".join(warnings)}
    return {name: ((), text, attrs(name)) for name, text in texts.items()}
