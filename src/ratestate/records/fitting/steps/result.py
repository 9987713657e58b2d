"""The Dataset of the fits of all steps and holds of a record."""

import itertools

import numpy as np
import xarray

from ....dynamics.results import flags
from ....model.quantities import attrs
from ...kit.results import labelled
from ..estimates import LEVELS, SIDES
from ..result import compare_laws, joined, names_of
from ..unknowns import to_value
from .shared import estimates_of, grouped, is_down, is_up, ratio_of

#: status of a window under a law
FITTED, FAILED, STICK_SLIP = 0, 1, 2
#: scalars of a fit that are kept for each step
SCALARS = (
    "rms noise_white noise_red noise_time noise_exponent misfit_p_value chi2_white log_likelihood"
    " aic bic log_evidence log_evidence_error"
).split()
#: what else is kept of a fit
KEPT = "standard_error interval interval_kind correlation identifiability warnings".split()
#: most samples of a window that are kept for figures
SAMPLES = 1000


def dataset_of_steps(fits, shared, laws):
    """The Dataset of `Fitted` windows in order of time.

    shared : law -> `Shared`, or None; laws : names, in order; along ``law`` if they are several
    """
    names = names_of([one.result for fit in fits for law in laws if (one := fit.of(law))], laws)
    size = min(SAMPLES, max(fit.task.data.sizes["time"] for fit in fits))
    windows = joined([_window(fit, size) for fit in fits], "step", names)
    tables = []
    for law in laws:
        table = joined([_row(fit, law, names, size) for fit in fits], "step", names)
        empty = [name for name in SCALARS if name in table and not np.isfinite(table[name]).any()]
        together = _shared(fits, shared[law], law, names)
        tables.append(table.drop_vars(empty).assign(together))
    result, several = tables[0], len(laws) > 1
    if several:
        result = joined(tables, "law", names).transpose("step", "law", ...)
        result["friction_fit"] = result["friction_fit"].transpose("law", ...)
    result = xarray.merge([result, windows], join="outer").drop_vars("sample")
    result["status"].attrs |= flags({FITTED: "fitted", FAILED: "failed", STICK_SLIP: "stick_slip"})
    steps = ("step", np.arange(1, len(fits) + 1), {"long_name": "step or hold"})
    result = result.assign_coords(law=laws if several else laws[0], step=steps)
    return _with_comparison(result, fits, laws) if several else result


def _row(fit, law, names, size):
    """What is kept of a window's fit under a law; NaN and "" if there is none."""
    one, rows = fit.of(law), _rows(fit, size)
    if one is None:
        texts = {"identifiability": "", "warnings": "", "message": fit.laws[law]}
        status, curve = STICK_SLIP if fit.is_stick_slip else FAILED, np.full(rows.size, np.nan)
        coords = {"parameter": names, "other": names, "level": list(LEVELS), "side": list(SIDES)}
        row = xarray.Dataset(coords=coords)
    else:
        part = one.result
        own = [name for name in (*part["parameter"].values.tolist(), *SCALARS) if name in part]
        row, status, curve = part[[*own, *KEPT]], FITTED, part["friction_fit"].values[rows]
        row.attrs = {}
        warnings = [*str(part["warnings"].item()).splitlines(), *fit.remarks(law)]
        texts = {"warnings": "\n".join(warnings), "message": ""}
    curves = labelled("sample", friction_fit=curve)
    return row.assign(labelled((), status=np.int8(status), **texts) | curves)


def _window(fit, size):
    """What the load point does in a window, the normal stress, and some of its samples."""
    task, window, data = fit.task, fit.task.window, fit.task.data
    rows, nothing = _rows(fit, size), np.full(data.sizes["time"], np.nan)
    names = ("time", "delta_lp", "friction")
    columns = {n: data[n].values if n in data.variables else nothing for n in names}
    time, delta_lp = columns["time"], columns["delta_lp"]
    scalars = {name: getattr(window, name) for name in ("kind", "V_before", "V_after", "t_hold")}
    scalars |= {
        "step_t": window.t,
        "step_delta_lp": np.interp(window.t, time, delta_lp) if time.size else np.nan,
        "sigma": task.settings.sliders[0].sigma,
        "sigma_after": window.stresses(data)[1] if window.kind == "normal stress" else np.nan,
        "samples": time.size,
        "rows_per_sample": task.rows_per_sample,
    }
    kept = labelled("sample", **{name: column[rows] for name, column in columns.items()})
    return xarray.Dataset(labelled((), **scalars) | kept)


def _rows(fit, size):
    """(size,) or fewer rows of a window, evenly."""
    return np.unique(np.linspace(0, fit.task.data.sizes["time"] - 1, size).astype(int))


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
    scalars = {"shared_deviance": np.nan, "shared_degrees": 0, "shared_p_value": np.nan}
    correlation = np.full((len(names), len(names)), np.nan)
    if shared is not None:
        scalars = {name: getattr(shared, name.removeprefix("shared_")) for name in scalars}
        which = [names.index(name) for name in shared.names]
        errors = np.sqrt(np.diag(shared.covariance))
        correlation[np.ix_(which, which)] = shared.covariance / np.outer(errors, errors)
    table = labelled(("parameter", "other"), shared_correlation=correlation)
    return labelled("parameter", **rows) | table | labelled((), **scalars)


def _with_comparison(result, fits, laws):
    """The result with the laws compared in each step, and in all in which all are fitted.

    No law fits if none does in most of these.
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
        sums = {law: {"bic": result["bic"].sel(law=law)[everywhere].sum()} for law in laws}
        total = {law: float(aic.sel(law=law).sum()) for law in laws}
        colored = bool((result["noise_red"] > 0.0).any())
        fitted = itertools.compress(fits, everywhere.values)
        misfits = [all(fit.of(law).is_misfit for law in laws) for fit in fitted]
        text = compare_laws(sums, total, colored, np.mean(misfits) <= 0.5)[1]
        result.attrs["comparison"] = text
    return result
