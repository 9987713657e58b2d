"""Checks of a fit against its record: whether the estimates and errors can be relied on."""

from pathlib import Path

import numpy as np
from scipy.special import fdtrc

from ....model.quantities import readable
from ....model.sentences import Sentences
from ...reading.stress_steps import VARIABLE
from ..record import changes
from ..score import CHANCE, responds, response
from ..unknowns import of_slider
from .identifiability import identifiability
from .left_out import left_out, rigid
from .search import search_warnings

#: slip after the last step, over Dc, after which friction is steady again
STEADY = 3.0
#: largest deviation of the mean normal stress from the slider's
OFF = 0.02
#: variance of residuals over that of white noise, and correlation time over Dc/V, from which
#: correlated residuals count as misfit
COLORED, LONG = 4.0, 0.1
#: mean square of whitened residuals after steps that is misfit; slip after a step, over Dc, that
#: counts as after it
MISFIT, AFTER = 1.5, 5.0
#: fewest samples elsewhere from which the noise is inference
FEWEST = 30
#: size of the residuals, over that of a given noise, that contradicts it
CONTRADICTED = 1.5
#: residuals, over friction's range, too small to be a misfit
FINE = 1e-4
#: the laws with two states, of the sum of two effects that one state cannot give
TWO_STATES = "two-state-aging or two-state-slip"
SENTENCES = Sentences(Path(__file__).with_suffix(".toml"))


def diagnose(inference, data):
    """A note on what a record determines (str), and warnings (list of str)."""
    solution = inference.solution
    if not responds(solution):
        warning = _no_response(solution)
        return f"Nothing is determined: {warning}.", [warning]
    note, warnings = identifiability(inference)
    name, D, high = _longest_distance(inference.estimates, solution.problem.slider)
    return note, [
        *rigid(solution),  # first, for it explains others
        *search_warnings(inference),
        *warnings,
        *_ends_early(solution.problem.record, name, D, high),
        *_noise_too_small(solution),
        *_misfit(solution, name, D),
        *_normal_stress(solution.problem, data),
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


def _longest_distance(estimates, slider):
    """Symbol of the longest distance over which a state evolves, its value, and the upper end of
    its 95 % interval; the slider's value if it was given.
    """
    found = []
    for symbol in slider.friction_law.states.values():
        given = float(getattr(slider, symbol))
        if symbol in estimates.names:
            estimate = estimates.of(symbol)
            found.append((estimate.value, float(estimate.interval[-1, 1]), symbol))
        else:
            found.append((given, given, symbol))
    value, high, symbol = max(found)
    return symbol, value, high


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


def _noise_too_small(solution):
    """A warning if residuals are much larger than the noise that was given."""
    ratio = np.sqrt(solution.chi2 / solution.fitted_friction.size)
    if ratio >= CONTRADICTED:
        yield SENTENCES("residuals.above_noise", ratio=ratio)


def _misfit(solution, name, D):
    """A warning if residuals are larger after steps, or last about as long as a transient."""
    record, noise, residual = solution.problem.record, solution.noise, solution.residual
    white = noise.whiten(record.t, residual)[0][:, 0]
    loading = record.loading
    events = changes(loading)
    if not events.size:
        return
    durations = D / np.maximum(loading.V_load(events), 1e-3 * loading.V.max())
    after = np.zeros(record.t.size, bool)
    for t, duration in zip(events, durations, strict=True):
        after |= (record.t >= t) & (record.t < t + AFTER * duration)
    count = int(after.sum())
    if not count or np.sqrt(np.mean(residual[after] ** 2)) < FINE * record.scale:
        return
    others = after.size - count
    elsewhere = float(np.mean(white[~after] ** 2)) if others > FEWEST else np.inf
    square = float(np.mean(white[after] ** 2)) / elsewhere
    if square > MISFIT and fdtrc(count, others, square) < CHANCE:
        massless = solution.problem.forward.fixed["M"] == 0.0
        mass = "the machine's mass (M is 0), " if massless else ""
        values = {"ratio": np.sqrt(square), "mass": mass, "other": _other_law(solution)}
        yield SENTENCES("residuals.after_steps", **values)
        return
    colored = float(np.mean(residual**2)) / (np.var(np.diff(residual)) / 2.0)
    duration = float(durations.min())
    if noise.red and colored > COLORED and noise.time > LONG * duration:
        values = {"red": noise.red, "time": noise.time, "name": name, "duration": duration}
        yield SENTENCES("residuals.correlated", other=_other_law(solution), **values)


def _other_law(solution):
    """Which law to try where one does not fit: of one with one state those with two."""
    if len(solution.problem.law.states) > 1:
        return "another law"
    return f"another law, such as {TWO_STATES}"


def _normal_stress(problem, data):
    """Warnings if the recorded normal stress is not the slider's, or varies unfollowed."""
    if "sigma" not in data.variables or data["sigma"].dims != ("time",):
        return
    recorded = np.asarray(data["sigma"].values, float)[problem.record.order]
    recorded = recorded[np.isfinite(recorded)]
    if not recorded.size:
        return
    mean, varies = float(recorded.mean()), problem.record.loading.normal_stress is not None
    stress = float(recorded[0]) if varies else mean  # it varies from the slider's on
    if abs(stress / problem.slider.sigma - 1.0) > OFF:
        where = "at the start" if varies else "on average"
        sigma = problem.slider.sigma
        yield SENTENCES("normal_stress.other", stress=stress, where=where, sigma=sigma)
    if problem.record.loading.normal_stress is None and recorded.std() > VARIABLE * mean:
        yield SENTENCES("normal_stress.variable", spread=100 * recorded.std() / mean, mean=mean)
