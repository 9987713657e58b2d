"""The Dataset of the fits of all steps and holds of a record."""

import numpy as np
import xarray

from ....dynamics.results import flags
from ....friction.laws import friction_law
from ....model.quantities import attrs
from ...kit.results import labelled
from ..by_law import value_of
from ..diagnostics.model_comparison import compare_laws
from ..estimates import LEVELS, SIDES
from ..unknowns import SUMS, free_under, to_value
from .comparison import estimates_of, grouped, is_down, is_up, ratio_of
from .recorded import curve_variables, window_variables

#: status of a window under a law
FITTED, FAILED, STICK_SLIP = 0, 1, 2
#: scalars of a fit that are kept for each step
SCALARS = (
    "rms noise_white noise_red noise_time noise_exponent misfit_p_value chi2_white log_likelihood"
    " aic bic log_evidence log_evidence_error"
).split()
TEXTS = ("identifiability", "warnings")


def dataset_of_steps(fits, shared, laws):
    """The Dataset of `Fitted` windows in order of time.

    shared : law -> `Shared`, or None; laws : names, in order; along ``law`` if they are several
    """
    names = _names(fits, laws)
    tables = [_estimates(fits, law, names) for law in laws]
    tables = [
        table.assign(_shared(fits, shared[law], law, names))
        for table, law in zip(tables, laws, strict=True)
    ]
    result = tables[0]
    if len(laws) > 1:
        tables = [table.expand_dims("law", -1) for table in tables]
        result = xarray.concat(tables, "law", join="outer").transpose("step", "law", ...)
    result = result.assign(window_variables(fits) | curve_variables(fits, laws))
    result = result.assign_coords(
        law=laws if len(laws) > 1 else laws[0],
        step=("step", np.arange(1, len(fits) + 1), {"long_name": "step or hold"}),
        parameter=names,
        other=names,
        level=list(LEVELS),
        side=list(SIDES),
    )
    if len(laws) > 1:
        result = _with_comparison(result, laws, _misfits(fits, laws))
    return result


def _names(fits, laws):
    """Names of all that was estimated under any law, in the order of a fit's result."""
    parts = [one.result for fit in fits for law in laws if (one := fit.of(law))]
    of_any = {name for part in parts for name in part["parameter"].values.tolist()}
    free = free_under([friction_law(law) for law in laws])
    return [name for name in (*free, *SUMS) if name in of_any]


def _estimates(fits, law, names):
    """Estimates along ``step`` under one law; NaN and "" where it has none."""
    n, p = len(fits), len(names)
    values = {name: np.full(n, np.nan) for name in (*names, *SCALARS)}
    texts = {name: np.full(n, "", object) for name in (*TEXTS, "message")}
    error, interval = np.full((n, p), np.nan), np.full((n, p, 2, 2), np.nan)
    kind, correlation = np.full((n, p), "", object), np.full((n, p, p), np.nan)
    status = np.full(n, FITTED, np.int8)
    for i, fit in enumerate(fits):
        one = fit.of(law)
        if one is None:
            texts["message"][i] = fit.laws[law]
            status[i] = STICK_SLIP if fit.is_stick_slip else FAILED
            continue
        part = one.result
        own = part["parameter"].values.tolist()
        rows = [names.index(name) for name in own]
        error[i, rows] = part["standard_error"].values
        interval[i, rows] = part["interval"].transpose("parameter", "level", "side").values
        kind[i, rows] = part["interval_kind"].values
        correlation[i, *np.ix_(rows, rows)] = part["correlation"].values
        for name in own:
            values[name][i] = value_of(part, name)
        for name in SCALARS:
            values[name][i] = float(part[name]) if name in part else np.nan
        for name in TEXTS:
            texts[name][i] = str(part[name].item())
        warnings = [*texts["warnings"][i].splitlines(), *fit.remarks(law)]
        texts["warnings"][i] = "\n".join(warnings)
    values = {name: one for name, one in values.items() if name in names or np.isfinite(one).any()}
    of_status = attrs("status") | flags(
        {FITTED: "fitted", FAILED: "failed", STICK_SLIP: "stick_slip"}
    )
    texts = {name: one.astype(str) for name, one in texts.items()}
    return xarray.Dataset(
        {
            **labelled("step", **values, **texts),
            **labelled(("step", "parameter"), standard_error=error, interval_kind=kind.astype(str)),
            **labelled(("step", "parameter", "level", "side"), interval=interval),
            **labelled(("step", "parameter", "other"), correlation=correlation),
            "status": ("step", status, of_status),
        }
    )


