"""The Dataset of the fits of all steps and holds of a record."""

import numpy as np
import xarray

from ....dynamics.results import flags
from ...kit import labelled
from ..by_law import warnings_of
from ..fit_dataset import joined, names_of, with_comparison
from ..quantities import LEVELS, SIDES
from ..unknowns import to_value
from . import FAILED, FITTED, NORMAL_STRESS, STICK_SLIP
from .shared import estimates_of, mean_of, moves_as_log, ratio_of

#: scalars of a fit that are stored for each step
SCALARS = (
    "rms noise_white noise_red noise_time noise_exponent misfit_p_value chi2_white log_likelihood"
    " aic bic log_evidence log_evidence_error"
).split()
#: other variables of a fit that are stored
KEPT = "standard_error interval interval_kind correlation identifiability".split()
#: most samples of a window that are stored for figures
SAMPLES = 1000


def dataset_of_steps(steps, shared):
    """Return the Dataset of the fits, along ``law`` if there are several.

    steps : law -> list of `Step` in order of time
    shared : law -> `Shared`, or None
    """
    laws, first = [*steps], next(iter(steps.values()))
    fitted = [step for own in steps.values() for step in own if step.status == FITTED]
    names = names_of([step.result for step in fitted], laws)
    size = min(SAMPLES, max(step.data.sizes["time"] for step in first))
    tables = [_law_table(steps[law], shared[law], names, size) for law in laws]
    result, several = tables[0], len(laws) > 1
    if several:
        result = joined(tables, "law", names).transpose("step", "law", ...).drop_vars("sample")
        result["friction_fit"] = result["friction_fit"].transpose("law", ...)
    empty = [name for name in SCALARS if name in result and result[name].isnull().all()]
    result = result.drop_vars(empty).assign(_window_variables(first, size))
    result["status"].attrs |= flags({FITTED: "fitted", FAILED: "failed", STICK_SLIP: "stick_slip"})
    numbers = ("step", np.arange(1, len(first) + 1), {"long_name": "step or hold"})
    result = result.assign_coords(law=laws if several else laws[0], step=numbers)
    if not several:
        return result
    # steps that are not fitted under all laws do not count
    everywhere = (result["status"] == FITTED).all("law")
    windows = zip(*steps.values(), strict=True)
    misfits = [all(step.is_misfit for step in window) for window in windows]
    fits = np.sum(everywhere.values & misfits) <= 0.5 * everywhere.sum()
    return with_comparison(result, result["aic"].where(everywhere), bool(fits))


def _law_table(steps, shared, names, size):
    """Return the fits under a law, NaN and "" without a fit, and joint estimates."""
    nothing = {"parameter": names, "other": names, "level": list(LEVELS), "side": list(SIDES)}
    rows = []
    for step in steps:
        row, warnings, curve = xarray.Dataset(coords=nothing), [], np.full(size, np.nan)
        if step.status == FITTED:
            fit = step.result
            kept = (*fit["parameter"].values.tolist(), *SCALARS, *KEPT)
            row = fit[[name for name in kept if name in fit]].drop_attrs(deep=False)
            warnings = [*warnings_of(fit), *filter(None, [step.no_posterior]), *step.caveats]
            curve = _sampled(fit["friction_fit"].values, size)
        row = row.assign(labelled("sample", friction_fit=curve))
        texts = {"warnings": "\n".join(warnings), "message": step.message}
        rows.append(row.assign(labelled((), status=np.int8(step.status), **texts)))
    table = joined(rows, "step", names).drop_vars("sample")
    return table.assign(_joint_variables(steps, shared, names))


def _window_variables(steps, size):
    """Return variables on the load point and normal stress, and some samples."""
    rows, samples = [], []
    for step in steps:
        window, data = step.window, step.data
        missing = np.full(data.sizes["time"], np.nan)
        columns = {
            name: data[name].values if name in data.variables else missing
            for name in ("time", "delta_lp", "friction")
        }
        of_stress = window.kind == NORMAL_STRESS
        samples.append({name: _sampled(column, size) for name, column in columns.items()})
        rows.append(
            {name: getattr(window, name) for name in ("kind", "V_before", "V_after", "t_hold")}
            | {
                "step_t": window.t,
                "step_delta_lp": np.interp(window.t, columns["time"], columns["delta_lp"]),
                "sigma": step.slider.sigma,
                "sigma_after": window.stress_levels(data)[1] if of_stress else np.nan,
                "samples": data.sizes["time"],
                "rows_per_sample": step.rows_per_sample,
            }
        )
    return labelled("step", **_columns(rows)) | labelled(("step", "sample"), **_columns(samples))


def _columns(rows):
    """Return name -> list of values, from dicts with the same names."""
    return {name: [row[name] for row in rows] for name in rows[0]}


def _sampled(values, size):
    """Return some of the values (size,), evenly spaced; padded with NaN."""
    rows = np.unique(np.linspace(0, len(values) - 1, size).astype(int))
    return np.append(values[rows], np.full(size - rows.size, np.nan))


def _joint_variables(steps, shared, names):
    """Return variables on what all steps under a law determine together."""
    rises, rows = np.array([step.window.rise for step in steps]), []
    for name in names:
        values, errors = estimates_of(steps, name)
        (mean, _, scatter), is_log = mean_of(values, errors), moves_as_log(name)
        known = np.isfinite(errors)
        up, down = ((values[known & to], errors[known & to]) for to in (rises > 0, rises < 0))
        row = {"shared": np.nan, "shared_error": np.nan}
        row["scatter"] = scatter * (np.exp(mean) if is_log else 1.0)
        names_of_ratio = ("up_over_down", "up_over_down_error", "up_over_down_p_value")
        row |= zip(names_of_ratio, ratio_of(up, down, is_log), strict=True)
        if shared is not None and name in shared.names:
            i = shared.names.index(name)
            value, error = float(to_value(name, shared.point[i])), shared.covariance[i, i] ** 0.5
            row |= {"shared": value, "shared_error": error * value if is_log else error}
        rows.append(row)
    scalars = {"shared_deviance": np.nan, "shared_degrees": 0, "shared_p_value": np.nan}
    correlation = np.full((len(names), len(names)), np.nan)
    if shared is not None:
        scalars = {name: getattr(shared, name.removeprefix("shared_")) for name in scalars}
        which = np.ix_(*2 * [[names.index(name) for name in shared.names]])
        errors = np.sqrt(np.diag(shared.covariance))
        correlation[which] = shared.covariance / np.outer(errors, errors)
    table = labelled(("parameter", "other"), shared_correlation=correlation)
    return labelled("parameter", **_columns(rows)) | table | labelled((), **scalars)


def warnings_of_steps(result):
    """Return a list of one sentence on stick-slip, failures and warnings, or none."""
    failed = result["status"].values == FAILED
    unstable = result["status"].values == STICK_SLIP
    doubtful = result["warnings"].values != ""
    if failed.ndim > 1:  # along law
        failed, unstable, doubtful = (x.any(axis=-1) for x in (failed, unstable, doubtful))
    parts = []
    for which, what, variable in (
        (unstable, "are stick-slip, and are not fitted", "message"),
        (failed, "cannot be fitted", "message"),
        (doubtful & ~failed, "have warnings", "warnings"),
    ):
        if which.any():
            steps = ", ".join(map(str, (np.flatnonzero(which) + 1).tolist()))
            parts.append(f"{which.sum()} of {which.size} {what} (step {steps}; see {variable})")
    return [f"fits of each step: {'; '.join(parts)}"] if parts else []
