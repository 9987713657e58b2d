"""Features of a record with their errors, and the effect of noise on them.

Noise shifts features: it enlarges the largest value, and displaces cuts.  A parametric bootstrap
gives the shift and the covariance of the features.  A cycle without noise is sampled as the
record is, noise of the record's size and correlation is added, and the features are measured.
If cycles differ from each other by more than such noise explains, the errors are enlarged to
their scatter.
"""

from typing import NamedTuple

import numpy as np
import scipy

from ...kit.sample_noise import SampleNoise
from ...messages import fitting as sentences
from .folding import (
    FEWEST_CYCLES,
    Cycles,
    Segment,
    cut_cycles,
    fold,
    main_period,
    periodic,
    regular_cuts,
    thinned,
)
from .waves import AMPLITUDE, DROP, FEATURES, HIGH, LEVEL, PERIOD, RISE, profile_features

# Least and largest number of bins of a profile; target of a bin's noise, divided by the amplitude.
BINS, BIN_NOISE = (24, 128), 0.01
# Number of artificial records, and the seed of their noise.
COPIES, SEED = 80, 20190117
# Least relative error of features: that of a machine's speed and stress.
MACHINE_ERROR = 1e-3
# Significance level of differences between cycles.
CHANCE = 0.005
# Shortest part of the period that is resolved, in bins; largest error of a resolved logarithm.
RESOLVED, UNCERTAIN = 1.5, 0.3
# Trend over the cycles, as a fraction of the amplitude, below which it is not mentioned.
DRIFT = 0.1


class MeasuredFeatures(NamedTuple):
    """Features of a segment; logarithms, except the level."""

    segment: Segment  # without the cycles left out
    cycles: Cycles
    noise: SampleNoise  # of tau/sigma
    raw: np.ndarray  # (6,) features that noise has shifted
    left_out: tuple  # notes on cycles left out
    # set by `corrected`
    values: np.ndarray = np.full(len(FEATURES), np.nan)  # (6,) corrected for the shift
    covariance: np.ndarray = np.eye(len(FEATURES))
    used: np.ndarray = np.zeros(len(FEATURES), bool)  # whether the record resolves the feature
    notes: tuple = ()  # on cycles left out, on the trend, on features that are not resolved
    warnings: tuple = ()  # on scatter


def measure(segment):
    """Return the `MeasuredFeatures` of a segment."""
    period = main_period(segment.t, segment.y)
    segment = thinned(segment, period)
    cuts, left_out = regular_cuts(segment, period)
    bins = _number_of_bins(segment, fold(segment.t, segment.y, cuts, BINS[0]))
    cycles = fold(segment.t, segment.y, cuts, bins)
    raw = _features(cycles)
    measured = MeasuredFeatures(segment, cycles, _residual_noise(segment, cycles), raw, left_out)
    return corrected(measured, lambda phase: periodic(cycles.profile, phase), raw)


def corrected(measured, wave, features):
    """Return `MeasuredFeatures` with shift and covariance from a bootstrap about a cycle.

    wave : function of phases in cycles, returns tau/sigma, which falls through its middle at 0
    features : (6,) of that cycle, without noise
    """
    segment, cycles = measured.segment, measured.cycles
    bins = cycles.profile.size
    rng = np.random.default_rng(SEED)
    phase = (segment.t - cycles.cuts[0]) / cycles.period
    sample = float(np.median(np.diff(phase)))
    copies = []
    for _ in range(COPIES):
        # the phase is uncertain by the spacing of samples
        clean = wave(phase + sample * rng.uniform(-0.5, 0.5))
        y = clean + measured.noise.draw(clean.size, rng)
        cuts = cut_cycles(segment.t, y, cycles.period)
        if cuts.size > FEWEST_CYCLES:
            copies.append(fold(segment.t, y, cuts, bins))
    if len(copies) < COPIES // 2:
        amplitude = np.exp(measured.raw[AMPLITUDE])
        raise sentences.refusal(
            "cycles.lost_in_noise", amplitude=amplitude, noise=measured.noise.sd
        )
    drawn = np.array([_features(copy) for copy in copies])
    true = np.array(features)
    true[PERIOD] = np.log(cycles.period)
    shift = np.nanmean(drawn, axis=0) - true
    filled = np.where(np.isfinite(drawn), drawn, np.nanmean(drawn, axis=0))
    covariance = np.cov(filled.T)
    # variances in excess of the noise; 0 if chance explains the excess
    scatter, typical = _scatter(cycles), np.mean([_scatter(copy) for copy in copies], axis=0)
    limit = scipy.special.chdtri(cycles.n - 1, CHANCE) / (cycles.n - 1)
    with np.errstate(invalid="ignore"):
        excess = np.where(scatter > limit * typical, scatter - typical, 0.0)
    covariance += np.diag(excess + np.where(np.arange(excess.size) == LEVEL, 0.0, MACHINE_ERROR**2))
    error = np.sqrt(np.diag(covariance))
    parts = np.exp(measured.raw - measured.raw[PERIOD]) * bins
    used = np.isfinite(measured.raw) & (error < UNCERTAIN)
    within = [RISE, HIGH, DROP]
    used[within] &= parts[within] > RESOLVED
    used[LEVEL] = True
    values = np.where(np.isfinite(measured.raw), measured.raw - np.nan_to_num(shift), np.nan)
    notes, warnings = _notes(measured, excess, used)
    return measured._replace(
        values=values, covariance=covariance, used=used, notes=notes, warnings=warnings
    )


