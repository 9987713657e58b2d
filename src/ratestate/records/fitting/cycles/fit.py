"""The fit of a record of stick-slip or vibration, by the features of its limit cycles."""

from typing import NamedTuple

import numpy as np

from ....errors import ParameterError
from ..likelihood.profile import BetterPoint
from .diagnostics import fit_warnings, identifiability
from .features import LEVEL
from .measured import corrected
from .model import GRID, CycleModel
from .profile import Profiles
from .search import Problem, starts
from .segments import check_feature_count, measured_of, segments_of
from .space import Space

# Probability of a misfit by errors of the features alone, below which the errors are enlarged.
CHANCE = 0.01
# Runs with a chi-squared within the first of the best one's fit equally well; runs are distinct if
# they end more standard errors apart than the second.
EQUAL, DISTINCT = 4.0, 4.0
# Runs are continued, once the shift by noise is known, if their chi-squared is within the first of
# the best one's; their largest number.
FOLLOWED, MOST = 30.0, 3
# Fall of chi-squared by which a point of a profile is better than the fit, which then continues
# there; how often at most.
BETTER, REFITS = 0.1, 2


class CyclesFit(NamedTuple):
    """Parameters of a slider from a record's cycles."""

    names: tuple  # free parameters, mu0, and a - b ("a_minus_b") where a or b is free
    values: dict  # symbol -> value [SI] of a, b, Dc, K, M, free or not, and of mu0
    covariance: np.ndarray  # (p, p) of the logarithms of the free, of mu0 and a - b themselves
    ends: np.ndarray  # (p, levels, sides) of the intervals, in the same scale; inf where open
    kinds: tuple  # source of each interval: "covariance" or "profile"
    law: str
    measured: tuple  # `Measured`, one a segment
    fitted_features: np.ndarray  # (s, 6), as `Measured.values`
    waves: np.ndarray  # (s, q) tau/sigma at the phases `GRID` of the model's cycle
    runs: tuple  # `Run`, one a start, the best first
    run_values: tuple  # dict symbol -> value [SI], of each run's end
    chi2: float
    dof: int  # features less free parameters
    enlarged: float  # factor by which errors are enlarged, for a misfit beyond them
    warnings: list
    identifiability: str

    @property
    def free(self):
        return self.names[: self.names.index("mu0")]

    @property
    def estimates(self):
        """symbol -> value [SI] of all names."""
        difference = {"a_minus_b": self.values["a"] - self.values["b"]}
        return {name: {**self.values, **difference}[name] for name in self.names}


def fit_cycles(record, slider, free, law, loading=None):
    """Parameters of a slider from the features of its limit cycles.

    Parameters
    ----------
    record : xarray.Dataset
        As for `fit`.  Each segment at one load-point speed that oscillates is fitted.
    slider : SpringSlider
        What is not free, and the first of the starts.
    free : sequence of str
        Any of a, b, Dc, K, M; mu0 is always free.
    law : {"slip", "aging"}
    loading : Loading, optional

    Returns
    -------
    CyclesFit

    Raises
    ------
    ParameterError
        No cycles that repeat; a slider that has none (M = 0); more free parameters than features.
    """
    segments = segments_of(record, slider, loading)
    space = Space(slider, free, min(segment.V_lp for segment in segments))
    measured, warnings = measured_of(segments)
    check_feature_count(space, measured)
    V_lp = np.array([one.segment.V_lp for one in measured])
    model = CycleModel(law, V_lp, [m.bins for m in measured], slider.sigma, slider.V0)
    problem = Problem(space, model, measured)
    runs = _ranked(problem.search(q) for q in starts(space, model, measured, slider.sigma))
    if not runs:
        raise ParameterError(
            f"no limit cycle was found near the record's with {', '.join(space.names)} free under "
            f"the {law} law; free more parameters, or start from a slider nearer to the machine"
        )
    # The shift by noise is found about the model's cycle, which has none.
    waves, features = _waves_and_features(problem, runs[0])
    measured = tuple(map(corrected, measured, map(wave_at, waves), features))
    check_feature_count(space, measured)
    problem = Problem(space, model, measured)
    # The shift moves a minimum by about an error: only the better ones are continued.
    distinct = _distinct(runs, runs[0].covariance)
    followed = [i for i in distinct[:MOST] if runs[i].chi2 < runs[0].chi2 + FOLLOWED]
    runs = _ranked(
        problem.search(run.end)._replace(start=run.start)
        if i in followed
        else problem.run(run.start, run.end, run.status)
        for i, run in enumerate(runs)
    )
    return _cycles_fit(problem, runs, warnings)


