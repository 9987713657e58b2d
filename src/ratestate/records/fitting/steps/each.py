"""Each step and hold of a record fitted on its own window, in parallel."""

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
from . import FAILED, FITTED, STICK_SLIP
from .windows import Window, stick_slip_in, stick_slip_slides, windows_of

#: most samples of a window that are fitted: a step is resolved as well as with ten times as many
MOST = 20_000
#: slip since the change before, in Dc, from which sliding may be steady when a window begins
STEADY_SLIP = 5.0


class Step(NamedTuple):
    """A step or hold under one law: its part of the record, and the fit, if there is one."""

    window: Window
    data: xarray.Dataset  # its samples
    rows_per_sample: int  # of the record, which are averaged
    settings: Settings  # with one slider, from which the search begins
    status: int = FAILED
    message: str = ""  # why there is no fit
    result: Any = None  # Dataset of `dataset_of`
    solution: Any = None  # `Solution`
    inflation: Any = None  # `Inflation` of the coordinates that steps share
    is_misfit: bool = False  # whether the residuals are more than noise
    responds: bool = False  # whether friction does, beyond noise

    @property
    def slider(self):
        return self.settings.sliders[0]

    @property
    def law(self):
        return self.slider.law

    def column(self, name):
        """(m,) a variable of the record; NaN if it has none of this name."""
        missing = np.full(self.data.sizes["time"], np.nan)
        return self.data[name].values if name in self.data.variables else missing

    @property
    def shared(self):
        """Coordinates (list of int) that the steps share: those of the law's parameters."""
        shared = set(self.settings.free).difference(MACHINE_PARAMETERS)
        return [i for i, name in enumerate(self.solution.unknowns.names) if name in shared]

    @property
    def caveats(self):
        """Sentences (list) on why the estimates from all steps leave out this fit."""
        names = self.solution.at_bound
        found = [sentences("each.at_bound", names=" and ".join(names))] if names else []
        if self.window.kind != "normal stress" and stress_range(self.data) > VARIABLE:
            found.insert(0, sentences("each.stress_varies"))
        return found

    @property
    def is_usable(self):
        """Whether the estimates from all steps use this fit."""
        if self.status != FITTED:
            return False
        return self.solution.converged and self.responds and not self.caveats

    def with_fit(self, inference):
        """The `Step` with the result of its `Inference`, and what the joint fit needs."""
        step = self._replace(status=FITTED, solution=inference.solution)
        return step._replace(
            result=dataset_of(inference, self.data),
            inflation=inflation_of(inference, step.shared),
            is_misfit=is_misfit(inference),
            responds=responds(inference.solution),
        )


def steps_of(data, settings):
    """For each window of a record (Dataset in SI) a list of its `Step`s, one for each law.

    None is fitted yet; where friction is stick-slip, none will be.  ParameterError as of
    `windows_of`, and if friction is stick-slip in all windows.
    """
    windows = windows_of(data)  # which checks the record
    slides = stick_slip_slides(data, settings.sliders[0].sigma)
    windows = [_steps_of(window, data, settings, slides) for window in windows]
    if all(steps[0].status == STICK_SLIP for steps in windows):
        slide = stick_slip_in(windows[-1][0].window, slides)
        count = {"count": len(windows), "events": slide.events}
        raise sentences.refusal("each.all_stick_slip", V_lp=slide.V, **count)
    return windows


def _steps_of(window, data, settings, slides):
    """The `Step`s of a window: free is alpha alone at a step of normal stress, else all others.

    A window of more than `MOST` rows is averaged.
    """
    part = window.part(data)
    if (each := -(-part.sizes["time"] // MOST)) > 1:
        part = part.coarsen(time=each, boundary="trim").mean()
    sigma, free = {}, tuple(name for name in settings.free if name != "alpha")
    if window.kind == "normal stress":
        sigma, free = {"sigma": window.stress_levels(part)[0]}, ("alpha",)
    elif "sigma" in part.data_vars and np.isfinite(part["sigma"]).all():
        sigma = {"sigma": float(part["sigma"].median())}
    each_law = [
        settings._replace(free=free, sliders=[slider.replace(**sigma)])
        for slider in settings.sliders
    ]
    status, message = FAILED, ""
    if slide := stick_slip_in(window, slides):
        status = STICK_SLIP
        message = sentences("each.stick_slip", events=slide.events, V_lp=slide.V)
    return [Step(window, part, max(each, 1), one, status, message) for one in each_law]


def fit_each(windows):
    """All `Step`s (list) with their fits; windows : lists of `Step`, one for each law.

    The first window that is fitted under all laws shows the others where to begin.
    """
    fitted: list[Step] = []
    pilot: list[Step] = []
    with bar("fits of steps") as show:
        while windows and not (pilot and all(step.status == FITTED for step in pilot)):
            pilot = _fit_all(windows[:1])
            fitted, windows = fitted + pilot, windows[1:]
        if windows:
            by_law = {step.law: step for step in pilot}
            fitted += _fit_all([_start_from(steps, by_law) for steps in windows], show)
    return fitted


def _start_from(steps, pilot):
    """The `Step`s of a window with the estimates of a pilot (law -> `Step`) as initial guess.

    The start is free if the change before is not over when the window begins.
    """
    sliders = []
    for step in steps:
        result = pilot[step.law].result
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
    """The `Step`s (list) of windows with their fits: in parallel, those that take longest first."""
    if windows[0][0].settings.errors != "posterior":  # for which laws share a prior
        windows = [[step] for steps in windows for step in steps]
    windows = sorted(windows, key=lambda steps: -len(steps[0].slider.friction_law.states))
    show = None if report is None else lambda done: report(done / len(windows))
    return [*itertools.chain.from_iterable(mapped(fit_window, windows, show))]


def fit_window(steps, adjust=lambda inference: inference):
    """The `Step`s (list) of one window with their fits; a law that fails leaves the others.

    adjust : function of an `Inference`, gives the one that is reported
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
    alone = settings._replace(errors="auto")  # without a prior that the laws share
    steps = [step._replace(settings=alone._replace(sliders=[step.slider])) for step in steps]
    return [fit_window([step], adjust)[0] for step in steps]
