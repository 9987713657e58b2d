"""Checks of a fit against its record: whether the estimates and errors can be relied on."""

from pathlib import Path

import numpy as np

from ....model.names import Sentences
from ....model.quantities import readable
from ...load_point.stress_steps import VARIABLE, stress_range
from ..likelihood.transients import longest_distance
from ..record import changes
from ..score import responds, response
from ..unknowns import of_slider
from .identifiability import identifiability
from .left_out import left_out, rigid
from .misfit import misfit_warnings
from .search import search_warnings
from .trend import trend_warnings

#: slip after the last step, over Dc, after which friction is steady again
STEADY = 3.0
#: largest deviation of the mean normal stress from the slider's
OFF = 0.02
SENTENCES = Sentences(Path(__file__).with_suffix(".toml"))


def diagnose(inference, data):
    """A note on what a record determines (str), and warnings (list of str)."""
    solution = inference.solution
    if not responds(solution):
        warning = _no_response(solution)
        return f"Nothing is determined: {warning}.", [warning, *_normal_stress(solution, data)]
    note, warnings = identifiability(inference)
    name, D, high = longest_distance(inference.estimates, solution.problem.slider)
    return note, [
        *rigid(solution),  # first, for it explains others
        *search_warnings(inference),
        *warnings,
        *_ends_early(solution.problem.record, name, D, high),
        *misfit_warnings(inference),
        *trend_warnings(inference),
        *_normal_stress(solution, data),
        *left_out(solution),
    ]


def _no_response(solution):
    """The warning that level and trend alone fit as well."""
    gain, free = response(solution)
    slider = solution.problem.slider
    alone = "alone_nearly" if gain > 0.0 else "alone_better"
    given = [s for s in of_slider(slider.friction_law) if s not in solution.unknowns.names]
    given = [s for s in given if s != "M" or slider.M > 0.0]
    return SENTENCES(
        f"response.{'unsuited' if given else 'noise'}",
        trend="" if solution.problem.record.trend is None else " and a trend",
        alone=SENTENCES(f"response.{alone}", gain=gain, free=free),
        given=", ".join(f"{s} = {readable(s, float(getattr(slider, s)))}" for s in given),
    )


def _ends_early(record, name, D, high):
    """A warning if the record ends before friction is steady after the last step.

    name : symbol of the distance D [m] over which it becomes so; high : the largest likely one
    """
    loading = record.loading
    last = max(changes(loading), default=0.0)
    slip = float(np.diff(loading.delta_lp(np.array([last, record.t[-1]])))[0])
    if loading.V[-1] == 0.0 or slip >= STEADY * high:
        return
    if slip >= STEADY * D:
        most = f"as large as {readable(name, high, 2)}" if np.isfinite(high) else "of any size"
        yield SENTENCES("end.uncertain", slip=slip, name=name, most=most)
    else:
        yield SENTENCES("end.early", slip=slip, name=name, over_D=slip / D, wanted=STEADY * D)


def _normal_stress(solution, data):
    """Warnings if the recorded normal stress is not the slider's, or varies."""
    problem = solution.problem
    if "sigma" not in data.variables or data["sigma"].dims != ("time",):
        return
    recorded = np.asarray(data["sigma"].values, float)[problem.record.order]
    recorded = recorded[np.isfinite(recorded)]
    if not recorded.size:
        return
    followed, slider = problem.record.loading.normal_stress is not None, problem.slider
    mean = float(recorded.mean())
    stress = float(recorded[0]) if followed else mean  # it varies from the slider's on
    if abs(stress / slider.sigma - 1.0) > OFF:
        where = "at the start" if followed else "on average"
        yield SENTENCES("normal_stress.other", stress=stress, where=where, sigma=slider.sigma)
    change = stress_range(data)
    if change > VARIABLE and not followed:
        yield SENTENCES("normal_stress.unfollowed", percent=100.0 * change, mean=mean)
    elif change > VARIABLE and "alpha" not in solution.unknowns.names:
        yield SENTENCES("normal_stress.varies", percent=100.0 * change, alpha=slider.alpha)