def _ranked(runs):
    """The runs that ended at a cycle, the best first."""
    return sorted((run for run in runs if np.isfinite(run.chi2)), key=lambda run: run.chi2)


def _waves_and_features(problem, run):
    """Waves (s, q) of tau/sigma and features (s, 6) at a run's end."""
    values = problem.space.values(run.end[None])
    features = problem.model.features(values)[0][0]
    features[:, LEVEL] += run.mu0
    return problem.model.waves(values)[1][0] + run.mu0, features


def wave_at(wave):
    """A wave at the phases `GRID` as a function of phase."""
    return lambda phase: np.interp(phase % 1.0, GRID, wave)


def _cycles_fit(problem, runs, warnings, refits=REFITS):
    """`CyclesFit` of the best run."""
    from scipy.special import chdtrc

    space, best = problem.space, runs[0]
    dof = problem.levels.size - space.size - 1
    misfit = dof > 0 and chdtrc(dof, best.chi2) < CHANCE
    enlarged = float(np.sqrt(best.chi2 / dof)) if misfit else 1.0
    by_coordinates = enlarged**2 * best.covariance
    names = (*space.names, "mu0", *space.reported[space.size :])
    gradients = np.array([_gradient(space, name, best.end) for name in names])
    covariance = gradients @ by_coordinates @ gradients.T
    errors = np.sqrt(np.diag(covariance))
    better = BETTER if refits else np.inf
    profiles = Profiles(problem, best, names, by_coordinates, errors, enlarged, better)
    try:
        ends, kinds = profiles.intervals()
    except BetterPoint as improvement:
        runs = [problem.search(improvement.point), *runs]
        return _cycles_fit(problem, runs, warnings, refits - 1)
    waves, features = _waves_and_features(problem, best)
    ends_of_runs = [space.values(run.end[None]) for run in runs]
    run_values = tuple({s: float(v[0]) for s, v in end.items()} for end in ends_of_runs)
    values = {**run_values[0], "mu0": best.mu0}
    alike = [i for i in _distinct(runs, by_coordinates)[1:] if runs[i].chi2 - best.chi2 < EQUAL]
    free = slice(space.size)
    note, vague = identifiability(space.names, covariance[free, free], problem.measured)
    fit = CyclesFit(
        names,
        values,
        covariance,
        ends,
        kinds,
        problem.model.law,
        problem.measured,
        features,
        waves,
        tuple(runs),
        run_values,
        best.chi2,
        dof,
        enlarged,
        [],
        note,
    )
    return fit._replace(warnings=[*warnings, *fit_warnings(fit, alike), *vague])


def _gradient(space, name, q):
    """(k + 1,) derivative of a reported quantity by the coordinates and mu0."""
    if name == "mu0":
        return np.append(np.zeros(q.size), 1.0)
    return np.append(space.gradient(name, q), 0.0)


def _distinct(runs, covariance):
    """Indices of the best run and of those that end away from it and from each other."""
    # (coordinate by coordinate: along a curved valley the covariance at one end misleads)
    errors = np.sqrt(np.diag(covariance)[:-1])
    kept = [0]
    for i, run in enumerate(runs):
        distances = [np.abs(run.end - runs[j].end) for j in kept]
        if all(np.any(d > DISTINCT * errors) for d in distances):
            kept.append(i)
    return kept
