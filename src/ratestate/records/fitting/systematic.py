"""Systematic errors of a record: times of steps, and the rounding of friction.

A systematic error is an unknown number with a standard normal prior, times a column: the change of
friction at all samples by one standard error.  Columns U add U U^T to the covariance of the noise.

A step of the load point is recorded with an error of time.  Friction is recorded in digits.  If the
noise is below half a digit, the rounding error of a mean does not vanish, because it is a periodic
function of friction.  Gaussian noise of standard deviation s multiplies the k-th harmonic of this
function by exp(-2 (pi k s)^2), with s in digits (Widrow, Kollar & Liu 1996 doi:10.1109/19.492748).
"""

import numpy as np

from ..kit.sample_noise import OF_STEP, digit_of
from .forward import Forward
from .problem import change_times

#: harmonics of the rounding error; most runs of samples with a rounding error in common
HARMONICS, RUNS = np.arange(1, 20), 60
#: relaxation time of noise that dithers, divided by the duration of the record
FAST = 0.01
#: systematic errors change chi-square by less than this number on average, and are left out
NEGLIGIBLE = 0.01


def least_noise(record):
    """Return the standard deviation of white noise by rounding friction; 0 without digits."""
    return OF_STEP * digit_of(record.friction)


def systematic_errors(problem, point, fitted, noise):
    """Return the columns (m, r) of a record's systematic errors; None if all are negligible.

    problem, point : `SamplesProblem` and its coordinates (k,)
    fitted : (m,) friction at the point
    noise : `Noise` of the samples
    """
    if problem.kind != "samples":
        return None
    columns = np.column_stack(
        [_of_step_times(problem, point, fitted), _of_rounding(problem.record, fitted, noise)]
    )
    white, _ = noise.whiten(problem.t, columns)
    columns = columns[:, np.sum(white**2, axis=0) > NEGLIGIBLE]
    return columns if columns.shape[1] else None


def _of_step_times(problem, point, fitted):
    """Return changes of friction (m, 2 n) if one of n steps is late or early by its error of time.

    Both changes differ if the machine is stiff.  Each has half of the variance.
    There are none if a lag is free, or if the machine is rigid: its friction jumps at a step.
    """
    record, names = problem.record, problem.unknowns.names
    rise, errors = np.diff(record.loading.V), record.step_errors
    known = errors > 0.0
    if not known.any() or "lag" in names or np.isinf(problem.slider.K):
        return np.zeros((fitted.size, 0))
    forward = Forward(record, problem.slider, names)
    start, error = record.loading.t[1:][known, None], errors[known, None]
    rise = rise[known, None]
    begins, ends = np.concatenate([start, start - error]), np.concatenate([start + error, start])
    forward.push(np.maximum(begins, 0.0), ends, np.concatenate([-rise, rise]))
    changes = forward.friction(np.tile(point, (len(begins), 1))) - fitted
    return 0.5**0.5 * np.nan_to_num(changes).T


def _of_rounding(record, fitted, noise):
    """Return the rounding errors (m, r) in `RUNS` longest runs of samples within a digit.

    Between changes of loading, digits count from the last friction, so that steady friction is in
    the middle of a digit.
    """
    digit = digit_of(record.friction)
    if digit == 0.0:
        return np.zeros((fitted.size, 0))
    variances, times = noise.relaxations(record.spacing)
    fast = noise.white**2 + variances[times < FAST * record.t[-1]].sum()
    dither = max(fast / digit**2 - OF_STEP**2, 0.0)  # the residuals include the rounding errors
    sizes = np.exp(-2.0 * dither * (np.pi * HARMONICS) ** 2) / (np.pi * HARMONICS)
    part = np.searchsorted(change_times(record.loading), record.t, side="right")
    last = np.searchsorted(part, part, side="right") - 1
    counts = np.round((fitted - fitted[last]) / digit)
    starts = np.flatnonzero((np.diff(counts) != 0.0) | (np.diff(part) != 0)) + 1
    lengths = np.diff(starts, prepend=0, append=fitted.size)
    run = np.repeat(np.arange(lengths.size), lengths)
    longest = np.argsort(-lengths, kind="stable")[:RUNS]
    return digit * np.sqrt(0.5 * sizes @ sizes) * (run[:, None] == longest)