def _shared(fits, shared, law, names):
    """What all steps together tell of each parameter under a law."""
    rows = {key: np.full(len(names), np.nan) for key in ("shared", "shared_error", "scatter")}
    of_ratio = ("up_over_down", "up_over_down_error", "up_over_down_p_value")
    rows |= {key: np.full(len(names), np.nan) for key in of_ratio}
    for i, name in enumerate(names):
        everything = grouped(fits, law, name)
        size = np.exp(everything.mean) if everything.is_log else 1.0
        if everything.n > 1:
            rows["scatter"][i] = size * everything.scatter
        up, down = (estimates_of(fits, law, name, which)[:2] for which in (is_up, is_down))
        ratio = ratio_of(up, down, everything.is_log)
        for key, value in zip(of_ratio, ratio, strict=True):
            rows[key][i] = value
        if shared is not None and name in shared.names:
            j = shared.names.index(name)
            value, spread = float(to_value(name, shared.point[j])), shared.covariance[j, j] ** 0.5
            rows["shared"][i] = value
            rows["shared_error"][i] = value * spread if everything.is_log else spread
    scalars = {
        "shared_deviance": np.nan if shared is None else shared.deviance,
        "shared_degrees": 0 if shared is None else shared.degrees,
        "shared_p_value": np.nan if shared is None else shared.p_value,
    }
    correlation = labelled(("parameter", "other"), shared_correlation=_correlation(shared, names))
    return labelled("parameter", **rows) | correlation | labelled((), **scalars)


def _correlation(shared, names):
    """(p, p) correlation of the coordinates that are shared; NaN of others."""
    table = np.full((len(names), len(names)), np.nan)
    if shared is not None:
        rows = [names.index(name) for name in shared.names]
        errors = np.sqrt(np.diag(shared.covariance))
        table[np.ix_(rows, rows)] = shared.covariance / np.outer(errors, errors)
    return table


def _misfits(fits, laws):
    """(n,) whether all laws are fitted to a window, and none fits."""
    return np.array([all((one := fit.of(law)) and one.is_misfit for law in laws) for fit in fits])


def _with_comparison(result, laws, misfits):
    """The result with the laws compared in each step, and in all in which all are fitted.

    misfits : of `_misfits`; if that is so in most of these, no law fits
    """
    everywhere = (result["status"] == FITTED).all("law")
    aic = result["aic"].where(everywhere)
    difference = aic - aic.min("law")
    weight = np.exp(-0.5 * difference)
    new = {"aic_difference": difference, "akaike_weight": weight / weight.sum("law")}
    if "log_evidence" in result:
        evidence = result["log_evidence"].where(everywhere)
        new["log_bayes_factor"] = evidence - evidence.max("law")
    for name, variable in new.items():
        result[name] = variable.transpose("step", "law").assign_attrs(attrs(name))
    if everywhere.any():
        sums = {
            law: xarray.Dataset({"bic": result["bic"].sel(law=law)[everywhere].sum()})
            for law in laws
        }
        total = {law: float(aic.sel(law=law).sum()) for law in laws}
        colored = bool((result["noise_red"] > 0.0).any())
        fits = misfits[everywhere].mean() <= 0.5
        result.attrs["comparison"] = compare_laws(sums, total, colored, fits)[1]
    return result
