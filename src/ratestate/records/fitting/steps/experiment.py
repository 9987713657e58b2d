"""What `fit` does where each="step": all steps and holds of an experiment."""

import numpy as np

from ...kit.least_squares import single_blas
from ...messages import fitting as sentences
from .each import fit_each
from .result import FAILED, STICK_SLIP, dataset_of_steps
from .shared import shared_fit
from .stress_response import fit_stress_steps


def fit_experiment(data, settings):
    """The Dataset of all steps and holds of a record (Dataset in SI), with checked `Settings`.

    ParameterError where there is no step and no hold, or none that can be fitted.
    """
    fits, of_stress = fit_each(data, settings)
    with single_blas():
        shared = {law: shared_fit(fits, law) for law in settings.laws}
        fits += fit_stress_steps(data, of_stress, settings, fits, shared)
    fits.sort(key=lambda fit: fit.task.window.t)
    if not any(fit.of(law) for fit in fits for law in settings.laws):
        raise sentences.refusal("each.failed", count=len(fits), message=_first_failure(fits))
    return dataset_of_steps(fits, shared, settings.laws)


def _first_failure(fits):
    """Why the first of `Fitted` windows failed, under the first law."""
    failed = next(fit for fit in fits if not fit.is_stick_slip)
    return next(iter(failed.laws.values()))


def warning_of_steps(result):
    """How many steps are stick-slip, failed or carry warnings, as a sentence; "" if none do."""
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
    return f"fits of each step: {'; '.join(parts)}" if parts else ""
