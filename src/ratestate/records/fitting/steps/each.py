"""Each step and hold of a record fitted on its own window, in parallel."""

import itertools
from typing import NamedTuple

import numpy as np
import xarray

from ....dynamics.progress import bar
from ....errors import RateStateError
from ...kit.least_squares import single_blas
from ...kit.processes import mapped
from ...load_point.stress_steps import VARIABLE, stress_range
from ...messages import fitting as sentences
from ..by_law import value_of
from ..diagnostics.checks import is_misfit
from ..generalized_least_squares import Solution, responds
from ..likelihood.inference import inferences_of, inflation_of
from ..likelihood.noise_uncertainty import Inflation
from ..result import datasets_of
from ..settings import Settings
from ..unknowns import OF_MACHINE
from .stick_slip import stick_slip_about, stick_slip_slides
from .windows import Window, windows_of

#: most samples of a window that are fitted: a step is resolved as well as with ten times as many
MOST = 20_000
#: slip since the change before, over Dc, from which on sliding may be steady at a window's begin
SLID = 5.0


class Task(NamedTuple):
    """A window to be fitted."""

    window: Window
    data: xarray.Dataset  # its rows
    settings: Settings  # with the sliders from where the searches begin
    rows_per_sample: int  # of the record, which are averaged

    def with_sliders(self, sliders):
        """The `Task` with other sliders (list)."""
        return self._replace(settings=self.settings._replace(sliders=sliders))


class Separate(NamedTuple):
    """The fit of a window under one law: what of its `Inference` goes from process to process."""

    result: xarray.Dataset  # of `datasets_of`
    solution: Solution
    inflation: Inflation  # of the coordinates that steps share
    is_misfit: bool  # whether the residuals are more than noise
    responds: bool  # whether friction does, beyond noise

    @property
    def at_bound(self):
        """Names (list) of parameters that are at the end of their range."""
        return [*itertools.compress(self.solution.unknowns.names, self.solution.at_bound)]


class Fitted(NamedTuple):
    """A window with its fits."""

    task: Task
    laws: dict  # law -> `Separate`, or the message (str) why there is none
    is_stick_slip: bool = False  # which is why there is none

    def of(self, law):
        """The `Separate` of a law, or None."""
        separate = self.laws[law]
        return None if isinstance(separate, str) else separate

    @property
    def is_spoilt(self):
        """Whether normal stress varies under a step or hold of the load point."""
        of_stress = self.task.window.kind == "normal stress"
        return not of_stress and stress_range(self.task.data) > VARIABLE

    def usable(self, law):
        """The `Separate` of a law if all steps may be judged by it, or None.

        Not if its search has not converged, friction does not respond, a parameter is at its bound,
        or normal stress varies.
        """
        separate = self.of(law)
        if not separate or not (separate.solution.converged and separate.responds):
            return None
        return None if separate.at_bound or self.is_spoilt else separate

    def remarks(self, law):
        """Sentences (list) on why all steps leave out one that is fitted under a law."""
        found = [sentences("each.stress_varies")] if self.is_spoilt else []
        if names := self.of(law).at_bound:
            found.append(sentences("each.at_bound", names=" and ".join(names)))
        return found


def fit_each(data, settings):
    """list of `Fitted`, for each step and hold of the load point: first those that are fitted.

    data : the record (Dataset in SI)

    And list of `Window`, for each step of normal stress.  Where friction is stick-slip, steps of
    both kinds are among the former, and not fitted.  ParameterError as of `windows_of`, and where
    all are so.
    """
    windows, unstable = _divided(data, settings)
    tasks = [task_of(one, data, settings) for one in windows if one.kind != "normal stress"]
    with bar("fits of steps") as show:
        fitted: list[Fitted] = []
        # the first that is fitted under all laws shows the others where to begin
        while tasks and not (fitted and all(map(fitted[-1].of, settings.laws))):
            fitted += _fit_all([tasks.pop(0)])
        fitted += _fit_all([_nearer(task, fitted[-1]) for task in tasks], show)
    return fitted + unstable, [one for one in windows if one.kind == "normal stress"]


