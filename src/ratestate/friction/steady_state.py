"""Find the states of steady sliding under a law, and check whether they exist."""

import numpy as np

from .law_formula import MARK
from .roots import root

# Newton steps; then the root is bracketed.
ITERATIONS = 10


def steady_point(law, p, v):
    """Return the `Point` of steady sliding at V_ref exp(v), if it exists.

    p : coefficients, arrays of one shape; v : such an array, or a number
    """
    at, *each = np.broadcast_arrays(v, *p)
    start = law.variables(at, (-at,) * len(law.states), each)
    found = (_steady_variable(law, k, each, at, start) for k in range(len(law.states)))
    return law.at_speed(v, tuple(found), p)


def _steady_variable(law, k, p, v, start):
    """Return psi_k, by iteration from theta_k = D_k/V; its rate needs no other state."""

    def at(psi_k, v, p):
        return law.at_speed(v, (psi_k,) * len(law.states), p)

    def rate(psi_k, v, *p):
        return at(psi_k, v, p).f[k]

    found, done = start[k], np.zeros(np.shape(start[k]), bool)
    before = np.full(np.shape(found), np.inf)
    with np.errstate(all="ignore"):  # steps may overflow
        for _ in range(ITERATIONS):
            here = at(found, v, p)
            value, slope = here.f[k], here.f_slopes[1][k]
            step = np.where(value == 0.0, 0.0, value / slope)
            found = np.where(done, found, found - step)
            size, moved = np.maximum(1.0, np.abs(found)), np.abs(step)
            is_rounding = (moved < 1e-10 * size) & (moved >= 0.5 * before)
            done = done | (((moved <= 1e-15 * size) | is_rounding) & np.isfinite(found))
            before = moved
            if done.all():
                return found
        rest = ~done & np.isfinite(start[k])
        v, p = v[rest], [x[rest] for x in p]
        found[rest] = root(lambda psi_k: -rate(psi_k, v, *p), start[k][rest])
        return found


def steady_problem(at):
    """Return the problem with a user's law or friction in steady sliding, "" if none."""
    law = at.law
    if MARK in law.name and all(np.all(np.isfinite(x)) for x in at.p):
        for name, one in zip(law.states, at.psi, strict=True):
            if not np.all(np.isfinite(one)):
                return f"{name} has no steady value"
        for name, slope in zip(law.states, at.f_slopes[1], strict=True):
            if not np.all(slope < 0.0):
                return (
                    f"{name} does not go to its steady value: there d {name}/dt does not fall with "
                    f"{name}"
                )
    if law.gives("friction") and np.any((by_v := at.R_slopes[0]) <= 0.0):
        least = np.nanmin(by_v)
        return f"friction does not rise with V in steady sliding, (d mu/d ln V)/a = {least:.4g}"
    return ""
