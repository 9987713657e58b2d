"""Small-amplitude limit cycles near the Hopf point, which shooting cannot resolve.

Dimensionless with V0 := V_lp, time in Dc/V_lp.  harmonic_balance.py has the equations, and how they
keep all digits down to zero amplitude.
"""

from typing import NamedTuple

import numpy as np

from ...friction.laws import friction_law
from ...friction.linear_stability import linearisation
from ...friction.normal_form import growth_slopes, lyapunov_1_of_law
from .harmonic_balance import (
    EVEN,
    EVEN_WAVES,
    FIRST,
    ODD,
    ODD_WAVES,
    Case,
    at_nodes,
    dynamic_stiffness,
    frequency,
    hopf_limit,
    logarithm,
    next_balance,
    project,
)
from .system import select

R_MAX = 0.3  # beyond, 15 harmonics are too few and the iteration converges too slowly
ERROR_MAX = 1e-3
MAX_ITERATIONS = 100
EPS = 2.0**-52


class SmallCycles(NamedTuple):
    """Small limit cycles, dimensionless, each (n,); all but `valid` NaN where it is False."""

    #: whether there is a cycle, small and accurate enough
    valid: np.ndarray
    #: amplitude of the fundamental of ln V
    r: np.ndarray
    #: angular frequency: the period is 2 pi/omega
    omega: np.ndarray
    #: psi and G = dv/dT at the section, where v = 0 and rises (the maximum of stress)
    psi: np.ndarray
    G: np.ndarray
    #: max - min of x
    amplitude: np.ndarray
    #: estimated relative error of r
    error: np.ndarray


def small_cycle(law, kappa, beta, eta, margin=None):
    """`SmallCycles` that bifurcate at the Hopf point kappa_c = (beta - 1) (1 + eta), while small.

    Of sliders (n,) with eta > 0 and this margin kappa - kappa_c, if it is known more accurately
    than by subtraction; r ~ sqrt(margin).  The cycles may be stable or not.  `valid` is False where
    beta <= 1, on the side of kappa_c where there is none, and where r exceeds 0.3, the estimated
    error exceeds 1e-3 or the iteration does not converge, as near a fold of cycles.  Rounding alone
    is an error of 1e-16 sqrt((beta - 1) beta)/curvature, which grows like 1/eta at
    small eta.
    """
    with np.errstate(all="ignore"):
        if margin is None:
            beta, size = np.asarray(beta, float), 1 + np.asarray(eta, float)
            b1 = beta - 1
            # rounding of kappa and kappa_c, and that of beta, which subtracting 1 amplifies
            margin, margin_error = kappa - b1 * size, EPS * (2 * b1 + 0.5 * beta) * size
        else:
            margin_error = 0.0
        kappa, beta, eta, margin, margin_error = _columns(kappa, beta, eta, margin, margin_error)
        case = Case(beta - 1, beta, eta, friction_law(law).series)
        balance, s, residual = _solve(margin, case)
        r, omega, psi, G, amplitude = _waveform(balance, s, kappa, case)
        tail = np.maximum(np.abs(balance.Q[:, -1:]) * np.sqrt(s), np.abs(balance.P[:, -1:]) * s)
        error = residual / np.abs(balance.m) + margin_error / np.abs(margin) + tail + EPS
        valid = (r <= R_MAX) & (error <= ERROR_MAX)
    values = (r, omega, psi, G, amplitude, error)
    return SmallCycles(valid[:, 0], *(np.where(valid, value, np.nan)[:, 0] for value in values))


def curvature(law, beta, eta):
    """d kappa/d(r^2) [1] along the cycles at the Hopf point, (n,).

    Cycles of small amplitude r exist at kappa - kappa_c = curvature r^2.  As steady sliding is
    stable at kappa > kappa_c, they are unstable (subcritical) where it is positive.  NaN where
    beta <= 1; without mass 0, to rounding.
    """
    beta, eta = _columns(beta, eta)
    with np.errstate(all="ignore"):
        return hopf_limit(Case(beta - 1, beta, eta, friction_law(law).series)).m[:, 0]


def hopf_curvature(system):
    """`curvature` of a `System` under any law, (n,)."""
    law = system.friction_law
    if law.one_length:
        return curvature(system.law, system.beta, system.eta)
    p, (kappa, omega) = system.coefficients, system.critical
    coefficient, _ = lyapunov_1_of_law(law, p, kappa, system.eta, omega)
    by_K, _ = growth_slopes(linearisation(law, p), kappa, system.eta, omega)
    return -coefficient * kappa / by_K


def _columns(*values):
    values = np.broadcast_arrays(*(np.atleast_1d(np.asarray(value, float)) for value in values))
    return [value[:, None] for value in values]


def _solve(margin, case):
    """Balance, s at which s m = margin, and the residual error of m, rounding included."""
    balance = hopf_limit(case)
    # rounding is relative to the terms that sum to m
    rounding = 2 * EPS * np.sqrt(case.b1 * case.beta) * (1 + case.eta)
    s = margin / balance.m
    s = np.where(s > 0, np.minimum(s, R_MAX**2), np.nan)
    residual = np.full_like(s, np.nan)
    rows = np.flatnonzero(s > 0)  # cases that have not converged
    for _ in range(MAX_ITERATIONS):
        old, s_old = select(balance, rows), s[rows]
        new = next_balance(old, s_old, select(case, rows))
        target = margin[rows] / new.m
        drift, off = np.abs(new.m - old.m), np.abs(new.m - margin[rows] / s_old)
        for values, new_values in zip(balance, new, strict=True):
            values[rows] = new_values
        residual[rows] = off + drift + rounding[rows]
        # m is small where eta is, but the rest of the balance is not: it converges before s moves
        follow = (drift < 0.1 * off) & (off > rounding[rows])
        s[rows] = np.where(follow, np.clip(target, s_old / 4, 4 * s_old), s_old)
        rows = rows[(off + drift > 2 * rounding[rows])[:, 0]]
    return balance, s, residual


def _waveform(balance, s, kappa, case):
    """r, omega, psi and G at the section and the amplitude of x, (n, 1) each."""
    Q, P, X0, _, d, g = balance
    omega, root = frequency(d, s, case), np.sqrt(s)
    (q,), (p,) = at_nodes(EVEN_WAVES, Q), at_nodes(ODD_WAVES, P)
    B, _ = logarithm(q, p, s)
    r = root * np.abs(1 + s * project(B, FIRST[None]))
    k = np.concatenate([[1], EVEN, ODD])
    w = root * np.concatenate([np.ones_like(s), root * Q, s * P], axis=1)  # harmonics of w - 1
    slope, integral = 1j * k * w, w / (1j * k)

    def at(phase, harmonics):
        return (harmonics * np.exp(1j * k * phase)).sum(axis=1, keepdims=True).real

    def crossing(phase):
        """Phase of v = 0 near this one, by Newton's method."""
        for _ in range(8):
            phase = phase - at(phase, w) / at(phase, slope)
        return phase

    rising, falling = crossing(np.full_like(s, -np.pi / 2)), crossing(np.full_like(s, np.pi / 2))
    # where v = 0, beta psi = beta z = x - eta omega w'
    mu = dynamic_stiffness(k, g, omega, s, case)
    psi = s * X0 - at(rising, mu * integral) / (omega * case.beta)
    amplitude = kappa / omega * (at(falling, integral) - at(rising, integral))
    return r, omega, psi, omega * at(rising, slope), amplitude
