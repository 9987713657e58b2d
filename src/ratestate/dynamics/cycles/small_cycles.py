"""Small limit cycles near the Hopf point, which a return map cannot resolve, by harmonic balance.

Dimensionless with V0 := V_lp, time in Dc/V_lp.  For a law whose state obeys d theta/dt = f(Omega),
Omega = V theta/Dc, the rate is d psi/dT = w h(z) with z = ln Omega = v + psi.  At the phase
omega T the slider's three equations become one for w = V/V_lp (' = d/d phase),

    kappa (w - 1) + eta omega^2 w'' + omega w'/w + beta w h(z) = 0,
    beta z = x + (beta - 1) v - eta omega w',    x' = -kappa (w - 1)/omega.

A small cycle is w = 1 + r cos(phase) for any r: the terms that determine r are r^2 times smaller,
and rounding would hide them.  But a shift of the phase by pi changes the sign of r, so that the
harmonics separate by parity,

    w = 1 + r (cos + r Q + r^2 P),     Q: harmonics 2, 4, ...,   P: harmonics 3, 5, ...,

and v, z and the equation split likewise into parts of even and odd harmonics.  The code omits the
terms that cos alone satisfies, and divides the parts by r^2 and r^3.  Only s = r^2 remains, and
nothing cancels, down to s = 0.  There the equations are triangular, so an iteration that solves
each harmonic's linear equation converges like s.  Arrays are (n, 1), harmonics complex
(n, harmonics).
"""

from typing import NamedTuple

import numpy as np

from ...friction.laws import friction_law
from ...friction.linear_stability import linearisation
from ...friction.normal_form import growth_slopes, lyapunov_1_of_law
from .system import select

R_MAX = 0.3  # beyond, 15 harmonics are too few and the iteration converges too slowly
ERROR_MAX = 1e-3
MAX_ITERATIONS = 100
EPS = 2.0**-52

HARMONICS = 15
# over half a period: parity gives the other half
NODES = np.pi * np.arange(HARMONICS + 1) / (HARMONICS + 1)
FIRST_HARMONIC = np.exp(1j * NODES)
C, S = FIRST_HARMONIC.real, FIRST_HARMONIC.imag
EVEN, ODD = np.arange(2, HARMONICS, 2), np.arange(3, HARMONICS + 1, 2)
EVEN_WAVES, ODD_WAVES = np.exp(1j * np.outer(EVEN, NODES)), np.exp(1j * np.outer(ODD, NODES))


class SmallCycles(NamedTuple):
    """Small limit cycles, dimensionless, arrays (n,); NaN where `valid` is False."""

    valid: np.ndarray  # whether there is a cycle, small and accurate enough
    r: np.ndarray  # amplitude of the fundamental of ln V
    omega: np.ndarray  # angular frequency: the period is 2 pi/omega
    psi: np.ndarray  # at the section, the maximum of stress
    G: np.ndarray  # dv/dT there
    amplitude: np.ndarray  # max - min of x
    error: np.ndarray  # estimated relative error of r


class SmallCase(NamedTuple):
    """beta - 1, beta, eta and the law's series."""

    b1: np.ndarray
    beta: np.ndarray
    eta: np.ndarray
    series: tuple


class Balance(NamedTuple):
    """Unknowns at given s; the mean of x is beta s X0."""

    Q: np.ndarray
    P: np.ndarray
    X0: np.ndarray
    m: np.ndarray  # (kappa - kappa_c)/s
    d: np.ndarray  # omega^2 = (beta - 1) (1 + s d)
    g: np.ndarray  # m - eta (beta - 1) d, kept apart as the difference would lose digits


def small_cycle(law, kappa, beta, eta, margin=None):
    """Return the `SmallCycles` that bifurcate at the Hopf point kappa_c = (beta - 1) (1 + eta).

    They may be stable or not; r ~ sqrt(kappa - kappa_c).  `valid` is False if beta <= 1, on the
    side of kappa_c that has no cycle, if r exceeds 0.3 or the estimated error 1e-3, and if the
    iteration does not converge, as near a fold of cycles.  Rounding alone is an error of
    1e-16 sqrt((beta - 1) beta)/curvature, which grows like 1/eta at small eta.

    kappa, beta, eta : (n,) of sliders with eta > 0
    margin : kappa - kappa_c, if it is more accurate than by subtraction
    """
    kappa, beta, eta, exact = _columns(kappa, beta, eta, np.nan if margin is None else margin)
    with np.errstate(all="ignore"):
        case = _case(law, beta, eta)
        # rounding of kappa and kappa_c, and that of beta, which subtracting 1 amplifies
        margin_error = EPS * (2 * case.b1 + 0.5 * beta) * (1 + eta) if margin is None else 0.0
        margin = kappa - case.b1 * (1 + eta) if margin is None else exact
        balance, s, residual = _solve(margin, case)
        r, omega, psi, G, amplitude = _waveform(balance, s, kappa, case)
        tail = np.maximum(np.abs(balance.Q[:, -1:]) * np.sqrt(s), np.abs(balance.P[:, -1:]) * s)
        error = residual / np.abs(balance.m) + margin_error / np.abs(margin) + tail + EPS
        valid = (r <= R_MAX) & (error <= ERROR_MAX)
    values = (r, omega, psi, G, amplitude, error)
    return SmallCycles(valid[:, 0], *(np.where(valid, value, np.nan)[:, 0] for value in values))


