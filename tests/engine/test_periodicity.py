"""The number of returns in the period of a run, for maps whose period is known."""

from typing import NamedTuple

import numpy as np
import pytest
from machine_control import Machine

from ratestate.engine import rows as R
from ratestate.engine.step_events import last_period
from ratestate.friction.laws import LAWS

LAW = LAWS["slip"]
ROWS = R.rows_of(LAW)


class Ends(NamedTuple):
    """A march that has ended, and its amplitude, period and number of returns."""

    shape: R.Shape
    s: np.ndarray
    found: np.ndarray


def write_period(run, _):
    run.found[0], run.found[1], returns = last_period(run, 0)
    run.found[2] = float(returns)
    return True


RUN = Ends(R.shape_of(LAW), np.zeros(ROWS.size), np.zeros(3))
WRITE = Machine(write_period, RUN)


def returns_of(highs, lows, tolerance=0.0):
    """Return the number of returns in the last period of a run with these extremes."""
    s, n = RUN.s, len(highs)
    s[R.CYCLES], s[R.TOLERANCE] = n, tolerance
    for k in range(max(n - R.RING, 0), n):
        at = (k % R.RING) * R.LANES
        s[ROWS.highs + at], s[ROWS.lows + at], s[ROWS.durations + at] = highs[k], lows[k], 1.0
    assert WRITE()
    amplitude, period, returns = RUN.found
    assert amplitude > 0.0
    if returns:
        assert period == pytest.approx(returns)
    return returns


def logistic(r, n, x=0.3):
    """Return n iterates of the logistic map, after 2,000 others."""
    found = []
    for k in range(2000 + n):
        x = r * x * (1.0 - x)
        if k >= 2000:
            found.append(x)
    return np.array(found)


@pytest.mark.parametrize(
    ("r", "returns"), [(2.8, 1), (3.2, 2), (3.5, 4), (3.55, 8), (3.565, 16), (3.83, 3), (3.74, 5)]
)
@pytest.mark.parametrize("n", [40, 64, 200])
def test_period_of_periodic_maps(r, returns, n):
    x = logistic(r, n)
    assert returns_of(1.0 + x, -x) == returns


@pytest.mark.parametrize("r", [3.6, 3.7, 3.8, 3.9, 4.0])
@pytest.mark.parametrize("n", [20, 64])
def test_chaos_has_no_period(r, n):
    """At 2,000 ends of a run each, whose last maxima may repeat by chance."""
    x = logistic(r, 2100)
    ends = range(n, n + 2000)
    named = [end for end in ends if returns_of((1.0 + x)[end - n : end], (-x)[end - n : end])]
    assert len(named) <= (2 if (r, n) == (4.0, 20) else 0)


@pytest.mark.parametrize(
    ("growth", "largest", "returns"), [(1.05, 1e-3, 0), (1.05, 1e-6, 2), (0.95, 1e-3, 2)]
)
def test_a_motion_that_leaves_an_orbit_of_two_returns_is_irregular(growth, largest, returns):
    """Though they repeat to 1e-4.  Growth below the errors of the run is ignored."""
    off = growth ** np.arange(64)
    pair = np.where(np.arange(64) % 2, 0.2, -0.2) + largest * off / off.max()
    assert returns_of(1.0 + pair, -pair, tolerance=1e-8) == returns


@pytest.mark.parametrize(("multiplier", "returns"), [(0.5, 1), (0.9, 1), (-0.5, 1), (-0.9, 1)])
def test_a_run_that_settles_has_its_final_period(multiplier, returns):
    x = 0.3 * multiplier ** np.arange(40)
    assert returns_of(1.0 + x, -x) == returns
    pair = np.where(np.arange(60) % 2, 0.2, -0.2) + 0.3 * multiplier ** np.arange(60)
    if abs(multiplier) < 0.9:
        assert returns_of(1.0 + pair, -pair) == 2
