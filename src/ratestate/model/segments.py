"""Make histories from the rows of a record, or of a sinusoid."""

from typing import Any

import numpy as np

from .arrays import check_aligned
from .history import History
from .names import refusal
from .units import is_array, to_si

#: largest number of lines of a sinusoid, and of its speeds in all cases of a sweep
MAX_LINES = 10**6
MAX_SPEEDS = 10**7
#: lines per period of a sinusoid, a multiple of 4: the error is at most 5.1e-5 of the amplitude for
#: the speed, and 1.3e-7 of the amplitude for the displacement
LINES_PER_PERIOD = 256


def sinusoid_history(V_lp, amplitude, period, t_end):
    """Return the `History` of V_lp + amplitude sin(2 pi t/period) [m/s] to t_end [s].

    Raises ParameterError for too many lines, a period that is too short, and a negative speed.

    V_lp, amplitude : float or DataArray

    Notes
    -----
    The fundamental of the lines is exactly this sinusoid.  Straight lines between N points per
    period, on a sine of amplitude A', have a fundamental of amplitude A' sinc^2(pi/N), with
    sinc(x) = sin(x)/x.  So the points lie on a sine of amplitude A/sinc^2(pi/N).  The harmonics
    m = N - 1, N + 1, 2 N - 1, ... remain, with amplitude A/m^2.  The points avoid the extremes of
    the sine, so that the lines stay within V_lp +- amplitude, and the speed is never negative.
    """
    if is_array(period):
        raise refusal("sinusoid.periods")
    check_aligned({"V_lp": V_lp, "amplitude": amplitude})
    if np.any(np.greater(amplitude, V_lp)):
        largest, least = float(np.max(amplitude)), float(np.min(V_lp))
        raise refusal("sinusoid.moves_back", amplitude=largest, V_lp=least)
    periods, cases = t_end / period, np.size(V_lp + amplitude)
    needed = periods * LINES_PER_PERIOD
    if not (needed <= MAX_LINES and needed * cases <= MAX_SPEEDS):
        limits = {"most": MAX_LINES, "most_in_all": MAX_SPEEDS}
        sizes = {"periods": periods, "needed": needed, "cases": cases}
        raise refusal("sinusoid.too_long", t_end=t_end, **sizes, **limits)
    n = LINES_PER_PERIOD
    odd = np.arange(1, 2 * n, 2)
    half = np.sin(np.pi * odd[: n // 2] / n)
    heights = np.concatenate([half, -half]) / np.sinc(1 / n) ** 2
    number = int(needed) + 2
    ends = np.arange(number) // n + np.resize(odd / (2 * n), number)  # in periods
    t = np.concatenate([[0.0], ends * period])
    wave: Any = np.concatenate([[0.0], np.resize(heights, number)])
    if is_array(V_lp) or is_array(amplitude):
        import xarray

        wave = xarray.DataArray(wave, dims="segment")
    V = V_lp + amplitude * wave
    V = V.transpose(..., "segment") if is_array(V) else V
    keep = int(np.searchsorted(t, t_end))
    history = History("V_lp", t[:keep], V[..., :keep], V[..., 1 : keep + 1], float(t[keep]))
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        if not (np.diff(t[: keep + 1]) > 0).all() or not np.isfinite(history.rate).all():
            raise refusal("sinusoid.short_period", period=period)
    return history


def period_of(name, period, frequency):
    """Return the period [s] of `what` from its period or frequency."""
    if (period is None) == (frequency is None):
        raise refusal("sinusoid.no_period", what=name)
    if frequency is None:
        return to_si("period", period, bound="> 0")
    with np.errstate(divide="ignore"):
        period = 1.0 / to_si("frequency", frequency, bound="> 0")
    if not np.all((period > 0.0) & (period < np.inf)):
        raise refusal("sinusoid.frequency", frequency=frequency)
    return period


def histories_from_rows(times, V, sigma=None):
    """Return the `History` of a record's speed, and of its normal stress or None.

    Arguments are columns in SI.  Raises ParameterError unless the rows are a valid record.
    """
    if is_array(times) or times.size < 2 or V.shape[-1] != times.size:
        raise refusal("rows.numbers", times=times.size, speeds=V.shape[-1])
    dt = np.diff(times)
    if times[0] != 0:
        raise refusal("rows.not_from_zero", t=times[0])
    if (dt < 0).any():
        i = int(np.argmax(dt < 0))
        raise refusal("rows.order", i=i, t=times[i], next=i + 1, t_next=times[i + 1])
    jump = np.concatenate([[True], dt == 0, [True]])  # a jump at either end is an error too
    if (jump[1:] & jump[:-1]).any():
        i = int(np.argmax(jump[1:] & jump[:-1]))
        where = "at an end of the series" if i in (0, times.size - 1) else "a third time"
        raise refusal("rows.repeated", i=i, t=times[i], where=where)
    keep = np.flatnonzero(dt > 0)
    speed = History("V_lp", times[keep], V[..., keep], V[..., keep + 1], float(times[-1]))
    with np.errstate(over="ignore"):
        if not np.isfinite(speed.rate).all():
            raise refusal("rows.too_close")
    return speed, None if sigma is None else _stress_from_rows(times, keep, sigma)


def _stress_from_rows(times, keep, sigma):
    """Return the `History` of a record's normal stress; `keep` are the rows of segments."""
    if sigma.shape[-1] != times.size:
        raise refusal("rows.stresses", stresses=sigma.shape[-1], times=times.size)
    if not np.all(np.greater(sigma, 0.0)):
        i = int(np.argmin(np.asarray(sigma).min(axis=tuple(range(sigma.ndim - 1)))))
        raise refusal("rows.stress", i=i, sigma=float(np.min(sigma)))
    rows = np.append(keep, times.size - 1)  # constant from the last time on
    return History("sigma", times[rows], sigma[..., rows], sigma[..., np.append(keep + 1, -1)])
