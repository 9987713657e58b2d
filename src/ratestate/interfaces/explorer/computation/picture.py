"""What is drawn for a slider: run, limit cycle, steady point, verdict; with a time limit."""

from typing import NamedTuple

import numpy as np
import xarray

from ....dynamics.cycles.limit_cycle import cycle_and_orbit
from ....dynamics.simulation.cases import failure
from ....dynamics.steady_sliding import stability
from ....dynamics.verdict import Verdict, result_or_error, verdict_of_cycle
from ....engine.model import FINISHED
from ....errors import SolverError
from . import charts
from .budget import TimeUp
from .decimation import decimated
from .experiment import plan_of_experiment
from .marks import marks
from .motion import Plan, plan_of, steady_stress, transient_note
from .settled import Settled

RTOL = 1e-8  # of the cycle
# How often a run is shortened before it is given up.
ATTEMPTS = 3
#: seconds of each part of the work: a search for a cycle, a verdict, a run
SECONDS = 1.0
# A run that takes too long is repeated up to this part of what was done.
AGAIN = 0.5
BESIDE = (
    "Before the kick, steady sliding and a limit cycle are both stable; the kick starts from "
    "steady sliding."
)
# What the block and the load point of a run are drawn from -> variables of the run [m].
PATHS = {"slip": "delta", "load": "delta_lp"}


class Study(NamedTuple):
    """The attractor of a slider at a speed, and the run that shows it."""

    verdict: Verdict
    orbit: xarray.Dataset | None
    plan: Plan
    notes: list[str]


def study_of(state, deadline):
    """The `Study` of a `PageState`; a search that fails or takes too long is no error, but noted.

    `TimeUp` if the verdict or the run's start takes too long, backend.Stopped if it was cancelled.
    """
    cycle, orbit = _attractor(state.slider, state.V_lp, deadline)
    with deadline.part():
        verdict = verdict_of_cycle(state.slider, state.V_lp, cycle)
    notes = [note] if (note := transient_note(verdict, orbit)) else []
    if state.before is None:
        return Study(verdict, orbit, plan_of(verdict, orbit), notes)
    settled, missing = _settled(state, cycle, orbit, deadline)
    plan = plan_of_experiment(state, verdict, orbit, settled, deadline)
    return Study(verdict, orbit, plan, notes + missing)


def _settled(state, cycle, orbit, deadline):
    """The `Settled` motion before an experiment, and notes on it.

    cycle, orbit : the attractor at its end, as from `_attractor`
    """
    slider, V_lp = state.before[:2]
    if (slider, V_lp) != (state.slider, state.V_lp):
        cycle, orbit = _attractor(slider, V_lp, deadline)
    if state.kick is not None and stability(slider, V_lp).stable:
        # A kick leads from there to the cycle beside it.
        beside = orbit is not None and orbit.sizes["time"] > 1
        return Settled(slider, V_lp), [BESIDE] if beside else []
    if not isinstance(cycle, SolverError):
        return Settled(slider, V_lp, orbit), []
    return Settled(slider, V_lp), [
        "No limit cycle was found at the speed and normal stress before time 0: the run begins in "
        "steady sliding there, stable or not."
    ]


def picture(state, deadline):
    """Header and arrays of the answer to "picture" (wire.py); it raises as `study_of` does.

    The arrays of a run that cannot be shown in time are empty; those of a cycle may be absent.
    """
    study, slider = study_of(state, deadline), state.slider
    run, notes = run_of(study.plan, deadline)
    verdict = study.verdict
    arrays = _curves("run", run, slider.sigma, study.plan.changes[0], PATHS)
    if verdict.period:
        arrays |= _curves("cycle", study.orbit, slider.sigma, 0.0)
    arrays |= charts.line(slider, state.V_lp, verdict.K_c_qs)
    header = {
        "values": state.values,
        "numbers": {name: getattr(verdict, name) for name in NUMBERS},
        "marks": marks(verdict),
        "sentences": verdict.sentences,
        "steady": steady_stress(slider, state.V_lp),
        "changes": [t - study.plan.changes[0] for t in study.plan.changes],
        "settling": study.plan.settings["t_end"] - study.plan.changes[-1],
        "notes": study.notes + notes,
        "chart": charts.key_of(slider),
    }
    return header, arrays


#: attributes of a `Verdict` that the page shows
NUMBERS = (
    "regime stable K_c K_c_qs V_c eta period frequency amplitude V_max V_min multiplier K_fold f_n "
    "fade"
).split()


def _attractor(slider, V, deadline):
    """The limit cycle and its orbit; or the SolverError why there is none, and None."""
    try:
        with deadline.part():
            found = result_or_error(
                lambda: cycle_and_orbit(slider, V, rtol=RTOL, progress=deadline)
            )
            return (found, None) if isinstance(found, SolverError) else found
    except TimeUp:
        return SolverError(
            f"the search was ended after {deadline.seconds:g} s; limit_cycle in Python has no such "
            f"limit"
        ), None


def run_of(plan, deadline):
    """The run as a Dataset, shortened if it takes too long, or None; and notes on that."""
    notes: list[str] = []
    t_end, requested = None, plan.settings["t_end"]
    limit = f"{deadline.seconds:g} s of computing; the Python lines have no such limit."
    for _ in range(ATTEMPTS):
        call = plan.call(t_end)
        try:
            with deadline.part():
                motion = call.move(deadline)
                run = call.dataset(call.variables(motion))
            if (status := motion.status[0]) != FINISHED:
                t = motion.numbers["t"][0]
                why = failure("The run", plan.slider, status, t, loading=call.loading)
                first = str(why).splitlines()[0].rstrip(".")
                notes.append(f"{first}. The CSV file has the run up to there.")
            return run, notes
        except TimeUp:
            t_end = AGAIN * deadline.done * call.t_end
            if not t_end > 0.0:
                break
            notes = [f"The run is cut at {t_end:.3g} s of {requested:.3g} s, after {limit}"]
    return None, [f"No run is shown: of {requested:.3g} s too little was done in {limit}"]


def _curves(name, run, sigma, t_zero, paths=()):
    """Arrays to draw a run: time relative to t_zero, tau/sigma, mu, V; empty if run is None.

    sigma : the normal stress, unless it is among the variables of the run, and sent as well
    paths : keys of `PATHS`, of which the displacement since the start of the run is sent
    """
    if run is None:
        return {f"{name}_{what}": np.empty(0) for what in ("time", "stress", "mu", "V", *paths)}
    curves = {
        "time": run.time.values - t_zero,
        "stress": (run.tau / run.get("sigma", sigma)).values,
        "mu": run.mu.values,
        "V": run.V.values,
    }
    for path in paths:
        displacement = run[PATHS[path]].values
        curves[path] = displacement - displacement[0]
    if "sigma" in run:
        curves["sigma"] = run.sigma.values
    which = decimated(curves["stress"], curves["V"])
    return {f"{name}_{what}": values[which] for what, values in curves.items()}
