"""The run of an experiment on the page: its changes from time 0 on, and its duration."""

import itertools
from functools import partial

import numpy as np

import ratestate as rs

from .deadline import TimeUp
from .entries import BadEntries
from .run_plan import Plan, durations, rounded
from .state import Segment, value_of

# Part of the shown time that comes before time 0.
LEAD = 0.2
# Shortest segment, as a part of the time shown: rounding would distort a shorter one.
SHORTEST = 1e-9
# Slowest slip [m/s] from which the direct effect is reckoned.
SLOWEST = 1e-100
# Three holds of a slide-hold-slide test, as multiples of the one asked for, and the slip between
# holds as a multiple of Dc.
HOLDS, SLIDE = (0.1, 1.0, 10.0), 20.0


def plan_of_experiment(state, verdict, orbit, settled, deadline):
    """Return the `Plan` of the run that shows a `PageState` with an experiment.

    verdict, orbit : of the motion at its end
    settled : the `Settled` motion before it

    `TimeUp` if the start takes too long, `Stopped` if it was cancelled.
    """
    plan = partial(_plan, verdict, orbit, settled, state.segments, state.kick)
    if not state.protocol:
        with deadline.part():
            return plan(_reloading_of_step(verdict, settled))
    with deadline.part():
        found = plan(0.0)
    try:
        with deadline.part():
            reloading = _reloading_after(found, verdict)
    except TimeUp:
        return found  # whose run will be cut sooner
    with deadline.part():
        return plan(reloading)


def _plan(verdict, orbit, settled, segments, kick, reloading):
    """Return the `Plan` whose last part lasts for the motion's duration and `reloading` [s]."""
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
            duration, shown = (rs.readable("t", t) for t in (segment.duration, t_end))
            raise BadEntries(
                {
                    "protocol": f"duration of segment {number} = {duration} is less than "
                    f"{SHORTEST:g} of the {shown} shown. Give a longer one, or leave it out."
                }
            )


def _loading(V, sigma, times, parts):
    loading = rs.Loading.constant(V)
    for t, part in zip(times, parts, strict=True):
        if part.V != V:
            loading = loading.step(t, part.V)
        if part.sigma != sigma:
            loading = loading.sigma_step(t, part.sigma)
        V, sigma = part.V, part.sigma
    return loading


def _reloading_of_step(verdict, settled):
    """Return the time [s] in which the spring reaches a higher steady stress after a step."""
    motions = settled[:2], (verdict.slider, verdict.V_lp)
    earlier, later = (slider.sigma * slider.steady_stress(V) for slider, V in motions)
    return _reloading(verdict, later - earlier)


def _reloading_after(plan, verdict):
    """Return the time [s] in which the spring's stress reaches friction after a plan's segments.

    It is the friction of steady sliding, or what the slider meets at once if that is more: after
    a hold V rises by the direct effect before the state changes.  0 if the run ends before.
    """
    t = plan.changes[-1]
    try:
        run = plan.run(t_end=t, times=[t]).isel(time=-1)
    except rs.SolverError:
        return 0.0
    faster = np.log(verdict.V_lp / max(float(run.V), SLOWEST))
    at_once = run.mu + verdict.slider.a * faster
    friction = np.fmax(at_once, verdict.slider.steady_stress(verdict.V_lp))
    return _reloading(verdict, float(verdict.slider.sigma * friction - run.tau))


def _reloading(verdict, stress):
    """Return the time [s] in which the load point raises the spring's stress by so much [Pa]."""
    speed = verdict.slider.K * verdict.V_lp
    return stress / speed if stress > 0.0 and np.isfinite(speed) else 0.0


def slide_hold_slide(state, text):
    """Return the rows (`state.rows_of`) of three holds, with slides between them.

    A slide brings the stress back and goes on for some Dc.  In a hold of t seconds the stress falls
    by at most a sigma ln(1 + K V_lp t/(a sigma)), and friction heals by b sigma ln(1 + V_lp t/Dc).

    text : the second hold, as typed; `BadEntries` if it is not a time > 0
    """
    try:
        middle = value_of("t", text, "hold", "> 0")
    except rs.ParameterError as error:
        raise BadEntries({"hold-time": str(error)}) from None
    slider, V_lp = state[:2]
    direct, evolution = slider.a * slider.sigma, max(slider.b, 0.0) * slider.sigma
    readable = rs.readable
    rows: list[list[str | None]] = []
    slide = 0.0
    for hold in (middle * times for times in HOLDS):
        if rows:
            rows.append([readable("V_lp", V_lp, 6), None, readable("t", slide, 2)])
        rows.append(["0 m/s", None, readable("t", hold, 6)])
        fall = direct * np.log1p(slider.K * V_lp * hold / direct)
        healed = evolution * np.log1p(V_lp * hold / slider.Dc)
        loading = (fall + healed) / slider.K if np.isfinite(slider.K) else 0.0
        slide = (loading + SLIDE * slider.Dc) / V_lp
    return rows
