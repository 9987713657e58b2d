"""Peaks and troughs between samples: where the lines on both sides of a fall's end meet."""

import numpy as np
import pytest

from ratestate.records.stick_slip.between_samples import with_spikes
from ratestate.records.stick_slip.detection import Noise

#: times of the samples of one fall; period of the falls
STEPS, PERIOD = np.arange(-20.0, 20.0), 100.0


def overshooting(phases, sd, rng, height=0.1, relaxes=0.6):
    """Times and stresses of falls from t = -1 to the trough of -1 - height at 0.

    The overshoot relaxes in this time, so that the loading seems to begin at -1.
    """
    t, y = [], []
    for k, phase in enumerate(phases):
        u = STEPS + phase
        after = -1.0 + 0.001 * u - height * np.exp(-np.maximum(u, 0.0) / relaxes)
        before = np.minimum(-(1.0 + height) * (1.0 + u), 0.0)
        y.append(np.where(u > 0.0, after, before) + sd * rng.normal(size=u.size))
        t.append(u + PERIOD * k)
    return np.concatenate(t), np.concatenate(y)


@pytest.mark.parametrize("sign", [-1, 1])
@pytest.mark.parametrize("sd", [0.0, 0.005])
def test_errors_cover_what_is_between_samples(sd, sign):
    """In any phase of the samples to the overshoot; the same for a peak, backwards and down."""
    rng = np.random.default_rng(1)
    phases = rng.uniform(0.0, 1.0, 40)
    t, y = overshooting(phases, sd, rng)
    middle = PERIOD * np.arange(40) - 0.6
    found = np.column_stack([np.full(40, -1.0), np.full(40, 0.6 * sd + 1e-6), middle, middle])
    if sign > 0:
        t, y, middle = -t[::-1], -y[::-1], -middle
        found[:, 0] *= -1.0
    value, error, time, time_error = with_spikes(t, y, middle, found, sign, Noise(sd)).T
    off = (value - sign * 1.1) / error
    assert (np.abs(off) < 2.0).mean() > 0.9
    assert np.sqrt(np.mean(off**2)) > 0.15
    assert (error < 0.15).all()
    assert (np.abs(time - np.sign(-sign) * PERIOD * np.arange(40)) <= 2.0 * time_error).all()


@pytest.mark.parametrize("events", [1, 8, 40])
def test_noise_makes_no_overshoot(events):
    rng, kept = np.random.default_rng(2), 0
    for _ in range(100):
        t, y = overshooting(rng.uniform(size=events), 0.02, rng, height=0.0)
        found = np.tile([-1.0, 0.012, 0.0, 1.0], (events, 1))
        made = with_spikes(t, y, PERIOD * np.arange(events) - 0.6, found, -1, Noise(0.02))
        kept += np.array_equal(made, found)
    assert kept >= 98
