"""What the engine finds inside a step: extremes and crossings of the dense output."""

import numpy as np
import pytest
from numba import njit

from ratestate.engine import events


@njit
def extreme(c):
    return events.extreme(c)


def from_derivative(*roots):
    """Coefficients, lowest first, of a polynomial whose derivative has these roots."""
    c = np.polynomial.Polynomial.fromroots(roots).integ().coef
    return tuple(np.append(c, np.zeros(5 - len(c))))


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("roots", "at"),
    [
        ((0.3,), 0.3),
        ((0.5,), 0.5),
        ((0.999,), 0.999),
        ((0.2, 1.5, -3.0), 0.2),
        # rounding has moved it out of the step: the end that is nearer to it
        ((-1e-3,), 0.0),
        ((1.001,), 1.0),
        ((-0.1, 3.0), 0.0),
        ((1.1, -3.0), 1.0),
    ],
)
def test_where_a_step_has_its_extreme(roots, at, sign):
    c = tuple(sign * x for x in from_derivative(*roots))
    assert extreme(c) == pytest.approx(at, abs=1e-13)
