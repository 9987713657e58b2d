"""The Dataset of a fit under one law, or under several laws, and which of them fits best."""

import numpy as np
import xarray

from ...dynamics.recipe import record_loading
from ...friction.laws import friction_law
from ...model.quantities import attrs
from ..kit import labelled
from ..messages import fitting as sentences
from .by_law import CLEAR, law_names
from .checks import diagnose, is_misfit, without_trend
from .posterior import prior_text
from .quantities import LEVELS, ROOTS, SIDES
from .unknowns import DERIVED, free_under, start_names

#: difference of ln(likelihood) or ln(evidence) below which the laws are undecided
UNDECIDED = 1.5


def datasets_of(inferences, laws, data):
    """Return law -> Dataset of each `Inference`, their AIC, and whether any law fits."""
    datasets = [dataset_of(inference, data) for inference in inferences]
    aic = [float(result["aic"]) for result in datasets]
    return dict(zip(laws, datasets, strict=True)), aic, not all(map(is_misfit, inferences))


def dataset_of(inference, data):
    """Return the Dataset of an `Inference`, with notes and warnings on it."""
    solution, quantities = inference.solution, inference.quantities
    record = solution.problem.record
    variables: dict = {}
    if (values := without_trend(inference)) is not None:
        variables |= labelled("parameter", without_trend=values)
    if inference.profiles:
        variables |= _profile_variables(inference.profiles, quantities)
    if inference.posterior is not None:
        variables |= _posterior_variables(inference.posterior, quantities)
    curves = curve_variables(record.time, record.friction, solution.fitted_friction)
    variables |= {**curves.variables, **_band_variables(solution), **_statistics(inference)}
    variables |= text_variables(*diagnose(inference, data))
    result = estimate_variables(inference.estimates).assign(variables)
    if inference.posterior is not None:
        result.attrs["prior"] = prior_text(inference.posterior.prior)
    record_loading(result, record.loading)
    if record.loading.normal_stress is not None:
        result.attrs["normal_stress"] = "varies"
    return result


def names_of(results, laws):
    """Return names (list) of quantities in any of the results, in order."""
    of_any = {name for result in results for name in result["parameter"].values.tolist()}
    free = free_under([friction_law(law) for law in laws])
    return [name for name in (*free, *DERIVED) if name in of_any]


def joined(results, dim, names):
    """Return results along a new dimension, padded with NaN, or "" for text.

    results : iterable of Dataset
    names : names of the parameters, in order
    """
    table = xarray.concat(
        [
            result.reindex(parameter=names, other=names).assign_coords(
                {d: range(result.sizes[d]) for d in result.dims if d not in result.coords}
            )
            for result in results
        ],
        dim,
        join="outer",
        combine_attrs="drop_conflicts",
    )
    for name, variable in table.data_vars.items():
        if variable.dtype == object:
            table[name] = variable.fillna("").astype(str)
    return table


def with_comparison(result, criterion, fits):
    """Return a result along ``law`` with the laws compared, in each step if it has steps.

    criterion : AIC along ``law``, or chi-square of laws with as many parameters; NaN in steps that
        are not fitted under all laws
    fits : whether any of the laws fits
    """
    difference = criterion - criterion.min("law")
    weight = np.exp(-0.5 * difference)
    new = {"aic_difference": difference, "akaike_weight": weight / weight.sum("law")}
    texts, laws, has_steps = [], result["law"].values.tolist(), "step" in criterion.dims
    total = criterion.sum("step") if has_steps else criterion
    if criterion.notnull().any():
        texts.append(_by_likelihood(total.values, laws, fits))
    if "bic" in result:
        bic = result["bic"].where(criterion.notnull())
        new["bic_difference"] = bic - bic.min("law")
    if "log_evidence" in result:
        evidence = result["log_evidence"].where(criterion.notnull())
        factor, error = evidence - evidence.max("law"), result["log_evidence_error"]
        of_both = np.hypot(error, error.where(factor == 0.0).max("law"))
        new["log_bayes_factor"] = factor
        new["log_bayes_factor_error"] = of_both.where(factor != 0.0, 0.0)
        if not has_steps:
            ranked = _ranked(-factor.values, laws)
            second = float(new["log_bayes_factor_error"].sel(law=ranked["other"]))
            which = "undecided" if ranked["difference"] < UNDECIDED + second else "decided"
            texts.append(sentences(f"evidence.{which}", **ranked, error=second))
    if texts and "noise_red" in result:
        is_red = (result["noise_red"] > 0.0).any([d for d in criterion.dims if d != "law"])
        if red := result["law"].values[is_red.values].tolist():
            is_best = laws[int(total.argmin("law"))] in red
            which = "correlated" if is_best else "others_correlated"
            texts.append(sentences(f"likelihood.{which}", laws=law_names(red)))
    result = result.assign(
        {name: x.transpose(*criterion.dims).assign_attrs(attrs(name)) for name, x in new.items()}
    )
    return result.assign_attrs(comparison=" ".join(texts)) if texts else result


