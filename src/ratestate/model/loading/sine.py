"""A sinusoid out of straight lines, whose fundamental is exactly the one that was asked for.

Between N points a period on a sine of amplitude A', straight lines have the amplitude
A' sinc^2(pi/N), sinc(x) = sin(x)/x, at the sine's frequency.  So the points lie A/sinc^2(pi/N) from
the mean.  What is left are the harmonics m = N - 1, N + 1, 2 N - 1, ..., of amplitude A/m^2.  The
points lie halfway between the extremes, which are thus on lines that pass inside of the sine's: a
speed whose amplitude is its mean never falls below 0.
"""

import dataclasses
from typing import Any

import numpy as np

from ...errors import ParameterError
from ..arrays import check_aligned
from ..units import is_array, to_si

#: lines in a period (a multiple of 4): the speed is off by up to 5.1e-5 of the amplitude,
#: the displacement by up to 1.3e-7 of its own
LINES = 256
#: lines in all, and speeds in all cases of a sweep, at most
MOST_LINES = 10**6
MOST_SPEEDS = 10**7


@dataclasses.dataclass(frozen=True)
class Sine:
    """V_lp + amplitude sin(2 pi t/period): speeds [m/s] that may be DataArrays, and a time [s]."""

    V_lp: Any
    amplitude: Any
    period: float


def checked_sine(V_lp, amplitude, period, frequency):
    """`Sine` of these values; ParameterError if they make none."""
    if (period is None) == (frequency is None):
        raise ParameterError(
            "a sinusoid needs either its period or its frequency, such as period='2 s'"
        )
    V_lp = to_si("V_lp", V_lp)
    amplitude = to_si("V_lp", amplitude, label="amplitude", bound=">= 0")
    symbol, given = ("frequency", frequency) if period is None else ("period", period)
    found = to_si(symbol, given, bound="> 0")
    if is_array(found):
        raise ParameterError(f"the {symbol} of a sinusoid is one number, common to all cases")
    found = 1.0 / found if period is None else found
    if not 0.0 < found < np.inf:
        raise ParameterError(f"frequency = {given!r} is beyond any size; give one such as '0.5 Hz'")
    check_aligned({"V_lp": V_lp, "amplitude": amplitude})
    if np.any(np.greater(amplitude, V_lp)):
        raise ParameterError(
            f"amplitude = {float(np.max(amplitude)):.6g} m/s is more than V_lp = "
            f"{float(np.min(V_lp)):.6g} m/s: the load point would move back; "
            f"give an amplitude up to V_lp"
        )
    return Sine(V_lp, amplitude, found)


def lines(sine, t_end):
    """The lines from 0 to t_end [s]: t, V, rate, t_last, the fields of a `Loading`."""
    t_end = float(np.max(to_si("t_end", t_end)))
    needed = t_end / sine.period * LINES
    cases = np.size(sine.V_lp + sine.amplitude)
    if not (needed <= MOST_LINES and needed * cases <= MOST_SPEEDS):
        raise ParameterError(
            f"{t_end:.6g} s are {t_end / sine.period:.6g} periods, and {needed:.6g} lines for each "
            f"of {cases} cases; no more than {MOST_LINES:.0e} lines, and {MOST_SPEEDS:.0e} in all "
            f"cases: shorten t_end, or lengthen the period"
        )
    half = np.sin(np.pi * np.arange(1, LINES, 2) / LINES)  # halfway between the ends of lines
    period = np.concatenate([half, -half]) / np.sinc(1 / LINES) ** 2
    number = int(needed) + 2
    points = np.arange(1, 2 * number, 2) * (sine.period / (2 * LINES))  # LINES is a power of 2
    t = np.concatenate([[0.0], points])
    wave: Any = np.concatenate([[0.0], np.resize(period, number)])
    keep = int(np.searchsorted(t, t_end))
    if is_array(sine.V_lp) or is_array(sine.amplitude):
        import xarray

        wave = xarray.DataArray(wave, dims="segment")
    V = sine.V_lp + sine.amplitude * wave
    V = V.transpose(..., "segment") if is_array(V) else V
    with np.errstate(over="ignore"):
        rate = (V[..., 1 : keep + 1] - np.asarray(V[..., :keep])) / np.diff(t[: keep + 1])
    if not (np.diff(t[: keep + 1]) > 0).all() or not np.isfinite(rate).all():
        raise ParameterError(f"period = {sine.period!r} s is too short; give a longer one")
    return t[:keep], V[..., :keep], rate, t_end
