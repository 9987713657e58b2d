"""Levenberg-Marquardt within bounds, against SciPy's least squares and closed forms."""

import numpy as np
import pytest
from scipy.optimize import least_squares, lsq_linear

from ratestate.records.kit.least_squares import CONVERGED, minimum

FREE = np.full(3, -np.inf), np.full(3, np.inf)
T = np.linspace(0.0, 4.0, 200)


def decay(x):
    """x[0] exp(-x[1] t) + x[2], and its derivatives."""
    e = np.exp(-x[1] * T)
    return x[0] * e + x[2], np.column_stack([e, -x[0] * T * e, np.ones(T.size)])


def problem(seed):
    """A decay in noise, as a function, and where a search may start."""
    rng = np.random.default_rng(seed)
    truth = rng.uniform((1.0, 0.3, -1.0), (3.0, 3.0, 1.0))
    data = decay(truth)[0] + 0.1 * rng.normal(size=T.size)

    def function(x):
        value, jacobian = decay(x)
        return value - data, jacobian

    return function, truth * rng.uniform(0.4, 2.5, 3)


def reference(function, start, low, high):
    keys = {"ftol": 1e-14, "xtol": 1e-14, "gtol": 1e-14}
    inside = np.clip(start, low + 1e-9, high - 1e-9)
    return least_squares(
        lambda x: function(x)[0], inside, lambda x: function(x)[1], bounds=(low, high), **keys
    )


@pytest.mark.parametrize("seed", range(6))
def test_a_search_ends_within_its_tolerance_of_the_minimum(seed):
    function, start = problem(seed)
    found, exact = minimum(function, start, *FREE, 100), reference(function, start, *FREE)
    covariance = np.linalg.inv(exact.jac.T @ exact.jac) * 2.0 * exact.cost / T.size
    off = found.x - exact.x
    assert found.converged
    assert np.sqrt(off @ np.linalg.solve(covariance, off)) < np.sqrt(T.size * CONVERGED)
    assert found.cost == pytest.approx(exact.cost, rel=1e-8)
    assert function(found.x)[0] @ function(found.x)[0] == pytest.approx(2.0 * found.cost, rel=1e-8)
    assert found.jacobian == pytest.approx(exact.jac, rel=1e-2, abs=1e-3)


def test_a_bound_on_the_way_does_not_hold():
    """A start on the bound leaves it; one beyond it is moved to it first."""
    function, start = problem(3)
    exact = reference(function, start, *FREE).x
    low, high = exact - 0.2, exact + 5.0
    for first in (low, low - 1.0):
        assert minimum(function, first, low, high, 100).x == pytest.approx(exact, abs=1e-3)


def test_the_last_step_of_least_squares_needs_no_evaluation():
    """A linear problem: of two steps, the second ends at the minimum, without an evaluation."""
    rng = np.random.default_rng(0)
    A, b = rng.normal(size=(40, 3)), rng.normal(size=40)
    calls = []

    def function(x):
        calls.append(x)
        return A @ x - b, A

    found = minimum(function, np.array([3.0, -2.0, 1.0]), *FREE, 100)
    exact, (squares,) = np.linalg.lstsq(A, b, rcond=None)[:2]
    assert found.x == pytest.approx(exact, abs=1e-7)
    assert 2.0 * found.cost == pytest.approx(squares, rel=1e-10)
    assert 3 <= len(calls) <= 4
    assert all((found.x != x).any() for x in calls)


def test_a_search_avoids_points_without_motion():
    function, start = problem(1)
    exact = reference(function, start, *FREE).x
    edge = 1.05 * exact[1]

    def bounded(x):
        residual, jacobian = function(x)
        return (residual if x[1] < edge else np.full_like(residual, np.nan)), jacobian

    assert minimum(bounded, np.array([0.2, 10.0, 0.0]), *FREE, 100) is None
    found = minimum(bounded, np.array([0.2, 0.05, 0.0]), *FREE, 100)
    assert found.x == pytest.approx(exact, abs=1e-3)


@pytest.mark.parametrize("start", [5.0, 14.0, 20.0, 25.0])
def test_a_start_with_large_derivatives_converges(start):
    """e**x against the mean of what is recorded, 1."""
    data = np.array([1.0, 1.2, 0.8])

    def function(x):
        return np.exp(x[0]) - data, np.full((3, 1), np.exp(x[0]))

    found = minimum(function, np.array([start]), *(x[:1] for x in FREE), 100)
    assert found.converged
    assert found.x[0] == pytest.approx(0.0, abs=1e-4)


def test_collinear_columns_within_bounds():
    """Linear problems, two columns nearly alike, of any scale, against the exact solution."""
    rng = np.random.default_rng(0)
    held = 0
    for _ in range(150):
        k = rng.integers(2, 6)
        A = rng.normal(size=(30, k))
        A[:, 1] = A[:, 0] + 10.0 ** rng.uniform(-6.0, -1.0) * A[:, 1]
        A *= 10.0 ** rng.uniform(-6.0, 6.0, k)
        size = 1.0 / np.linalg.norm(A, axis=0)
        truth = size * rng.normal(size=k)
        b = A @ truth + 10.0 ** rng.uniform(-6.0, 0.0) * rng.normal(size=30)
        low = truth + size * rng.uniform(-2.0, 0.5, k)
        high = low + size * rng.uniform(0.1, 3.0, k)
        found = minimum(lambda x, A=A, b=b: (A @ x - b, A), low, low, high, 200)
        best = lsq_linear(A * size, b, (low / size, high / size), method="bvls", tol=1e-14)
        cost = 0.5 * np.sum((A @ found.x - b) ** 2)
        assert found.converged
        assert cost == pytest.approx(best.cost, rel=1e-5)
        assert found.cost == pytest.approx(cost, rel=1e-6)
        held += ((found.x == low) | (found.x == high)).any()
    assert held > 60


def test_an_end_at_the_edge_of_motion_is_not_a_minimum():
    """Least on the edge x + 2 y = 2 is (1.8, 0.1), and no search gets there."""

    def function(x):
        residual = np.array([x[0] - 3.0, x[1] - 1.0, 10.0])
        moves = x[0] + 2.0 * x[1] <= 2.0
        return residual if moves else residual * np.nan, np.eye(3)[:, :2]

    found = minimum(function, np.zeros(2), *(x[:2] for x in FREE), 200)
    assert 2.0 * found.cost > 100.5
    assert not found.converged


@pytest.mark.parametrize("most", [1, 2, 3])
def test_no_more_evaluations_than_allowed(most):
    function, start = problem(4)
    calls = []

    def counted(x):
        calls.append(x)
        return function(x)

    found = minimum(counted, start, *FREE, most)
    assert len(calls) == most
    assert not found.converged
    assert 2.0 * found.cost == pytest.approx(min(np.sum(function(x)[0] ** 2) for x in calls))
