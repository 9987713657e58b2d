"""The history of the load point: speeds that are constant between breaks."""

from typing import NamedTuple

import numpy as np

from ...errors import ParameterError
from ...model.quantities import readable
from .runs import breakpoints, noise_variances
from .splits import MOST, Rows, cut
from .steps import ROUNDED, WANDER, mark_holds, oddities, scatter_of, steps_and_jumps, without_ramps

#: rows in which noise is looked for by a second search, and by how much it must lessen the scatter
SHORT, SUCCESS = 16, 5.0


class Segments(NamedTuple):
    """Starts [s] and speeds [m/s] of segments with their standard errors, and notes."""

    t: np.ndarray
    V: np.ndarray
    t_error: np.ndarray
    V_error: np.ndarray
    notes: list[str]


def find_segments(t, delta_lp):
    """Constant speeds that a load point had one after the other, from its displacement.

    Parameters
    ----------
    t : array, shape (n,)
        Times [s], increasing, n >= 4.
    delta_lp : array, shape (n,)
        Load-point displacement [m], with noise or without.

    Returns
    -------
    segment_t : ndarray, shape (segments,)
        Start of each [s]; the first is ``t[0]``.
    segment_V : ndarray, shape (segments,)
        Speed [m/s]; exactly 0 in a hold.

    Raises
    ------
    ParameterError
        Times that do not increase; values that are not finite; fewer than 4; a load point that
        moves backwards, or one with no constant speeds.

    Notes
    -----
    Breaks are placed by least squares of all times and speeds together, between rows as well.  A
    step is a change of speed by 5 % or more that bends the displacement by three times its noise.
    The displacement may jump at one speed (a sensor that slips, samples that were lost): that is
    no step, and does not move those beside it.

    Examples
    --------
    >>> t = np.arange(101.0)
    >>> segment_t, segment_V = find_segments(t, 1e-6 * np.maximum(t, 10 * t - 405))
    >>> segment_t.round(6).tolist(), segment_V.round(12).tolist()
    ([0.0, 45.0], [1e-06, 1e-05])
    """
    segments = segments_from_displacement(t, delta_lp)
    return segments.t, segments.V


def segments_from_displacement(t, x):
    """`find_segments` with errors and notes: `Segments`."""
    t, x = checked_arrays(t, x)
    rows, runs = _runs(t, x)
    runs, notes = mark_holds(t, x, runs, rows)
    runs, ramps = without_ramps(t, x, runs)
    _check_forward(t, runs)
    noise, at = noise_variances(t, x, runs), breakpoints(t, runs)
    variance = [
        (s * one.variance(tau, -1) + z * other.variance(tau, 0)) / (one.V - other.V) ** 2
        for tau, one, other, s, z in zip(at, runs, runs[1:], noise, noise[1:], strict=False)
    ]
    V_error = [0.0 if r.hold else (s / r.spread) ** 0.5 for r, s in zip(runs, noise, strict=True)]
    return Segments(
        np.append(t[0], at),
        np.array([run.V for run in runs]),
        np.append(0.0, np.sqrt(variance)),
        np.array(V_error),
        notes + ramps + oddities(t, x, runs),
    )


def _runs(t, x):
    """Candidates and runs.

    Steps in quick succession may be taken for a load point that wanders: where there is much of
    that, a second search looks for noise in short spans only.
    """
    rows = Rows(t, x)
    runs = steps_and_jumps(rows, check_count(cut(rows), t), t, x)
    scatter, steps = scatter_of(t, x, runs)
    if scatter > max(WANDER * steps, ROUNDED * np.ptp(x)):
        again = Rows(t, x, longest=SHORT)
        closer = steps_and_jumps(again, check_count(cut(again), t), t, x)
        if SUCCESS * scatter_of(t, x, closer)[0] < scatter:
            return again, closer
    return rows, runs


def checked_arrays(t, x, symbol="delta_lp"):
    """Times and values as arrays of numbers, or ParameterError."""
    t, x = np.asarray(t, float), np.asarray(x, float)
    if t.ndim != 1 or t.shape != x.shape or t.size < 4:
        raise ParameterError(
            f"t and {symbol} have shapes {t.shape} and {x.shape}; expected two columns of equal "
            f"length, 4 rows at least"
        )
    if not (np.isfinite(t).all() and np.isfinite(x).all()):
        raise ParameterError(f"t or {symbol} has values that are not finite; leave their rows out")
    if not (np.diff(t) > 0.0).all():
        row = int(np.argmin(np.diff(t) > 0.0)) + 1
        raise ParameterError(f"t does not increase at index {row}; sort the rows by time")
    return t, x


def check_count(cuts, t):
    """The cuts; refuses as many as a history without constant speeds would make."""
    if len(cuts) > MOST:
        raise ParameterError(
            f"the load point has no constant speeds from {t[0]:.6g} s to {t[-1]:.6g} s: more than "
            f"{MOST} pieces would be needed; choose a shorter window, for example "
            f"time=('{t[0]:.6g} s', '{t[0] + (t[-1] - t[0]) / 10:.6g} s')"
        )
    return cuts


def _check_forward(t, runs):
    """Refuse a load point that moves backwards."""
    for run in runs:
        if run.V < 0.0:
            first, last = f"{t[run.first]:.7g} s", f"{t[run.last - 1]:.7g} s"
            window = f"(None, '{first}')" if run.first else f"('{last}', None)"
            raise ParameterError(
                f"delta_lp runs backwards, at {readable('V_lp', -run.V, 3)} from {first} to "
                f"{last}; a load point moves at V >= 0: leave that span out, such as time={window}"
            )
