"""The fit of a record of stick-slip or vibration, by the features of its limit cycles."""

from typing import NamedTuple

import numpy as np

from ....errors import ParameterError
from ..likelihood.profile import Better
from .features import LEVEL
from .measured import corrected
from .model import GRID, CycleModel
from .profile import Profiles
from .search import Problem, starts
from .space import Space
from .stretches import enough, measured_of, segments
from .words import identified, remarks

# Chance below which a misfit is not put down to errors of the features.
CHANCE = 0.01
# Starts that end with a chi-squared within this of the best fit equally well; they are distinct
# when as many standard errors apart.
EQUAL, DISTINCT = 4.0, 4.0
# Chi-squared beyond the best one's of the runs that go on once noise's shift is known, and
# their number.
FOLLOWED, MOST = 30.0, 3
# Fall of chi-squared by which a point of a profile is better than the fit, which then goes on from
# there; how often.
BETTER, REFITS = 0.1, 2


class CyclesFit(NamedTuple):
    """What a record's cycles say of a slider."""

    names: tuple  # free parameters, mu0, and a - b ("a_minus_b") where a or b is free
    values: dict  # symbol -> value [SI] of a, b, Dc, K, M, fitted or not, and of mu0
    covariance: np.ndarray  # (p, p) of the logarithms of the free, of mu0 and a - b themselves
    ends: np.ndarray  # (p, levels, sides) of the intervals, in the same scale; inf: none there
    kinds: tuple  # "covariance" or "profile", which the intervals are from
    law: str
    measured: tuple  # `Measured`, one a segment
    fitted: np.ndarray  # (s, 6) features, as `Measured.values`
    waves: np.ndarray  # (s, q) tau/sigma at the phases `GRID` of the model's cycle
    runs: tuple  # `Run`, one a start, the best first
    run_values: tuple  # dict symbol -> value [SI], of each run's end
    chi2: float
    dof: int  # features less free parameters
    enlarged: float  # factor by which errors are, for a misfit beyond theirs
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
        As for `fit`.  Each stretch of one load-point speed that oscillates is fitted.
    slider : SpringSlider
        What is not free, and the first of the starts.
    free : sequence of str
        Any of a, b, Dc, K, M; mu0 is always found.
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
    found = segments(record, slider, loading)
    space = Space(slider, free, min(segment.V_lp for segment in found))
    measured, said = measured_of(found)
    enough(space, measured)
    V_lp = np.array([found.segment.V_lp for found in measured])
    model = CycleModel(law, V_lp, [m.bins for m in measured], slider.sigma, slider.V0)
    problem = Problem(space, model, measured)
    runs = [problem.search(q) for q in starts(space, model, measured, slider.sigma)]
    runs = sorted((run for run in runs if np.isfinite(run.chi2)), key=lambda run: run.chi2)
    if not runs:
        raise ParameterError(
            f"no limit cycle was found near the record's with {', '.join(space.names)} free under "
            f"the {law} law; free more parameters, or start from a slider nearer to the machine"
        )
    # Noise shifts the features of the model's cycle, not those of the record's.
    waves, fitted = _at(problem, runs[0])
    measured = tuple(map(corrected, measured, map(wave_at, waves), fitted))
    enough(space, measured)
    problem = Problem(space, model, measured)
    # The shift moves a minimum by about an error: only the better ones are followed.
    distinct = _distinct(runs, runs[0].covariance)
    followed = [i for i in distinct[:MOST] if runs[i].chi2 < runs[0].chi2 + FOLLOWED]
    runs = [
        problem.search(run.end)._replace(start=run.start)
        if i in followed
        else problem.run(run.start, run.end, run.status)
        for i, run in enumerate(runs)
    ]
    runs = sorted((run for run in runs if np.isfinite(run.chi2)), key=lambda run: run.chi2)
    return _result(problem, runs, said)


def _at(problem, run):
    """Waves (s, q) of tau/sigma and features (s, 6) at a run's end."""
    values = problem.space.values(run.end[None])
    fitted = problem.model.features(values)[0][0]
    fitted[:, LEVEL] += run.mu0
    return problem.model.waves(values)[1][0] + run.mu0, fitted


def wave_at(wave):
    """A wave at the phases `GRID` as a function of phase."""
    return lambda phase: np.interp(phase % 1.0, GRID, wave)


def _result(problem, runs, said, again=REFITS):
    """`CyclesFit` of the best run."""
    from scipy.special import chdtrc

    space, best = problem.space, runs[0]
    dof = problem.levels.size - space.size - 1
    misfit = dof > 0 and chdtrc(dof, best.chi2) < CHANCE
    enlarged = float(np.sqrt(best.chi2 / dof)) if misfit else 1.0
    moved = enlarged**2 * best.covariance
    names = (*space.names, "mu0", *space.numbers[space.size :])
    by_moved = np.array([_gradient(space, name, best.end) for name in names])
    covariance = by_moved @ moved @ by_moved.T
    errors = np.sqrt(np.diag(covariance))
    better = BETTER if again else np.inf
    try:
        ends, kinds = Profiles(problem, best, names, moved, errors, enlarged, better).intervals()
    except Better as passed:
        return _result(problem, [problem.search(passed.point), *runs], said, again - 1)
    waves, fitted = _at(problem, best)
    ended = [space.values(run.end[None]) for run in runs]
    run_values = tuple({s: float(v[0]) for s, v in end.items()} for end in ended)
    values = {**run_values[0], "mu0": best.mu0}
    alike = [i for i in _distinct(runs, moved)[1:] if runs[i].chi2 - best.chi2 < EQUAL]
    free = slice(space.size)
    words, vague = identified(space.names, covariance[free, free], problem.measured)
    found = CyclesFit(
        names,
        values,
        covariance,
        ends,
        kinds,
        problem.model.law,
        problem.measured,
        fitted,
        waves,
        tuple(runs),
        run_values,
        best.chi2,
        dof,
        enlarged,
        [],
        words,
    )
    return found._replace(warnings=[*said, *remarks(found, alike), *vague])


def _gradient(space, name, q):
    """(k + 1,) derivative of a number by the coordinates and mu0."""
    if name == "mu0":
        return np.append(np.zeros(q.size), 1.0)
    return np.append(space.gradient(name, q), 0.0)


def _distinct(runs, covariance):
    """Numbers of the best run and of those that end away from it, and from each other."""
    # (each by itself: along a bent valley the covariance at one end misleads)
    errors = np.sqrt(np.diag(covariance)[:-1])
    kept = [0]
    for i, run in enumerate(runs):
        apart = [run.end - runs[j].end for j in kept]
        if all(np.any(np.abs(d) > DISTINCT * errors) for d in apart):
            kept.append(i)
    return kept
