"""Find the states of steady sliding under a law, and check whether they exist."""

import numpy as np

from .law_formula import HASH_MARK
from .roots import root

# Newton steps; then the root is bracketed.
ITERATIONS = 10


def steady_point(law, p, v):
    """Return the `Point` of steady sliding at V_ref exp(v), if it exists.

    p : coefficients, arrays of one shape; v : such an array, or a number
    """
    v_full, *p_full = np.broadcast_arrays(v, *p)
    start = law.variables(v_full, (-v_full,) * len(law.states), p_full)
    psi = (_steady_variable(law, k, p_full, v_full, start) for k in range(len(law.states)))
    return law.at_speed(v, tuple(psi), p)


def _steady_variable(law, k, p, v, start):
    """Return psi_k, by iteration from theta_k = D_k/V; its rate needs no other state."""

    def at(psi_k, v, p):
        return law.at_speed(v, (psi_k,) * len(law.states), p)

    def rate(psi_k, v, *p):
        return at(psi_k, v, p).f[k]

    psi_k, is_done = start[k], np.zeros(np.shape(start[k]), bool)
    previous = np.full(np.shape(psi_k), np.inf)
    with np.errstate(all="ignore"):  # steps may overflow
        for _ in range(ITERATIONS):
            point = at(psi_k, v, p)
            value = point.f[k]
            if not np.any(value) and np.isfinite(psi_k).all():
                return psi_k
            step = np.where(value == 0.0, 0.0, value / point.f_slopes[1][k])
            psi_k = np.where(is_done, psi_k, psi_k - step)
            size, change = np.maximum(1.0, np.abs(psi_k)), np.abs(step)
            is_rounding = (change < 1e-10 * size) & (change >= 0.5 * previous)
            is_done = is_done | (((change <= 1e-15 * size) | is_rounding) & np.isfinite(psi_k))
            previous = change
            if is_done.all():
                return psi_k
        remaining = ~is_done & np.isfinite(start[k])
        v, p = v[remaining], [x[remaining] for x in p]
        psi_k[remaining] = root(lambda psi_k: -rate(psi_k, v, *p), start[k][remaining])
        return psi_k


def steady_problem(at):
    """Return the problem with a user's law or friction in steady sliding, "" if none."""
    law = at.law
    if HASH_MARK in law.name and all(np.all(np.isfinite(x)) for x in at.p):
        for name, psi in zip(law.states, at.psi, strict=True):
            if not np.all(np.isfinite(psi)):
                return f"{name} has no steady value"
        for name, slope in zip(law.states, at.f_slopes[1], strict=True):
            if not np.all(slope < 0.0):
                return (
                    f"{name} does not approach its steady value, because d {name}/dt does not "
                    f"fall with {name} there"
                )
    if law.overrides("friction") and np.any((by_v := at.R_slopes[0]) <= 0.0):
        least = np.nanmin(by_v)
        return f"friction does not rise with V in steady sliding, (d mu/d ln V)/a = {least:.4g}"
    return ""
