"""Soft limit cycles: the small ones near the Hopf point, which shooting cannot resolve.

Dimensionless with V0 := V_lp, time in Dc/V_lp; the equations and how they keep all digits down to
cycles of no size at all are told in balance.py.
"""

from typing import NamedTuple

import numpy as np

from .harmonic_balance import (
    EVEN,
    EVEN_WAVES,
    FIRST,
    ODD,
    ODD_WAVES,
    SERIES,
    Balance,
    Case,
    at_nodes,
    birth,
    dynamic_stiffness,
    frequency,
    logarithm,
    project,
    sweep,
)

R_MAX = 0.3  # beyond, 15 harmonics and the sweeps no longer serve
ERROR_MAX = 1e-3
SWEEPS = 100
EPS = 2.0**-52


class SoftCycles(NamedTuple):
    """Small limit cycles, dimensionless, each (n,); NaN where none was found."""

    found: np.ndarray
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


def soft_cycle(law, kappa, beta, eta, margin=None):
    """The cycle that is born at the Hopf point kappa_c = (beta - 1) (1 + eta), while it is small.

    Stable or not: `found` is False on the side of kappa_c where there is none, and where r
    exceeds 0.3, the estimated error exceeds 1e-3 or the sweeps do not converge.  They do not near
    a fold of cycles; rounding alone is an error of 1e-16 sqrt((beta - 1) beta)/curvature, which
    for both laws grows like 1/eta at small eta.

    Parameters
    ----------
    law : {"slip", "aging"}
        Evolution law.
    kappa, beta, eta : array, (n,)
        K Dc/(a sigma) > 0, b/a > 1 and M V_lp^2/(a sigma Dc) > 0 [1].
    margin : array, (n,), optional
        kappa - kappa_c, if it is known better than by subtraction; r ~ sqrt(margin).

    Returns
    -------
    SoftCycles
    """
    with np.errstate(all="ignore"):
        if margin is None:
            beta, size = np.asarray(beta, float), 1 + np.asarray(eta, float)
            b1 = beta - 1
            # rounding of kappa and of what it is compared with, and of beta, which b1 lays bare
            margin, doubt = kappa - b1 * size, EPS * (2 * b1 + 0.5 * beta) * size
        else:
            doubt = 0.0
        kappa, beta, eta, margin, doubt = _columns(kappa, beta, eta, margin, doubt)
        case = Case(beta - 1, beta, eta, SERIES[law])
        balance, s, gap = _solve(margin, case)
        r, omega, psi, G, amplitude = _waveform(balance, s, kappa, case)
        tail = np.maximum(np.abs(balance.Q[:, -1:]) * np.sqrt(s), np.abs(balance.P[:, -1:]) * s)
        error = gap / np.abs(balance.m) + doubt / np.abs(margin) + tail + EPS
        found = (r <= R_MAX) & (error <= ERROR_MAX)
    values = (r, omega, psi, G, amplitude, error)
    return SoftCycles(found[:, 0], *(np.where(found, value, np.nan)[:, 0] for value in values))


def curvature(law, beta, eta):
    """d kappa/d(r^2) [1] along the cycles at their birth, (n,).

    Cycles of small amplitude r exist at kappa - kappa_c = curvature r^2.  As steady sliding is
    stable at kappa > kappa_c, they are unstable (subcritical) where it is positive.
    """
    beta, eta = _columns(beta, eta)
    with np.errstate(all="ignore"):
        return birth(Case(beta - 1, beta, eta, SERIES[law])).m[:, 0]


def _columns(*values):
    values = np.broadcast_arrays(*(np.atleast_1d(np.asarray(value, float)) for value in values))
    return [value[:, None] for value in values]


def _solve(margin, case):
    """Balance, s at which s m = margin, and by how much m may fail it, rounding included."""
    balance = birth(case)
    # rounding is relative to the terms that sum to m
    rounding = 2 * EPS * np.sqrt(case.b1 * case.beta) * (1 + case.eta)
    s = margin / balance.m
    s = np.where(s > 0, np.minimum(s, R_MAX**2), np.nan)
    gap = np.full_like(s, np.nan)
    rows = np.flatnonzero(s > 0)  # those still at work
    for _ in range(SWEEPS):
        at_work = Case(case.b1[rows], case.beta[rows], case.eta[rows], case.series)
        before, s_now = Balance(*(value[rows] for value in balance)), s[rows]
        now = sweep(before, s_now, at_work)
        target = margin[rows] / now.m
        drift, off = np.abs(now.m - before.m), np.abs(now.m - margin[rows] / s_now)
        for value, new in zip(balance, now, strict=True):
            value[rows] = new
        gap[rows] = off + drift + rounding[rows]
        # m is small where eta is, but not the rest of the balance: let it settle before s follows
        follow = (drift < 0.1 * off) & (off > rounding[rows])
        s[rows] = np.where(follow, np.clip(target, s_now / 4, 4 * s_now), s_now)
        rows = rows[(off + drift > 2 * rounding[rows])[:, 0]]
    return balance, s, gap


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
