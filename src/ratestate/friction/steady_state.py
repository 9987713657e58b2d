"""Steady sliding under a law that does not know it in closed form: its states, by root finding."""

import numpy as np

# Newton steps before the root is bracketed.
ITERATIONS = 20


def steady_variables(law, p):
    """psi of each state in steady sliding at V_ref, a tuple, under coefficients p, (n,) each."""
    return tuple(_steady_variable(law, k, p) for k in range(len(law.states)))


def _steady_variable(law, k, p):
    """psi_k; the rate of each state knows no other."""
    p = np.broadcast_arrays(*p)
    zero = np.zeros(p[0].shape)

    def arguments(psi_k, p):
        psi = tuple(psi_k if j == k else 0.0 * psi_k for j in range(len(law.states)))
        return 0.0, 1.0, psi, law.exponentials(0.0, 1.0, psi, p), p

    def rate(psi_k, *p):
        return law.rates(*arguments(psi_k, p))[k]

    found = zero
    with np.errstate(all="ignore"):  # of steps that lead nowhere
        for _ in range(ITERATIONS):
            value = rate(found, *p)
            if not np.any(value):
                return found
            step = value / law.rate_partials(*arguments(found, p))[1][k]
            found = found - step
            if np.all(np.abs(step) <= 1e-15 * np.maximum(1.0, np.abs(found))):
                return found
    from scipy.optimize.elementwise import bracket_root, find_root  # slow to import

    # (these call it for the elements that have not converged yet)
    found = bracket_root(rate, zero - 1.0, zero + 1.0, args=tuple(p))
    return find_root(rate, found.bracket, args=tuple(p)).x
