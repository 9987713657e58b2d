"""Harmonic balance of a small-amplitude limit cycle near the Hopf point.

Dimensionless with V0 := V_lp, time in Dc/V_lp.  For a law whose state obeys d theta/dt = f(Omega),
Omega = V theta/Dc, the rate is d psi/dT = w h(z) with z = ln Omega = v + psi, and at the phase
omega T the slider's three equations become one for w = V/V_lp (' = d/d phase),

    kappa (w - 1) + eta omega^2 w'' + omega w'/w + beta w h(z) = 0,
    beta z = x + (beta - 1) v - eta omega w',    x' = -kappa (w - 1)/omega.

A small cycle is w = 1 + r cos(phase) for any r: the terms that determine r are r^2 times smaller,
and rounding would bury them.  But a shift of the phase by pi changes the sign of r, so that the
harmonics separate by parity,

    w = 1 + r (cos + r Q + r^2 P),     Q: harmonics 2, 4, ...,   P: harmonics 3, 5, ...,

and v, z and the equation split likewise into parts of even and odd harmonics.  The terms that cos
alone satisfies are left out by hand, the parts are divided by r^2 and r^3, and only s = r^2 is
left: nothing cancels, down to s = 0.  There the equations are triangular, so an iteration that
solves each harmonic's linear equation converges like s.  Arrays are (n, 1), harmonics complex
(n, harmonics).
"""

from typing import NamedTuple

import numpy as np

HARMONICS = 15
# over half a period: parity gives the other half
NODES = np.pi * np.arange(HARMONICS + 1) / (HARMONICS + 1)
FIRST = np.exp(1j * NODES)
C, S = FIRST.real, FIRST.imag
EVEN, ODD = np.arange(2, HARMONICS, 2), np.arange(3, HARMONICS + 1, 2)
EVEN_WAVES, ODD_WAVES = np.exp(1j * np.outer(EVEN, NODES)), np.exp(1j * np.outer(ODD, NODES))


class Case(NamedTuple):
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
    #: (kappa - kappa_c)/s
    m: np.ndarray
    #: omega^2 = (beta - 1) (1 + s d)
    d: np.ndarray
    #: m - eta (beta - 1) d, kept apart as the difference would lose digits
    g: np.ndarray


def hopf_limit(case):
    """The `Balance` at s = 0, the Hopf point; exact after two iterations."""
    n = len(case.eta)
    scalars = (np.zeros((n, 1)) for _ in range(4))
    balance = Balance(np.zeros((n, EVEN.size)), np.zeros((n, ODD.size)), *scalars)
    return next_balance(next_balance(balance, 0.0, case), 0.0, case)


def next_balance(balance, s, case):
    """The `Balance` after one iteration, which solves each harmonic's linear part for the residual.

    s : r^2, (n, 1) or one value for all
    """
    Q, P, X0, _, d, g = balance
    even, odd = residual(balance, s, case)
    omega = frequency(d, s, case)

    def correction(k, waves, part):
        mu = dynamic_stiffness(k, g, omega, s, case)
        return -project(part, waves) / (mu * (1 - 1j / (k * omega)) + 1j * k * omega - case.b1)

    Q, P = Q + correction(EVEN, EVEN_WAVES, even), P + correction(ODD, ODD_WAVES, odd)
    first = project(odd, FIRST[None])
    g = g - first.real
    d = d - (first.imag + first.real / omega) * omega / case.b1
    X0 = X0 + even.mean(axis=1, keepdims=True) / case.beta
    return Balance(Q, P, X0, g + case.eta * case.b1 * d, d, g)


def frequency(d, s, case):
    """(n, 1) omega in units of V_lp/Dc; NaN where 1 + s d < 0."""
    return np.sqrt(case.b1 * (1 + s * d))


def dynamic_stiffness(k, g, omega, s, case):
    """(n, len(k)) kappa - eta (k omega)^2, without cancellation at k = 1."""
    return case.b1 + s * g + (1 - k**2) * case.eta * omega**2


def residual(balance, s, case):
    """Even part/r^2 and odd part/r^3 of the equation at the nodes, (n, nodes) each.

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
    omega = frequency(d, s, case)
    mu_Q = dynamic_stiffness(EVEN, g, omega, s, case) * Q
    mu_P = dynamic_stiffness(ODD, g, omega, s, case) * P
    q, dq, even, int_Q = at_nodes(EVEN_WAVES, Q, 1j * EVEN * Q, mu_Q, mu_Q / (1j * EVEN))
    p, dp, odd, int_P = at_nodes(ODD_WAVES, P, 1j * ODD * P, mu_P, mu_P / (1j * ODD))
    Wo, dWo = C + s * p, s * dp - S
    w = 1 + s * q
    D = w**2 - s * Wo**2
    Jo, Je = -Wo / D, (Wo**2 - q * w) / D
    B, Ve = logarithm(q, p, s)
    root = np.sqrt(b1)
    detuning = root * d / (1 + omega / root)  # (omega - root)/s
    Z0 = (b1 * C - root * S) / beta
    Y = (b1 * B + detuning * root / omega * S - (g * S + int_P) / omega) / beta
    Zo, Ze = Z0 + s * Y, X0 + (b1 * Ve - int_Q / omega) / beta
    No, Ne = beyond_linear(Zo, Ze, s, series)
    Ho, He = s * No - Zo, Ne - Ze
    even += omega * (dq * (1 + s * Je) + dWo * Jo)
    even += beta * (He + Wo * Ho + s * q * He)
    odd += g * C - detuning * S + omega * (dp + dWo * Je + dq * Jo)
    odd += beta * (No - Y + q * Ho + Wo * He)
    return even, odd


def logarithm(q, p, s):
    """B and Ve of v = r (cos + s B) + s Ve = ln(1 + r (cos + s p) + s q), (n, nodes) each."""
    Wo = C + s * p
    t = Wo / (1 + s * q)  # the odd part is artanh(r t)
    B = p - t * q + t**3 * artanh_tail(s * t**2)
    E = q * (2 + s * q) - Wo**2  # the even part is log1p(s E)/2, which is artanh(s t) with
    t = E / (2 + s * E)
    return B, t * (1 + (s * t) ** 2 * artanh_tail((s * t) ** 2))


def artanh_tail(z):
    """(artanh(t)/t - 1)/t^2 at t^2 = z, to double precision for z < 0.3, by Gauss's fraction."""
    fraction = 19.0
    for k in range(9, 1, -1):
        fraction = 2 * k - 1 - k * k * z / fraction
    return 1 / (fraction - z)


def beyond_linear(o, e, s, series):
    """Odd part/r^3 and even part/r^2 of h(z) + z at z = r o + r^2 e, in the shape of o and e."""
    odd, even = 0.0, series[-1]  # of (h + z)/z^2 = r odd + even, by Horner's rule
    for c in series[-2::-1]:
        odd, even = even * o + s * odd * e, s * (odd * o + even * e) + c
    cross, square = 2 * o * e, o**2 + s * e**2  # z^2 = r^3 cross + r^2 square
    return cross * even + square * odd, square * even + s * cross * odd


# One product a case, never one for the batch: the same bits in any batch, and no threads.
def at_nodes(waves, *harmonics):
    """List of node values, (n, nodes), one for each set of harmonics, of their sum."""
    return [(amplitudes[:, None, :] @ waves)[:, 0].real for amplitudes in harmonics]


def project(values, waves):
    """(n, waves) complex amplitudes of these waves in node values (n, nodes)."""
    return (values[:, None, :] @ waves.conj().T)[:, 0] * (2 / NODES.size)
