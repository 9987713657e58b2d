"""What was recorded in each window: what the load point does, and samples under the fits."""

import numpy as np

from ...kit.results import labelled

#: most samples of a window that are kept for figures
KEPT = 1000


def window_variables(fits):
    """What the load point does in each window, and the normal stress."""
    windows = [fit.task.window for fit in fits]
    tasks = [fit.task for fit in fits]
    columns = {
        "kind": np.array([window.kind for window in windows]),
        "step_t": np.array([window.t for window in windows]),
        "step_delta_lp": np.array([_displacement(task) for task in tasks]),
        "V_before": np.array([window.V_before for window in windows]),
        "V_after": np.array([window.V_after for window in windows]),
        "t_hold": np.array([window.t_hold for window in windows]),
        "sigma": np.array([task.settings.sliders[0].sigma for task in tasks]),
        "sigma_after": np.array([_stress_after(task) for task in tasks]),
        "samples": np.array([task.data.sizes["time"] for task in tasks]),
        "rows_per_sample": np.array([task.rows_per_sample for task in tasks]),
    }
    return labelled("step", **columns)


def _stress_after(task):
    """Normal stress [Pa] after a step of it; NaN of a step or hold of the load point."""
    is_step = task.window.kind == "normal stress"
    return task.window.stresses(task.data)[1] if is_step else np.nan


def _displacement(task):
    """Displacement of the load point [m] at the step; NaN where it was not recorded."""
    if "delta_lp" not in task.data or not task.data.sizes["time"]:
        return np.nan
    return float(np.interp(task.window.t, task.data["time"], task.data["delta_lp"]))


def curve_variables(fits, laws):
    """Some samples of each window along ``sample``, and friction as fitted; NaN beyond them."""
    n, size = len(fits), min(KEPT, max(fit.task.data.sizes["time"] for fit in fits))
    table = {name: np.full((n, size), np.nan) for name in ("time", "delta_lp", "friction")}
    fitted = np.full((len(laws), n, size), np.nan)
    for i, fit in enumerate(fits):
        data = fit.task.data
        rows = np.unique(np.linspace(0, data.sizes["time"] - 1, size).astype(int))
        for name in [name for name in table if name in data.variables]:
            table[name][i, : rows.size] = data[name].values[rows]
        for j, law in enumerate(laws):
            if one := fit.of(law):
                curve = one.result["friction_fit"].values
                fitted[j, i, : rows.size] = curve[rows]
    dims = ("law", "step", "sample") if len(laws) > 1 else ("step", "sample")
    curves = fitted if len(laws) > 1 else fitted[0]
    return labelled(("step", "sample"), **table) | labelled(dims, friction_fit=curves)
