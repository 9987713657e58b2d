"""The fit of all steps and holds of an experiment, as `fit` does with each="step".

Steps of normal stress are fitted last.  They determine alpha, while the law's other parameters
are held at the estimates from the other steps.
"""

import numpy as np
from scipy.linalg import block_diag

from ...messages import fitting as sentences
from ..estimates import ROOTS
from ..forward import Forward
from ..unknowns import to_coordinate, to_value
from . import FAILED, FITTED, NORMAL_STRESS, STICK_SLIP
from .each import Step, fit_each, fit_window, steps_of
from .result import dataset_of_steps
from .shared import estimates_of, mean_of, shared_fit


def fit_experiment(data, settings):
    """Return the Dataset of all steps and holds of a record (in SI).

    ParameterError if there is no step or hold, or if none can be fitted.
    """
    unstable: list[Step] = []
    of_stress: list[Step] = []
    others = []
    for steps in steps_of(data, settings):
        if steps[0].status == STICK_SLIP:
            unstable += steps
        elif steps[0].window.kind == NORMAL_STRESS:
            of_stress += steps
        else:
            others.append(steps)
    fitted = fit_each(others)
    by_law = {law: [step for step in fitted if step.law == law] for law in settings.laws}
    shared = {law: shared_fit(steps) for law, steps in by_law.items()}
    fitted += [fit_stress_step(step, by_law[step.law], shared[step.law]) for step in of_stress]
    fitted = sorted(unstable + fitted, key=lambda step: step.window.t)
    by_law = {law: [step for step in fitted if step.law == law] for law in settings.laws}
    if not any(step.status == FITTED for step in fitted):
        steps = by_law[settings.laws[0]]
        message = next(step.message for step in steps if step.status == FAILED)
        raise sentences.refusal("each.failed", count=len(steps), message=message)
    return dataset_of_steps(by_law, shared)


def fit_stress_step(step, others, shared):
    """Return the `Step` of normal stress with its fit, in which alpha alone is free.

    others : fitted `Step`s of the load point under the same law; the mean of their K is held
    shared : their `Shared`, or None

    The errors of held parameters widen the interval of alpha, to first order.
    """
    held, covariance = {}, np.zeros((0, 0))
    if shared is not None:
        held, covariance = dict(zip(shared.names, shared.point, strict=True)), shared.covariance
    K = mean_of(*estimates_of(others, "K"))
    if np.isfinite(K.value):
        held["K"], covariance = K.value, block_diag(covariance, K.error**2)
    values = {name: float(to_value(name, x)) for name, x in held.items()}
    settings = step.settings._replace(sliders=[step.slider.replace(**values)])
    (step,) = fit_window(
        [step._replace(settings=settings)],
        lambda inference: _with_held_errors(inference, tuple(held), covariance),
    )
    return step


def _with_held_errors(inference, held, covariance):
    """Return the `Inference` with errors (h, h) of held parameters added to alpha's."""
    solution, estimates = inference.solution, inference.estimates
    i, least = estimates.names.index("alpha"), to_value("alpha", -np.inf)
    errors, intervals = estimates.errors.copy(), estimates.intervals.copy()
    if not np.isfinite(errors[i]):
        return inference
    problem, names = solution.problem, solution.unknowns.names
    point = [to_coordinate(name, getattr(problem.slider, name)) for name in held]
    forward = Forward(problem.record, problem.slider, (*held, *names))
    jacobian = forward.jacobian(np.concatenate([point, solution.point]))[1]
    if not np.isfinite(jacobian).all():  # no motion close to the held values
        errors[i], intervals[i] = np.inf, (least, np.inf)
    else:
        white, _ = solution.noise.whiten(problem.record.t, jacobian)
        by_held = np.linalg.lstsq(white[:, len(held) :], white[:, : len(held)])[0]
        slopes = by_held[names.index("alpha")]
        errors[i] = np.sqrt(errors[i] ** 2 + slopes @ covariance @ slopes)
        # adding to the ends is also right at a bound, where intervals are not symmetric
        more = (errors[i] - estimates.errors[i]) * ROOTS[:, None] * np.array([-1.0, 1.0])
        intervals[i] = np.maximum(intervals[i] + more, least)
    return inference._replace(estimates=estimates._replace(errors=errors, intervals=intervals))


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
        (doubtful & ~failed, "must not be used unread", "warnings"),
    ):
        if which.any():
            steps = ", ".join(map(str, (np.flatnonzero(which) + 1).tolist()))
            parts.append(f"{which.sum()} of {which.size} {what} (step {steps}; see {variable})")
    return [f"fits of each step: {'; '.join(parts)}"] if parts else []
