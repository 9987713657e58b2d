"""A fit of cycles as a Dataset."""

import numpy as np
import xarray

from ....model.quantities import attrs
from ..result import Estimates, estimate_variables, text_variables
from .features import FEATURES, LEVEL
from .fit import wave_at

# Shifts of phase, in cycles, that are tried to lay the model's cycle over the record's.
SHIFTS = np.linspace(-0.05, 0.05, 101)


def cycles_dataset(found):
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
        [estimate_variables(_estimates(found)), _features(found), _starts(found), _curves(found)]
    )
    result["chi2"] = ((), found.chi2, {"units": "1", "long_name": "chi-squared of the features"})
    return result.assign(text_variables(found.identifiability, found.warnings))


def _estimates(found):
    """`Estimates` in SI."""
    errors = np.sqrt(np.diag(found.covariance))
    values = np.array([found.estimates[name] for name in found.names])
    plain = np.array([name not in found.free for name in found.names])
    with np.errstate(over="ignore"):
        ends = np.where(plain[:, None, None], found.ends, np.exp(found.ends))
    correlation = found.covariance / np.outer(errors, errors)
    scale = np.where(plain, 1.0, values)
    return Estimates(found.names, values, scale * errors, ends, correlation, found.kinds)


def _features(found):
    """Features measured and fitted, in SI."""
    plain = np.arange(len(FEATURES)) == LEVEL
    used = np.array([m.used for m in found.measured])
    values = np.array([m.values for m in found.measured])
    errors = np.sqrt([np.diag(m.covariance) for m in found.measured])
    measured = np.where(plain, values, np.exp(values))
    columns = {
        "measured": (measured, "feature measured, freed of noise's shift"),
        "measured_error": (np.where(plain, errors, measured * errors), "its standard error"),
        "fitted": (np.where(plain, found.fitted, np.exp(found.fitted)), "feature of the fit"),
        "used": (used, "whether the record resolves the feature"),
    }
    tables = {
        name: (("segment", "feature"), v, {"units": "", "long_name": text})
        for name, (v, text) in columns.items()
    }
    each = {
        "segment_V": [m.segment.V_lp for m in found.measured],
        "cycles": [m.cycles.n for m in found.measured],
    }
    lists = {name: ("segment", v, attrs(name)) for name, v in each.items()}
    return xarray.Dataset(tables | lists, {"feature": list(FEATURES)})


def _starts(found):
    """Where each start ended."""
    names = found.free
    ends = np.array([[values[n] for n in names] for values in found.run_values])
    chi2 = np.array([run.chi2 for run in found.runs])
    return xarray.Dataset(
        {
            "start_chi2": ("start", chi2, {"units": "1", "long_name": "chi-squared at its end"}),
            "start_status": ("start", [run.status for run in found.runs]),
            "start_end": (("start", "free"), ends, {"units": "", "long_name": "its end [SI]"}),
        },
        {"free": list(names)},
    )


def _curves(found):
    """The record's cycles, and the model's laid over them."""
    times, friction, fit = [], [], []
    for measured, wave in zip(found.measured, found.waves, strict=True):
        cycles = measured.cycles
        inside = (cycles.phase >= 0.0) & (cycles.phase < cycles.n)
        t, y, phase = measured.segment.t[inside], measured.segment.y[inside], cycles.phase[inside]
        model = wave_at(wave)
        trend = cycles.slope * (t - cycles.middle)
        curves = [model(phase + shift) + trend for shift in SHIFTS]
        best = int(np.argmin([np.sum((y - curve) ** 2) for curve in curves]))
        times.append(t)
        friction.append(y)
        fit.append(curves[best])
    y, model = np.concatenate(friction), np.concatenate(fit)
    left = {"units": "1", "long_name": "recorded less fitted friction"}
    return xarray.Dataset(
        {
            "friction": ("time", y, attrs("friction")),
            "friction_fit": ("time", model, attrs("friction_fit")),
            "residual": ("time", y - model, left),
        },
        {"time": ("time", np.concatenate(times), attrs("time"))},
    )
