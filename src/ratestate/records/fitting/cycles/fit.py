"""The fit of a record of stick-slip or vibration, by the features of its limit cycles."""

from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc

from ....errors import ParameterError
from ....model.quantities import readable
from ...messages import fitting as sentences
from ..estimates import Estimates, estimates_from
from ..likelihood.profile import BetterPoint
from .features import FEATURES, LEVEL
from .measured import corrected, measure
from .model import GRID, CycleModel
from .profile import profiled_intervals
from .search import Problem, distinct_runs, starts
from .segments import SENTENCES, segments_of
from .space import Space

# Probability of a misfit by errors of the features alone, below which the errors are enlarged.
CHANCE = 0.01
# Runs are continued, once the shift by noise is known, if their chi-squared is within the first of
# the best one's; their largest number.
FOLLOWED, MOST = 30.0, 3
# Fall of chi-squared by which a point of a profile is better than the fit, which then continues
# there; how often at most.
BETTER, REFITS = 0.1, 2


class CyclesFit(NamedTuple):
    """Parameters of a slider from a record's cycles."""

    law: str
    free: tuple
    estimates: Estimates  # of the free, of mu0, and of a - b ("a_minus_b") where a or b is free
    covariance: np.ndarray  # (p, p) of the logarithms of the free, of mu0 and a - b themselves
    measured: tuple  # `Measured`, one a segment
    fitted_features: np.ndarray  # (s, 6), as `Measured.values`
    waves: np.ndarray  # (s, q) tau/sigma at the phases `GRID` of the model's cycle
    runs: tuple  # `Run`, one a start, the best first
    run_values: tuple  # dict symbol -> value [SI] of a, b, Dc, K, M, free or not, at each run's end
    dof: int  # features less free parameters
    enlarged: float  # factor by which errors are enlarged, for a misfit beyond them
    left_out: list  # warnings on segments that have no cycles

    @property
    def chi2(self):
        """Chi-squared of the features at the best run's end; errors are not enlarged in it."""
        return self.runs[0].chi2


def fit_cycles(record, slider, free, law, loading=None):
    """`CyclesFit` of a record; each segment at one load-point speed that oscillates is fitted.

    ParameterError as of `segments_of` and `Space`, and: cycles in no segment; not more features
    than unknowns; no cycle of the model at any start.
    """
    segments = segments_of(record, slider, loading)
    space = Space(slider, free, min(segment.V_lp for segment in segments))
    measured, left_out = _measured(segments)
    _check_feature_count(space, measured)
    V_lp = np.array([one.segment.V_lp for one in measured])
    model = CycleModel(law, V_lp, [m.bins for m in measured], slider.sigma, slider.V0)
    problem = Problem(space, model, measured)
    runs = _ranked(problem, (problem.search(q) for q in starts(space, model, measured)))
    # The shift by noise is found about the model's cycle, which has none.
    waves, features = _waves_and_features(problem, runs[0])
    measured = tuple(map(corrected, measured, map(wave_at, waves), features))
    _check_feature_count(space, measured)
    problem = Problem(space, model, measured)
    # The shift moves a minimum by about an error: only the better ones are continued.
    distinct = distinct_runs(runs, runs[0].covariance)
    followed = [i for i in distinct[:MOST] if runs[i].chi2 < runs[0].chi2 + FOLLOWED]

    def continued(i, run):
        if i in followed:
            return problem.search(run.end)._replace(start=run.start)
        problem.near = run.near
        return problem.run(run.start, run.point, run.status)

    runs = _ranked(problem, (continued(i, run) for i, run in enumerate(runs)))
    return _cycles_fit(problem, runs, left_out)


def _measured(segments):
    """`Measured` of the segments that have cycles, and warnings on the others."""
    measured, refused = [], []
    for segment in segments:
        try:
            measured.append(measure(segment))
        except ParameterError as error:
            refused.append((segment.V_lp, error))
    if not measured:
        raise refused[0][1]
    warnings = [SENTENCES("measured.left_out", V_lp=V_lp, error=error) for V_lp, error in refused]
    return tuple(measured), warnings


def _check_feature_count(space, measured):
    """Refuse more unknowns than features."""
    features = sum(int(one.used.sum()) for one in measured)
    if len(space.names) < features:
        return
    listed = "; ".join(
        f"at {readable('V_lp', one.segment.V_lp)} "
        + ", ".join(name for name, used in zip(FEATURES, one.used, strict=True) if used)
        for one in measured
    )
    count, names = len(space.names), ", ".join(space.names)
    raise sentences.refusal(
        "cycles.few_features", count=count, names=names, features=features, listed=listed
    )


def _ranked(problem, runs):
    """The runs that ended at a cycle, the best first; ParameterError if none did."""
    ranked = sorted((run for run in runs if np.isfinite(run.chi2)), key=lambda run: run.chi2)
    if not ranked:
        names = ", ".join(problem.space.names)
        raise sentences.refusal("cycles.no_cycle", names=names, law=problem.model.law)
    return ranked


def _waves_and_features(problem, run):
    """Waves (s, q) of tau/sigma and features (s, 6) at a run's end."""
    (features,), _, (waves,) = problem.model.features(problem.space.values(run.end[None]), run.near)
    features[:, LEVEL] += run.mu0
    return waves + run.mu0, features


def wave_at(wave):
    """A wave at the phases `GRID` as a function of phase, which may be any number of cycles."""
    return lambda phase: np.interp(phase % 1.0, GRID, wave)


def _cycles_fit(problem, runs, left_out, refits=REFITS):
    """`CyclesFit` of the best run."""
    space, best = problem.space, runs[0]
    dof = problem.levels.size - len(space.names) - 1
    misfit = dof > 0 and chdtrc(dof, best.chi2) < CHANCE
    enlarged = float(np.sqrt(best.chi2 / dof)) if misfit else 1.0
    gradients = np.array([problem.gradient(name, best.point) for name in space.reported])
    covariance = gradients @ (enlarged**2 * best.covariance) @ gradients.T
    errors = dict(zip(space.reported, np.sqrt(np.diag(covariance)), strict=True))
    better = BETTER if refits else np.inf
    try:
        intervals = profiled_intervals(problem, best, errors, enlarged, better)
    except BetterPoint as improvement:
        runs = _ranked(problem, [problem.search(improvement.point[:-1]), *runs])
        return _cycles_fit(problem, runs, left_out, refits - 1)
    waves, features = _waves_and_features(problem, best)
    ends_of_runs = [space.values(run.end[None]) for run in runs]
    run_values = tuple({s: float(v[0]) for s, v in end.items()} for end in ends_of_runs)
    at = run_values[0] | {"mu0": best.mu0}
    at["a_minus_b"] = at["a"] - at["b"]
    centres = np.array([problem.value(name, best.point) for name in space.reported])
    is_log = np.array([name in space.names for name in space.reported])
    values = np.array([at[name] for name in space.reported])
    estimates = estimates_from(space.reported, centres, covariance, is_log, values)
    ends = {name: np.exp(x) if name in space.names else x for name, x in intervals.items()}
    return CyclesFit(
        problem.model.law,
        space.names,
        estimates.with_intervals(ends, "profile"),
        covariance,
        problem.measured,
        features,
        waves,
        tuple(runs),
        run_values,
        dof,
        enlarged,
        left_out,
    )
