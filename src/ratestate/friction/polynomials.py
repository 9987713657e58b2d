"""Polynomials with real coefficients, in arrays: their products and their roots."""

import numpy as np

# Steps of the iteration for roots; some ten are needed, more where roots are all but equal.
MAX_STEPS = 60


def product(factors):
    """The product of polynomials, coefficients along the last axis, highest first."""
    product = factors[0]
    for factor in factors[1:]:
        size = product.shape[-1] + factor.shape[-1] - 1
        longer = np.zeros((*product.shape[:-1], size), product.dtype)
        for i in range(factor.shape[-1]):
            longer[..., i : i + product.shape[-1]] += factor[..., i, None] * product
        product = longer
    return product


def roots(c):
    """(..., n) complex roots of polynomials, coefficients (..., n + 1), highest first, not 0.

    By the iteration of Ehrlich and Aberth from the moduli that Newton's polygon gives, as in Bini
    (1996, doi:10.1007/BF02207694): roots may differ by many orders of magnitude, and each has its
    own digits.  Those of a complex pair are conjugate, and a real root is exactly so.  NaN where
    a coefficient is not finite.
    """
    found = np.full((*c.shape[:-1], c.shape[-1] - 1), np.nan, complex)
    finite = np.isfinite(c).all(axis=-1)
    found[finite] = _conjugate(_iterated(c[finite]))
    return found


def _iterated(c):
    """`roots` of polynomials (m, n + 1)."""
    z, moving = _starts(c), np.arange(len(c))
    with np.errstate(all="ignore"):  # of roots that are 0
        for _ in range(MAX_STEPS):
            now = z[moving]
            newton = _newton_step(c[moving], now)
            apart = now[:, :, None] - now[:, None, :]
            repulsion = np.where(apart == 0.0, 0.0, 1.0 / apart).sum(axis=-1)
            step = newton / (1.0 - newton * repulsion)
            step[~np.isfinite(step)] = 0.0
            z[moving] = now - step
            moving = moving[(np.abs(step) > 2e-16 * np.abs(now)).any(axis=-1)]
            if not len(moving):
                break
    return z


def _starts(c):
    """(m, n) numbers of about the moduli of the roots: slopes of the hull of ln |c_k| over k."""
    n = c.shape[-1] - 1
    with np.errstate(divide="ignore"):
        height = np.log(np.abs(c))
    hull = height.copy()
    for k in range(1, n):
        for i in range(k):
            for j in range(k + 1, n + 1):
                between = ((j - k) * height[:, i] + (k - i) * height[:, j]) / (j - i)
                hull[:, k] = np.maximum(hull[:, k], between)
    with np.errstate(invalid="ignore"):
        modulus = np.exp(np.nan_to_num(np.diff(hull), nan=-np.inf, posinf=np.inf, neginf=-np.inf))
    return modulus * np.exp(1j * (0.7 + 2.0 * np.pi * np.arange(n) / n))


def _newton_step(c, z):
    """(m, n) p/p' at z, by the reversed polynomial where |z| > 1, so that nothing overflows."""
    n, large = c.shape[-1] - 1, np.abs(z) > 1.0
    x = np.where(large, 1.0 / z, z)
    value, slope = np.zeros_like(z), np.zeros_like(z)
    for k in range(n + 1):
        slope = slope * x + value
        value = value * x + np.where(large, c[:, None, n - k], c[:, None, k])
    return np.where(large, z / (n - x * slope / value), value / slope)


def _conjugate(z):
    """Roots (m, n) made real, or conjugate to another one, whichever is nearer."""
    other = np.abs(z[:, :, None].conj() - z[:, None, :]).argmin(axis=-1)
    return 0.5 * (z + np.take_along_axis(z, other, axis=-1).conj())
