"""alpha from steps of normal stress, the law's other parameters held at those of other steps."""

import numpy as np

from ....errors import RateStateError
from ....model.quantities import readable
from ...kit.least_squares import single_blas
from ..estimates import ROOTS
from ..one_record import solutions_of
from ..unknowns import to_value
from .comparison import grouped
from .each import fit_window, task_of
from .fitted import Fitted


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
        directions += [
            [_values(shared.names, shared.point + side * move) for side in (1.0, -1.0)]
            for move in moves
        ]
        held |= _values(shared.names, shared.point)
    return held, directions


def _values(names, point):
    """name -> value [SI] of coordinates."""
    return {name: float(to_value(name, x)) for name, x in zip(names, point, strict=True)}


def _change(task, sides):
    """Half the difference of alpha between two sets of held parameters; inf without a fit."""
    alphas = []
    for moved in sides:
        sliders = [slider.replace(**moved) for slider in task.settings.sliders]
        try:
            with single_blas():
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
