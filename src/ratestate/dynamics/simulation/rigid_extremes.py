"""The smallest friction, strength and stress of a slider that moves as its load point does."""

import numpy as np

from ...engine.rigid_steps import Lines
from ...friction.functions import weighted_sum

# Sums of friction R, of the strength N, and of x: how much of each
FRICTION, WITH_STRENGTH = (1.0, 0.0, 0.0), (0.0, 1.0, 1.0)


def sums(path, parts, at):
    """Sums of parts of R, N and x, at a `Point` of a `Path`."""
    law, of = path.law, (at.v, at.w, at.psi, at.p)
    friction, strength = law.resistance_in_v(*of), law.strength_in_v(*of)
    return parts[0] * friction + parts[1] * strength + parts[2] * path.force(at)


def rises(path, parts, at):
    """d/dT of `sums`."""
    law, of = path.law, at[:5]
    rates, d_w = law.rates_in_v(*of), path.lines.rate[at.k] / (path.p.V0 * path.scale)
    d_omega = d_w / law.speed_slope(at.w, at.e)
    drift = sum(law.strength_drift(at.v, at.w, at.psi, at.p))
    slopes = law.resistance_slopes(*of), law.strength_slopes(*of), law.stress_slopes(*of)
    friction, strength, stress = (
        by_omega * d_omega + weighted_sum(by_psi, rates) for by_omega, by_psi in slopes
    )
    return parts[0] * friction + parts[1] * (strength + drift) + parts[2] * (stress + drift)


def lowest(path, parts, t, psi, jumps):
    """The smallest of `sums` of these parts, at times t (m,), or in a minimum between two.

    jumps : times at which normal stress jumps
    """
    begin, end, first = t[:-1], t[1:], psi[:, :-1]
    last = np.where(np.isin(end, jumps), first, psi[:, 1:])  # (of times just before them)
    k = np.searchsorted(path.lines.t, begin, side="right") - 1
    sides = path.at(begin, first, k), path.at(end, last, k)
    values = [sums(path, parts, side) for side in sides]
    slopes = [rises(path, parts, side) for side in sides]
    smallest = np.minimum(*values)
    inside = np.flatnonzero((slopes[0] < 0.0) & (slopes[1] > 0.0))
    if path.varies:  # the points are dense
        ends = (x[inside] for x in (*values, *slopes, path.scale * (end - begin)))
        between = _lowest_of_cubics(*ends)
        return min(smallest.min(), between.min(initial=np.inf))
    for i in inside:
        smallest[i] = _minimum(path, parts, first[:, i], begin[i], end[i], k[i])
    return smallest.min()


def _minimum(path, parts, psi, begin, end, k):
    """The minimum of `sums` between two times in segment k, from psi at the first."""
    from scipy.optimize import brentq  # slow to import, and no other run needs it

    def point(t):
        return path.at(t, _between(path, t, psi, begin, k), k)

    def slope(t):
        return rises(path, parts, point(t))

    # (where it does not rise there it was rounding, at the end of a relaxation)
    at = brentq(slope, begin, end) if slope(end) > 0.0 else end
    return sums(path, parts, point(at))


def _between(path, t, psi, begin, k):
    """psi at one time in segment k, where normal stress is constant, from psi at `begin` on."""
    _, V, rate, *stress = path.lines
    from_there = V[k] + rate[k] * (begin - path.lines.t[k])
    line = Lines(np.zeros(1), np.array([from_there]), rate[k : k + 1], *stress)
    return path.states(psi, np.array([t - begin]), line)[:, 0]


def _lowest_of_cubics(first, last, falls, rises, length):
    """Minima of cubics that have these values and slopes, < 0 and > 0, at the ends of a length."""
    mean = (last - first) / length
    c, d = (3.0 * mean - 2.0 * falls - rises) / length, (falls + rises - 2.0 * mean) / length**2
    root = np.sqrt(np.maximum(c * c - 3.0 * d * falls, 0.0))
    at = np.clip(-falls / (c + root), 0.0, length)
    return first + at * (falls + at * (c + at * d))
