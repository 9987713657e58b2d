"""The fit of a record of stick-slip or vibration by features of its limit cycles."""

from typing import NamedTuple

import numpy as np
import scipy
import xarray

from ....dynamics.recipe import record_loading
from ....errors import ParameterError
from ....model.loading import Loading
from ....model.quantities import readable
from ...kit import labelled
from ...messages import fitting as sentences
from ..checks import search_warnings
from ..fit_dataset import curve_variables, estimate_variables, text_variables
from ..identifiability import identifiability
from ..inference import Inference, infer_quantities
from ..solutions import solution_from
from ..unknowns import distinct
from .folding import sliding_segments
from .measured import corrected, measure
from .problem import CyclesProblem, FeatureNoise, check_slider, starting_points
from .waves import FEATURES, LEVEL, wave_at

# Significance level of a misfit, beyond which errors are enlarged.
CHANCE = 0.01
# Distance between ends of distinct runs, in standard errors; difference of chi-squared between
# runs that fit equally well.
DISTINCT, EQUAL = 4.0, 4.0
# Shifts of phase [cycles] that are tried to align the model's cycle with the record's.
SHIFTS = np.linspace(-0.05, 0.05, 101)


class CyclesFit(NamedTuple):
    """Parameters of a slider from a record's cycles."""

    inference: Inference  # its solution has the errors of the features enlarged
    runs: list  # `Solution` from each start, the best first
    enlarged: float  # factor by which errors are enlarged because of a misfit
    left_out: list  # warnings on segments that have no cycles
    features: np.ndarray  # (s, 6) of the fitted cycles
    waves: np.ndarray  # (s, q)

    @property
    def problem(self):
        return self.inference.solution.problem

    @property
    def chi2(self):
        """Chi-square of the features with errors that are not enlarged."""
        return self.enlarged**2 * self.inference.solution.chi2


def fit_cycles(record, slider, free, loading=None):
    """Return the `CyclesFit` of a record; it includes all segments that oscillate."""
    segments = sliding_segments(record, slider, loading)
    check_slider(slider, free)
    measured, left_out = _measured_segments(segments)
    problem = CyclesProblem(slider, free, measured)
    runs = _solutions_from(problem, starting_points(problem))
    # The model's cycle has no noise, and so gives a better estimate of the shift by noise.
    features, waves = runs[0].problem.forward.cycles(runs[0].point[None])
    measured = tuple(map(corrected, measured, map(wave_at, waves[0]), features[0]))
    problem = CyclesProblem(slider, free, measured)
    runs = _solutions_from(problem, [run.point for run in runs])
    best, dof = runs[0], problem.dof
    misfit = dof > 0 and scipy.special.chdtrc(dof, best.chi2) < CHANCE
    enlarged = float(np.sqrt(best.chi2 / dof)) if misfit else 1.0
    noise = FeatureNoise(enlarged * problem.noise.root)
    solution = best._replace(
        problem=best.problem.bounded_about(best.point),
        noise=noise,
        root=enlarged * best.root,
        chi2=best.chi2 / enlarged**2,
    )
    forward = solution.problem.forward
    inference = infer_quantities(solution, forward.quantities(), noise)
    features, waves = forward.cycles(inference.solution.point[None])
    return CyclesFit(inference, runs, enlarged, left_out, features[0], waves[0])


def _measured_segments(segments):
    """Return `MeasuredFeatures` (tuple), and warnings on segments without cycles."""
    measured, refused = [], []
    for segment in segments:
        try:
            measured.append(measure(segment))
        except ParameterError as error:
            refused.append((segment.V_lp, error))
    if not measured:
        raise refused[0][1]
    warnings = [sentences("cycles.left_out", V_lp=V_lp, error=error) for V_lp, error in refused]
    return tuple(measured), warnings


def _solutions_from(problem, starts):
    """Return `Solution`s (list), the best first; ParameterError if none has a cycle."""
    runs = []
    for start in starts:
        try:
            runs.append(solution_from(problem.bounded_about(start), start, problem.noise))
        except ParameterError:
            continue  # no cycle there
    if not runs:
        names = ", ".join(problem.unknowns.names[:-1])
        raise sentences.refusal("cycles.no_cycle", names=names, law=problem.law.name)
    return sorted(runs, key=lambda run: run.chi2)


def cycles_datasets(data, settings, loading):
    """Return law -> Dataset of a record's cycles, their chi-squared, and whether any law fits.

    chi-squared has the errors as enlarged under the law that fits best.
    """
    fits = [fit_cycles(data, slider, settings.free, loading) for slider in settings.sliders]
    results = dict(zip(settings.laws, map(cycles_dataset, fits), strict=True))
    least = min(fit.enlarged for fit in fits)
    return results, [fit.chi2 / least**2 for fit in fits], least == 1.0


