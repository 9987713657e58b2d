"""Times at which falls cross the middle of their levels, with few samples, and their errors."""

import numpy as np
import pytest

from ratestate.records.kit.sample_noise import SampleNoise
from ratestate.records.stick_slip.between_samples import middles


def deviations_and_errors(width, sd=0.0, level_error=0.0):
    """Return true and standard errors (600,) of the middle of parabolic falls of this width.

    The drop is 1.  Samples have a spacing of 1 and a random phase.
    """
    rng, rows = np.random.default_rng(1), []
    for _ in range(600):
        t = np.arange(-40.0, 60.0) + rng.uniform()
        y = 0.5 - np.clip(t / width, 0.0, 1.0) ** 2 + sd * rng.normal(size=t.size)
        high, low = np.array([[0.5], [-0.5]]) + level_error * rng.normal()
        falls = np.array([10]), np.array([95])
        found = middles(t, y, *falls, high, low, np.array([level_error]), SampleNoise(sd))
        rows.append(found[:, 0])
    time, error = np.array(rows).T
    return time - width * 0.5**0.5, error


@pytest.mark.parametrize("width", [0.02, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0])
def test_errors_between_samples_are_calibrated(width):
    """Falls last from less than one to five steps between samples."""
    off, error = deviations_and_errors(width)
    assert 0.35 < np.sqrt(np.mean((off / error) ** 2)) < 1.2
    assert np.mean(np.abs(off) < 2.0 * error) > 0.93


@pytest.mark.parametrize(
    ("width", "sd", "level_error"),
    [(4.0, 0.05, 0.0), (4.0, 0.0, 0.05), (15.0, 0.03, 0.0), (15.0, 0.0, 0.03), (15.0, 0.03, 0.03)],
)
def test_noise_and_levels_are_part_of_the_error(width, sd, level_error):
    """The crossing is on a line between two samples, or on a cubic."""
    off, error = deviations_and_errors(width, sd, level_error)
    assert abs(np.mean(off / error)) < 0.25
    assert (0.7 if width == 4.0 else 0.85) < np.sqrt(np.mean((off / error) ** 2)) < 1.15
    assert np.median(error) > 2.0 * np.median(deviations_and_errors(width)[1])


def test_noise_may_raise_the_last_sample_of_a_fall():
    t = np.arange(20.0)
    y = np.interp(t, [5.0, 10.0], [0.5, -0.5])
    y[12] = 0.45
    levels = np.array([0.5]), np.array([-0.5]), np.zeros(1)
    falls = np.array([3]), np.array([12])
    (time,), (error,) = middles(t, y, *falls, *levels, SampleNoise(0.01))
    assert abs(time - 7.5) < error < 0.5
