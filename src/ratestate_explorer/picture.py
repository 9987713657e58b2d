"""The answer for a slider: run, limit cycle, steady point, verdict, critical values."""

from typing import NamedTuple

import numpy as np
import xarray

import ratestate as rs

from . import charts
from .deadline import TimeUp
from .experiment import plan_of_experiment
from .run_plan import Plan, Settled, plan_of, transient_note

RTOL = 1e-8  # of the cycle
# How often a run is shortened before it is given up.
ATTEMPTS = 3
#: seconds of each part of the work: a search for a cycle, a verdict, a run
SECONDS = 1.0
# A run that takes too long is repeated up to this part of what was done.
AGAIN = 0.5
BESIDE = (
    "Before the kick, steady sliding and a limit cycle are both stable. The kick starts from "
    "steady sliding."
)
# What the block and the load point of a run are drawn from -> variables of the run [m].
PATHS = {"slip": "delta", "load": "delta_lp"}
#: most points of a curve that are sent
MOST_SENT = 6000
#: field -> the critical values of its quantity, attributes of the `Verdict`
OF_VERDICT = {"K": ("K_c", "K_fold"), "V_lp": ("V_c", "V_c_upper")}
#: fields on whose sliders critical values are marked
MARKED = (*OF_VERDICT, "M")
#: attributes of a `Verdict` that the page shows
NUMBERS = (
    "regime stable K_c K_c_qs V_c eta period frequency amplitude V_max V_min multiplier K_fold f_n "
    "fade"
).split()


class Study(NamedTuple):
    """The attractor of a slider at a speed, and the run that shows it."""

    verdict: rs.Verdict
    orbit: xarray.Dataset | None
    plan: Plan
    notes: list[str]


def study_of(state, deadline):
    """Return the `Study` of a `PageState`; a search that fails or takes too long is noted.

    `TimeUp` if the verdict or the run's start takes too long, `Stopped` if it was cancelled.
    """
    cycle, orbit = _attractor(state.slider, state.V_lp, deadline)
    with deadline.part():
        verdict = rs.verdict(state.slider, state.V_lp, cycle)
    notes = [note] if (note := transient_note(verdict, orbit)) else []
    if state.before is None:
        return Study(verdict, orbit, plan_of(verdict, orbit), notes)
    settled, missing = _settled(state, cycle, orbit, deadline)
    plan = plan_of_experiment(state, verdict, orbit, settled, deadline)
    return Study(verdict, orbit, plan, notes + missing)


def _settled(state, cycle, orbit, deadline):
    """Return the `Settled` motion before an experiment, and notes on it.

    cycle, orbit : the attractor at its end, as from `_attractor`
    """
    slider, V_lp = state.before[:2]
    if (slider, V_lp) != (state.slider, state.V_lp):
        cycle, orbit = _attractor(slider, V_lp, deadline)
    if state.kick is not None and rs.stability(slider, V_lp).stable:
        # A kick may lead from steady sliding to a stable cycle.
        has_cycle = Settled(slider, V_lp, orbit).on_cycle
        return Settled(slider, V_lp), [BESIDE] if has_cycle else []
    if not isinstance(cycle, rs.SolverError):
        return Settled(slider, V_lp, orbit), []
    return Settled(slider, V_lp), [
        "No limit cycle was found at the speed and normal stress before time 0. So the run begins "
        "in steady sliding, which may be unstable."
    ]


def picture(state, deadline):
    """Return header and arrays of the answer to "picture" (wire.py); it raises as `study_of`.

    The arrays of a run that cannot be shown in time are empty; arrays of a cycle may be absent.
    """
    study, slider = study_of(state, deadline), state.slider
    run, notes = run_of(study.plan, deadline)
    verdict = study.verdict
    numbers = {name: getattr(verdict, name) for name in NUMBERS}
    if (multiplier := verdict.multiplier) is not None:
        numbers["multiplier"] = [multiplier.real, multiplier.imag]
    arrays = _curves("run", run, slider.sigma, study.plan.changes[0], PATHS)
    if verdict.period:
        arrays |= _curves("cycle", study.orbit, slider.sigma, 0.0)
    arrays |= charts.line(slider, state.V_lp, verdict.K_c_qs)
    header = {
        "values": state.values,
        "numbers": numbers,
        "marks": marks(verdict),
        "sentences": verdict.sentences,
        "steady": slider.steady_stress(state.V_lp),
        "changes": [t - study.plan.changes[0] for t in study.plan.changes],
        "settling": study.plan.settings["t_end"] - study.plan.changes[-1],
        "notes": study.notes + notes,
        "chart": charts.key_of(slider),
    }
    return header, arrays


