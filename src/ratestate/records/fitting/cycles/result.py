"""A fit of cycles as a Dataset."""

import numpy as np
import xarray

from ....dynamics.recorded_loading import record_loading
from ....model.loading import Loading
from ...kit.results import labelled
from ..result import curve_variables, estimate_variables, text_variables
from .diagnostics import diagnose
from .features import FEATURES, LEVEL
from .fit import wave_at

# Shifts of phase [cycles] that are tried to align the model's cycle with the record's.
SHIFTS = np.linspace(-0.05, 0.05, 101)


def cycles_dataset(fit):
    """The Dataset of a `CyclesFit`: estimates, features of the segments, starts, curves, texts."""
    result = xarray.merge(
        [estimate_variables(fit.estimates), _features(fit), _starts(fit), _curves(fit)]
    )
    result["chi2"] = ((), fit.chi2, {"units": "1", "long_name": "chi-squared of the features"})
    record_loading(result, _loading(fit, result["time"].values[0]))
    return result.assign(text_variables(*diagnose(fit)))


def _loading(fit, start):
    """The `Loading` of the segments that were fitted, from a time [s] of the record on."""
    first, *others = (measured.segment for measured in fit.measured)
    steps = ((float(one.t[0] - start), one.V_lp) for one in others)
    return Loading.steps(first.V_lp, *steps)


def _features(fit):
    """Features measured and fitted, in SI."""
    is_level = np.arange(len(FEATURES)) == LEVEL
    errors = np.sqrt([np.diag(m.covariance) for m in fit.measured])
    logs = np.array([m.values for m in fit.measured]), fit.fitted_features
    measured, fitted = (np.where(is_level, values, np.exp(values)) for values in logs)
    columns = {
        "measured": (measured, "feature measured, freed of noise's shift"),
        "measured_error": (np.where(is_level, errors, measured * errors), "its standard error"),
        "fitted": (fitted, "feature of the fit"),
        "used": ([m.used for m in fit.measured], "whether the record resolves the feature"),
    }
    tables = {
        name: (("segment", "feature"), v, {"units": "", "long_name": text})
        for name, (v, text) in columns.items()
    }
    speeds, cycles = zip(*((m.segment.V_lp, m.cycles.n) for m in fit.measured), strict=True)
    lists = labelled("segment", segment_V=list(speeds), cycles=list(cycles))
    return xarray.Dataset(tables | lists, {"feature": list(FEATURES)})


def _starts(fit):
    """Where each start ended."""
    names = fit.free
    ends = np.array([[values[n] for n in names] for values in fit.run_values])
    chi2 = np.array([run.chi2 for run in fit.runs])
    return xarray.Dataset(
        {
            "start_chi2": ("start", chi2, {"units": "1", "long_name": "chi-squared at its end"}),
            "start_status": ("start", [run.status for run in fit.runs]),
            "start_end": (("start", "free"), ends, {"units": "", "long_name": "its end [SI]"}),
        },
        {"free": list(names)},
    )


def _curves(fit):
    """The record's cycles, and the model's aligned with them."""
    times, friction, fitted = [], [], []
    for measured, wave in zip(fit.measured, fit.waves, strict=True):
        cycles, model = measured.cycles, wave_at(wave)
        samples = measured.segment.t, measured.segment.y, cycles.phase
        t, y, phase = (column[cycles.inside] for column in samples)
        trend = cycles.slope * (t - cycles.middle)
        curves = [model(phase + shift) + trend for shift in SHIFTS]
        times.append(t)
        friction.append(y)
        fitted.append(min(curves, key=lambda curve: np.sum((y - curve) ** 2)))
    return curve_variables(*map(np.concatenate, (times, friction, fitted)))
