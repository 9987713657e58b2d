"""Steady sliding under a law: its states, by root finding, and whether there is such sliding."""

import numpy as np

from .roots import root

# Newton steps before the root is bracketed.
ITERATIONS = 10


def steady_variables(law, p, v):
    """psi of each state in steady sliding at V_ref exp(v), a tuple.

    p : coefficients, arrays of one shape; v : such an array, or a number
    """
    v, *p = np.broadcast_arrays(v, *p)
    start = law.variables(v, (-v,) * len(law.states), p)
    return tuple(_steady_variable(law, k, p, v, start) for k in range(len(law.states)))


def _steady_variable(law, k, p, v, start):
    """psi_k, from theta_k = D_k/V on; its rate does not depend on other states."""

    def arguments(psi_k, v, p):
        psi, w = (psi_k,) * len(law.states), np.exp(v)
        return v, w, psi, law.exponentials(v, w, psi, p), p

    def rate(psi_k, v, *p):
        return law.rates(*arguments(psi_k, v, p))[k]

    found, done = start[k], np.zeros(np.shape(start[k]), bool)
    before = np.full(np.shape(found), np.inf)
    with np.errstate(all="ignore"):  # (steps may lead nowhere)
        for _ in range(ITERATIONS):
            value = rate(found, v, *p)
            slope = law.rate_partials(*arguments(found, v, p))[1][k]
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


def steady_problem(law, psi, p, v=0.0):
    """The problem with steady sliding under a user's law or friction, as text; "" if none."""
    w = np.exp(v)
    if law.is_of_user and all(np.all(np.isfinite(x)) for x in p):
        for name, one in zip(law.states, psi, strict=True):
            if not np.all(np.isfinite(one)):
                return f"{name} has no steady value"
        slopes = law.rate_partials(v, w, psi, law.exponentials(v, w, psi, p), p)[1]
        for name, slope in zip(law.states, slopes, strict=True):
            if not np.all(slope < 0.0):
                return (
                    f"{name} does not go to its steady value: there d {name}/dt does not fall with "
                    f"{name}"
                )
    if law.gives("friction"):
        by_v, _ = law.resistance_partials(v, w, psi, p)
        if np.any(by_v <= 0.0):
            return (
                "friction does not rise with V in steady sliding, (d mu/d ln V)/a = "
                f"{np.min(by_v):.4g}"
            )
    return ""
