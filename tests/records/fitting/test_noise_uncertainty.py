"""How the uncertainty of the noise widens errors, in a linear fit."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import norm
from synthetic_records import correlated, power_law

from ratestate.records.fitting.noise_uncertainty import (
    _quantile,
    likely_noise,
)
from ratestate.records.fitting.problem import SamplesProblem
from ratestate.records.fitting.quantities import GAUSSIAN
from ratestate.records.kit.noise import Noise, RestrictedLikelihood, estimated_noise

T = np.linspace(0.0, 10.0, 300)
# level, trend, and a transient that is over after a tenth of the record
JACOBIAN = np.column_stack([np.ones(T.size), T / 10.0, np.where(T > 4, np.exp(4 - T), 0.0)])
TRANSIENT = np.eye(3)[2:]


def fitted(noise):
    """Return a solution of least squares, and the estimate divided by its error."""
    shape = estimated_noise(RestrictedLikelihood(T, noise, JACOBIAN))[0]
    white, _ = shape.whiten(T, np.column_stack([noise, JACOBIAN]))
    covariance = np.linalg.inv(white[:, 1:].T @ white[:, 1:])
    point = covariance @ (white[:, 1:].T @ white[:, 0])
    problem = SamplesProblem.__new__(SamplesProblem)
    problem.t = T
    solution = SimpleNamespace(
        problem=problem,
        residual=noise - JACOBIAN @ point,
        jacobian=JACOBIAN,
        root=np.linalg.cholesky(covariance),
        noise=shape,
        peaks=None,
    )
    return solution, float(point[2] / np.sqrt(covariance[2, 2]))


def slow(rng):
    return np.sqrt(0.2) * rng.normal(size=T.size) + np.sqrt(0.8) * correlated(T, 2.0, rng)


def flicker(rng):
    return power_law(T.size, 1.0, rng)


@pytest.mark.statistics
@pytest.mark.parametrize("draw", [slow, flicker])
def test_intervals_in_slow_noise_contain_the_truth(draw):
    hold, widths = [], []
    for seed in range(60):
        solution, deviation = fitted(draw(np.random.default_rng(seed)))
        below, above = likely_noise(solution).widening(TRANSIENT).roots[0, 1]
        hold.append(-above <= deviation <= below)
        widths.append((below + above) / GAUSSIAN[1].sum())
    assert 0.9 < np.mean(hold) < 1.0
    assert 1.01 < np.mean(widths) < 1.6


def test_intervals_in_white_noise_are_hardly_wider():
    rng = np.random.default_rng(5)
    solutions = [fitted(rng.normal(size=T.size))[0] for _ in range(20)]
    roots = np.array(
        [likely_noise(solution).widening(TRANSIENT).roots[0, 1] for solution in solutions]
    )
    widths = roots.sum(axis=1) / GAUSSIAN[1].sum()
    assert np.all(widths > 0.98)
    assert 1.0 <= np.median(widths) < 1.12


def test_a_coordinate_without_effect_is_not_widened():
    solution, _ = fitted(np.random.default_rng(1).normal(size=T.size))
    solution.jacobian = np.column_stack([JACOBIAN, np.zeros(T.size)])
    solution.root = np.diag([*np.linalg.norm(solution.root, axis=1), 1e9])
    both = likely_noise(solution).widening(np.eye(4)[2:])
    assert both.errors[1] == 1.0
    np.testing.assert_array_equal(both.roots[1], GAUSSIAN)
    assert both.errors[0] > 1.0


@pytest.mark.parametrize("part", [0.025, 0.16, 0.5, 0.975])
def test_quantiles_of_a_mixture(part):
    """Compare with samples, and with one Gaussian in closed form."""
    alone = _quantile(np.ones(1), np.full((1, 1), 3.0), np.full((1, 1), 2.0), part)
    assert alone == pytest.approx(3.0 + 2.0 * norm.ppf(part), abs=1e-9)
    weight, means, spreads = (
        np.array([0.7, 0.3]),
        np.array([[0.0], [4.0]]),
        np.array([[1.0], [2.0]]),
    )
    rng = np.random.default_rng(0)
    which = (rng.random(400_000) < 0.3).astype(int)
    samples = means[which, 0] + spreads[which, 0] * rng.normal(size=which.size)
    assert _quantile(weight, means, spreads, part)[0] == pytest.approx(
        np.quantile(samples, part), abs=0.03
    )


def test_the_shift_and_covariance_agree_with_generalized_least_squares():
    """Compare with dense matrices."""
    rng = np.random.default_rng(2)
    residual = correlated(T, 1.0, rng) + 0.5 * rng.normal(size=T.size)
    share, time = 0.7, 1.3
    gaps = np.abs(T[:, None] - T)
    unit = (1.0 - share) * np.eye(T.size) + share * np.exp(-gaps / time)
    inverse = np.linalg.inv(unit)
    normal = JACOBIAN.T @ inverse @ JACOBIAN
    shift = np.linalg.solve(normal, JACOBIAN.T @ inverse @ residual)
    left = residual - JACOBIAN @ shift
    variance = left @ inverse @ left / (T.size - 3)
    shape = Noise(np.sqrt(1.0 - share), np.sqrt(share), time)
    likelihood = RestrictedLikelihood(T, residual, JACOBIAN)
    found = likelihood.at(shape)
    found_shift, root = likelihood.shift_and_root(found.factor)
    np.testing.assert_allclose(found_shift, shift, rtol=1e-9)
    assert found.noise.level**2 == pytest.approx(variance, rel=1e-10)
    assert found.noise.time == time
    np.testing.assert_allclose(
        root @ root.T, variance * np.linalg.inv(normal), rtol=1e-9, atol=1e-15
    )


def test_inflation_of_several_coordinates_does_not_depend_on_their_units_or_axes():
    rng = np.random.default_rng(3)
    solution, _ = fitted(correlated(T, 2.0, rng) + 0.5 * rng.normal(size=T.size))
    found = likely_noise(solution).inflation([1, 2])
    axes = np.array([[1.0, 0.0, 0.0], [0.0, 3e4, 0.0], [2e-4, 5e-4, 1e-3]]).T
    moved = SimpleNamespace(**vars(solution) | {"jacobian": JACOBIAN @ axes})
    np.testing.assert_allclose(likely_noise(moved).inflation([1, 2]), found, rtol=1e-6)
    unseen = np.column_stack([solution.jacobian, np.zeros(T.size)])
    more = SimpleNamespace(**vars(solution) | {"jacobian": unseen})
    np.testing.assert_allclose(likely_noise(more).inflation([1, 2, 3]), found, rtol=1e-2)
    assert likely_noise(more).inflation([3]) == (1.0, 0.0)


@pytest.mark.statistics
def test_inflation_corrects_for_the_error_of_the_noise():
    """The mean square of deviations divided by errors is 1 only with the inflation."""
    squares, factors = [], []
    for seed in range(150):
        solution, deviation = fitted(slow(np.random.default_rng(seed)))
        squares.append(deviation**2)
        factors.append(likely_noise(solution).inflation([2]).factor)
    assert np.mean(squares) > 1.1
    assert 0.8 < np.mean(squares) / np.mean(factors) < 1.2