def _notes(measured, excess, used):
    """Return notes on trend and resolution, and warnings on scatter."""
    cycles, V_lp = measured.cycles, measured.segment.V_lp
    notes, warnings = [*measured.left_out], []
    drift = cycles.slope * (cycles.cuts[-1] - cycles.cuts[0])
    if abs(drift) > DRIFT * float(np.ptp(cycles.profile)):
        notes.append(sentences("cycles.trend", V_lp=V_lp, drift=drift))
    if not used[DROP]:
        notes.append(sentences("cycles.short_drop", V_lp=V_lp))
    if excess.any():
        names = ", ".join(name for name, more in zip(FEATURES, excess, strict=True) if more > 0.0)
        warnings.append(sentences("cycles.scatter", names=names, V_lp=V_lp))
    return tuple(notes), tuple(warnings)


def _number_of_bins(segment, rough):
    """Return the number of bins for which noise is small and no bin is empty."""
    inside = int(np.sum(rough.inside))
    noise = _residual_noise(segment, rough).sd
    amplitude = float(np.ptp(rough.profile))
    quiet = inside * (BIN_NOISE * amplitude / noise) ** 2 if noise > 0.0 else np.inf
    filled = min(inside / 4, inside / rough.n)
    return int(np.clip(min(quiet, filled), *BINS))


def _features(cycles):
    return profile_features(cycles.profile[None], np.array([cycles.period]))[0]


def _scatter(cycles):
    """Return variances (6,) of features from differences between cycles (jackknife)."""
    n = cycles.n
    copies = profile_features(cycles.leave_one_out, np.full(n, cycles.period))
    with np.errstate(invalid="ignore"):
        variance = (n - 1) / n * np.sum((copies - copies.mean(axis=0)) ** 2, axis=0)
    periods = np.diff(cycles.cuts)
    variance[PERIOD] = periods.var(ddof=1) / n / cycles.period**2
    variance[LEVEL] = cycles.means.var(ddof=1) / n
    return variance


def _residual_noise(segment, cycles):
    """Return the `SampleNoise` about the folded cycle, robust against outliers."""
    t, phase = segment.t[cycles.inside], cycles.phase[cycles.inside]
    folded = periodic(cycles.profile, phase) + cycles.slope * (t - cycles.middle)
    residual = segment.y[cycles.inside] - folded
    residual -= np.interp(phase, np.arange(cycles.n) + 0.5, cycles.means)
    sd = 1.4826 * float(np.median(np.abs(residual)))
    sd *= np.sqrt(residual.size / max(residual.size - cycles.profile.size, 0.25 * residual.size))
    residual = np.clip(residual, -3.0 * sd, 3.0 * sd)
    power = float(residual @ residual)
    correlation = float(residual[1:] @ residual[:-1]) / power if power > 0.0 else 0.0
    # white noise has 0 within 3 standard errors
    correlation = 0.0 if abs(correlation) < 3.0 / np.sqrt(residual.size) else correlation
    return SampleNoise(sd, float(np.clip(correlation, 0.0, 0.99)))
