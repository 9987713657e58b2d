"""Bifurcation points of a branch of fixed points: where multipliers cross the unit circle.

Each kind has a test function that changes sign there (Kuznetsov, Elements of Applied Bifurcation
Theory, section 10.2, doi:10.1007/978-3-031-22007-4).  Factors like 1 + m are divided by 1 + |m|,
so that multipliers from 1e-300 to 1e6 leave test functions of order 1.
"""

from itertools import combinations, pairwise

import numpy as np

from .newton import NO_CONVERGENCE, StepFailed, fixed_point, unit

MAX_SECANTS = 100


def fold(point):
    """Changes sign where the branch turns back in p: the p component of its tangent, dp/ds [1].

    As dp/ds is proportional to det(1 - dP/du), a multiplier is 1 there; but where branches merely
    cross, and a multiplier is 1 as well, dp/ds keeps its sign.
    """
    return point.tangent[-1]


def period_doubling(point):
    """Changes sign where a multiplier passes -1; a float from -1 to 1."""
    m = point.multipliers
    return np.prod((1 + m) / (1 + np.abs(m))).real


def torus(point):
    """Changes sign where the product of two multipliers passes 1 (Neimark-Sacker, if complex).

    A float from -1 to 1; 1 where there is but one multiplier.
    """
    products = np.array([m * n for m, n in combinations(point.multipliers, 2)])
    return np.prod((products - 1) / (1 + np.abs(products))).real


def saddle(point):
    """Changes sign where a multiplier passes 1; a float from -1 to 1."""
    m = point.multipliers
    return np.prod((1 - m) / (1 + np.abs(m))).real


TESTS = {"fold": fold, "period_doubling": period_doubling, "torus": torus}


def change(a, b):
    """How much the multipliers of two points differ, from 0 to 2."""
    return max(abs(test(b) - test(a)) for test in (saddle, period_doubling, torus))


def bifurcation_points(problem, a, b, weights):
    """The bifurcation points between neighbouring points of a branch, in their order along it.

    A list of `Point`, empty if there is none, with the name of the bifurcation as `special`; each
    on the branch, as near to the bifurcation as rounding and noise allow.  The tangents at a and b
    make an acute angle.  Raises StepFailed where one that must exist is not found.
    """
    points = []
    for name, test in TESTS.items():
        if (test(a) > 0) == (test(b) > 0):
            continue
        point = locate(problem, a, b, test, weights)
        # With two real multipliers m and 1/m it is a neutral saddle, no torus bifurcation.
        if name != "torus" or _pair(point):
            points.append(point._replace(special=name))
    chord = (b.y - a.y) / weights**2
    return sorted(points, key=lambda point: chord @ point.y)


def _pair(point):
    """Whether the two multipliers whose product is nearest to 1 are a conjugate pair."""
    pairs = combinations(point.multipliers, 2)
    first, second = min(pairs, key=lambda pair: abs(pair[0] * pair[1] - 1))
    return first.imag != 0 and second == first.conjugate()


def stable_pieces(special, stable):
    """(n - 1,) whether cycles are stable, for each piece of a branch between two of n points.

    special, stable : (n,) as `continue_cycle` returns them
    """
    # Where a multiplier is on the unit circle, rounding would tell stable from unstable.
    firm = stable.astype(bool) | np.isin(special, ["hopf", *TESTS])
    return firm[:-1] & firm[1:]


def without_noise(points):
    """The branch (list of `Point`) without folds between which p varies by no more than its error.

    Where p is all but constant, as near a degenerate Hopf point, noise makes it turn back: then two
    folds, or a fold and an end, are that close in p, and the folds become ordinary points.
    """
    points = list(points)
    while True:
        folds = [i for i, point in enumerate(points) if point.special == "fold"]
        for i, j in pairwise([0, *folds, len(points) - 1]):
            ends = [k for k in (i, j) if k in folds]
            p = [point.p for point in points[i : j + 1]]
            if ends and max(p) - min(p) <= max(points[k].error for k in ends):
                break
        else:
            return points
        for k in ends:
            points[k] = points[k]._replace(special="")


def locate(problem, a, b, test, weights):
    """The `Point` between a and b on the branch where the function `test` of a point is 0.

    Its sign at a and at b must differ, which is not checked.  False position by the `illinois`
    method in the distance along the chord; each trial is on the branch.  Raises StepFailed where a
    trial is not found, or after `MAX_SECANTS` of them.
    """
    chord = (b.y - a.y) / weights
    length, normal = np.linalg.norm(chord), unit(chord)
    low, high, f_low, f_high = 0.0, length, test(a), test(b)
    last, side = np.inf, 0
    for _ in range(MAX_SECANTS):
        s = (low * f_high - high * f_low) / (f_high - f_low)
        guess = _hermite(a, b, normal, length, weights, s / length)
        point = fixed_point(problem, guess, normal, normal, weights, tol=0.0)
        f = test(point)
        if f == 0 or abs(s - last) <= point.error:
            return point
        f_low, f_high, side = illinois(f_low, f_high, f, side)
        low, high = (low, s) if side > 0 else (s, high)
        last = s
    raise StepFailed(NO_CONVERGENCE)


def illinois(low, high, new, side):
    """Values at the low and high ends of brackets after a trial, and which end it replaced: -1, 1.

    The end whose sign it has; the other one counts half if it stays a second time (the Illinois
    method, Dowell & Jarratt 1971, doi:10.1007/BF01934364).

    low, high, new : (n,) or float; low and high of opposite signs, which is not checked
    side : the end that the trial before replaced, or 0
    """
    is_high = (new > 0) == (high > 0)
    kept_low, kept_high = np.where(side > 0, 0.5 * low, low), np.where(side < 0, 0.5 * high, high)
    sides = np.where(is_high, 1, -1)
    return np.where(is_high, kept_low, new), np.where(is_high, new, kept_high), sides


def _hermite(a, b, normal, length, weights, x):
    """Cubic through a (x = 0) and b (x = 1) with their tangents, linear in x along the chord."""
    slope_a = a.tangent * length / (normal @ (a.tangent / weights))
    slope_b = b.tangent * length / (normal @ (b.tangent / weights))
    rise = b.y - a.y
    deviation = (1 - x) * (slope_a - rise) - x * (slope_b - rise)
    return a.y + x * rise + x * (1 - x) * deviation
