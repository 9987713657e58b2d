"""Times at which falls cross the middle of their levels, with few samples, and their errors."""

import numpy as np
import pytest

from ratestate.records.kit.sample_noise import SampleNoise
from ratestate.records.stick_slip.between_samples import middles

#: name -> (fall from 1/2 to -1/2 against time divided by its width, time of the middle)
FALLS = {
    "parabola": (lambda u: 0.5 - np.clip(u, 0.0, 1.0) ** 2, 0.5**0.5),
    "exponential": (lambda u: np.exp(-np.maximum(u, 0.0)) - 0.5, np.log(2.0)),
    "growing": (lambda u: 0.5 - np.exp(np.minimum(u, 0.0)), -np.log(2.0)),
    "half-cosine": (lambda u: 0.5 * np.cos(np.pi * np.clip(u, 0.0, 1.0)), 0.5),
    "line": (lambda u: 0.5 - np.clip(u, 0.0, 1.0), 0.5),
}


def deviations_and_errors(width, sd=0.0, level_error=0.0, draws=600, shape="parabola", uneven=0.0):
    """Return true and standard errors (draws,) of the middle of falls of this shape and width.

    The drop is 1.  Samples have a spacing of 1, a random phase, and random shifts up to `uneven`.
    """
    rng, rows = np.random.default_rng(1), []
    fall, middle = FALLS[shape]
    for _ in range(draws):
        t = np.arange(-40.0, 60.0) + rng.uniform() + uneven * rng.uniform(-1.0, 1.0, 100)
        y = fall(t / width) + sd * rng.normal(size=t.size)
        high, low = np.array([[0.5], [-0.5]]) + level_error * rng.normal()
        falls = np.array([10]), np.array([95])
        found = middles(t, y, *falls, high, low, np.array([level_error]), SampleNoise(sd))
        rows.append(found[:, 0])
    time, error = np.array(rows).T
    return time - width * middle, error


def z_of(width, *arguments, **shape):
    """Return the root mean square of error/standard error, and the fraction below 2."""
    off, error = deviations_and_errors(width, *arguments, **shape)
    return np.sqrt(np.mean((off / error) ** 2)), np.mean(np.abs(off) < 2.0 * error)


@pytest.mark.parametrize("width", [0.02, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0])
def test_errors_between_samples_are_calibrated(width):
    """Falls last from less than one to five steps between samples."""
    size, within = z_of(width)
    assert 0.35 < size < 1.2
    assert within > 0.93


@pytest.mark.parametrize("uneven", [0.0, 0.3])
@pytest.mark.parametrize("sd", [1e-4, 1e-3])
@pytest.mark.parametrize(
    ("shape", "widths"),
    [
        ("exponential", (1.0, 2.0, 3.0, 4.0)),
        ("growing", (1.0, 2.0, 3.0, 4.0)),
        ("half-cosine", (0.1, 0.5)),
        ("line", (0.1, 0.5, 4.5, 5.5)),
    ],
)
def test_errors_include_the_curvature(shape, widths, sd, uneven):
    """A curved fall deviates from the line between samples by its second difference."""
    for width in widths:
        size, _ = z_of(width, sd, sd / 3.0, 300, shape=shape, uneven=uneven)
        assert 0.5 < size < 1.35


def test_a_fall_within_a_step_has_a_uniform_error():
    off, error = deviations_and_errors(1e-6)
    np.testing.assert_allclose(error, 12**-0.5, rtol=1e-12)
    assert np.std(off) == pytest.approx(12**-0.5, rel=0.05)


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
