"""The fits of one record under all laws that are asked for."""

from ..messages import fitting as sentences
from .cycles.fit import fit_cycles
from .cycles.result import cycles_dataset
from .diagnostics.misfit import is_misfit
from .generalized_least_squares import least_squares_fit
from .likelihood.uncertainty import infer, with_posteriors
from .record import record_of
from .result import add_comparison, dataset_of
from .unknowns import free_under


def fits_of_cycles(data, settings, loading):
    """dict law -> Dataset of a fit of cycles.

    data, loading : as of `fit`, whose errors are raised, data in SI; settings : `Settings`
    """
    fits = {
        one.law: fit_cycles(data, one, settings.free, one.law, loading) for one in settings.sliders
    }
    results = {law: cycles_dataset(fit) for law, fit in fits.items()}
    if len(results) > 1:
        # errors that were enlarged for a misfit are so in the comparison as well
        scale = min(fit.enlarged for fit in fits.values()) ** 2
        chi2 = {law: fit.chi2 / scale for law, fit in fits.items()}
        add_comparison(results, chi2, fits=any(fit.enlarged == 1.0 for fit in fits.values()))
    return results


def fits_of_samples(data, settings, loading):
    """dict law -> Dataset of a fit of friction, sample by sample; else as `fits_of_cycles`."""
    return datasets_of(inferences_of(data, settings, loading), settings.laws, data)


def inferences_of(data, settings, loading=None):
    """list of `Inference`, for each law, of a fit of friction; arguments as of `fits_of_cycles`."""
    noise, errors = settings.noise, settings.errors
    solutions = solutions_of(data, settings, loading)
    inferences = [infer(solution, noise, errors) for solution in solutions]
    return with_posteriors(inferences) if errors == "posterior" else inferences


def solutions_of(data, settings, loading=None):
    """list of `Solution`, as `inferences_of`: estimates alone, without their errors."""
    free, sliders, noise, against, trend, start, _ = settings
    record = record_of(data, sliders[0], loading=loading, trend=trend, against=against)
    if "alpha" in free and record.loading.normal_stress is None:
        raise sentences.refusal("free.constant_sigma")
    solutions = []
    for one in sliders:
        has = free_under([one.friction_law])
        of_law = tuple(name for name in free if name in has)
        solutions.append(least_squares_fit(record, one, of_law, noise, start))
    return solutions


def datasets_of(inferences, laws, data):
    """dict law -> Dataset of each `Inference`, with the comparison of several; laws : names."""
    datasets = [dataset_of(inference, data) for inference in inferences]
    results = dict(zip(laws, datasets, strict=True))
    if len(results) > 1:
        colored = any(inference.solution.noise.red for inference in inferences)
        aic = {law: float(result["aic"]) for law, result in results.items()}
        fits = not all(map(is_misfit, inferences))
        add_comparison(results, aic, colored=colored, fits=fits)
    return results
