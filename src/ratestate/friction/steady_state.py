"""Steady sliding under a law: its states, by root finding."""

import numpy as np

# Newton steps before the root is bracketed.
ITERATIONS = 20


def steady_variables(law, p, v):
    """psi of each state in steady sliding at V_ref exp(v), a tuple.

    p : coefficients, (n,) each; v : (n,), or a number
    """
    v, *p = np.broadcast_arrays(v, *p)
    start = law.variables(v, (-v,) * len(law.states), p)
    return tuple(_steady_variable(law, k, p, v, start) for k in range(len(law.states)))


def _steady_variable(law, k, p, v, start):
    """psi_k, sought from that of theta_k = D_k/V on; the rate of each state knows no other."""

    def arguments(psi_k, v, p):
        psi, w = (psi_k,) * len(law.states), np.exp(v)
        return v, w, psi, law.exponentials(v, w, psi, p), p

    def rate(psi_k, v, *p):
        return law.rates(*arguments(psi_k, v, p))[k]

    found, done = start[k], np.zeros(np.shape(start[k]), bool)
    before = np.full(np.shape(found), np.inf)
    with np.errstate(all="ignore"):  # of steps that lead nowhere
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
        return np.where(done, found, _bracketed(rate, start[k], (v, *p)))


def _bracketed(rate, start, p):
    from scipy.optimize.elementwise import bracket_root, find_root  # slow to import

    # (these call it for the elements that have not converged yet)
    found = bracket_root(rate, start - 1.0, start + 1.0, args=p)
    return find_root(rate, found.bracket, args=p).x
