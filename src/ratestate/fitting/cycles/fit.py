"""The fit of a record of stick-slip or vibration, by the features of its limit cycles."""

from typing import NamedTuple

import numpy as np

from ...errors import ParameterError
from ..blas import single_blas
from ..record import column, displacement_of, friction_of, increasing, loading_of
from .features import FEATURES, LEVEL
from .measured import Segment, corrected, measure
from .model import GRID, CycleModel
from .profile import Profiles
from .search import Problem, starts
from .space import PARAMETERS, Space
from .words import identified, remarks

# Samples below which a stretch of record is not looked at.
FEWEST = 20
# Chance below which a misfit is not put down to errors of the features.
CHANCE = 0.01
# Widest error of a coordinate that is told from no knowledge at all.
WIDEST = 50.0
# Starts that end with a chi-squared within this of the best fit equally well; they are distinct
# when as many standard errors apart.
EQUAL, DISTINCT = 4.0, 4.0
# Chi-squared beyond the best one's of the runs that go on once noise's shift is known, and
# their number.
FOLLOWED, MOST = 30.0, 3


class CyclesFit(NamedTuple):
    """What a record's cycles say of a slider."""

    names: tuple  # free parameters, then mu0
    estimates: dict  # symbol -> value [SI], of all names
    covariance: np.ndarray  # (k, k) of the logarithms of all names, but of mu0 itself
    ends: np.ndarray  # (k, levels, sides) of the intervals, in the same scale; inf: none there
    values: dict  # symbol -> value [SI] of a, b, Dc, K, M, fitted or not
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
    with single_blas():
        return _fit(segments(record, slider, loading), slider, free, law)


def _fit(found, slider, free, law):
    """`fit_cycles` of segments."""
    space = Space(slider, free, min(segment.V_lp for segment in found))
    measured, said = _measured(found)
    _enough(space, measured)
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
    _enough(space, measured)
    problem = Problem(space, model, measured)
    # The shift moves a minimum by about an error: only the better ones are followed.
    distinct = _distinct(runs, _covariance(runs[0].jacobian))
    for i in [i for i in distinct[:MOST] if runs[i].chi2 < runs[0].chi2 + FOLLOWED]:
        runs[i] = problem.search(runs[i].end)._replace(start=runs[i].start)
    runs = sorted(runs, key=lambda run: run.chi2)
    return _result(problem, runs, said)


def segments(record, slider, loading):
    """`Segment`s of a record in which the load point moves at one speed."""
    time = column(record, "time")
    increasing(time)
    kind, friction = friction_of(record, slider)
    if kind != "tau":
        raise ParameterError(
            "the record has mu, the friction of the interface; cycles are fitted by the spring's: "
            "give friction (tau/sigma) or tau"
        )
    t = time - time[0]
    loading = loading_of(record, displacement_of(record, t), time, loading)
    ends = np.append(loading.t[1:], np.inf)
    found = []
    for start, end, V_lp in zip(loading.t, ends, loading.V, strict=True):
        rows = (t >= start) & (t < end)
        if V_lp > 0.0 and rows.sum() >= FEWEST:
            found.append(Segment(time[rows], friction[rows], float(V_lp)))
    if not found:
        raise ParameterError(
            f"the record has no stretch of {FEWEST} samples at one load-point speed > 0; give a "
            f"longer one"
        )
    return found


def _measured(found):
    """`Measured` of the segments that have cycles, and warnings of those that do not."""
    measured, refused = [], []
    for segment in found:
        try:
            measured.append(measure(segment))
        except ParameterError as error:
            refused.append((segment.V_lp, error))
    if not measured:
        raise refused[0][1]
    return tuple(measured), [
        f"the record at {V_lp:.4g} m/s is left out: {error}" for V_lp, error in refused
    ]


def _enough(space, measured):
    """Refuse more unknowns than features."""
    count = sum(int(found.used.sum()) for found in measured)
    if space.size + 1 <= count:
        return
    listed = "; ".join(
        f"at {found.segment.V_lp:.4g} m/s "
        + ", ".join(name for name, used in zip(FEATURES, found.used, strict=True) if used)
        for found in measured
    )
    raise ParameterError(
        f"{space.size} free parameters ({', '.join(space.names)}) and mu0, but the record has only "
        f"{count} features of cycles: {listed}; leave known parameters out of free, or give a "
        f"record with another speed"
    )


def _at(problem, run):
    """Waves (s, q) of tau/sigma and features (s, 6) at a run's end."""
    values = problem.space.values(run.end[None])
    fitted = problem.model.features(values)[0][0]
    fitted[:, LEVEL] += run.mu0
    return problem.model.waves(values)[1][0] + run.mu0, fitted


def wave_at(wave):
    """A wave at the phases `GRID` as a function of phase."""
    return lambda phase: np.interp(phase % 1.0, GRID, wave)


def _result(problem, runs, said):
    """`CyclesFit` of the best run."""
    from scipy.special import chdtrc

    space, best = problem.space, runs[0]
    waves, fitted = _at(problem, best)
    dof = problem.levels.size - space.size - 1
    misfit = dof > 0 and chdtrc(dof, best.chi2) < CHANCE
    enlarged = float(np.sqrt(best.chi2 / dof)) if misfit else 1.0
    covariance = enlarged**2 * _covariance(best.jacobian)
    ended = [space.values(run.end[None]) for run in runs]
    run_values = tuple({s: float(end[s][0]) for s in PARAMETERS} for end in ended)
    alike = [i for i in _distinct(runs, covariance)[1:] if runs[i].chi2 - best.chi2 < EQUAL]
    to_log = np.eye(space.size + 1)
    to_log[:-1, :-1] = space.to_logarithms(best.end)
    moved, covariance = covariance, to_log @ covariance @ to_log.T
    names = (*space.names, "mu0")
    errors = np.sqrt(np.diag(covariance))
    profiles = Profiles(problem, best, names, moved, errors, enlarged)
    ends = np.array([profiles.ends(i) for i in range(len(names))])
    estimates = {**{s: run_values[0][s] for s in space.names}, "mu0": best.mu0}
    words, vague = identified(space.names, covariance[:-1, :-1], len(problem.measured))
    found = CyclesFit(
        names,
        estimates,
        covariance,
        ends,
        run_values[0],
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


def _covariance(jacobian):
    """(k, k) inverse of the normal matrix; what no feature depends on has an error of `WIDEST`."""
    _, size, axes = np.linalg.svd(np.nan_to_num(jacobian), full_matrices=False)
    return (axes.T / np.maximum(size, 1.0 / WIDEST) ** 2) @ axes


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
