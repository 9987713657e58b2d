"""The fits of all steps and holds of a record, each on its own window, in parallel."""

import itertools
from typing import Any, NamedTuple

import numpy as np
import xarray

from ....dynamics.progress import bar
from ....errors import RateStateError
from ...kit.least_squares import single_blas
from ...kit.processes import mapped
from ...load_point.stress_steps import VARIABLE, stress_range
from ...messages import fitting as sentences
from ..diagnostics.checks import is_misfit
from ..generalized_least_squares import responds
from ..likelihood.inference import inferences_of, inflation_of
from ..result import dataset_of
from ..settings import Settings
from ..unknowns import MACHINE_PARAMETERS
from . import FAILED, FITTED, NORMAL_STRESS, STICK_SLIP
from .windows import Window, stick_slip_in, stick_slip_slides, windows_of

#: most samples that are fitted in a window; ten times as many resolve a step no better
MOST = 20_000
#: slip since the change before, in Dc, from which sliding may be steady as a window begins
STEADY_SLIP = 5.0


class Step(NamedTuple):
    """A step or hold under one law: its part of the record, and its fit, if any."""

    window: Window
    data: xarray.Dataset  # its samples
    rows_per_sample: int  # number of rows of the record that are averaged
    sigma_after: float  # normal stress after a step of normal stress [Pa], else NaN
    settings: Settings  # with one slider, from which the search begins
    status: int = FAILED
    message: str = ""  # why there is no fit
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

    def column(self, name):
        """Return a variable (m,) of the record; NaN if it has none of this name."""
        missing = np.full(self.data.sizes["time"], np.nan)
        return self.data[name].values if name in self.data.variables else missing

    @property
    def shared(self):
        """The law's coordinates (list of int), which the steps share."""
        shared = set(self.settings.free).difference(MACHINE_PARAMETERS)
        return [i for i, name in enumerate(self.solution.unknowns.names) if name in shared]

    @property
    def caveats(self):
        """Sentences (list) on why the estimates from all steps leave out this fit."""
        names = " and ".join(self.solution.at_bound)
        caveats = [sentences("each.at_bound", names=names)] if names else []
        if self.window.kind != NORMAL_STRESS and stress_range(self.data) > VARIABLE:
            caveats.insert(0, sentences("each.stress_varies"))
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


def steps_of(data, settings):
    """Return, for each window of a record (in SI), its `Step` under each law (lists).

    None of them is fitted yet.  ParameterError as of `windows_of`, and if friction is stick-slip in
    all windows.
    """
    windows = windows_of(data)
    slides = stick_slip_slides(data, settings.sliders[0].sigma)
    windows = [_steps_of(window, data, settings, slides) for window in windows]
    if all(steps[0].status == STICK_SLIP for steps in windows):
        slide = stick_slip_in(windows[-1][0].window, slides)
        count = {"count": len(windows), "events": slide.events}
        raise sentences.refusal("each.all_stick_slip", V_lp=slide.V, **count)
    return windows


def _steps_of(window, data, settings, slides):
    """Return the `Step`s of a window; a window of more than `MOST` rows is averaged.

    Alpha alone is free at a step of normal stress; all other free parameters at other steps.
    """
    part = window.part(data)
    if (rows := -(-part.sizes["time"] // MOST)) > 1:
        part = part.coarsen(time=rows, boundary="trim").mean()
    sigma, sigma_after = None, np.nan
    free = tuple(name for name in settings.free if name != "alpha")
    if window.kind == NORMAL_STRESS:
        free, (sigma, sigma_after) = ("alpha",), window.stress_levels(part)
    elif "sigma" in part.data_vars and np.isfinite(part["sigma"]).all():
        sigma = float(part["sigma"].median())
    changed = {} if sigma is None else {"sigma": sigma}
    sliders = [slider.replace(**changed) for slider in settings.sliders]
    status, message = FAILED, ""
    if slide := stick_slip_in(window, slides):
        status = STICK_SLIP
        message = sentences("each.stick_slip", events=slide.events, V_lp=slide.V)
    of_laws = [settings._replace(free=free, sliders=[slider]) for slider in sliders]
    return [Step(window, part, max(rows, 1), sigma_after, x, status, message) for x in of_laws]


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
    longest = max(float(getattr(one, D)) for one in sliders for D in one.friction_law.lengths)
    start = steps[0].settings.start
    if start == "auto" and steps[0].window.slip_since_change < STEADY_SLIP * longest:
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
        if len(steps) == 1:
            return [steps[0]._replace(message=str(error))]
    alone = settings._replace(errors="auto")  # a posterior needs the prior of all laws
    steps = [step._replace(settings=alone._replace(sliders=[step.slider])) for step in steps]
    return [fit_window([step], adjust)[0] for step in steps]