def curvature(law, beta, eta):
    """Return d kappa/d(r^2) along the cycles at the Hopf point, (n,).

    Cycles of small amplitude r exist at kappa - kappa_c = curvature r^2.  As steady sliding is
    stable at kappa > kappa_c, they are unstable (subcritical) if it is positive.  NaN if
    beta <= 1; without mass it is 0, to rounding.
    """
    with np.errstate(all="ignore"):
        return _hopf_limit(_case(law, *_columns(beta, eta))).m[:, 0]


def hopf_curvature(system):
    """Return the `curvature` of a `System` under any law."""
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


def _case(law, beta, eta):
    return SmallCase(beta - 1, beta, eta, friction_law(law).series)


def _solve(margin, case):
    """Return the Balance, s where s m = margin, and the error of m, with rounding."""
    balance = _hopf_limit(case)
    # rounding is relative to the terms that sum to m
    rounding = 2 * EPS * np.sqrt(case.b1 * case.beta) * (1 + case.eta)
    s = margin / balance.m
    s = np.where(s > 0, np.minimum(s, R_MAX**2), np.nan)
    residual = np.full_like(s, np.nan)
    rows = np.flatnonzero(s > 0)  # cases that have not converged
    for _ in range(MAX_ITERATIONS):
        old, s_old = select(balance, rows), s[rows]
        new = _next_balance(old, s_old, select(case, rows))
        target = margin[rows] / new.m
        drift, residual_m = np.abs(new.m - old.m), np.abs(new.m - margin[rows] / s_old)
        for values, new_values in zip(balance, new, strict=True):
            values[rows] = new_values
        residual[rows] = residual_m + drift + rounding[rows]
        # m is small where eta is, but the rest of the balance is not: it converges before s moves
        follow = (drift < 0.1 * residual_m) & (residual_m > rounding[rows])
        s[rows] = np.where(follow, np.clip(target, s_old / 4, 4 * s_old), s_old)
        rows = rows[(residual_m + drift > 2 * rounding[rows])[:, 0]]
    return balance, s, residual


def _waveform(balance, s, kappa, case):
    """Return r, omega, psi and G at the section, and the amplitude of x, (n, 1) each."""
    Q, P, X0, _, d, g = balance
    omega, root = _frequency(d, s, case), np.sqrt(s)
    (q,), (p,) = _at_nodes(EVEN_WAVES, Q), _at_nodes(ODD_WAVES, P)
    B, _ = _logarithm(q, p, s)
    r = root * np.abs(1 + s * _project(B, FIRST_HARMONIC[None]))
    k = np.concatenate([[1], EVEN, ODD])
    w = root * np.concatenate([np.ones_like(s), root * Q, s * P], axis=1)  # harmonics of w - 1
    slope, integral = 1j * k * w, w / (1j * k)

    def at(phase, harmonics):
        return (harmonics * np.exp(1j * k * phase)).sum(axis=1, keepdims=True).real

    def crossing(phase):
        """Return the phase of v = 0 near this one, by Newton's method."""
        for _ in range(8):
            phase = phase - at(phase, w) / at(phase, slope)
        return phase

    rising, falling = crossing(np.full_like(s, -np.pi / 2)), crossing(np.full_like(s, np.pi / 2))
    # where v = 0, beta psi = beta z = x - eta omega w'
    mu = _dynamic_stiffness(k, g, omega, s, case)
    psi = s * X0 - at(rising, mu * integral) / (omega * case.beta)
    amplitude = kappa / omega * (at(falling, integral) - at(rising, integral))
    return r, omega, psi, omega * at(rising, slope), amplitude


def _hopf_limit(case):
    """Return the `Balance` at the Hopf point, s = 0; it is exact after two iterations."""
    n = len(case.eta)
    scalars = (np.zeros((n, 1)) for _ in range(4))
    balance = Balance(np.zeros((n, EVEN.size)), np.zeros((n, ODD.size)), *scalars)
    return _next_balance(_next_balance(balance, 0.0, case), 0.0, case)


def _next_balance(balance, s, case):
    """Return the `Balance` after one iteration, which solves each harmonic's linear part.

    s : r^2, (n, 1) or one value for all
    """
    Q, P, X0, _, d, g = balance
    even, odd = _residual(balance, s, case)
    omega = _frequency(d, s, case)

    def correction(k, waves, part):
        mu = _dynamic_stiffness(k, g, omega, s, case)
        return -_project(part, waves) / (mu * (1 - 1j / (k * omega)) + 1j * k * omega - case.b1)

    Q, P = Q + correction(EVEN, EVEN_WAVES, even), P + correction(ODD, ODD_WAVES, odd)
    first = _project(odd, FIRST_HARMONIC[None])
    g = g - first.real
    d = d - (first.imag + first.real / omega) * omega / case.b1
    X0 = X0 + even.mean(axis=1, keepdims=True) / case.beta
    return Balance(Q, P, X0, g + case.eta * case.b1 * d, d, g)


