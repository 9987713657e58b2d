"""What the engine finds inside a step: extremes and crossings of the dense output."""

import numpy as np
import pytest
from numba import njit

from ratestate.engine import (
    dense_output,
    extremes,
    law_methods,  # noqa: F401  (compiled code calls methods of laws)
)
from ratestate.friction.composition import composed, under_varying_stress
from ratestate.friction.laws.slip import SlipLaw


@njit
def extreme(c):
    return dense_output.extreme(c)


def from_derivative(*roots):
    """Coefficients, lowest first, of a polynomial whose derivative has these roots."""
    c = np.polynomial.Polynomial.fromroots(roots).integ().coef
    return np.append(c, np.zeros(5 - len(c)))


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
    c = sign * from_derivative(*roots)
    assert extreme(c) == pytest.approx(at, abs=1e-13)


@njit
def crossing(c, w_lp, dw, log_w_lp):
    return extremes.crossing_of_v(c, (w_lp, dw, log_w_lp), 0.0, 1.0)


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
def test_where_a_step_crosses_the_speed_of_the_load_point(roots, at, sign):
    c = sign * np.polynomial.Polynomial.fromroots(roots).coef
    c = np.append(c, np.zeros(5 - c.size))
    c[0] += np.log(3.0)
    near = 1e-13 if len(set(roots)) == len(roots) else 1e-4  # rounding hides a flat crossing
    assert crossing(c, 3.0, 0.0, np.log(3.0)) == pytest.approx(at, abs=near)


def test_a_crossing_from_where_the_middle_is_flat():
    """(s - 1/2)^3 - 0.027, in which Newton's method cannot begin."""
    c = np.array([-0.152, 0.75, -1.5, 1.0, 0.0])
    assert crossing(c, 1.0, 0.0, 0.0) == pytest.approx(0.8, abs=1e-13)


def test_a_crossing_of_a_load_point_that_speeds_up():
    """From 0.01 below ln(2), v meets ln(2 + 2 s) at s = 1/2, where both are ln(3)."""
    c = np.array([np.log(2.0) - 0.01, np.log(2.25) + 0.02, 0.0, 0.0, 0.0])
    assert crossing(c, 2.0, 2.0, np.nan) == pytest.approx(0.5, abs=1e-12)


@njit
def extreme_value(c, parts, h, law, p, enough=0.0):
    return extremes.extreme_value(c, parts, h, law, p, enough)


class Viscous(SlipLaw):
    """The slip law beside a friction that grows with V: of no polynomials a polynomial."""

    name = "viscous"

    def resistance(self, v, w, psi, p):
        return v + p[0] * psi[0] + 0.3 * w

    def resistance_partials(self, v, w, psi, p):
        return 1.0 + 0.3 * w, (p[0],)


@pytest.mark.parametrize("law", [SlipLaw(), Viscous()], ids=["slip", "viscous"])
@pytest.mark.parametrize("damped", [False, True])
@pytest.mark.parametrize(
    "parts",
    [(1.0, -1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), (1.0, 0.0, 1.0, 0.0)],
    ids=["x - S", "f", "x + N"],
)
def test_extreme_forces_are_those_of_a_dense_grid(law, damped, parts):
    """Where the slope has one sign at both ends, that at the end where it is nearer to zero."""
    rng, law = np.random.default_rng(12), composed(law, damped=damped)
    h = 0.7
    s = np.linspace(0.0, 1.0, 20_001)
    changes = {0: 0, 1: 0, 3: 0}
    for _ in range(200):
        c, p = rng.normal(size=(3, 5)), (rng.uniform(1.1, 5.0), *([0.2] if damped else []))
        x, v, psi = np.polynomial.polynomial.polyval(s, c.T)
        friction = v + p[0] * psi + (0.3 * np.exp(v) if isinstance(law, Viscous) else 0.0)
        stress = friction + (0.2 * np.exp(v) if damped else 0.0)
        force = parts[0] * x + parts[1] * stress + (parts[2] + parts[3]) * friction
        found = extreme_value(tuple(c), parts, h, law, p)
        rises = np.diff(force) > 0.0
        if rises[0] == rises[-1]:
            changes[0] += 1
            slope = np.abs(np.diff(force)[[0, -1]])
            assert abs(slope[0] / slope[1] - 1.0) > 1e-3  # else the grid cannot tell
            end = force[0] if slope[0] < slope[1] else force[-1]
            assert found == pytest.approx(end, rel=1e-13, abs=1e-13)
        else:
            inner = 1 + np.flatnonzero(rises[1:] != rises[:-1])
            changes[len(inner)] += 1
            size = np.abs(force).max()
            assert np.abs(force[inner] - found).min() < 1e-8 * size
    assert changes[0] > 50
    assert changes[1] > 50


@pytest.mark.parametrize("parts", [(1.0, -1.0, 0.0, 0.0), (1.0, 0.0, 1.0, 0.0)])
def test_extreme_forces_where_normal_stress_varies(parts):
    """N = s R + (s - 1) mu_ref/a, s = 1.1 + 0.2 T + 0.1 sin(2 pi (0.3 + T))."""
    rng, law = np.random.default_rng(13), under_varying_stress(SlipLaw())
    s, h, minima = np.linspace(0.0, 1.0, 100_001), 0.4, 0
    for _ in range(100):
        c, beta = rng.normal(size=(3, 5)), rng.uniform(1.1, 5.0)
        own = (beta, 3.0, 0.0, 0.0, 1.1, 0.2, 0.1, 1.0, 0.3, 1.0, 0.0, 0.0)
        p = tuple(map(float, law.at_time(own, 1.1, 0.2, 0.3)))
        x, v, psi = np.polynomial.polynomial.polyval(s, c.T)
        ratio = 1.1 + 0.2 * h * s + 0.1 * np.sin(2.0 * np.pi * (0.3 + h * s))
        strength = ratio * (v + beta * psi) + (ratio - 1.0) * 3.0
        force = x + (parts[1] + parts[2]) * strength
        found = extreme_value(tuple(c), parts, h, law, p)
        rises = np.diff(force) > 0.0
        if rises[0] != rises[-1]:
            inner = 1 + np.flatnonzero(rises[1:] != rises[:-1])
            minima += 1
            assert np.abs(force[inner] - found).min() < 1e-8 * np.abs(force).max()
    assert minima > 30
