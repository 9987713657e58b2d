"""Extremes and crossings of the dense output inside a step."""

from types import SimpleNamespace

import numpy as np
import pytest

from ratestate.engine import rows as R
from ratestate.engine import step_events as events
from ratestate.engine.rows import WORK_SIZE
from ratestate.engine.units import MarchUnits, in_python
from ratestate.friction.built_in_laws import SlipLaw
from ratestate.friction.composition import composed
from ratestate.laws import log

LANE = 3


def lane(law, c, p=(), h=1.0):
    """A run of which the lane LANE has made a step of this dense output.

    c : coefficients of x, v and psi, of a step of Rodas5P if there are 5 of each
    """
    rows = R.rows_of(law)
    s = np.full(rows.size, np.nan)
    s[R.TAYLOR + LANE], s[R.H_USED + LANE] = len(c[0]) > R.RODAS5P_TERMS, h
    for row, coefficients in zip(rows.c, c, strict=True):
        s[np.add(row[: len(coefficients)], LANE)] = coefficients
    s[np.add(rows.p, LANE)] = p
    s[np.add(rows.y, LANE)] = np.transpose(c)[0]
    units = in_python(law, MarchUnits)
    return SimpleNamespace(s=s, shape=R.shape_of(law), units=units, work=np.zeros(WORK_SIZE))


def of_v(c):
    """`lane` under the slip law with this polynomial of v."""
    return lane(SlipLaw(), [np.zeros(len(c)), c, np.zeros(len(c))], (1.5,))


def extreme(run):
    return events.extreme_speed(run, LANE, events.ANY_VALUE)[0]


def from_derivative(terms, *roots):
    """Coefficients, lowest first, of a polynomial whose derivative has these roots."""
    c = np.polynomial.Polynomial.fromroots(roots).integ().coef
    return np.append(c, np.zeros(terms - len(c)))


#: of a step of Rodas5P, and of the Taylor method
TERMS = pytest.mark.parametrize("terms", [5, 13])


@TERMS
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
def test_extreme_of_a_step(roots, at, sign, terms):
    c = sign * from_derivative(terms, *roots)
    assert extreme(of_v(c)) == pytest.approx(at, abs=1e-13)


def crossing(c, *load):
    return events.crossing(of_v(c), LANE, load, 0.0, 1.0)


@TERMS
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("roots", "at"),
    [
        ((0.3,), 0.3),  # of slope 1
        ((0.8, 0.8, 0.8), 0.8),  # flat where it crosses
        ((1e-9, 3.0), 1e-9),
        ((1.0 - 1e-9, -2.0, 4.0), 1.0 - 1e-9),
    ],
)
def test_crossing_of_the_load_point_speed(roots, at, sign, terms):
    c = sign * np.polynomial.Polynomial.fromroots(roots).coef
    c = np.append(c, np.zeros(terms - c.size))
    c[0] += np.log(3.0)
    near = 1e-13 if len(set(roots)) == len(roots) else 1e-4  # rounding hides a flat crossing
    assert crossing(c, 3.0, 0.0) == pytest.approx(at, abs=near)


@pytest.mark.parametrize(
    ("c", "load", "at"),
    [
        ((-0.152, 0.75, -1.5, 1.0, 0.0), (1.0, 0.0), 0.8),  # (s - 1/2)^3 - 0.027, flat at 1/2
        # from 0.01 below ln(2), v meets ln(2 + 2 s) where both are ln(3)
        ((np.log(2.0) - 0.01, np.log(2.25) + 0.02, 0.0, 0.0, 0.0), (2.0, 2.0), 0.5),
        ((1.0, -2.0, 0.0, 0.0, 0.0), (0.0, 2.0), 0.5),  # from rest, whose logarithm is no number
    ],
)
def test_a_crossing_of_a_load_point(c, load, at):
    assert crossing(np.array(c), *load) == pytest.approx(at, abs=1e-12)


def count_extremes(force, c, parts, h, law, p):
    """Compare the extreme force of a step with a dense grid; return the extremes inside."""
    found = events.extreme_value(lane(law, c, p, h), LANE, parts, 0.0, events.ANY_VALUE)
    rises = np.diff(force) > 0.0
    inner = 1 + np.flatnonzero(rises[1:] != rises[:-1])
    if rises[0] != rises[-1]:
        assert np.abs(force[inner] - found).min() < 1e-8 * np.abs(force).max()
        return inner.size
    slope = np.abs(np.diff(force)[[0, -1]])  # nearer to zero at the end that is meant
    assert abs(slope[0] / slope[1] - 1.0) > 1e-3  # else the grid cannot tell
    assert found == pytest.approx(force[0 if slope[0] < slope[1] else -1], rel=1e-13, abs=1e-13)
    return 0


