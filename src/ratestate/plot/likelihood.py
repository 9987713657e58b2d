"""What a record tells of single parameters: profiles of the likelihood, posteriors."""

import numpy as np

from ..records.fitting.by_law import results_by_law
from ..records.fitting.unknowns import DERIVED, parameter
from ..report.fits import estimated_symbols
from .labels import GRAY, LAWS, in_unit, label, scaled

#: relative likelihood at the ends of the 95 % interval, exp(-3.84/2)
END_95 = 0.1465
BINS = 40
#: part of a posterior at each end of it that a histogram leaves out
TAIL = 0.002


def non_gaussian(result):
    """list of the free parameters with a likelihood to draw: those of a finite standard error.

    Empty if there is no profile or posterior of any, under any law.
    """
    laws = results_by_law(result)
    free = {s: _those_with(laws, s).values() for s in estimated_symbols(laws) if s not in DERIVED}
    drawn = (_profile(p, s) or _samples(p, s) is not None for s, has in free.items() for p in has)
    if not any(drawn):
        return []
    return [
        s for s, has in free.items() if all(np.isfinite(_standard_error(part, s)) for part in has)
    ]


def _those_with(laws, symbol):
    """Of the laws (law -> part) those under which a parameter was estimated."""
    return {law: part for law, part in laws.items() if symbol in part["parameter"].values}


def _standard_error(part, symbol):
    return float(part["standard_error"].sel(parameter=symbol))


def likelihood(result, symbol, ax):
    """Draw a parameter's likelihood as a line (profile, or else Gaussian), a posterior filled."""
    laws = _those_with(results_by_law(result), symbol)
    largest = max(abs(float(part[symbol])) for part in laws.values())
    factor, unit = scaled(symbol, largest)
    for law, part in laws.items():
        color = LAWS[law].color
        if (samples := _samples(part, symbol)) is not None:
            ends = np.quantile(samples, (TAIL, 1.0 - TAIL))
            counts, edges = np.histogram(samples, BINS, tuple(ends))
            ax.stairs(counts / counts.max(), factor * edges, fill=True, color=color, alpha=0.25)
        values, deviance = _profile(part, symbol) or _gaussian(part, symbol)
        ax.plot(factor * values, np.exp(-0.5 * deviance), lw=1.1, **LAWS[law].line)
        ax.axvline(factor * float(part[symbol]), color=color, lw=0.7, ls=":")
    ax.axhline(END_95, color=GRAY, lw=0.7)
    ax.set(ylim=(0.0, 1.08), xlabel=in_unit(label(symbol), unit))


def _profile(part, symbol):
    """Values and deviances of a profile, finely; None where there is none."""
    from scipy.interpolate import PchipInterpolator

    if "profile_value" not in part:
        return None
    values, deviance = (
        part[name].sel(parameter=symbol).values for name in ("profile_value", "profile_deviance")
    )
    known = np.isfinite(values) & np.isfinite(deviance)
    values, deviance = values[known], deviance[known]
    if values.size < 3:
        return None
    fine = np.linspace(values[0], values[-1], 200)
    # between its points the root of the deviance is smooth, and nearly straight
    side = np.where(values < values[np.argmin(deviance)], -1.0, 1.0)
    return fine, PchipInterpolator(values, side * np.sqrt(deviance))(fine) ** 2


def _gaussian(part, symbol):
    """The same as `_profile`, of a Gaussian in the logarithm, or in what moves as itself."""
    value, z = float(part[symbol]), np.linspace(-3.0, 3.0, 200)
    error = _standard_error(part, symbol)
    is_log = parameter(symbol).is_log
    return (value * np.exp(error / value * z) if is_log else value + error * z), z**2


def _samples(part, symbol):
    """Samples of the posterior, or None."""
    if "posterior" not in part:
        return None
    samples = part["posterior"].sel(parameter=symbol).values
    return samples if np.isfinite(samples).all() and np.ptp(samples) > 0.0 else None