def _ranked(values, laws):
    first, second = np.argsort(values)[:2]
    difference = float(values[second] - values[first])
    return {"best": laws[first], "other": laws[second], "difference": difference}


def _by_likelihood(aic, laws, fits):
    ranked, weight = _ranked(aic, laws), np.exp(-0.5 * (aic - aic.min()))
    half, shares = 0.5 * ranked["difference"], map(_share, weight / weight.sum())
    which = "undecided" if half < UNDECIDED else "better" if fits else "nearer"
    how = "clearly" if half > CLEAR else "somewhat"
    *others, last = (f"{share} ({law})" for law, share in zip(laws, shares, strict=True))
    weights = f"{', '.join(others)} and {last}"
    sentence = sentences(f"likelihood.{which}", **ranked, half=half, how=how, weights=weights)
    none = "Neither law" if len(laws) == 2 else "None of the laws"
    return sentence if fits else f"{sentences('likelihood.none_fits', none=none)} {sentence}"


def _share(weight):
    """Return an Akaike weight as text, at most as "> 0.99" and at least as "< 0.01"."""
    return "> 0.99" if weight > 0.99 else "< 0.01" if weight < 0.01 else f"{weight:.2f}"


def estimate_variables(estimates):
    """Return the Dataset of `Estimates` [SI]."""
    names = [*estimates.by_name]
    values, errors, intervals, kinds = map(list, zip(*estimates.by_name.values(), strict=True))
    variables = {
        **labelled((), **dict(zip(names, values, strict=True))),
        **labelled("parameter", standard_error=errors),
        **labelled(("parameter", "level", "side"), interval=intervals),
        **labelled(("parameter", "other"), correlation=estimates.correlation),
        **labelled("parameter", interval_kind=kinds),
    }
    coords = {"parameter": names, "other": names, "level": list(LEVELS), "side": list(SIDES)}
    return xarray.Dataset(variables, coords)


def _profile_variables(profiles, quantities):
    size = max(profile.values.size for profile in profiles.values())
    value, deviance = table = np.full((2, len(quantities), size), np.nan)
    for i, quantity in enumerate(quantities):
        if profile := profiles.get(quantity.name):
            table[:, i, : profile.values.size] = quantity.si(profile.values), profile.deviance
    dims = ("parameter", "profile_point")
    variables = labelled(dims, profile_value=value, profile_deviance=deviance)
    return {"profile_point": ("profile_point", np.arange(size)), **variables}


def _posterior_variables(posterior, quantities):
    samples = np.stack([q.si(q.values(posterior.points)) for q in quantities], axis=1)
    return labelled(("sample", "parameter"), posterior=samples) | labelled(
        (),
        log_evidence=posterior.log_evidence,
        log_evidence_error=posterior.log_evidence_error,
        posterior_evaluations=posterior.evaluations,
        effective_samples=posterior.effective,
        posterior_efficiency=posterior.efficiency,
    )


def curve_variables(time, friction, fitted):
    """Return the Dataset of recorded and fitted friction (m,), and residuals."""
    variables = labelled("time", friction=friction, friction_fit=fitted)
    labels = {"units": "1", "long_name": "recorded less fitted friction"}
    variables["residual"] = ("time", friction - fitted, labels)
    return xarray.Dataset(variables, labelled("time", time=time))


def _band_variables(solution):
    """Return the error of fitted friction, the 95 % band of samples, and delta_lp."""
    record = solution.problem.record
    error = np.linalg.norm(solution.jacobian @ solution.root, axis=1)
    reach = ROOTS[-1] * np.hypot(error, solution.noise.level)
    band = solution.fitted_friction[:, None] + reach[:, None] * np.array([-1.0, 1.0])
    delta_lp = record.loading.delta_lp(record.t)
    variables = labelled("time", fit_error=error, delta_lp=delta_lp)
    return variables | labelled(("time", "side"), band=band)


def _statistics(inference):
    """Return misfit, noise and information criteria; the start, if it was free."""
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
        "misfit_p_value": inference.p_value,
        "chi2_white": np.mean(residual**2) / successive,
        "log_likelihood": solution.log_likelihood,
        "aic": 2.0 * k - 2.0 * solution.log_likelihood,
        "bic": k * np.log(residual.size) - 2.0 * solution.log_likelihood,
        "samples": residual.size,
        "evaluations": solution.evaluations,
    }
    law, forward = solution.problem.law, solution.problem.forward
    V_start, *states = start_names(law)
    if V_start in solution.unknowns.names:
        at = forward.values(solution.point[None])
        v, logs = forward.start(at, forward.steady(at))
        values[V_start] = forward.V0 * np.exp(v.item())
        for name, D, log in zip(states, law.lengths, logs, strict=True):
            values[name] = (at[D] / forward.V0 * np.exp(log)).item()
    return labelled((), **values)


def text_variables(identifiability, warnings):
    """Return variables with the note on identifiability, and the warnings."""
    return labelled((), identifiability=identifiability, warnings="\n".join(warnings))
