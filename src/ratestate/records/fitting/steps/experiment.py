"""What `fit` does if each="step": all steps and holds of an experiment.

Steps of normal stress come last: they tell alpha, with the law's other parameters held at those of
the other steps.
"""

import numpy as np

from ....errors import RateStateError
from ....model.quantities import readable
from ...messages import fitting as sentences
from ..estimates import ROOTS
from ..generalized_least_squares import solutions_of
from ..unknowns import to_value
from .each import Fitted, fit_each, fit_window, task_of
from .result import FAILED, STICK_SLIP, dataset_of_steps
from .shared import grouped, shared_fit


def fit_experiment(data, settings):
    """The Dataset of all steps and holds of a record (Dataset in SI), with checked `Settings`.

    ParameterError where there is no step and no hold, or none that can be fitted.
    """
    fits, of_stress = fit_each(data, settings)
    shared = {law: shared_fit(fits, law) for law in settings.laws}
    fits += fit_stress_steps(data, of_stress, settings, fits, shared)
    fits.sort(key=lambda fit: fit.task.window.t)
    if not any(fit.of(law) for fit in fits for law in settings.laws):
        failed = next(fit for fit in fits if not fit.is_stick_slip)
        message = failed.laws[settings.laws[0]]
        raise sentences.refusal("each.failed", count=len(fits), message=message)
    return dataset_of_steps(fits, shared, settings.laws)


def warnings_of_steps(result):
    """How many steps are stick-slip, failed or carry warnings: a list of one sentence, or none."""
    failed = result["status"].values == FAILED
    unstable = result["status"].values == STICK_SLIP
    doubtful = result["warnings"].values != ""
    if failed.ndim > 1:  # under any law
        failed, unstable, doubtful = (x.any(axis=-1) for x in (failed, unstable, doubtful))
    parts = []
    for which, what, variable in (
        (unstable, "are stick-slip, and are not fitted", "message"),
        (failed, "cannot be fitted", "message"),
        (doubtful & ~failed, "must not be used unread", "warnings"),
    ):
        if which.any():
            steps = ", ".join(map(str, (np.flatnonzero(which) + 1).tolist()))
            parts.append(f"{which.sum()} of {which.size} {what} (step {steps}; see {variable})")
    return [f"fits of each step: {'; '.join(parts)}"] if parts else []


def fit_stress_steps(data, windows, settings, fits, shared):
    """list of `Fitted`, for each `Window` of a step of normal stress, with alpha free alone.

    data : the record (Dataset in SI); settings, fits : of the other steps
    shared : law -> `Shared` of these, or None; what is not shared stays as the slider has it

    What the errors of held parameters add to that of alpha is in its interval.
    """
    fitted = []
    for window in windows:
        task, laws, sliders = task_of(window, data, settings), {}, []
        for slider in task.settings.sliders:
            held, directions = _held(fits, shared[slider.law], slider)
            sliders.append(slider.replace(**held))
            alone = task.with_sliders(sliders[-1:])
            fit = fit_window(alone)
            laws[slider.law] = fit.laws[slider.law]
            if one := fit.of(slider.law):
                changes = [_change(alone, moved) for moved in directions]
                _widen(one.result, float(np.sqrt(np.sum(np.square(changes)))))
        fitted.append(Fitted(task.with_sliders(sliders), laws))
    return fitted


def _held(fits, shared, slider):
    """name -> value [SI] of what other steps tell of a slider; and, for each independent direction
    in which these are uncertain, two such dicts a standard error to either side.
    """
    held, directions = {}, []
    K = grouped(fits, slider.law, "K")
    if K.n:
        held["K"] = float(np.exp(K.mean))
        directions.append([{"K": float(np.exp(K.mean + s * K.error))} for s in (1.0, -1.0)])
    if shared is not None:
        sizes, axes = np.linalg.eigh(shared.covariance)
        moves = (axes * np.sqrt(np.maximum(sizes, 0.0))).T
        directions += [[shared.values(move), shared.values(-move)] for move in moves]
        held |= shared.values()
    return held, directions


def _change(task, sides):
    """Half the difference of alpha between two sets of held parameters; inf without a fit."""
    alphas = []
    for moved in sides:
        sliders = [slider.replace(**moved) for slider in task.settings.sliders]
        try:
            (one,) = solutions_of(task.data, task.settings._replace(sliders=sliders))
        except RateStateError:
            return np.inf
        alphas.append(to_value("alpha", one.point[one.unknowns.names.index("alpha")]))
    return float(0.5 * (alphas[0] - alphas[1]))


def _widen(result, extra):
    """Add an independent error to that of alpha in a Dataset, and in its texts, in place."""
    at = {"parameter": "alpha"}
    own = float(result["standard_error"].sel(at))
    total = float(np.hypot(own, extra))
    result["standard_error"].loc[at] = total
    value = float(result["alpha"])
    ends = result["interval"].sel(at).transpose("level", "side").values
    reach = np.hypot(ends - value, extra * ROOTS[:, None])
    is_open = ends == to_value("alpha", -np.inf)
    wider = np.where(is_open, ends, value + reach * np.array([-1.0, 1.0]))
    before, after = (f"< {readable('alpha', one[-1, 1], 3)}" for one in (ends, wider))
    result["interval"].loc[at] = wider  # ("ends" is a view of it)
    for name in ("warnings", "identifiability"):
        result[name].values = np.array(str(result[name].item()).replace(before, after))