def _divided(data, settings):
    """The `Window`s (list) of a record, and the `Fitted` of those in stick-slip."""
    windows = windows_of(data)
    slides = stick_slip_slides(data, settings.sliders[0].sigma)
    found = {window: stick_slip_about(window, slides) for window in windows}
    unstable = []
    for window in (window for window in windows if found[window]):
        slide = {"events": found[window].events, "V_lp": found[window].V}
        laws = dict.fromkeys(settings.laws, sentences("each.stick_slip", **slide))
        unstable.append(Fitted(task_of(window, data, settings), laws, is_stick_slip=True))
    if len(unstable) == len(windows):
        raise sentences.refusal("each.all_stick_slip", count=len(windows), **slide)
    return [window for window in windows if not found[window]], unstable


def task_of(window, data, settings):
    """The `Task` of a window: free is alpha alone at a step of normal stress, elsewhere all else.

    data : the record (Dataset in SI), of which a window of more than `MOST` rows is averaged
    """
    part, free = window.part(data), ("alpha",)
    if (each := -(-part.sizes["time"] // MOST)) > 1:
        part = part.coarsen(time=each, boundary="trim").mean()
    if window.kind != "normal stress":
        free = tuple(name for name in settings.free if name != "alpha")
    sliders = [slider.replace(sigma=_stress(window, part, slider)) for slider in settings.sliders]
    return Task(window, part, settings._replace(free=free, sliders=sliders), max(each, 1))


def _stress(window, part, slider):
    """Normal stress [Pa] of a window, or before a step of it: as recorded, else the slider's."""
    if window.kind == "normal stress":
        return window.stresses(part)[0]
    recorded = part["sigma"].values if "sigma" in part.data_vars else np.array(np.nan)
    return float(np.median(recorded)) if np.isfinite(recorded).all() else slider.sigma


def _nearer(task, pilot):
    """The `Task` with the estimates of a `Fitted` as initial guess, where it has them.

    Its start is free where the change before is not over by then.
    """
    sliders, longest = [], 0.0
    for slider in task.settings.sliders:
        if separate := pilot.of(slider.law):
            part = separate.result
            names = [name for name in part["parameter"].values.tolist() if name in slider.values]
            slider = slider.replace(**{name: value_of(part, name) for name in names})
        sliders.append(slider)
        lengths = (float(getattr(slider, D)) for D in slider.friction_law.lengths)
        longest = max(longest, *lengths)
    start = task.settings.start
    if start == "auto" and task.window.slid < SLID * longest:
        start = "free"
    return task._replace(settings=task.settings._replace(sliders=sliders, start=start))


def _fit_all(tasks, report=None):
    """`Fitted` (list) of all tasks, in parallel: law by law, unless they share a prior."""
    pieces = [(i, piece) for i, task in enumerate(tasks) for piece in _by_law(task)]
    # those that take longest first
    pieces.sort(key=lambda one: -len(one[1].settings.sliders[0].friction_law.states))
    show = None if report is None else lambda done: report(done / len(pieces))
    fitted = mapped(fit_window, [piece for _, piece in pieces], show)
    laws: list[dict] = [{} for _ in tasks]
    for (i, _), one in zip(pieces, fitted, strict=True):
        laws[i] |= one.laws
    return [
        Fitted(task, {law: of_any[law] for law in task.settings.laws})
        for task, of_any in zip(tasks, laws, strict=True)
    ]


def _by_law(task):
    """The `Task`s of each law alone; of a posterior the whole, for laws have one prior."""
    if task.settings.errors == "posterior":
        return [task]
    return [task.with_sliders([slider]) for slider in task.settings.sliders]


def fit_window(task):
    """The `Fitted` of a `Task`: a law that cannot be fitted leaves the others."""
    settings = task.settings
    with single_blas():
        try:
            inferences = inferences_of(task.data, settings)
            results = datasets_of(inferences, settings.laws, task.data)
            pairs = zip(inferences, results.values(), strict=True)
            separate = [_separate(one, result, settings) for one, result in pairs]
            return Fitted(task, dict(zip(results, separate, strict=True)))
        except RateStateError as error:
            if len(settings.sliders) == 1:
                return Fitted(task, {settings.laws[0]: str(error)})
    alone = settings._replace(errors="auto")  # without a prior that the laws share
    return _fit_all([task._replace(settings=alone)])[0]


def _separate(inference, result, settings):
    solution = inference.solution
    inflation = inflation_of(inference, shared_coordinates(solution.unknowns, settings))
    return Separate(result, solution, inflation, is_misfit(inference), responds(solution))


def shared_coordinates(unknowns, settings):
    """Coordinates (list of int) that the steps share: those of the law's parameters."""
    names = unknowns.names
    return [i for i, n in enumerate(names) if n in settings.free and n not in OF_MACHINE]