def _frequency(d, s, case):
    """Return omega [V_lp/Dc]; NaN if 1 + s d < 0."""
    return np.sqrt(case.b1 * (1 + s * d))


def _dynamic_stiffness(k, g, omega, s, case):
    """Return kappa - eta (k omega)^2 without cancellation at k = 1."""
    return case.b1 + s * g + (1 - k**2) * case.eta * omega**2


def _residual(balance, s, case):
    """Return the even part/r^2 and odd part/r^3 of the equation at the nodes, (n, nodes) each.

    Names end in o and e for odd parts/r and even parts/r^2, and begin with d for d/d phase:

    q, p        harmonics 2, 4, ... and 3, 5, ... of w: Q and P at the nodes
    Wo          w = 1 + r Wo + r^2 q, where Wo = cos + s p
    Jo, Je      1/w = 1 + r Jo + r^2 Je
    B, Ve       v = ln w = r (cos + s B) + r^2 Ve
    Zo, Ze      z = r Zo + r^2 Ze, where Zo = Z0 + s Y, and Z0 belongs to cos alone
    Ho, He      h(z) = r Ho + r^2 He
    No, Ne      h(z) + z = r^3 No + r^2 Ne
    mu_Q, mu_P  harmonics of kappa (w - 1) + eta omega^2 w'', int_Q and int_P their integrals
    """
    b1, beta, _, series = case
    Q, P, X0, _, d, g = balance
    omega = _frequency(d, s, case)
    mu_Q = _dynamic_stiffness(EVEN, g, omega, s, case) * Q
    mu_P = _dynamic_stiffness(ODD, g, omega, s, case) * P
    q, dq, even, int_Q = _at_nodes(EVEN_WAVES, Q, 1j * EVEN * Q, mu_Q, mu_Q / (1j * EVEN))
    p, dp, odd, int_P = _at_nodes(ODD_WAVES, P, 1j * ODD * P, mu_P, mu_P / (1j * ODD))
    Wo, dWo = C + s * p, s * dp - S
    w = 1 + s * q
    D = w**2 - s * Wo**2
    Jo, Je = -Wo / D, (Wo**2 - q * w) / D
    B, Ve = _logarithm(q, p, s)
    root = np.sqrt(b1)
    detuning = root * d / (1 + omega / root)  # (omega - root)/s
    Z0 = (b1 * C - root * S) / beta
    Y = (b1 * B + detuning * root / omega * S - (g * S + int_P) / omega) / beta
    Zo, Ze = Z0 + s * Y, X0 + (b1 * Ve - int_Q / omega) / beta
    No, Ne = _beyond_linear(Zo, Ze, s, series)
    Ho, He = s * No - Zo, Ne - Ze
    even += omega * (dq * (1 + s * Je) + dWo * Jo)
    even += beta * (He + Wo * Ho + s * q * He)
    odd += g * C - detuning * S + omega * (dp + dWo * Je + dq * Jo)
    odd += beta * (No - Y + q * Ho + Wo * He)
    return even, odd


def _logarithm(q, p, s):
    """Return B and Ve of v = r (cos + s B) + s Ve = ln(1 + r (cos + s p) + s q)."""
    Wo = C + s * p
    t = Wo / (1 + s * q)  # the odd part is artanh(r t)
    B = p - t * q + t**3 * _artanh_tail(s * t**2)
    E = q * (2 + s * q) - Wo**2  # the even part is log1p(s E)/2, which is artanh(s t) with
    t = E / (2 + s * E)
    return B, t * (1 + (s * t) ** 2 * _artanh_tail((s * t) ** 2))


def _artanh_tail(z):
    """Return (artanh(t)/t - 1)/t^2 at t^2 = z < 0.3, by Gauss's continued fraction."""
    fraction = 19.0
    for k in range(9, 1, -1):
        fraction = 2 * k - 1 - k * k * z / fraction
    return 1 / (fraction - z)


def _beyond_linear(o, e, s, series):
    """Return the odd part/r^3 and even part/r^2 of h(z) + z at z = r o + r^2 e."""
    odd, even = 0.0, series[-1]  # of (h + z)/z^2 = r odd + even, by Horner's rule
    for c in series[-2::-1]:
        odd, even = even * o + s * odd * e, s * (odd * o + even * e) + c
    cross, square = 2 * o * e, o**2 + s * e**2  # z^2 = r^3 cross + r^2 square
    return cross * even + square * odd, square * even + s * cross * odd


# One product a case, never one for the batch: the same bits in any batch, and no threads.
def _at_nodes(waves, *harmonics):
    """Return the values (n, nodes) of each set of harmonics, a list."""
    return [(amplitudes[:, None, :] @ waves)[:, 0].real for amplitudes in harmonics]


def _project(values, waves):
    """Return the complex amplitudes (n, waves) of these waves in values (n, nodes)."""
    return (values[:, None, :] @ waves.conj().T)[:, 0] * (2 / NODES.size)
