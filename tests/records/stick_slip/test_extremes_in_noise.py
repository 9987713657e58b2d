"""Extremes of a noisy parabola and of a kink with known place and value."""

import numpy as np
import pytest

from ratestate.records.kit.sample_noise import SampleNoise
from ratestate.records.stick_slip.extremes import FallWindow, edges, extremes

DRAWS = 1500
#: least contradiction of a window without a bound by the fall
BOUNDED = 1e3


@pytest.mark.parametrize(("samples", "sd"), [(30, 0.3), (60, 0.1)])
def test_vertices_are_unbiased(samples, sd):
    """-t^2 has its maximum, 0, at 0: mean and scatter of value and time in standard errors."""
    value, time = drawn_vertices(samples, sd)
    for z in (value[0] / value[1], time[0] / time[1]):
        assert abs(np.mean(z)) < 6.0 / np.sqrt(DRAWS)  # (events share a part of their errors)
        assert 0.9 < np.std(z) < 1.1
    assert abs(np.mean(value[0])) < 4.0 * np.std(value[0]) / np.sqrt(DRAWS)


def drawn_vertices(samples, sd, events=30):
    """Return values and times (2, DRAWS), with errors, of maxima of -t^2 in noise.

    Each record has several events.  Results are NaN if noise hides the vertices.
    """
    rng, window = np.random.default_rng(1), FallWindow(-2.6, -0.4, 1)
    origins, one = 10.0 * np.arange(events), np.linspace(-1.0, 1.0, samples)
    t, rows = np.concatenate([one + origin for origin in origins]), []
    for _ in range(DRAWS // events):
        y = -np.tile(one**2, events) + sd * rng.normal(size=t.size)
        found = extremes(t, y, origins + 1.5, window, 0, 1, SampleNoise(sd))
        row = np.array([found.value, found.error, found.time - origins, found.time_error])
        rows.append(row if found.contradiction < BOUNDED else np.nan * row)
    return np.concatenate(rows, axis=1).reshape(2, 2, -1)


def test_hidden_vertices_are_replaced_by_the_mean_vertex():
    """-t^2 for 40 events, so noisy that the vertex of a single event is mostly hidden."""
    rng, sd, m = np.random.default_rng(2), 3.0, 40
    middles, window = 10.0 * np.arange(m) + 1.5, FallWindow(-2.5, -0.5, 1)
    off, time = [], []
    for _ in range(20):
        t = np.arange(-1.0, 10.0 * m, 0.05)
        y = -((t - 10.0 * np.round(t / 10.0)) ** 2) + sd * rng.normal(size=t.size)
        found = extremes(t, y, middles, window, 0, 1, SampleNoise(sd))
        off.append(found.value / found.error)
        assert found.contradiction < BOUNDED
        time.append((found.time - middles + 1.5) / found.time_error)
    assert np.abs(np.mean(off)) < 0.1
    assert 0.9 < np.std(off) < 1.1
    assert 0.6 < np.std(time) < 1.3
    assert np.isfinite(drawn_vertices(40, sd, 1)[0][0]).mean() < 0.25


def test_errors_include_the_difference_of_the_degrees():
    """Extremes of -t^2 + 0.3 t^3 at 0, far from those of parabolas, hardly any noise."""
    begins, window, noise = 10.0 * np.arange(8), FallWindow(-2.5, -0.5, 1), SampleNoise(1e-4)
    t = np.arange(-1.0, 75.0, 0.02)
    u = t - 10.0 * np.round(t / 10.0)
    y = -(u**2) + 0.3 * u**3 + noise.sd * np.random.default_rng(1).normal(size=t.size)
    found = extremes(t, y, begins + 1.5, window, 0, 1, noise)
    bias = abs(np.mean(found.difference))
    np.testing.assert_allclose(found.biased_error, bias, rtol=1e-3)
    assert np.abs(found.value).max() < 0.1 * bias
    assert np.abs(found.time - begins).max() < 0.4 * found.time_error.min()


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("rate", "spread"), [(0.5, (1.2, 1.45)), (5.0, (0.92, 1.2))])
def test_a_kink_is_located_at_the_start_of_a_quadratic_fall(sign, rate, spread):
    """Stress rises with slope 0.01 until t = 0 and then falls as rate t^2; random phase."""
    rng, places, off, sd = np.random.default_rng(2), [], [], 0.05
    for _ in range(300):
        t = np.arange(-60.0, 12.0) + rng.uniform()
        y = np.where(t > 0.0, -rate * t**2, 0.01 * t) + sd * rng.normal(size=t.size)
        first, last = (int(i) for i in np.searchsorted(t, (-50.0, -0.5)))
        middle = int(np.searchsorted(t, 8.0))
        c, span = np.array([0.0, 0.01, 0.0]), (first, last, middle)
        if sign < 0:  # reversed in time, as for a trough
            t, y, c = -t[::-1], y[::-1], c * [1.0, -1.0, 1.0]
            span = t.size - last, t.size - first, t.size - middle
        (u,), (error,), (bounded,) = placed((t, y), span, c, sign, sd)
        assert bounded
        places.append(u)
        off.append(u / error)
    assert abs(np.mean(places)) < 0.15  # of the step between samples
    assert spread[0] < np.std(off) < spread[1]


def placed(samples, span, c, sign, sd, events=1):
    """Return `edges` for several identical events."""
    spans = [np.full(events, i) for i in span]
    scales = np.zeros(events), 1.0, np.zeros(events)
    return edges(samples, spans, scales, np.tile(c, (events, 1)), sign, sign, sd)


def test_many_events_show_a_fall_that_noise_hides_in_one():
    """A sample deviates by 2 standard deviations in each of 16 events."""
    t, c = np.arange(40.0), np.zeros(3)
    y = np.where(t > 19.5, -2.0, 0.0)
    *_, bounded = placed((t, y), (0, 20, 22), c, 1, 1.0)
    assert not bounded.any()
    u, error, bounded = placed((t, y), (0, 20, 22), c, 1, 1.0, 16)
    assert bounded.all()
    assert (np.abs(19.5 - u) < 2.0 * error).all()
