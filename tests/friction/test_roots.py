"""Roots of functions and polynomials: each is accurate, whatever the others are."""

import numpy as np
import pytest

from ratestate.friction.roots import polynomial_roots, root, root_between


@pytest.mark.parametrize("slope", [1.0, -1.0])
@pytest.mark.parametrize("zero", [-4.0, -1.0, 0.0, 1.0, 2.0, 8.0])
def test_a_root_at_an_end_of_the_interval(slope, zero):
    low, high = np.array([zero, zero - 3.0]), np.array([zero + 3.0, zero])
    found = root_between(lambda x: slope * (x - zero), low, high)
    np.testing.assert_array_equal(found, zero)
    np.testing.assert_array_equal(root(lambda x: x - zero, np.array([0.0])), zero)


def test_roots_are_real_or_in_conjugate_pairs():
    """This holds for nearly coinciding roots too."""
    rng = np.random.default_rng(4)
    c = np.array([np.poly(rng.choice([1.0, -2.0, 3.0], 4)) for _ in range(200)])
    found = polynomial_roots(c)
    np.testing.assert_array_equal(np.sort_complex(found), np.sort_complex(found.conj()))
    back = np.array([np.poly(z) for z in found])
    np.testing.assert_allclose(back, c, atol=2e-3 * np.abs(c).max())


@pytest.mark.parametrize("first", [[1.0, np.nan], [1.0, np.inf], [0.0, 1.0], [5e-324, 1.0]])
def test_roots_are_nan_if_a_root_or_coefficient_is_not_finite(first):
    found = polynomial_roots(np.array([[*first, 2.0, 1.0], [1.0, -6.0, 11.0, -6.0]]))
    assert np.isnan(found[0]).all()
    np.testing.assert_allclose(np.sort_complex(found[1]), [1.0, 2.0, 3.0], rtol=1e-14)
    assert polynomial_roots(np.empty((0, 4))).shape == (0, 3)


@pytest.mark.parametrize(
    "function", [np.sinh, np.cbrt, np.sign, lambda x: np.expm1(30.0 * x), lambda x: x**3]
)
def test_roots_of_functions(function):
    """Roots are exact to rounding, for smooth functions and others; NaN without a root."""
    roots = np.array([0.0, 1e-9, -3.0, 50.0, -700.0])
    allowed = 1e-15 * np.abs(roots) + 1e-20
    between = root_between(lambda x: -function(x - roots), roots - 1.0, roots + np.e)
    assert (np.abs(between - roots) <= allowed).all()
    around = root(lambda x: function(x - roots), roots[::-1])
    assert (np.abs(around - roots) <= allowed).all()
    assert np.isnan(root(lambda x: function(x) ** 2 + 1.0, roots)).all()