class Viscous(SlipLaw):
    """The slip law beside a friction that grows with V: of no polynomials a polynomial."""

    name = "viscous"

    def friction(self, V, theta, p):
        of_V = log(V / p.V0) + 0.3 * V / p.V0
        return p.mu0 + p.a * of_V + p.b * log(p.V0 * theta / p.Dc)


UNITS = {"a": 1.0, "Dc": 1.0, "mu0": 0.6, "V0": 1.0, "sigma": 1.0, "damping": 0.2}


@pytest.mark.parametrize("law", [SlipLaw(), Viscous()], ids=["slip", "viscous"])
@pytest.mark.parametrize("damped", [False, True])
@pytest.mark.parametrize(
    "parts",
    [(1.0, -1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), (1.0, 0.0, 1.0, 0.0)],
    ids=["x - S", "f", "x + N"],
)
def test_extreme_forces_agree_with_a_dense_grid(law, damped, parts):
    rng, law = np.random.default_rng(12), composed(law, damped=damped)
    s, h, counts = np.linspace(0.0, 1.0, 20_001), 0.7, []
    for _ in range(70):
        c, b = rng.normal(size=(3, 5)), rng.uniform(1.1, 5.0)
        p = law.coefficients(1.0, SimpleNamespace(b=b, **UNITS))
        x, v, psi = np.polynomial.polynomial.polyval(s, c.T)
        friction = v + b * psi + (0.3 * np.expm1(v) if isinstance(law, Viscous) else 0.0)
        stress = friction + (0.2 * np.exp(v) if damped else 0.0)
        force = parts[0] * x + parts[1] * stress + (parts[2] + parts[3]) * friction
        counts.append(count_extremes(force, c, parts, h, law, p))
    assert counts.count(0) > 15
    assert counts.count(1) > 15


#: x of a step, known values, and the value that is found; the step begins at 0
PARABOLA, TROUGH = (0.0, 1.0, -1.0), (0.0, -1.0, 1.0)
#: the slope -(0.1 + 10 s (0.95 - s)) falls before it rises: no bound follows from the ends
UNEVEN = (0.0, -0.1, -4.75, 10.0 / 3.0)


@pytest.mark.parametrize(
    ("of_x", "terms", "known", "found"),
    [
        (PARABOLA, 13, (-1.0, 1.99), 0.25),  # tangents meet at 0.5: at most 2.0
        (PARABOLA, 13, (-1.0, 2.01), 0.0),
        (PARABOLA, 5, (-1.0, 2.01), 0.25),  # every extreme is needed after a step of Rodas5P
        (TROUGH, 13, (-1.99, np.inf), -0.25),
        (TROUGH, 13, (-2.01, np.inf), 0.0),
        (UNEVEN, 13, (-9.0, 9.0), -1.52448),
        (UNEVEN, 13, (-9.0, np.inf), -1.52448),
    ],
)
def test_an_extreme_that_cannot_leave_the_known_values_is_not_searched_for(
    of_x, terms, known, found
):
    of_x = np.append(of_x, np.zeros(terms - len(of_x)))
    run = lane(SlipLaw(), [of_x, np.zeros(terms), np.zeros(terms)], (1.5,))
    value = events.extreme_value(run, LANE, (1.0, 0.0, 0.0, 0.0), 0.0, known)
    assert value == pytest.approx(found, abs=1e-4)


@pytest.mark.parametrize(
    ("w", "w_end", "known"),
    [
        (2.0, 3.0, (np.log(3.0), 7.0)),  # a minimum above V_lp is searched for
        (0.5, 0.9, (-5.0, np.log(0.5))),  # a maximum below
        (2.0, 1.4, (-5.0, 7.0)),  # the load point's speed rises from 1 to 1.5: V crosses it
        (0.5, 1.6, (-5.0, 7.0)),
    ],
)
def test_extremes_of_speed_that_turn_to_the_load_points_speed_are_always_searched_for(
    w, w_end, known
):
    run = of_v(np.zeros(5))
    given = {R.W: w, R.W_NEW: w_end, R.V: np.log(w), R.V_NEW: np.log(w_end)}
    given |= {R.W_LP: 1.0, R.RAMP: 0.5, R.V_LOW: -5.0, R.V_HIGH: 7.0}
    for row, value in given.items():
        run.s[row + LANE] = value
    assert events.known_speeds(run, LANE) == known