def cycles_dataset(fit):
    measured = fit.problem.measured
    result = xarray.merge(
        [
            estimate_variables(fit.inference.estimates),
            _feature_variables(measured, fit.features),
            _start_variables(fit.runs),
            _curves(measured, fit.waves),
        ]
    )
    result["chi2"] = ((), fit.chi2, {"units": "1", "long_name": "chi-squared of the features"})
    first, *later = (m.segment for m in measured)
    start = result["time"].values[0]
    steps = ((float(segment.t[0] - start), segment.V_lp) for segment in later)
    record_loading(result, Loading.steps(first.V_lp, *steps))
    return result.assign(text_variables(*diagnose(fit)))


def _feature_variables(measured, fitted):
    """Return measured and fitted features in SI."""
    is_level = np.arange(len(FEATURES)) == LEVEL
    errors = np.sqrt([np.diag(m.covariance) for m in measured])
    logs = np.array([m.values for m in measured]), fitted
    values, fitted = (np.where(is_level, x, np.exp(x)) for x in logs)
    columns = {
        "measured": (values, "feature measured, freed of noise's shift"),
        "measured_error": (np.where(is_level, errors, values * errors), "its standard error"),
        "fitted": (fitted, "feature of the fit"),
        "used": ([m.used for m in measured], "whether the record resolves the feature"),
    }
    tables = {
        name: (("segment", "feature"), v, {"units": "", "long_name": text})
        for name, (v, text) in columns.items()
    }
    speeds, cycles = zip(*((m.segment.V_lp, m.cycles.n) for m in measured), strict=True)
    lists = labelled("segment", segment_V=list(speeds), cycles=list(cycles))
    return xarray.Dataset(tables | lists, {"feature": list(FEATURES)})


def _start_variables(runs):
    """Return the end of the search from each start."""
    names = runs[0].unknowns.names[:-1]
    status = [
        "at a bound" if run.at_bound else "converged" if run.converged else "not converged"
        for run in runs
    ]
    chi2 = [run.chi2 for run in runs]
    ends = [[end[name] for name in names] for end in map(_end_of, runs)]
    return xarray.Dataset(
        {
            "start_chi2": ("start", chi2, {"units": "1", "long_name": "chi-squared at its end"}),
            "start_status": ("start", status),
            "start_end": (("start", "free"), ends, {"units": "", "long_name": "its end [SI]"}),
        },
        {"free": list(names)},
    )


def _end_of(run):
    return {s: float(v[0]) for s, v in run.problem.forward.values(run.point[None]).items()}


def _curves(measured, waves):
    """Return the record's cycles, and the model's cycles aligned with them."""
    parts = []
    for m, wave in zip(measured, waves, strict=True):
        cycles, model = m.cycles, wave_at(wave)
        samples = m.segment.t, m.segment.y, cycles.phase
        t, y, phase = (column[cycles.inside] for column in samples)
        trend = cycles.slope * (t - cycles.middle)
        curves = [model(phase + shift) + trend for shift in SHIFTS]
        parts.append((t, y, min(curves, key=lambda curve: np.sum((y - curve) ** 2))))
    return curve_variables(*map(np.concatenate, zip(*parts, strict=True)))


def diagnose(fit):
    """Return a note on what is determined (str), and warnings (list of str)."""
    note, warnings = identifiability(fit.inference)
    notes = [note, sentences("cycles.numbers")]
    notes += [f"{text[0].upper()}{text[1:]}." for m in fit.problem.measured for text in m.notes]
    return " ".join(notes), [
        *fit.left_out,
        *(text for m in fit.problem.measured for text in m.warnings),
        *search_warnings(fit.inference._replace(solution=fit.runs[0])),
        *_misfit(fit),
        *_equal_fits(fit),
        *warnings,
    ]


def _misfit(fit):
    """Yield a warning if the fit is off by more than errors, with the features."""
    if fit.enlarged == 1.0:
        return
    off = []
    for measured, features in zip(fit.problem.measured, fit.features, strict=True):
        difference = features - measured.values
        errors = np.sqrt(np.diag(measured.covariance))
        for i in np.flatnonzero(measured.used & (np.abs(difference) > 2.0 * errors)):
            by = difference[i]
            size = f"{by:.2g}" if i == LEVEL else f"{100 * np.expm1(by):.2g} %"
            off.append(f"{FEATURES[i]} by {size}")
    values = {"law": fit.problem.law.name, "chi2": fit.chi2, "dof": fit.problem.dof}
    listed = f"; off: {', '.join(off)}" if off else ""
    yield sentences("cycles.misfit", **values, off=listed, enlarged=fit.enlarged)


def _equal_fits(fit):
    """Yield warnings on other minima that fit as well."""
    errors = fit.inference.solution.errors[:-1]
    # coordinate by coordinate, because the covariance misleads along a curved valley
    for i in distinct([run.point[:-1] for run in fit.runs], DISTINCT * errors)[1:]:
        if fit.runs[i].chi2 - fit.runs[0].chi2 < EQUAL:
            end = _end_of(fit.runs[i])
            names = fit.problem.unknowns.names[:-1]
            values = ", ".join(f"{name} = {readable(name, end[name])}" for name in names)
            yield sentences("cycles.alike", values=values)
