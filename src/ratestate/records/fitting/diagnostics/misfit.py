"""Whether a law fits: residuals larger than the noise, or as slow as what the law describes."""

from pathlib import Path

import numpy as np
from scipy.special import fdtrc

from ....model.sentences import Sentences
from ..record import changes
from ..score import CHANCE

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


def is_misfit(inference):
    """Whether residuals are larger than the noise that was given, or after steps than elsewhere."""
    solution = inference.solution
    _, D, _ = longest_distance(inference.estimates, solution.problem.slider)
    return _over_given(solution) >= CONTRADICTED or _over_elsewhere(solution, D) > 0.0


def misfit_warnings(solution, name, D):
    """Warnings on residuals that are as `is_misfit` says, or last about as long as a transient.

    name, D : symbol of the longest distance over which a state evolves, and this
    """
    if (ratio := _over_given(solution)) >= CONTRADICTED:
        yield SENTENCES("residuals.above_noise", ratio=ratio)
    if ratio := _over_elsewhere(solution, D):
        massless = solution.problem.forward.fixed["M"] == 0.0
        mass = "the machine's mass (M is 0), " if massless else ""
        values = {"ratio": ratio, "mass": mass, "other": _other_law(solution)}
        yield SENTENCES("residuals.after_steps", **values)
    elif _after_steps(solution, D).any():
        yield from _correlated(solution, name, D)


def longest_distance(estimates, slider):
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


def _over_given(solution):
    """Size of the residuals over that of the noise; about 1 where the noise was estimated."""
    return np.sqrt(solution.chi2 / solution.fitted_friction.size)


def _over_elsewhere(solution, D):
    """Size of residuals after steps over that elsewhere; 0 where it may be so by chance."""
    after = _after_steps(solution, D)
    count, others = int(after.sum()), int((~after).sum())
    if not count:
        return 0.0
    white = solution.noise.whiten(solution.problem.record.t, solution.residual)[0][:, 0]
    elsewhere = float(np.mean(white[~after] ** 2)) if others > FEWEST else np.inf
    square = float(np.mean(white[after] ** 2)) / elsewhere
    by_chance = square <= MISFIT or fdtrc(count, others, square) >= CHANCE
    return 0.0 if by_chance else np.sqrt(square)


def _after_steps(solution, D):
    """(m,) which samples are after steps, as long as friction evolves; none of a fine fit."""
    record = solution.problem.record
    after = np.zeros(record.t.size, bool)
    for t, duration in zip(changes(record.loading), _durations(record.loading, D), strict=True):
        after |= (record.t >= t) & (record.t < t + AFTER * duration)
    if after.any() and np.sqrt(np.mean(solution.residual[after] ** 2)) < FINE * record.scale:
        after[:] = False
    return after


def _durations(loading, D):
    """Times [s] in which friction evolves after each change of a `Loading`."""
    return D / np.maximum(loading.V_load(changes(loading)), 1e-3 * loading.V.max())


def _correlated(solution, name, D):
    """A warning if residuals last about as long as a transient."""
    noise, residual = solution.noise, solution.residual
    colored = float(np.mean(residual**2)) / (np.var(np.diff(residual)) / 2.0)
    duration = float(_durations(solution.problem.record.loading, D).min())
    if noise.red and colored > COLORED and noise.time > LONG * duration:
        values = {"red": noise.red, "time": noise.time, "name": name, "duration": duration}
        yield SENTENCES("residuals.correlated", other=_other_law(solution), **values)


def _other_law(solution):
    """Which law to try where one does not fit: of one with one state those with two."""
    if len(solution.problem.law.states) > 1:
        return "another law"
    return f"another law, such as {TWO_STATES}"
