"""Times at which falls pass the middle of their levels, between few samples, and their errors."""

import numpy as np
import pytest

from ratestate.records.stick_slip.crossings import middles
from ratestate.records.stick_slip.noise import Noise


def off_and_errors(width, sd=0.0, level_error=0.0, draws=600):
    """Errors (draws,), and standard errors, of the middle of falls by 1 - (t/width)^2.

    A sample is taken in each unit of time, in any phase to the fall; the drop is 1.
    """
    rng, rows = np.random.default_rng(1), []
    for _ in range(draws):
        t = np.arange(-20.0, 20.0) + rng.uniform()
        y = 0.5 - np.clip(t / width, 0.0, 1.0) ** 2 + sd * rng.normal(size=t.size)
        levels = np.array([[0.5], [-0.5]]) + level_error * rng.normal()
        error = np.array([level_error])
        rows += [*middles(t, y, np.array([15]), np.array([39]), levels, error, Noise(sd))]
    time, error = np.array(rows).T
    return time - width * np.sqrt(0.5), error


@pytest.mark.parametrize("width", [0.02, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0])
def test_errors_between_samples_are_honest(width):
    """From falls that are in one step between samples to those in five."""
    off, error = off_and_errors(width)
    assert 0.4 < np.sqrt(np.mean((off / error) ** 2)) < 1.2
    assert np.mean(np.abs(off) < 2.0 * error) > 0.93


def test_a_fall_within_a_step_is_anywhere_in_it():
    off, error = off_and_errors(1e-6)
    np.testing.assert_allclose(error, 12**-0.5, rtol=1e-12)
    assert np.std(off) == pytest.approx(12**-0.5, rel=0.05)


@pytest.mark.parametrize(("width", "sd", "level_error"), [(4.0, 0.05, 0.0), (4.0, 0.0, 0.05)])
def test_noise_and_levels_are_part_of_the_error(width, sd, level_error):
    """Of two steps between samples the line has the error of one sample, at most."""
    off, error = off_and_errors(width, sd, level_error)
    assert 0.7 < np.sqrt(np.mean((off / error) ** 2)) < 1.15
    assert np.median(error) > 2.0 * np.median(off_and_errors(width)[1])


@pytest.mark.parametrize(("sd", "level_error"), [(0.03, 0.0), (0.0, 0.03), (0.03, 0.03)])
def test_errors_on_a_cubic_are_honest(sd, level_error):
    off, error = off_and_errors(15.0, sd, level_error)
    z = off / error
    assert abs(z.mean()) < 0.25
    assert 0.85 < z.std() < 1.15
