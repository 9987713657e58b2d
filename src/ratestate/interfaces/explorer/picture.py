"""What is drawn of a slider: run, limit cycle, steady point, verdict; in bounded time."""

from typing import NamedTuple

import numpy as np
import xarray

from ...dynamics.cycles.orbit import cycle_and_orbit
from ...dynamics.simulation.cases import failure
from ...dynamics.verdict import Verdict, verdict_of_cycle
from ...engine.backend import Stopped
from ...engine.model import FINISHED
from ...errors import SolverError
from ...friction.laws import mu_ss
from .budget import bounded
from .charts import key_of
from .motion import Plan, plan_of, unsettled

RTOL = 1e-8  # of the cycle
# How often a run is shortened before it is given up.
ATTEMPTS = 3
#: seconds of each part of the work: a search for a cycle, a verdict, a run
SECONDS = 1.0
# Of a run that was cut, what is run again; points of a curve that are sent, at most.
AGAIN, MOST_SENT = 0.5, 6000


class Study(NamedTuple):
    """What a slider does at a speed, and the run that shows it."""

    found: Verdict
    turn: xarray.Dataset | None
    plan: Plan
    notes: list[str]


def study_of(asked, watch):
    """The `Study` of what is asked; backend.Stopped if somebody cancelled it."""
    cycle, turn = _settled(asked.slider, asked.V_lp, watch)
    watch.deadline.start()
    found = verdict_of_cycle(asked.slider, asked.V_lp, cycle)
    notes = [said] if (said := unsettled(found, turn)) else []
    before = None
    if asked.V_from is not None:
        earlier, cycle_before = _settled(asked.slider, asked.V_from, watch)
        before = asked.V_from, cycle_before
        if isinstance(earlier, SolverError):
            notes.append(
                "No cycle is known at the speed before the step: the run begins in steady "
                "sliding there, stable or not."
            )
    return Study(found, turn, plan_of(found, turn, before), notes)


def picture(asked, deadline):
    """Header and arrays of the answer to "picture" (wire.py)."""
    with bounded(deadline) as watch:
        study = study_of(asked, watch)
        run, notes = _run(study.plan, watch)
    found, slider = study.found, asked.slider
    level = mu_ss(asked.V_lp, a=slider.a, b=slider.b, mu0=slider.mu0, V0=slider.V0)
    arrays = _curves("run", run, slider.sigma, study.plan.t_step)
    if found.period:
        arrays |= _curves("cycle", study.turn, slider.sigma, 0.0)
    numbers = {name: getattr(found, name) for name in NUMBERS}
    header = {
        "values": asked.values,
        "numbers": numbers | {"f_n": found.f_n, "fade": found.fade},
        "sentences": found.sentences,
        "steady": level,
        "notes": study.notes + notes,
        "chart": key_of(slider),
    }
    return header, arrays


#: of a `Verdict`, what the page shows
NUMBERS = (
    "regime stable K_c K_c_qs V_c eta period frequency amplitude V_max V_min multiplier K_fold"
).split()


def _settled(slider, V, watch):
    """Cycle, or the SolverError that says why there is none; and its orbit, or None."""
    watch.deadline.start()
    try:
        return cycle_and_orbit(slider, V, rtol=RTOL, progress=watch)
    except SolverError as error:
        return error, None
    except Stopped:
        if watch.deadline.cancelled:
            raise
        return SolverError(
            f"the search was ended after {watch.deadline.seconds:g} s; limit_cycle in Python has "
            f"no such limit"
        ), None


def _run(plan, watch):
    """The run as a Dataset, as far as it comes; and notes on that."""
    notes, t_end, asked = [], None, plan.settings["t_end"]
    limit = f"{watch.deadline.seconds:g} s of computing; the Python lines have no such limit."
    for _ in range(ATTEMPTS):
        call = plan.call(t_end)
        watch.deadline.start()
        watch.done = 0.0
        try:
            motion = call.move(watch)
        except Stopped:
            if watch.deadline.cancelled:
                raise
            t_end = AGAIN * watch.done * call.t_end
            if not t_end > 0.0:
                break
            notes = [f"The run is cut at {t_end:.3g} s of {asked:.3g} s, after {limit}"]
        else:
            return call.dataset(call.variables(motion)), notes + _failed(plan.slider, motion)
    return None, [f"No run is shown: of {asked:.3g} s too little was done in {limit}"]


def _failed(slider, motion):
    """A note on a run that failed, if it did."""
    if (status := motion.status[0]) == FINISHED:
        return []
    why = str(failure("The run", slider, status, motion.numbers["t"][0])).splitlines()[0]
    return [f"{why.rstrip('.')}. The CSV file has the run up to there."]


def _curves(name, run, sigma, t_zero):
    """Arrays to draw a run: time from t_zero on, tau/sigma, mu, V; empty without one."""
    if run is None:
        return {f"{name}_{what}": np.empty(0) for what in ("time", "stress", "mu", "V")}
    curves = {
        "time": run.time.values - t_zero,
        "stress": run.tau.values / sigma,
        "mu": run.mu.values,
        "V": run.V.values,
    }
    which = _kept(curves["stress"], curves["V"])
    return {f"{name}_{what}": values[which] for what, values in curves.items()}


def _kept(*curves):
    """Numbers of the points that are sent: all, or of each of many pieces the extremes."""
    n = len(curves[0])
    if n <= MOST_SENT:
        return slice(None)
    pieces = np.array_split(np.arange(n), MOST_SENT // (2 * len(curves) + 1))
    kept = {0, n - 1}
    for piece in pieces:
        for curve in curves:
            part = curve[piece]
            kept |= {int(piece[0]), int(piece[part.argmin()]), int(piece[part.argmax()])}
    return np.array(sorted(kept))
