"""The Dataset of a fit: one law's, and several laws' side by side."""

import numpy as np
import xarray

from ...dynamics.recorded_loading import record_loading
from ...friction.laws import friction_law
from ..kit.results import labelled
from .diagnostics.checks import diagnose
from .diagnostics.model_comparison import compare_laws
from .diagnostics.trend import without_trend
from .estimates import LEVELS, ROOTS, SIDES
from .likelihood.posterior import prior_text
from .unknowns import SUMS, free_under, starts_of


def dataset_of(inference, data):
    """The Dataset of an `Inference`, with notes and warnings on it."""
    solution, quantities = inference.solution, inference.quantities
    record = solution.problem.record
    result = xarray.merge(
        [
            estimate_variables(inference.estimates),
            _trend_variables(inference),
            _profile_variables(inference.profiles, quantities),
            _posterior_variables(inference.posterior, quantities),
            curve_variables(record.time, record.friction, solution.fitted_friction),
            _band_variables(solution),
            _statistics(inference),
        ]
    )
    result = result.assign(text_variables(*diagnose(inference, data)))
    if inference.posterior is not None:
        result.attrs["prior"] = prior_text(inference.posterior.prior)
    record_loading(result, record.loading)
    if record.loading.normal_stress is not None:
        result.attrs["normal_stress"] = "varies"
    return result


def add_comparison(results, aic, *, colored=False, fits=True):
    """Add the comparison of two laws or more to each of their results, in place.

    aic : law -> Akaike information criterion, or chi-square of laws with as many parameters
    colored : whether residuals are correlated; fits : whether any of the laws fits
    """
    table, text = compare_laws(results, aic, colored, fits)
    for law, result in results.items():
        for name, variable in table.sel(law=law, drop=True).items():
            result[name] = variable
        result.attrs["comparison"] = text


def side_by_side(results):
    """Results under several laws (dict, law -> Dataset) as one, along ``law``; padded: NaN, ""."""
    free = free_under([friction_law(law) for law in results])
    of_any = {name for result in results.values() for name in result["parameter"].values.tolist()}
    names = [name for name in (*free, *SUMS) if name in of_any]
    joined = xarray.concat(
        [
            result.reindex(parameter=names, other=names).assign_coords(
                {d: range(result.sizes[d]) for d in result.dims if d not in result.coords}
            )
            for result in results.values()
        ],
        "law",
        join="outer",
        combine_attrs="drop_conflicts",
    )
    for name, variable in joined.data_vars.items():
        if variable.dtype == object:  # text, padded where a law has less of it
            joined[name] = variable.fillna("").astype(str)
    return joined


def estimate_variables(estimates):
    """The Dataset of `Estimates` [SI]: a scalar for each, and tables along ``parameter``."""
    names = list(estimates.names)
    values = zip(names, estimates.values.tolist(), strict=True)
    variables = {
        **labelled((), **dict(values)),
        **labelled("parameter", standard_error=estimates.errors),
        **labelled(("parameter", "level", "side"), interval=estimates.intervals),
        **labelled(("parameter", "other"), correlation=estimates.correlation),
        **labelled("parameter", interval_kind=list(estimates.kinds)),
    }
    coords = {"parameter": names, "other": names, "level": list(LEVELS), "side": list(SIDES)}
    return xarray.Dataset(variables, coords)


def _trend_variables(inference):
    """Estimates if the trend is left out, ``without_trend``; nothing if the fit has no trend."""
    if (values := without_trend(inference)) is None:
        return xarray.Dataset()
    return xarray.Dataset(labelled("parameter", without_trend=values))


