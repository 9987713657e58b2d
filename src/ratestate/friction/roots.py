"""Roots, in arrays: of increasing functions, and of polynomials."""

import numpy as np

# Steps of the iteration for roots; about ten are needed, more if roots almost coincide.
MAX_STEPS = 60
# Relative length of a step after which the next would be rounding alone.
CONVERGED = 1e-14


@np.errstate(all="ignore")  # (if a root does not matter there may be none)
def root(off, start, where=True):
    """The root (n,) of an increasing function, within some 4000 of the start; NaN if there is none.

    off : the function, of (n,), giving (n,)
    start : (n,) near the root
    where : (n,) whether the root matters; NaN if not
    """
    start = np.where(where, start, np.nan)
    low, high = start - 1.0, start + 1.0
    for width in 2.0 ** np.arange(12):
        is_above, is_below = off(low) > 0.0, off(high) < 0.0
        if not (is_above | is_below).any():
            break
        low, high = np.where(is_above, low - width, low), np.where(is_below, high + width, high)
    return root_between(off, low, high)


@np.errstate(all="ignore")
def root_between(off, low, high):
    """The root of a function between numbers at which its signs differ; NaN if they do not.

    Each is found by inverse quadratic interpolation, or else bisection, to rounding.

    Source: Chandrupatla (1997) doi:10.1016/S0965-9978(96)00051-8.
    """
    x, y, other, y_other = high, off(high), low, off(low)
    found = np.where(np.sign(y) * np.sign(y_other) <= 0.0, x, np.nan)
    found = np.where(y_other == 0.0, other, found)
    done = np.isnan(found) | (y == 0.0) | (y_other == 0.0)
    part = np.full(np.shape(found), 0.5)
    for _ in range(2 * MAX_STEPS):
        if done.all():
            break
        new = x + part * (other - x)
        y_new = off(new)
        stays = (y_new > 0.0) == (y > 0.0)  # (and x is left out, else the other)
        left, y_left = np.where(stays, x, other), np.where(stays, y, y_other)
        other, y_other = np.where(stays, other, x), np.where(stays, y_other, y)
        x, y = new, y_new
        found = np.where(done, found, np.where(np.abs(y) < np.abs(y_other), x, other))
        least = 2.0**-52 * np.abs(found) / np.abs(other - x)
        done = done | (y == 0.0) | ~(least < 0.5)
        u, f = (x - other) / (left - other), (y - y_other) / (y_left - y_other)
        smooth = (f**2 < u) & ((1.0 - f) ** 2 < 1.0 - u)
        bent = y / (y_other - y) * y_left / (y_other - y_left)
        bent = bent + (left - x) / (other - x) * y / (y_left - y) * y_other / (y_left - y_other)
        part = np.clip(np.where(smooth, bent, 0.5), least, 1.0 - least)
    return found


def polynomial_roots(c):
    """(..., n) complex roots of polynomials, coefficients (..., n + 1), highest first, n > 0.

    Closed form for degree 2, else the iteration of Ehrlich and Aberth from the moduli that
    Newton's polygon gives, as in Bini (1996, doi:10.1007/BF02207694): roots may differ by many
    orders of magnitude, and each has its own digits.  They are real, or in conjugate pairs.  All
    are NaN if a coefficient is not finite, or the first so small that a root is not.
    """
    n = c.shape[-1] - 1
    found = np.full((*c.shape[:-1], n), np.nan, complex)
    usable = np.isfinite(c).all(axis=-1) & (c[..., 0] != 0.0)
    c = c[usable]
    # (a power of 2, which leaves the digits, lest sums overflow)
    c = np.ldexp(c, -np.frexp(np.abs(c).max(axis=-1, keepdims=True, initial=1e-300))[1])
    with np.errstate(all="ignore"):  # of roots that are 0, or not finite
        z = _conjugate(_quadratic(c) if n == 2 else _iterated(c))
        z[~np.isfinite(z).all(axis=-1)] = np.nan
    found[usable] = z
    return found


def _quadratic(c):
    """(m, 2) roots of polynomials (m, 3), neither as a difference of like numbers."""
    a, b, last = c.T
    root = np.sqrt((b * b - 4.0 * a * last).astype(complex))
    larger = -0.5 * (b + np.where(b < 0.0, -root, root))
    return np.stack([larger / a, np.where(larger == 0.0, 0.0, last / larger)], axis=-1)


def _iterated(c):
    """`polynomial_roots` of polynomials (m, n + 1); NaN where one is beyond all numbers."""
    z = _starts(c)
    z[~np.isfinite(z).all(axis=-1)] = np.nan
    moving = np.arange(len(c))
    for _ in range(MAX_STEPS):
        now = z[moving]
        apart = now[:, :, None] - now[:, None, :]
        repulsion = np.where(apart == 0.0, 0.0, 1.0 / apart).sum(axis=-1)
        step = 1.0 / (_slope_over_value(c[moving], now) - repulsion)
        step[~np.isfinite(step)] = 0.0  # where the value is 0, or all but
        z[moving] = now - step
        moving = moving[(np.abs(step) > CONVERGED * np.abs(now)).any(axis=-1)]
        if not len(moving):
            break
    return z


def _starts(c):
    """(m, n) numbers of about the moduli of the roots: slopes of the hull of ln |c_k| over k."""
    n = c.shape[-1] - 1
    height = np.log(np.abs(c))
    hull = height.copy()
    for k in range(1, n):
        for i in range(k):
            for j in range(k + 1, n + 1):
                between = ((j - k) * height[:, i] + (k - i) * height[:, j]) / (j - i)
                hull[:, k] = np.maximum(hull[:, k], between)
    slope = np.diff(hull)  # -inf for roots that are 0, NaN after the first of them
    modulus = np.exp(np.where(np.isnan(slope), -np.inf, slope))
    return modulus * np.exp(1j * (0.7 + 2.0 * np.pi * np.arange(n) / n))


def _slope_over_value(c, z):
    """p'/p at z, (m, n); where |z| > 1 by the reversed polynomial, lest p overflow."""
    n, large = c.shape[-1] - 1, np.abs(z) > 1.0
    x = np.where(large, 1.0 / z, z)
    value, slope = np.zeros_like(z), np.zeros_like(z)
    for k in range(n + 1):
        slope = slope * x + value
        value = value * x + np.where(large, c[:, None, n - k], c[:, None, k])
    return np.where(large, x * (n - x * slope / value), slope / value)


def _conjugate(z):
    """Roots (m, n) in conjugate pairs, each nearest to the other's conjugate; all others real."""
    other = np.abs(z[:, :, None].conj() - z[:, None, :]).argmin(axis=-1)
    paired = np.take_along_axis(other, other, axis=-1) == np.arange(z.shape[-1])
    mean = 0.5 * z + 0.5 * np.take_along_axis(z, other, axis=-1).conj()
    return np.where(paired, mean, z.real)
