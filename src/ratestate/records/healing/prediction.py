"""What a slider predicts for holds: it is simulated under the load point's history of each.

It slides steadily before the hold, at the speed that was recorded.  Errors of fitted parameters are
propagated linearly, by central differences.
"""

from typing import NamedTuple

import numpy as np
import xarray

from ...dynamics.simulation.simulate import simulate
from ...errors import QuasiStaticInstability, RateStateError
from ...model.loading import Loading
from ..messages import healing as sentences

#: step of a difference, over a parameter; start of the hold in the run, over its duration
STEP, LEAD = 1e-4, 1e-3
#: points about the largest friction, within so many of the solver's steps on either side
POINTS, BESIDE = 400, 2
RTOL = 1e-9
#: dimension of the sliders of a difference
CASE = "difference"


class Predicted(NamedTuple):
    """Healing and relaxation of one hold, their derivatives, and why there are none, or ""."""

    values: np.ndarray  # (2,); NaN
    derivatives: np.ndarray  # (2, k) by the free parameters; NaN
    message: str = ""


def predict(fitted, hold, kind):
    """`Predicted` of a `sliders.Fitted` for a `Hold`; kind of friction: "tau" or "mu"."""
    free = fitted.free
    none = Predicted(np.full(2, np.nan), np.full((2, len(free)), np.nan))
    lead, lasts = LEAD * (hold.end - hold.start), hold.end - hold.start
    end = lead + lasts
    loading = Loading.steps(hold.V_before, (lead, 0.0), (end, hold.V_after))
    try:
        window = _about_peak(fitted.slider, loading, end, end + hold.slide, kind)
        if window is None:
            return none._replace(message=sentences("prediction.no_peak", law=fitted.slider.law))
        steps = [STEP * (abs(getattr(fitted.slider, s)) or fitted.slider.a) for s in free]
        times = np.concatenate([[0.0, end], np.linspace(window[0], window[1], POINTS)])
        cases = _cases(fitted.slider, free, steps)
        run = simulate(cases, loading, float(times[-1]), times=times, rtol=RTOL)
    except RateStateError as error:
        return none._replace(
            message=sentences("prediction.failed", law=fitted.slider.law, reason=str(error))
        )
    friction = _friction(run, cases, kind).transpose(..., "time").values.reshape(-1, times.size)
    level, low, high = friction[:, 0], friction[:, 1], _largest(friction[:, 2:])
    found = np.array([high - level, level - low])
    differences = (found[:, 1::2] - found[:, 2::2]) / (2.0 * np.array(steps))
    return Predicted(found[:, 0], differences)


def _cases(slider, free, steps):
    """The slider, and it with each free parameter larger and smaller by its step: a sweep."""
    if not free:
        return slider
    values = {}
    for i, (symbol, step) in enumerate(zip(free, steps, strict=True)):
        column = np.full(1 + 2 * len(free), float(getattr(slider, symbol)))
        column[1 + 2 * i] += step
        column[2 + 2 * i] -= step
        values[symbol] = xarray.DataArray(column, dims=CASE)
    return slider.replace(**values)


def _about_peak(slider, loading, end, last, kind):
    """Times [s] before and after the largest friction from the hold's end on; None if at an end."""
    try:
        run = simulate(slider, loading, last, rtol=RTOL)
    except QuasiStaticInstability as error:  # it may be after the peak
        run = error.best
    later = run.isel(time=(run["time"].values >= end))
    t, friction = later["time"].values, _friction(later, slider, kind).values
    at = int(np.argmax(friction)) if t.size else 0
    if not 0 < at < t.size - 1:
        return None
    return t[max(at - BESIDE, 0)], t[min(at + BESIDE, t.size - 1)]


def _friction(run, slider, kind):
    """Friction as it is recorded: of the spring, or of the interface."""
    return run["mu"] if kind == "mu" else run["tau"] / slider.sigma


def _largest(friction):
    """(n,) largest values of rows (n, m) at equal steps: of a parabola through three of them."""
    at = np.clip(np.argmax(friction, axis=1), 1, friction.shape[1] - 2)
    before, here, after = (friction[np.arange(len(friction)), at + i] for i in (-1, 0, 1))
    bend = before - 2.0 * here + after
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(bend < 0.0, here - (after - before) ** 2 / (8.0 * bend), here)
