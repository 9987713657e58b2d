"""The fits of all steps and holds of an experiment: windows, fits, joint fit, table.

Each window is fitted on its own, in parallel.  Steps of normal stress are fitted last.  They
determine alpha, while the law's other parameters are held at the estimates from the other steps.
"""

import itertools
import warnings
from typing import Any, NamedTuple

import numpy as np
import scipy
import xarray

from ....dynamics.progress import bar
from ....errors import FitWarning, RateStateError
from ...kit.least_squares import single_blas
from ...kit.processes import mapped
from ...load_point.stress_steps import VARIABLE, stress_range
from ...messages import fitting as sentences
from ..checks import is_misfit
from ..fit_dataset import dataset_of
from ..forward import Forward
from ..inference import inferences_of, inflation_of
from ..quantities import ROOTS
from ..settings import Settings
from ..solutions import responds
from ..unknowns import MACHINE_PARAMETERS, to_coordinate, to_value
from . import FAILED, FITTED, NORMAL_STRESS, STICK_SLIP
from .shared import estimates_of, mean_of, shared_fit
from .step_table import dataset_of_steps
from .windows import StepWindow, stick_slip_in, stick_slip_segments, windows_of

#: most samples that are fitted in a window; ten times as many resolve a step no better
MOST = 20_000
#: slip since the change before, in Dc, from which sliding may be steady as a window begins
STEADY_SLIP = 5.0


class Step(NamedTuple):
    """A step or hold under one law: its part of the record, and its fit, if any."""

    window: StepWindow
    data: xarray.Dataset  # its samples
    rows_per_sample: int  # number of rows of the record that are averaged
    settings: Settings  # with one slider, from which the search begins
    status: int = FAILED
    message: str = ""  # why there is no fit
    no_posterior: str = ""  # why the intervals are not from a requested posterior
    result: Any = None  # Dataset of `dataset_of`
    solution: Any = None  # `Solution`
    inflation: Any = None  # `Inflation` of the coordinates in `shared`
    is_misfit: bool = False  # whether the residuals are more than noise
    responds: bool = False  # whether friction responds to the step beyond noise

    @property
    def slider(self):
        return self.settings.sliders[0]

    @property
    def law(self):
        return self.slider.law

    @property
    def shared(self):
        """The law's coordinates (list of int), which the steps share."""
        shared = set(self.settings.free).difference(MACHINE_PARAMETERS)
        return [i for i, name in enumerate(self.solution.unknowns.names) if name in shared]

    @property
    def caveats(self):
        """Sentences (list) on why the estimates from all steps leave out this fit."""
        caveats = []
        if self.window.kind != NORMAL_STRESS and stress_range(self.data) > VARIABLE:
            caveats.append(sentences("per_step.stress_varies"))
        if names := " and ".join(self.solution.at_bound):
            caveats.append(sentences("per_step.at_bound", names=names))
        return caveats

    @property
    def is_usable(self):
        """Whether the estimates from all steps use this fit."""
        if self.status != FITTED:
            return False
        return self.solution.converged and self.responds and not self.caveats

    def with_fit(self, inference):
        """Return the `Step` with the result of an `Inference`."""
        step = self._replace(status=FITTED, solution=inference.solution)
        return step._replace(
            result=dataset_of(inference, self.data),
            inflation=inflation_of(inference, step.shared),
            is_misfit=is_misfit(inference),
            responds=responds(inference.solution),
        )


def fit_experiment(data, settings):
    """Return the Dataset of all steps and holds of a record (in SI)."""
    windows = steps_of(data, settings)
    unstable = [steps for steps in windows if steps[0].status == STICK_SLIP]
    stable = [steps for steps in windows if steps[0].status != STICK_SLIP]
    of_stress = [steps for steps in stable if steps[0].window.kind == NORMAL_STRESS]
    fitted = fit_each([steps for steps in stable if steps[0].window.kind != NORMAL_STRESS])
    by_law = {law: [step for step in fitted if step.law == law] for law in settings.laws}
    shared = {law: shared_fit(steps) for law, steps in by_law.items()}
    for step in itertools.chain(*of_stress):
        fitted.append(fit_stress_step(step, by_law[step.law], shared[step.law]))
    fitted = sorted([*itertools.chain(*unstable), *fitted], key=lambda step: step.window.t)
    by_law = {law: [step for step in fitted if step.law == law] for law in settings.laws}
    for law, steps in by_law.items():
        for i, step in enumerate(steps, 1):
            if step.no_posterior and step.status == FITTED:
                text = f"step {i}, {law} law: {step.no_posterior}"
                warnings.warn(text, FitWarning, stacklevel=4)  # (past `fit` and its check)
    if not any(step.status == FITTED for step in fitted):
        steps = by_law[settings.laws[0]]
        message = next(step.message for step in steps if step.status == FAILED)
        raise sentences.refusal("per_step.failed", count=len(steps), message=message)
    return dataset_of_steps(by_law, shared)


def steps_of(data, settings):
    """Return, for each window of a record, its `Step` under each law (lists), not yet fitted."""
    windows = windows_of(data)
    segments = stick_slip_segments(data, settings.sliders[0].sigma)
    windows = [_steps_of(window, data, settings, segments) for window in windows]
    if all(steps[0].status == STICK_SLIP for steps in windows):
        segment = stick_slip_in(windows[-1][0].window, segments)
        count = {"count": len(windows), "events": segment.events}
        raise sentences.refusal("per_step.all_stick_slip", V_lp=segment.V, **count)
    return windows


