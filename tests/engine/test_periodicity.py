"""Of how many returns the period of a run is, by maxima of maps whose periods are known."""

import numpy as np
import pytest
from numba import njit

from ratestate.engine import law_methods  # noqa: F401  (compiled code calls methods of laws)
from ratestate.engine import rows as R
from ratestate.engine.periodicity import last_period
from ratestate.friction.laws import LAWS

LAW = LAWS["slip"]
ROWS = R.rows_of(LAW)


@njit
def period_of(s, law):
    return last_period(s, 0, law)


def returns_of(highs, lows):
    """How many returns make the last period of a run with these stress maxima and minima."""
    s, n = np.zeros(ROWS.size), len(highs)
    s[R.CYCLES] = n
    for k in range(max(n - R.RING, 0), n):
        at = (k % R.RING) * R.LANES
        s[ROWS.highs + at], s[ROWS.lows + at], s[ROWS.spans + at] = highs[k], lows[k], 1.0
    amplitude, period, returns = period_of(s, LAW)
    assert amplitude > 0.0
    if returns:
        assert period == pytest.approx(returns)
    return returns


def logistic(r, n, x=0.3):
    """n iterates of the logistic map, after 2,000 others."""
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
def test_a_period_is_named(r, returns, n):
    x = logistic(r, n)
    assert returns_of(1.0 + x, -x) == returns


@pytest.mark.parametrize("r", [3.6, 3.7, 3.8, 3.9, 4.0])
def test_no_period_is_named_in_chaos(r):
    """At 2,000 ends of a run each, whose last maxima may repeat by chance."""
    x = logistic(r, 2100)
    named = [n for n in range(64, 2064) if returns_of((1.0 + x)[n - 64 : n], (-x)[n - 64 : n])]
    assert named == []


@pytest.mark.parametrize(("multiplier", "returns"), [(0.5, 1), (0.9, 1), (-0.5, 1), (-0.9, 1)])
def test_a_run_that_settles_has_the_period_it_settles_to(multiplier, returns):
    x = 0.3 * multiplier ** np.arange(40)
    assert returns_of(1.0 + x, -x) == returns
    pair = np.where(np.arange(60) % 2, 0.2, -0.2) + 0.3 * multiplier ** np.arange(60)
    if abs(multiplier) < 0.9:
        assert returns_of(1.0 + pair, -pair) == 2
