"""Extremes of a noisy parabola and of a kink, whose place and value are known."""

import numpy as np
import pytest

from ratestate.records.stick_slip.edges import edge
from ratestate.records.stick_slip.noise import Noise, loading_noise, white_noise
from ratestate.records.stick_slip.polynomials import Window, extreme
from ratestate.records.stick_slip.windows import extremes

DRAWS = 3000


@pytest.mark.parametrize(("samples", "sd"), [(30, 0.3), (60, 0.1)])
def test_vertices_are_unbiased(samples, sd):
    """-t^2 has its maximum, 0, at 0: mean and scatter of value and time over their errors."""
    rng = np.random.default_rng(1)
    t, window = np.linspace(-1.0, 1.0, samples), Window(-2.6, -0.4, 1)
    value, time, raw = [], [], []
    for _ in range(DRAWS):
        y = -(t**2) + sd * rng.normal(size=samples)
        found = extreme(t, y, 1.5, window, 0, 1, Noise(sd))
        assert found.inside
        value.append(found.value / found.error)
        time.append(found.time / found.time_error)
        raw.append(found.value)
    for z in (value, time):
        assert abs(np.mean(z)) < 4.0 / np.sqrt(DRAWS)
        assert 0.9 < np.std(z) < 1.1
    assert abs(np.mean(raw)) < 0.01 * sd


def test_the_error_of_a_value_has_that_of_the_vertex():
    """Of a vertex that noise hides: what the value at it is corrected by is as uncertain."""
    rng, sd = np.random.default_rng(1), 1.0
    t, window = np.linspace(-1.0, 1.0, 30), Window(-2.6, -0.4, 1)
    draws = (-(t**2) + sd * rng.normal(size=t.size) for _ in range(DRAWS))
    found = [extreme(t, y, 1.5, window, 0, 1, Noise(sd)) for y in draws]
    value, error = np.array([(one.value, one.error) for one in found if one.inside]).T
    assert 0.8 < np.std(value) / np.sqrt(np.mean(error**2)) < 1.0


def test_what_both_degrees_differ_by_is_part_of_the_errors():
    """Extremes of -t^2 + 0.3 t^3 at 0, far from those of parabolas, hardly any noise."""
    begins, window, noise = 10.0 * np.arange(8), Window(-2.5, -0.5, 1), Noise(1e-4)
    t = np.arange(-1.0, 75.0, 0.02)
    u = t - 10.0 * np.round(t / 10.0)
    y = -(u**2) + 0.3 * u**3 + noise.sd * np.random.default_rng(1).normal(size=t.size)
    found = extremes(t, y, begins + 1.5, window, 0, 1, noise)
    raw = [extreme(t, y, at + 1.5, window, 0, 1, noise) for at in begins]
    off = np.array([one.value for one in found]), np.array([one.time for one in found]) - begins
    bias = abs(np.mean([one.difference for one in raw]))
    moved = np.mean([one.time for one in raw]) - np.mean([one.time for one in found])
    np.testing.assert_allclose([one.error for one in found], bias, rtol=1e-3)
    np.testing.assert_allclose([one.time_error for one in found], 0.5 * moved, rtol=1e-3)
    assert np.abs(off[0]).max() < 0.1 * bias
    assert np.abs(off[1]).max() < 0.2 * moved


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("rate", "spread"), [(0.5, (1.2, 1.45)), (5.0, (0.92, 1.2))])
def test_a_kink_is_where_a_quadratic_fall_begins(sign, rate, spread):
    """Loading at slope 0.01 up to t = 0, from which stress falls as rate t^2: in any phase."""
    rng, places, off, sd = np.random.default_rng(2), [], [], 0.05
    for _ in range(300):
        t = np.arange(-60.0, 12.0) + rng.uniform()
        y = np.where(t > 0.0, -rate * t**2, 0.01 * t) + sd * rng.normal(size=t.size)
        first, last = (int(i) for i in np.searchsorted(t, (-50.0, -0.5)))
        middle = int(np.searchsorted(t, 8.0))
        c, span = np.array([0.0, 0.01, 0.0]), (first, last, middle)
        if sign < 0:  # the same backwards: a trough's side
            t, y, c = -t[::-1], y[::-1], c * [1.0, -1.0, 1.0]
            span = t.size - last, t.size - first, t.size - middle
        place = edge((t, y), span, c, sign, sign, sd)
        assert place.bounded
        places.append(place.u)
        off.append(place.u / place.error)
    assert abs(np.mean(places)) < 0.15  # of the step between samples
    assert spread[0] < np.std(off) < spread[1]


def test_what_nothing_bounds_is_told():
    t = np.arange(40.0)
    place = edge((t, 0.01 * t), (0, 20, 40), np.array([0.0, 0.01, 0.0]), 1, 1, 1.0)
    assert not place.bounded
    assert place.u == 19.0


def test_noise_of_the_loading():
    """White and of first order, about a curved loading in three phases."""
    t = np.arange(3000.0)
    curve = np.sin(2.0 * np.pi * t / 4000.0) * 1e4
    rises = [(0, 999), (1000, 1999), (2000, 2999)]
    rng = np.random.default_rng(3)
    z = rng.normal(size=t.size)
    white = loading_noise(t, curve + 5.0 * z, rises, 1.0)
    assert white.sd == pytest.approx(5.0, rel=0.06)
    assert white.correlation == 0.0
    red = z.copy()
    for i in range(1, t.size):
        red[i] = 0.6 * red[i - 1] + 0.8 * z[i]
    found = loading_noise(t, curve + 5.0 * red, rises, 1.0)
    assert found.sd == pytest.approx(5.0, rel=0.1)
    assert found.correlation == pytest.approx(0.6, abs=0.06)
    assert found.inflation == pytest.approx(4.0, rel=0.25)
    assert loading_noise(t, curve, [], 2.0) == Noise(2.0)


def test_white_noise_is_rounding_at_least():
    rng = np.random.default_rng(4)
    assert white_noise(7.0 * rng.normal(size=5000)) == pytest.approx(7.0, rel=0.04)
    steps = np.repeat(np.arange(500.0), 20)
    assert white_noise(steps) == pytest.approx(12**-0.5)
