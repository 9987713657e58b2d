"""Extremes with known place and value: a kink in noise, and a cubic."""

import numpy as np
import pytest

from ratestate.records.kit.sample_noise import SampleNoise
from ratestate.records.stick_slip.extremes import (
    Extremes,
    FallWindow,
    chosen_window,
    edges,
    extremes,
)


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


def test_the_window_with_the_smaller_contradiction_is_chosen_however_large_both_are(monkeypatch):
    found = {1: 1e150, 2: 1e149, 3: 1e200}  # powers of these overflow

    def contradictory(t, y, middles, window, *_):
        value = np.ones(len(middles))
        return Extremes(value, value, 0.1 * value, value, value, found[window.fall])

    monkeypatch.setattr("ratestate.records.stick_slip.extremes.extremes", contradictory)
    windows = [FallWindow(0.0, 1.0, fall) for fall in found]
    t = np.arange(9.0)
    chosen = chosen_window(t, t, t[:3], windows, 0, 1, None)
    assert chosen.fall == 2
