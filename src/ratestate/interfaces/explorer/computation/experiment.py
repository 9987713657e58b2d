"""The run that shows an experiment: what changes from time 0 on, and how long its end is shown."""

import itertools
from functools import partial

import numpy as np

from ....model.loading import Loading
from ....model.quantities import readable
from ..page_state.entries import BadEntries
from ..page_state.protocol import Segment
from .budget import TimeUp
from .motion import Plan, durations, steady_stress
from .settled import rounded

# Part of the shown time that comes before time 0.
LEAD = 0.2
# Shortest segment, over all that is shown: of a shorter one rounding would leave little.
SHORTEST = 1e-9
# Slowest slip [m/s] from which the direct effect is reckoned.
SLOWEST = 1e-100


def plan_of_experiment(state, verdict, orbit, settled, deadline):
    """The `Plan` of the run that shows a `PageState` with an experiment.

    verdict, orbit : of the motion in its end
    settled : the `Settled` motion before it

    `TimeUp` if its start takes too long, backend.Stopped if it was cancelled.
    """
    plan = partial(_plan, verdict, orbit, settled, state.segments, state.kick)
    if not state.protocol:
        with deadline.part():
            return plan(_reloading_of_step(verdict, settled))
    with deadline.part():
        found = plan(0.0)
    try:
        with deadline.part():
            reloading = _reloading_after(found, verdict, deadline)
    except TimeUp:
        return found  # whose run will be cut sooner
    with deadline.part():
        return plan(reloading)


def _plan(verdict, orbit, settled, segments, kick, reloading):
    """The `Plan` whose last part is shown for the motion's duration and `reloading` [s] more."""
    time = rounded(min(durations(verdict, orbit)) + reloading)
    parts = [*segments, Segment(verdict.V_lp, verdict.slider.sigma, time)]
    if kick is None:
        slider, V = settled.slider, settled.V_lp
        start, zero = settled.start(sum(p.duration for p in parts) * LEAD / (1.0 - LEAD))
    else:
        slider, start = settled.kicked(kick, parts[0].sigma)
        V, zero = parts[0].V, 0.0
    ends = itertools.accumulate((p.duration for p in parts), initial=zero)
    *changes, t_end = (float(f"{t:.15g}") for t in ends)  # (0.1 + 0.2 is 0.30000000000000004)
    _check(segments, t_end)
    loading = _loading(V, slider.sigma, changes, parts)
    return Plan(slider, {"loading": loading, "t_end": t_end, **start}, tuple(changes))


def _check(segments, t_end):
    """Raise BadEntries for a segment that is too short for a run up to t_end [s]."""
    for number, segment in enumerate(segments, 1):
        if segment.duration < SHORTEST * t_end:
            duration, shown = readable("t", segment.duration), readable("t", t_end)
            raise BadEntries(
                {
                    "protocol": f"duration of segment {number} = {duration} is less than "
                    f"{SHORTEST:g} of the {shown} shown; give a longer one, or leave it out"
                }
            )


def _loading(V, sigma, times, parts):
    """The `Loading` that begins with a speed and a normal stress, and at these times changes."""
    loading = Loading.constant(V)
    for t, part in zip(times, parts, strict=True):
        if part.V != V:
            loading = loading.step(t, part.V)
        if part.sigma != sigma:
            loading = loading.sigma_step(t, part.sigma)
        V, sigma = part.V, part.sigma
    return loading


def _reloading_of_step(verdict, settled):
    """Time [s] in which the load point brings the spring to a higher steady stress after a step."""
    motions = settled[:2], (verdict.slider, verdict.V_lp)
    earlier, later = (slider.sigma * steady_stress(slider, V) for slider, V in motions)
    return _reloading(verdict, later - earlier)


def _reloading_after(plan, verdict, progress):
    """Time [s] in which the load point brings the spring to friction, after a plan's segments.

    To that of steady sliding, or what it meets at once if that is more: after a hold V rises by
    the direct effect before the state changes.  0 where a run does not come to there.
    """
    call = plan.call(plan.changes[-1], [plan.changes[-1]])
    run = call.dataset(call.variables(call.move(progress))).isel(time=-1)
    faster = np.log(verdict.V_lp / max(float(run.V), SLOWEST))
    friction = np.fmax(
        run.mu + verdict.slider.a * faster, steady_stress(verdict.slider, verdict.V_lp)
    )
    return _reloading(verdict, float(verdict.slider.sigma * friction - run.tau))


def _reloading(verdict, stress):
    """Time [s] in which the load point raises that of the spring by so much [Pa], if it must."""
    speed = verdict.slider.K * verdict.V_lp
    return stress / speed if stress > 0.0 and np.isfinite(speed) else 0.0