def _steps_of(window, data, settings, segments):
    """Return the `Step`s of a window; a window of more than `MOST` rows is averaged.

    Alpha alone is free at a step of normal stress; all other free parameters at other steps.
    """
    part = window.part(data)
    if (rows := -(-part.sizes["time"] // MOST)) > 1:
        part = part.coarsen(time=rows, boundary="trim").mean()
    free, changed = tuple(name for name in settings.free if name != "alpha"), {}
    if window.kind == NORMAL_STRESS:
        free, changed = ("alpha",), {"sigma": window.stress_levels(part)[0]}
    elif "sigma" in part.data_vars and np.isfinite(part["sigma"]).all():
        changed = {"sigma": float(part["sigma"].median())}
    sliders = [slider.replace(**changed) for slider in settings.sliders]
    status, message = FAILED, ""
    if segment := stick_slip_in(window, segments):
        status = STICK_SLIP
        message = sentences("per_step.stick_slip", events=segment.events, V_lp=segment.V)
    settings = settings._replace(free=free)
    return [
        Step(window, part, max(rows, 1), settings._replace(sliders=[slider]), status, message)
        for slider in sliders
    ]


def fit_each(windows):
    """Return all `Step`s (list) with their fits; windows : as of `steps_of`.

    Windows are fitted one by one, until one is fitted under all laws.  The searches in all later
    windows start from its estimates.
    """
    fitted: list[Step] = []
    with bar("fits of steps") as show:
        for i, steps in enumerate(windows, 1):
            pilot = _fit_all([steps])
            fitted += pilot
            if all(step.status == FITTED for step in pilot):
                return fitted + _fit_all([_start_from(pilot, x) for x in windows[i:]], show)
    return fitted


def _start_from(pilot, steps):
    """Return the `Step`s of a window with the estimates of a pilot as initial guess.

    The start is free if the change before may not be over when the window begins.
    """
    sliders, results = [], {step.law: step.result for step in pilot}
    for step in steps:
        result = results[step.law]
        names = [n for n in result["parameter"].values.tolist() if n in step.slider.values]
        sliders.append(step.slider.replace(**{name: float(result[name]) for name in names}))
    lengths = [getattr(slider, D) for slider in sliders for D in slider.friction_law.lengths]
    start = steps[0].settings.start
    if start == "auto" and steps[0].window.slip_since_change < STEADY_SLIP * max(lengths):
        start = "free"
    return [
        step._replace(settings=step.settings._replace(sliders=[slider], start=start))
        for step, slider in zip(steps, sliders, strict=True)
    ]


def _fit_all(windows, report=None):
    """Return the `Step`s (list) of windows with their fits, computed in parallel."""
    # laws that share the prior of a posterior are fitted together
    if windows and windows[0][0].settings.errors != "posterior":
        windows = [[step] for steps in windows for step in steps]
    # fits of more states take longer, and so begin first
    windows = sorted(windows, key=lambda steps: -len(steps[0].slider.friction_law.states))
    show = None if report is None else lambda done: report(done / len(windows))
    return [*itertools.chain.from_iterable(mapped(fit_window, windows, show))]


def fit_window(steps, adjust=lambda inference: inference):
    """Return the `Step`s (list) of a window with their fits; each law may fail alone.

    adjust : function from an `Inference` to the one that is reported
    """
    settings = steps[0].settings._replace(sliders=[step.slider for step in steps])
    try:
        with single_blas():
            inferences = inferences_of(steps[0].data, settings)
            pairs = zip(steps, map(adjust, inferences), strict=True)
            return [step.with_fit(inference) for step, inference in pairs]
    except RateStateError as error:
        if settings.errors != "posterior":
            return [steps[0]._replace(message=str(error))]
        reason = sentences("per_step.no_posterior", reason=error)
    alone = settings._replace(errors="auto")  # a posterior needs the prior of all laws
    steps = [step._replace(settings=alone._replace(sliders=[step.slider])) for step in steps]
    return [fit_window([step], adjust)[0]._replace(no_posterior=reason) for step in steps]


def fit_stress_step(step, load_steps, shared):
    """Return the `Step` of normal stress with its fit, in which alpha alone is free.

    load_steps : fitted `Step`s of the load point under the same law; the mean of their K is held
    shared : their `Shared`, or None

    The errors of held parameters widen the interval of alpha, to first order.
    """
    held, covariance = {}, np.zeros((0, 0))
    if shared is not None:
        held, covariance = dict(zip(shared.names, shared.point, strict=True)), shared.covariance
    K, error, _ = mean_of(*estimates_of(load_steps, "K"))
    if np.isfinite(K):
        held["K"], covariance = K, scipy.linalg.block_diag(covariance, error**2)
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
    estimate, least = estimates.by_name["alpha"], to_value("alpha", -np.inf)
    if not np.isfinite(estimate.error):
        return inference
    problem, names = solution.problem, solution.unknowns.names
    point = [to_coordinate(name, getattr(problem.slider, name)) for name in held]
    forward = Forward(problem.record, problem.slider, (*held, *names))
    jacobian = forward.jacobian(np.concatenate([point, solution.point]))[1]
    if not np.isfinite(jacobian).all():  # no motion close to the held values
        error, interval = np.inf, np.array(2 * [(least, np.inf)])
    else:
        white, _ = problem.whiten(jacobian, solution.noise)
        by_held = np.linalg.lstsq(white[:, len(held) :], white[:, : len(held)])[0]
        slopes = by_held[names.index("alpha")]
        error = np.sqrt(estimate.error**2 + slopes @ covariance @ slopes)
        # adding to the ends is also right at a bound, where intervals are not symmetric
        more = (error - estimate.error) * ROOTS[:, None] * np.array([-1.0, 1.0])
        interval = np.maximum(estimate.interval + more, least)
    changed = {"alpha": estimate._replace(error=error, interval=interval)}
    return inference._replace(estimates=estimates._replace(by_name=estimates.by_name | changed))
