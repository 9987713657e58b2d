"""Errors of fits if friction is recorded in coarse digits, or the times of steps are uncertain."""

import numpy as np
import pytest
from synthetic_records import FREE, SLIDER, record

import ratestate as rs
from ratestate.records.kit.sample_noise import digit_of

DIGIT = 1e-4
T = np.arange(0.013, 130.0, 0.05)
STEP = rs.Loading.steps("1 um/s", (100.0, "10 um/s"))
START = SLIDER.replace(a=0.005, b=0.01, Dc=3e-5, K=1e11)


def deviations(result, names=FREE):
    """Return the deviations of estimates from the truth, divided by their errors."""
    truth = [getattr(SLIDER, name) for name in names]
    away = np.array([float(result[name]) for name in names]) - truth
    return away / result.standard_error.sel(parameter=list(names)).values


@pytest.fixture(scope="module")
def smooth():
    return record(SLIDER, STEP, T)


def rounded(data, noise, seed):
    rng = np.random.default_rng(seed)
    friction = data.friction + DIGIT * (rng.random() + noise * rng.normal(size=data.time.size))
    return data.assign(friction=DIGIT * np.round(friction / DIGIT))


@pytest.mark.filterwarnings("error::ratestate.errors.FitWarning")
@pytest.mark.parametrize("noise", [0.0, 0.2])
def test_errors_with_little_noise_between_digits(smooth, noise):
    """A plateau of friction has a rounding error of which its mean keeps nearly all."""
    results = [rs.fit(rounded(smooth, noise, seed), START, errors="covariance") for seed in (1, 2)]
    away = np.array([deviations(result) for result in results])
    assert np.abs(away).max() < 3.0
    assert np.sqrt(np.mean(away**2)) > 0.1
    for result in results:
        error = float(result.standard_error.sel(parameter="a_minus_b"))
        assert abs(float(result.a_minus_b) - (SLIDER.a - SLIDER.b)) < 3.0 * error
        assert error < DIGIT


def test_noise_above_the_digits_gives_errors_as_without_digits(smooth):
    rng = np.random.default_rng(1)
    noisy = smooth.assign(friction=smooth.friction + DIGIT * rng.normal(size=T.size))
    fits = [rs.fit(data, START, errors="covariance") for data in (noisy, rounded(noisy, 0.0, 2))]
    free, coarse = (one.standard_error.sel(parameter=list(FREE)).values for one in fits)
    assert coarse == pytest.approx(free, rel=0.15)


def test_digits_of_a_series():
    values = 0.6 + DIGIT * np.array([0.0, 3.0, 4.0, 9.0, 4.0])
    assert digit_of(values) == pytest.approx(DIGIT)
    assert digit_of(values + 0.3 * DIGIT * np.array([0, 0, 0, 1, 0])) == 0.0
    assert digit_of(np.ones(5)) == 0.0


@pytest.mark.parametrize("lag", [0.1, -0.1])
def test_error_of_the_time_of_a_step_widens_errors(smooth, lag):
    """The stored time of the step is wrong by one standard error."""
    noise = 1e-4 * np.random.default_rng(3).normal(size=T.size)
    noisy = smooth.assign(friction=smooth.friction + noise)
    steps = {"segment_t": [T[0], T[0] + 100.0 + lag], "segment_V": [1e-6, 1e-5]}
    steps["segment_t_error"] = [0.0, abs(lag)]
    found = rs.fit(noisy.assign({k: ("segment", v) for k, v in steps.items()}), START)
    assert found.warnings.item() == ""
    assert np.abs(deviations(found)).max() < 3.0
    exact = rs.fit(noisy, START)
    error, least = (float(one.standard_error.sel(parameter="K")) for one in (found, exact))
    assert 1.2 * least < error < 0.2 * SLIDER.K
