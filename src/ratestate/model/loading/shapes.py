"""Shapes of periodic loading: a wave about a mean speed, out of straight lines.

A new shape is a class here, in `SHAPES`, and in history.py a field of `Loading`, one more in its
`shape`, and a class method whose name is the shape's kind.  All else reads `SHAPES` or `shape`.
One with arguments beside amplitude and period has its own `arguments`, `example` and `checked`.
"""

import dataclasses
from typing import Any, ClassVar

import numpy as np

from ...errors import ParameterError
from ..arrays import check_aligned
from ..units import is_array, to_si

#: lines in all, and speeds in all cases of a sweep, at most
MOST_LINES = 10**6
MOST_SPEEDS = 10**7


@dataclasses.dataclass(frozen=True)
class Shape:
    """V_lp + amplitude w(t/period): speeds [m/s] that may be DataArrays, and a time [s]."""

    V_lp: Any
    amplitude: Any
    period: float

    #: key in scenario files and results, and method of `Loading`
    kind: ClassVar[str]
    #: arguments beside the mean speed: symbol and range of each, or None for the symbol's own
    arguments: ClassVar[dict[str, tuple[str, str | None]]] = {
        "amplitude": ("V_lp", ">= 0"),
        "period": ("period", "> 0"),
        "frequency": ("frequency", "> 0"),
    }
    #: in the language of scenario files
    example: ClassVar[str] = '{ amplitude = "0.05 mm/s", period = "2 s" }'

    @classmethod
    def corners(cls):
        """Where lines meet, as parts (n,) of a period, 0 to 1, and w (n,) there; w(0) = 0."""
        raise NotImplementedError

    @classmethod
    def checked(cls, V_lp, amplitude, period, frequency):
        """The shape with these values of `Loading.sinusoid`; ParameterError if they make none."""
        V_lp = to_si("V_lp", V_lp)
        amplitude = to_si("V_lp", amplitude, label="amplitude", bound=">= 0")
        found = period_of(f"a {cls.kind}", period, frequency)
        if is_array(found):
            raise ParameterError(f"the period of a {cls.kind} is one number, common to all cases")
        check_aligned({"V_lp": V_lp, "amplitude": amplitude})
        if np.any(np.greater(amplitude, V_lp)):
            raise ParameterError(
                f"amplitude = {float(np.max(amplitude)):.6g} m/s is more than V_lp = "
                f"{float(np.min(V_lp)):.6g} m/s: the load point would move back; "
                f"give an amplitude up to V_lp"
            )
        return cls(V_lp, amplitude, found)

    @property
    def values(self):
        """The numbers that make it: name -> value in SI."""
        return dataclasses.asdict(self)

    def lines(self, t_end):
        """The lines from 0 to t_end [s]: t, V, rate, t_last, the fields of a `Loading`.

        ParameterError for too many lines, or too short a period.
        """
        t_end = float(np.max(to_si("t_end", t_end)))
        phases, heights = self.corners()
        needed = t_end / self.period * phases.size
        cases = np.size(self.V_lp + self.amplitude)
        if not (needed <= MOST_LINES and needed * cases <= MOST_SPEEDS):
            raise ParameterError(
                f"{t_end:.6g} s are {t_end / self.period:.6g} periods, and {needed:.6g} lines for "
                f"each of {cases} cases; no more than {MOST_LINES:.0e} lines, and "
                f"{MOST_SPEEDS:.0e} in all cases: shorten t_end, or lengthen the period"
            )
        number = int(needed) + 2
        periods = np.arange(number) // phases.size + np.resize(phases, number)
        t = np.concatenate([[0.0], periods * self.period])
        wave: Any = np.concatenate([[0.0], np.resize(heights, number)])
        keep = int(np.searchsorted(t, t_end))
        if is_array(self.V_lp) or is_array(self.amplitude):
            import xarray

            wave = xarray.DataArray(wave, dims="segment")
        V = self.V_lp + self.amplitude * wave
        V = V.transpose(..., "segment") if is_array(V) else V
        with np.errstate(over="ignore"):
            rate = (V[..., 1 : keep + 1] - np.asarray(V[..., :keep])) / np.diff(t[: keep + 1])
        if not (np.diff(t[: keep + 1]) > 0).all() or not np.isfinite(rate).all():
            raise ParameterError(f"period = {self.period!r} s is too short; give a longer one")
        return t[:keep], V[..., :keep], rate, t_end


class Sine(Shape):
    """A sinusoid, whose fundamental is exactly the one with the given amplitude.

    Between N points a period on a sine of amplitude A', straight lines have the amplitude
    A' sinc^2(pi/N), sinc(x) = sin(x)/x, at the sine's frequency.  So the points lie A/sinc^2(pi/N)
    from the mean.  What is left are the harmonics m = N - 1, N + 1, 2 N - 1, ..., of amplitude
    A/m^2.  The points lie halfway between the extremes, which are thus on lines that pass inside
    of the sine's: a speed whose amplitude is its mean never falls below 0.
    """

    kind = "sinusoid"
    #: lines in a period (a multiple of 4): the speed is off by up to 5.1e-5 of the amplitude,
    #: the displacement by up to 1.3e-7 of its own
    LINES: ClassVar[int] = 256

    @classmethod
    def corners(cls):
        """Points of a sine, halfway between the ends of lines."""
        odd = np.arange(1, 2 * cls.LINES, 2)
        half = np.sin(np.pi * odd[: cls.LINES // 2] / cls.LINES)
        return odd / (2 * cls.LINES), np.concatenate([half, -half]) / np.sinc(1 / cls.LINES) ** 2


def period_of(what, period, frequency):
    """The period [s] of something, given by itself or by the frequency; else ParameterError."""
    if (period is None) == (frequency is None):
        raise ParameterError(
            f"{what} needs either its period or its frequency, such as period='2 s'"
        )
    if frequency is None:
        return to_si("period", period, bound="> 0")
    with np.errstate(divide="ignore"):
        found = 1.0 / to_si("frequency", frequency, bound="> 0")
    if not np.all((found > 0.0) & (found < np.inf)):
        raise ParameterError(
            f"frequency = {frequency!r} is beyond any size; give one such as '0.5 Hz'"
        )
    return found


#: kind -> the shape
SHAPES: dict[str, type[Shape]] = {shape.kind: shape for shape in (Sine,)}
