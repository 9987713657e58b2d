"""Roots of increasing functions and of polynomials, in arrays."""

import numpy as np

# Limit on iterations; about ten are needed, more if roots almost coincide.
MAX_STEPS = 60
# Relative length of a step after which only rounding is left.
CONVERGED = 1e-14


@np.errstate(all="ignore")  # a root that is not needed may not exist
def root(function, start, where=True):
    """Return the root (n,) of an increasing function, within about 4000 of the start.

    function : takes and returns (n,)
    start : (n,) near the root
    where : (n,) whether the root is needed; the result is NaN if not, or without a root
    """
    start = np.where(where, start, np.nan)
    low, high = start - 1.0, start + 1.0
    for width in 2.0 ** np.arange(12):
        is_above, is_below = function(low) > 0.0, function(high) < 0.0
        if not (is_above | is_below).any():
            break
        low, high = np.where(is_above, low - width, low), np.where(is_below, high + width, high)
    return root_between(function, low, high)


@np.errstate(all="ignore")
def root_between(function, low, high):
    """Return the root of a function between numbers where its signs differ, or NaN.

    The method is inverse quadratic interpolation, or bisection, to rounding.

    Source: Chandrupatla (1997) doi:10.1016/S0965-9978(96)00051-8.
    """
    x, y, other, y_other = high, function(high), low, function(low)
    best = np.where(np.sign(y) * np.sign(y_other) <= 0.0, x, np.nan)
    best = np.where(y_other == 0.0, other, best)
    is_done = np.isnan(best) | (y == 0.0) | (y_other == 0.0)
    fraction = np.full(np.shape(best), 0.5)
    for _ in range(2 * MAX_STEPS):
        if is_done.all():
            break
        new = x + fraction * (other - x)
        y_new = function(new)
        keeps_sign = (y_new > 0.0) == (y > 0.0)  # then x is dropped, else `other`
        dropped, y_dropped = np.where(keeps_sign, x, other), np.where(keeps_sign, y, y_other)
        other, y_other = np.where(keeps_sign, other, x), np.where(keeps_sign, y_other, y)
        x, y = new, y_new
        best = np.where(is_done, best, np.where(np.abs(y) < np.abs(y_other), x, other))
        least = 2.0**-52 * np.abs(best) / np.abs(other - x)
        is_done = is_done | (y == 0.0) | ~(least < 0.5)
        u, f = (x - other) / (dropped - other), (y - y_other) / (y_dropped - y_other)
        smooth = (f**2 < u) & ((1.0 - f) ** 2 < 1.0 - u)
        inverse = y / (y_other - y) * y_dropped / (y_other - y_dropped)
        ratio = (dropped - x) / (other - x)
        inverse = inverse + ratio * y / (y_dropped - y) * y_other / (y_dropped - y_other)
        fraction = np.clip(np.where(smooth, inverse, 0.5), least, 1.0 - least)
    return best


def polynomial_roots(c):
    """Return the complex roots (..., n) of polynomials, real or in conjugate pairs.

    The method is a closed form for degree 2, else the iteration of Ehrlich and Aberth from the
    moduli of Newton's polygon, as in Bini (1996, doi:10.1007/BF02207694): each root is accurate
    even if roots differ by many orders of magnitude.  All are NaN if a coefficient or a root is not
    finite.

    c : coefficients (..., n + 1), the highest power first, n > 0
    """
    n = c.shape[-1] - 1
    roots = np.full((*c.shape[:-1], n), np.nan, complex)
    usable = np.isfinite(c).all(axis=-1) & (c[..., 0] != 0.0)
    c = c[usable]
    # scale by a power of 2, which keeps all digits, to prevent overflow of sums
    c = np.ldexp(c, -np.frexp(np.abs(c).max(axis=-1, keepdims=True, initial=1e-300))[1])
    with np.errstate(all="ignore"):  # roots may be 0 or not finite
        z = _pair_conjugates(_quadratic(c) if n == 2 else _iterate(c))
        z[~np.isfinite(z).all(axis=-1)] = np.nan
    roots[usable] = z
    return roots


def _quadratic(c):
    """Return the roots (m, 2) of polynomials (m, 3), without cancellation."""
    a, b, last = c.T
    root = np.sqrt((b * b - 4.0 * a * last).astype(complex))
    larger = -0.5 * (b + np.where(b < 0.0, -root, root))
    return np.stack([larger / a, np.where(larger == 0.0, 0.0, last / larger)], axis=-1)


def _iterate(c):
    """Return the `polynomial_roots` for c (m, n + 1); NaN if a root overflows."""
    z = _start_values(c)
    z[~np.isfinite(z).all(axis=-1)] = np.nan
    active = np.arange(len(c))
    for _ in range(MAX_STEPS):
        current = z[active]
        distance = current[:, :, None] - current[:, None, :]
        repulsion = np.where(distance == 0.0, 0.0, 1.0 / distance).sum(axis=-1)
        step = 1.0 / (_slope_over_value(c[active], current) - repulsion)
        step[~np.isfinite(step)] = 0.0  # the polynomial is (almost) 0 here
        z[active] = current - step
        active = active[(np.abs(step) > CONVERGED * np.abs(current)).any(axis=-1)]
        if not len(active):
            break
    return z


def _start_values(c):
    """Return numbers like the moduli of the roots: slopes of the hull of ln |c_k|."""
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
    """Return p'/p at z (m, n); the reversed polynomial avoids overflow if |z| > 1."""
    n, large = c.shape[-1] - 1, np.abs(z) > 1.0
    x = np.where(large, 1.0 / z, z)
    value, slope = np.zeros_like(z), np.zeros_like(z)
    for k in range(n + 1):
        slope = slope * x + value
        value = value * x + np.where(large, c[:, None, n - k], c[:, None, k])
    return np.where(large, x * (n - x * slope / value), slope / value)


def _pair_conjugates(z):
    """Pair roots (m, n) that are nearest to each other's conjugate; make others real."""
    partner = np.abs(z[:, :, None].conj() - z[:, None, :]).argmin(axis=-1)
    is_pair = np.take_along_axis(partner, partner, axis=-1) == np.arange(z.shape[-1])
    mean = 0.5 * z + 0.5 * np.take_along_axis(z, partner, axis=-1).conj()
    return np.where(is_pair, mean, z.real)