def _profile_variables(profiles, quantities):
    """Points of the profiles: ``profile_value`` [SI] and ``profile_deviance``, padded with NaN."""
    if not profiles:
        return xarray.Dataset()
    size = max(profile.values.size for profile in profiles.values())
    table = np.full((2, len(quantities), size), np.nan)
    for i, quantity in enumerate(quantities):
        if profile := profiles.get(quantity.name):
            columns = quantity.si(profile.values), profile.deviance
            table[:, i, : profile.values.size] = columns
    value, deviance = table
    dims = ("parameter", "profile_point")
    coords = {"parameter": [q.name for q in quantities], "profile_point": np.arange(size)}
    return xarray.Dataset(labelled(dims, profile_value=value, profile_deviance=deviance), coords)


def _posterior_variables(posterior, quantities):
    """Samples of equal weight, and the sampler's diagnostics."""
    if posterior is None:
        return xarray.Dataset()
    scalars = labelled(
        (),
        log_evidence=posterior.log_evidence,
        log_evidence_error=posterior.log_evidence_error,
        posterior_evaluations=posterior.evaluations,
        effective_samples=posterior.effective,
        posterior_efficiency=posterior.efficiency,
    )
    samples = np.stack([q.si(posterior.samples_of(q)) for q in quantities], axis=1)
    coords = {"parameter": [q.name for q in quantities]}
    return xarray.Dataset(scalars | labelled(("sample", "parameter"), posterior=samples), coords)


def curve_variables(time, friction, fitted):
    """Dataset of recorded and fitted friction (m,) along time (m,) [s], and their difference."""
    variables = labelled("time", friction=friction, friction_fit=fitted)
    labels = {"units": "1", "long_name": "recorded less fitted friction"}
    variables["residual"] = ("time", friction - fitted, labels)
    return xarray.Dataset(variables, labelled("time", time=time))


def _band_variables(solution):
    """The error of the fitted friction, the band of 95 % of samples, and the load point's way."""
    record, jacobian = solution.problem.record, solution.jacobian
    variance = np.einsum("mi,ij,mj->m", jacobian, solution.covariance, jacobian)
    error = np.sqrt(np.maximum(variance, 0.0))
    reach = ROOTS[-1] * np.hypot(error, solution.noise.level)
    band = solution.fitted_friction[:, None] + reach[:, None] * np.array([-1.0, 1.0])
    delta_lp = record.loading.delta_lp(record.t)
    variables = labelled("time", fit_error=error, delta_lp=delta_lp)
    return xarray.Dataset(variables | labelled(("time", "side"), band=band), {"side": list(SIDES)})


def _statistics(inference):
    """The misfit, the noise and the information criteria; the start, if that was free."""
    solution = inference.solution
    residual, noise = solution.residual, solution.noise
    k = len(solution.point) + (3 if noise.red else 1)
    successive = np.var(np.diff(residual)) / 2.0
    values = {
        "rms": np.sqrt(np.mean(residual**2)),
        "noise_white": noise.white,
        "noise_red": noise.red,
        "noise_time": noise.time if noise.red else 0.0,
        "noise_exponent": noise.exponent or 0.0,
        "misfit_p_value": inference.chance,
        "chi2_white": np.mean(residual**2) / successive,
        "log_likelihood": solution.log_likelihood,
        "aic": 2.0 * k - 2.0 * solution.log_likelihood,
        "bic": k * np.log(residual.size) - 2.0 * solution.log_likelihood,
        "samples": residual.size,
        "evaluations": solution.evaluations,
    }
    law, forward = solution.problem.law, solution.problem.forward
    V_start, *states = starts_of(law)
    if V_start in solution.unknowns.names:
        at = forward.values(solution.point[None])
        v, logs = forward.start(at, forward.coefficients(at))
        values[V_start] = forward.V0 * np.exp(v.item())
        for name, D, log in zip(states, law.lengths, logs, strict=True):
            values[name] = (at[D] / forward.V0 * np.exp(log)).item()
    return xarray.Dataset(labelled((), **values))


def text_variables(identifiability, warnings):
    """Two variables: the note on what is determined (str); the warnings, one on each line."""
    return labelled((), identifiability=identifiability, warnings="\n".join(warnings))
