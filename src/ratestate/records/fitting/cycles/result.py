"""A fit of cycles as a Dataset."""

import numpy as np
import xarray

from ..variables import curve_variables, estimate_variables, labelled, text_variables
from .diagnostics import diagnose
from .features import FEATURES, LEVEL
from .fit import wave_at

# Shifts of phase [cycles] that are tried to align the model's cycle with the record's.
SHIFTS = np.linspace(-0.05, 0.05, 101)


def cycles_dataset(fit):
    """The result of `fit` for cycles, of a `CyclesFit`.

    Returns
    -------
    xarray.Dataset
        A scalar for each free parameter, ``mu0`` and ``a_minus_b`` [SI]; ``standard_error``,
        ``interval`` and ``correlation``; along ``segment`` and ``feature``: ``measured``,
        ``measured_error``, ``fitted`` [SI], ``used``; along ``segment``: ``segment_V``,
        ``cycles``; along ``start``:
        ``start_chi2``, ``start_status``, ``start_end`` (with ``free``; SI); along ``time``:
        ``friction``, ``friction_fit``, ``residual`` of the cycles that were fitted.  ``chi2``,
        ``identifiability`` and ``warnings``.
    """
    result = xarray.merge(
        [estimate_variables(fit.estimates), _features(fit), _starts(fit), _curves(fit)]
    )
    result["chi2"] = ((), fit.chi2, {"units": "1", "long_name": "chi-squared of the features"})
    return result.assign(text_variables(*diagnose(fit)))


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
        cycles = measured.cycles
        inside = (cycles.phase >= 0.0) & (cycles.phase < cycles.n)
        t, y, phase = measured.segment.t[inside], measured.segment.y[inside], cycles.phase[inside]
        model = wave_at(wave)
        trend = cycles.slope * (t - cycles.middle)
        curves = [model(phase + shift) + trend for shift in SHIFTS]
        best = int(np.argmin([np.sum((y - curve) ** 2) for curve in curves]))
        times.append(t)
        friction.append(y)
        fitted.append(curves[best])
    return curve_variables(*map(np.concatenate, (times, friction, fitted)))
