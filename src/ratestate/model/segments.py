"""Histories from the rows of a record, and of a sinusoid."""

from typing import Any

import numpy as np

from ..errors import ParameterError
from .arrays import check_aligned
from .history import History, NormalStress
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
        raise ParameterError(
            "the period of a sinusoid is an array, but all cases share one period",
            "Give one number.",
        )
    check_aligned({"V_lp": V_lp, "amplitude": amplitude})
    if np.any(np.greater(amplitude, V_lp)):
        raise ParameterError(
            f"is more than V_lp = {float(np.min(V_lp)):.6g} m/s: the load point would move back",
            "Give an amplitude up to V_lp.",
            symbol="amplitude",
            value=f"{float(np.max(amplitude)):.6g}",
            unit="m/s",
        )
    needed = t_end / period * LINES_PER_PERIOD
    cases = np.size(V_lp + amplitude)
    if not (needed <= MAX_LINES and needed * cases <= MAX_SPEEDS):
        raise ParameterError(
            (
                f"holds {t_end / period:.6g} periods, which need {needed:.6g} lines for each "
                f"of {cases} cases (at most {MAX_LINES:.0e} lines, and {MAX_SPEEDS:.0e} in "
                "all cases)"
            ),
            "Shorten t_end, or lengthen the period.",
            symbol="t_end",
            value=f"{t_end:.6g}",
            unit="s",
        )
    n = LINES_PER_PERIOD
    odd = np.arange(1, 2 * n, 2)
    half = np.sin(np.pi * odd[: n // 2] / n)
    heights = np.concatenate([half, -half]) / np.sinc(1 / n) ** 2
    number = int(needed) + 2
    periods = np.arange(number) // n + np.resize(odd / (2 * n), number)
    t = np.concatenate([[0.0], periods * period])
    wave: Any = np.concatenate([[0.0], np.resize(heights, number)])
    if is_array(V_lp) or is_array(amplitude):
        import xarray

        wave = xarray.DataArray(wave, dims="segment")
    V = V_lp + amplitude * wave
    V = V.transpose(..., "segment") if is_array(V) else V
    keep = int(np.searchsorted(t, t_end))
    history = History(t[:keep], V[..., :keep], V[..., 1 : keep + 1], float(t[keep]))
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        if not (np.diff(t[: keep + 1]) > 0).all() or not np.isfinite(history.rate).all():
            raise ParameterError(
                "is too short", "Give a longer one.", symbol="period", value=repr(period), unit="s"
            )
    return history


def period_of(what, period, frequency):
    """Return the period [s] of `what` from its period or frequency."""
    if (period is None) == (frequency is None):
        raise ParameterError(
            f"{what} needs either its period or its frequency", "Give for example period='2 s'."
        )
    if frequency is None:
        return to_si("period", period, bound="> 0")
    with np.errstate(divide="ignore"):
        period = 1.0 / to_si("frequency", frequency, bound="> 0")
    if not np.all((period > 0.0) & (period < np.inf)):
        raise ParameterError(
            "is beyond any size",
            "Give a frequency such as '0.5 Hz'.",
            symbol="frequency",
            value=repr(frequency),
        )
    return period


def histories_from_rows(times, V, sigma=None):
    """Return the `History` of a record's speed, and `NormalStress` if sigma is given.

    Arguments are columns in SI.  Raises ParameterError unless the rows are a valid record.
    """
    if is_array(times) or times.size < 2 or V.shape[-1] != times.size:
        raise ParameterError(
            f"has {times.size} and V_lp {V.shape[-1]} values",
            "Give as many times as speeds, at least 2.",
            symbol="t",
        )
    dt = np.diff(times)
    if times[0] != 0:
        raise ParameterError(
            "must be 0",
            "Subtract it from all times.",
            symbol="t[0]",
            value=f"{times[0]:.6g}",
            unit="s",
        )
    if (dt < 0).any():
        i = int(np.argmax(dt < 0))
        raise ParameterError(
            f"is less than t[{i}] = {times[i]} s, but times must not decrease",
            "Correct the record.",
            symbol=f"t[{i + 1}]",
            value=str(times[i + 1]),
            unit="s",
        )
    jump = np.concatenate([[True], dt == 0, [True]])  # a jump at either end is an error too
    if (jump[1:] & jump[:-1]).any():
        i = int(np.argmax(jump[1:] & jump[:-1]))
        where = "at an end of the series" if i in (0, times.size - 1) else "a third time"
        raise ParameterError(
            f"is repeated {where}: a jump is one time in two rows between others",
            "Drop a row (V_start of `simulate` gives a start at another speed).",
            symbol=f"t[{i}]",
            value=str(times[i]),
            unit="s",
        )
    keep = np.flatnonzero(dt > 0)
    speed = History(times[keep], V[..., keep], V[..., keep + 1], float(times[-1]))
    with np.errstate(over="ignore"):
        if not np.isfinite(speed.rate).all():
            raise ParameterError(
                "two times are too close for a ramp", "For a jump repeat the time."
            )
    return speed, None if sigma is None else _stress_from_rows(times, keep, sigma)


def _stress_from_rows(times, keep, sigma):
    """Return the `NormalStress` of a record; `keep` are the rows that start segments."""
    if sigma.shape[-1] != times.size:
        raise ParameterError(
            f"sigma has {sigma.shape[-1]} values for {times.size} times", "Give one at each time."
        )
    if not np.all(np.greater(sigma, 0.0)):
        i = int(np.argmin(np.asarray(sigma).min(axis=tuple(range(sigma.ndim - 1)))))
        raise ParameterError(
            "must be > 0, as a normal stress",
            "Correct the record.",
            symbol=f"sigma[{i}]",
            value=f"{float(np.min(sigma)):.6g}",
            unit="Pa",
        )
    rows = np.append(keep, times.size - 1)  # constant from the last time on
    return NormalStress(times[rows], sigma[..., rows], sigma[..., np.append(keep + 1, -1)])