def _attractor(slider, V, deadline):
    """Return the limit cycle and its orbit; or the SolverError of the search, and None."""
    try:
        with deadline.part():
            orbit, cycle = rs.orbit(slider, V, rtol=RTOL, return_cycle=True)
            return cycle, orbit
    except rs.SolverError as error:
        return error, None
    except TimeUp:
        return rs.SolverError(
            f"the search was ended after {deadline.seconds:g} s. In Python limit_cycle has no such "
            f"limit."
        ), None


def run_of(plan, deadline):
    """Return the run, shortened if it takes too long, or None; and notes on that."""
    notes: list[str] = []
    t_end = requested = plan.settings["t_end"]
    limit = f"{deadline.seconds:g} s of computing. The Python lines have no such limit."
    for _ in range(ATTEMPTS):
        try:
            with deadline.part():
                return plan.run(t_end=t_end), notes
        except rs.SolverError as error:
            first = str(error).splitlines()[0].rstrip(".")
            return error.best, [*notes, f"{first}. The CSV file has the run up to there."]
        except TimeUp:
            t_end = AGAIN * deadline.done * t_end
            if not t_end > 0.0:
                break
            notes = [f"The run is cut at {t_end:.3g} s of {requested:.3g} s, after {limit}"]
    return None, [f"No run of {requested:.3g} s is shown: too little of it was computed in {limit}"]


def marks(verdict):
    """Return field -> [[name, value in SI], ...] of the critical values, in rising order.

    M_c, the mass at which K = K_c, follows from eq. 6 for laws of one length.
    """
    found = {
        field: [[name, getattr(verdict, name)] for name in names]
        for field, names in OF_VERDICT.items()
    }
    found["M"] = [["M_c", _critical_mass(verdict.slider, verdict.V_lp)]]
    return {field: [row for row in rows if _exists(row[1])] for field, rows in found.items()}


def _critical_mass(slider, V_lp):
    """Return the mass per area [kg/m^2] at which K = K_c; None if it has no closed form."""
    if not slider.friction_law.one_length or slider.b <= slider.a:
        return None
    return (slider.K / slider.K_c_qs - 1.0) / slider.replace(M=1.0).eta(V_lp)


def _exists(value):
    return value is not None and np.isfinite(value) and value > 0.0


def _curves(name, run, sigma, t_zero, paths=()):
    """Return arrays to draw a run: time from t_zero on, tau/sigma, mu, V; empty without a run.

    sigma : the normal stress, unless the run has it as a variable, which is then sent too
    paths : keys of `PATHS`, of which the displacement since the start of the run is sent
    """
    if run is None:
        return {f"{name}_{curve}": np.empty(0) for curve in ("time", "stress", "mu", "V", *paths)}
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
    rows = decimated(curves["stress"], curves["V"])
    return {f"{name}_{curve}": values[rows] for curve, values in curves.items()}


def decimated(*curves):
    """Return the indices of the points to send: all, or the extremes of each of many pieces.

    curves : (n,) each, of the same points
    """
    n = len(curves[0])
    if n <= MOST_SENT:
        return slice(None)
    pieces = np.array_split(np.arange(n), (MOST_SENT - 1) // (2 * len(curves) + 1))
    kept = [n - 1]
    for piece in pieces:
        for curve in curves:
            part = curve[piece]
            kept += [piece[0], piece[part.argmin()], piece[part.argmax()]]
    return np.unique(kept)
