"""Each step and hold of a record fitted on its own window, in parallel."""

import numpy as np

from ....dynamics.progress import bar
from ....errors import RateStateError
from ...kit.least_squares import single_blas
from ...kit.processes import mapped
from ...messages import fitting as sentences
from ..by_law import value_of
from ..diagnostics.misfit import is_misfit
from ..likelihood.uncertainty import inflation_of
from ..one_record import datasets_of, inferences_of
from ..score import responds
from .fitted import Fitted, Separate, Task, shared_coordinates
from .stick_slip import stick_slip_about, stick_slip_slides
from .windows import windows_of

#: most samples of a window that are fitted: a step is resolved as well as with ten times as many
MOST = 20_000
#: slip since the change before, over Dc, from which on sliding may be steady at a window's begin
SLID = 5.0


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
        fitted = _pilots(tasks)
        if fitted:
            tasks[len(fitted) :] = [_nearer(task, fitted[-1]) for task in tasks[len(fitted) :]]
        fitted += _fit_all(tasks[len(fitted) :], show)
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


def _pilots(tasks):
    """The first `Fitted`s, up to one under all laws: it shows the others where to begin."""
    fitted = []
    for task in tasks:
        fitted += _fit_all([task])
        if all(fitted[-1].of(law) for law in task.settings.laws):
            break
    return fitted


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


def task_of(window, data, settings):
    """The `Task` of a window: free is alpha alone at a step of normal stress, elsewhere all else.

    data : the record (Dataset in SI)
    """
    part, each = _averaged(window.part(data))
    free = ("alpha",)
    if window.kind != "normal stress":
        free = tuple(name for name in settings.free if name != "alpha")
    sliders = [slider.replace(sigma=_stress(window, part, slider)) for slider in settings.sliders]
    return Task(window, part, settings._replace(free=free, sliders=sliders), each)


def _averaged(part):
    """The rows of a window, or of more than `MOST` the means of some neighbours; of how many."""
    each = -(-part.sizes["time"] // MOST)
    return (part.coarsen(time=each, boundary="trim").mean(), each) if each > 1 else (part, 1)


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
    sliders = []
    for slider in task.settings.sliders:
        separate, values = pilot.of(slider.law), {}
        if separate:
            part = separate.result
            names = [name for name in part["parameter"].values.tolist() if name in slider.values]
            values = {name: value_of(part, name) for name in names}
        sliders.append(slider.replace(**values))
    start = task.settings.start
    if start == "auto" and task.window.slid < SLID * max(map(_longest_distance, sliders)):
        start = "free"
    return task._replace(settings=task.settings._replace(sliders=sliders, start=start))


def _longest_distance(slider):
    """The longest distance [m] over which a state of a slider evolves."""
    return max(float(getattr(slider, D)) for D in slider.friction_law.lengths)


def _separate(task):
    """law -> `Separate` of a `Task`; ParameterError where a law cannot be fitted."""
    settings = task.settings
    inferences = inferences_of(task.data, settings)
    results = datasets_of(inferences, settings.laws, task.data)
    return {
        law: Separate(
            result,
            one.problem.record,
            one.unknowns,
            one.point,
            one.noise,
            one.chi2,
            inflation_of(inference, shared_coordinates(one.unknowns, settings)),
            one.converged,
            is_misfit(inference),
            responds(one),
        )
        for (law, result), inference in zip(results.items(), inferences, strict=True)
        for one in [inference.solution]
    }


def fit_window(task):
    """The `Fitted` of a `Task`: a law that cannot be fitted leaves the others."""
    with single_blas():
        try:
            return Fitted(task, _separate(task))
        except RateStateError as error:
            if len(task.settings.sliders) == 1:
                return Fitted(task, {task.settings.laws[0]: str(error)})
    alone = task.settings._replace(errors="auto")  # without a prior that the laws share
    return _fit_all([task._replace(settings=alone)])[0]
