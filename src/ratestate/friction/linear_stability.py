"""Steady sliding under any friction law, and whether it is stable.

Linearised at V, with times in Dc/V and e to the power of L T, small perturbations obey

    eta L + S_v + kappa/L - sum_k r_k s_k/(L + s_k) = 0,

eta = M V^2/(a sigma Dc) (eq. 7), kappa = K Dc/(a sigma), where s_k is the rate at which the k-th
state relaxes, S_v the direct effect, with that of damping, and r_k the evolution effect of that
state, over a.  On the edge of stability L = i omega, with z = omega^2,

    sum_k r_k s_k^2/(z + s_k^2) = S_v,      kappa = z (eta + sum_k r_k s_k/(z + s_k^2)).

For laws of one length this is eq. 6, and the closed forms of stability.py are used.
Functions take NumPy arrays of one shape, SI units, by their symbols, and check no range.
"""

from typing import NamedTuple

import numpy as np

from . import stability
from .eigenvalues import steady_modes
from .polynomials import product, roots

# eta below which inertia is none: the fastest mode is beyond all numbers.
LIGHTEST = 1e-290
# Evolution effect over direct effect, less 1, that is rounding.
NEUTRAL = 1e-15
# Of the roots of the polynomial, what may be rounding of a real one.
IMAGINARY = 1e-9


class Linearisation(NamedTuple):
    """Of steady sliding, dimensionless, in arrays of one shape, states along a last axis."""

    direct: np.ndarray  # S_v
    evolution: np.ndarray  # (..., n) r_k
    rates: np.ndarray  # (..., n) s_k


def linearisation(law, p):
    """The `Linearisation` of steady sliding at V_ref, under a law with these coefficients."""
    psi = law.steady_variables(p)
    by_v, by_psi = law.rate_partials(0.0, 1.0, psi, law.exponentials(0.0, 1.0, psi, p), p)
    S_v, S_psi = law.stress_partials(0.0, 1.0, psi, p)
    shape = np.shape(p[0])
    by_v, by_psi, S_psi = (
        np.stack([np.broadcast_to(x, shape) for x in parts], axis=-1)
        for parts in (by_v, by_psi, S_psi)
    )
    return Linearisation(np.broadcast_to(S_v, shape), S_psi * by_v / by_psi, -by_psi)


class Edges(NamedTuple):
    """Where steady sliding at one speed changes stability, with each edge along the last axis.

    As K falls to kappa, `pairs` more pairs of eigenvalues, 1 or -1, are unstable; 0 where there is
    no edge.
    """

    z: np.ndarray  # (..., n) omega^2
    mass: np.ndarray  # kappa is this times eta, and the other
    quasi_static: np.ndarray
    pairs: np.ndarray

    def kappa(self, inertia):
        """kappa of each edge, for eta (...)."""
        return self.mass * inertia[..., None] + self.quasi_static

    def unstable_pairs(self, stiffness, inertia):
        """(...) how many pairs of eigenvalues are unstable, for kappa and eta (...)."""
        return (self.pairs * (stiffness[..., None] <= self.kappa(inertia))).sum(axis=-1)


def edges(law, p):
    """The `Edges` of steady sliding at V_ref, under a law with these coefficients."""
    linear = linearisation(law, p)
    z, r, s = _edge_frequencies(linear), linear.evolution, linear.rates
    if s.shape[-1] == 1:  # z < 0 where there is no edge, and so is kappa
        return Edges(z, z, z * linear.direct[..., None] / s, (z > 0.0).astype(int))
    is_edge = z > 0.0
    apart = np.where(is_edge, z, 1.0)[..., None] + (s**2)[..., None, :]
    quasi_static = z * ((r * s)[..., None, :] / apart).sum(axis=-1)
    direction = ((r * s**2)[..., None, :] / apart**2).sum(axis=-1)
    zero = np.zeros_like(z)
    return Edges(
        np.where(is_edge, z, zero),
        np.where(is_edge, z, zero),
        np.where(is_edge, quasi_static, zero),
        np.where(is_edge, np.sign(direction), zero).astype(int),
    )


class Critical(NamedTuple):
    """Where steady sliding at one speed first becomes unstable as K falls, dimensionless."""

    kappa: np.ndarray  # K_c Dc/(a sigma): not above 0 where it is stable at any K
    omega: np.ndarray  # angular frequency there [V/Dc]; NaN where there is no such K


def critical(law, p, inertia):
    """`Critical` of steady sliding at V_ref under a law with these coefficients, for eta."""
    if law.one_length:
        b1 = p[0] - 1.0
        return Critical(b1 * (1.0 + inertia), np.sqrt(np.where(b1 > 0.0, b1, np.nan)))
    found = edges(law, p)
    kappa = found.kappa(inertia)
    last = kappa.argmax(axis=-1)[..., None]
    z, kappa = (np.take_along_axis(x, last, axis=-1)[..., 0] for x in (found.z, kappa))
    return Critical(kappa, np.sqrt(np.where(z > 0.0, z, np.nan)))


def K_c(law, V, *, sigma, M, **values):
    """Critical stiffness [Pa/m] at V: the largest K at which steady sliding changes stability.

    Not above 0 where it is stable at any K.
    """
    if law.one_length:
        return stability.K_c(V, sigma=sigma, M=M, **values)
    inertia = _inertia(V, sigma=sigma, M=M, **values)
    kappa = critical(law, _coefficients(law, V, sigma=sigma, **values), inertia).kappa
    return kappa * values["a"] * sigma / values["Dc"]


def omega_c(law, V, *, sigma, M, **values):
    """Angular frequency [rad/s] on the edge of stability, at K = K_c; NaN where there is none."""
    if law.one_length:
        return stability.omega_c(V, **values)
    inertia = _inertia(V, sigma=sigma, M=M, **values)
    p = _coefficients(law, V, sigma=sigma, **values)
    return V / values["Dc"] * critical(law, p, inertia).omega


def _coefficients(law, V, **values):
    """The law's coefficients at V, a tuple of arrays."""
    return law.coefficient_arrays(V, values)


def _inertia(V, *, sigma, M, **values):
    """eta (eq. 7) at V."""
    return stability.eta(V, a=values["a"], Dc=values["Dc"], sigma=sigma, M=M)


def is_stable(law, V, *, sigma, K, M, **values):
    """Whether steady sliding at V is stable; on the edge it is not."""
    if law.one_length:
        return stability.K_c(V, sigma=sigma, M=M, **values) < K
    stiffness = K * values["Dc"] / (values["a"] * sigma)
    inertia = _inertia(V, sigma=sigma, M=M, **values)
    found = edges(law, _coefficients(law, V, sigma=sigma, **values))
    return found.unstable_pairs(stiffness, inertia) <= 0


def _edge_frequencies(linear):
    """(..., n) z = omega^2 on the edges of stability; in place of others a number not above 0."""
    S_v, r, s = linear.direct[..., None], linear.evolution, linear.rates
    if s.shape[-1] == 1:
        # (friction may be so regularized that none is left, in double precision)
        excess = r / np.where(S_v == 0.0, 1.0, S_v) - 1.0
        return s**2 * np.where(np.abs(excess) <= NEUTRAL, 0.0, excess)
    # S_v prod_k (z + s_k^2) - sum_k r_k s_k^2 prod_(j not k) (z + s_j^2)
    whole = product([np.stack([np.ones_like(x), x**2], axis=-1) for x in np.moveaxis(s, -1, 0)])
    total = S_v * whole
    for k in range(s.shape[-1]):
        rest = [x for j, x in enumerate(np.moveaxis(s, -1, 0)) if j != k]
        part = product([np.stack([np.ones_like(x), x**2], axis=-1) for x in rest])
        total[..., 1:] -= (r * s**2)[..., k, None] * part
    z = roots(total)
    real = np.abs(z.imag) <= IMAGINARY * np.abs(z)
    return np.where(real, z.real, 0.0)


def eigenvalues(law, V, *, sigma, K, M, **values):
    """(..., n + 2) eigenvalues [1/s] of steady sliding at V, least stable first.

    A mode faster than everything is -inf: one at M = 0, two at K = inf, where V is imposed.
    """
    if law.one_length:
        return stability.eigenvalues(V, sigma=sigma, K=K, M=M, **values)
    rigid = np.isinf(K)
    kappa = np.where(rigid, 1.0, K) * values["Dc"] / (values["a"] * sigma)
    p = _coefficients(law, V, sigma=sigma, **values)
    found = modes(law, p, kappa, _inertia(V, sigma=sigma, M=M, **values))
    relaxing = np.full(found.shape, -np.inf, complex)
    relaxing[..., :-2] = -np.sort(linearisation(law, p).rates, axis=-1)
    found = np.where(rigid[..., None], relaxing, found)
    rate = (V / values["Dc"])[..., None]
    found.real, found.imag = found.real * rate, found.imag * rate  # -inf times a complex is nan
    return found


def modes(law, p, kappa, inertia):
    """`eigenvalues` [V/Dc] of steady sliding at V_ref, under a law with these coefficients.

    kappa, inertia : K Dc/(a sigma) < inf, and eta
    """
    linear = linearisation(law, p)
    if linear.rates.shape[-1] == 1:
        return _modes_of_one_state(linear, inertia, kappa)
    return _modes(linear, inertia, kappa)


def beside_the_pair(modes, omega):
    """(n, k - 2) the `modes` (n, k) but the two whose frequency is nearest to omega (n,)."""
    order = np.argsort(np.abs(np.abs(modes.imag) - omega[:, None]), axis=1)
    return np.take_along_axis(modes, np.sort(order[:, 2:], axis=1), axis=1)


def _modes_of_one_state(linear, inertia, kappa):
    """The modes of one state, by a change of units those of eq. 1 and a law of one length."""
    S_v, r, s = linear.direct, linear.evolution[..., 0], linear.rates[..., 0]
    eta, kappa, beta = inertia * s / S_v, kappa / (s * S_v), r / S_v
    found = steady_modes(eta, kappa, beta, kappa - (beta - 1.0) * (1.0 + eta))
    found.real, found.imag = found.real * s[..., None], found.imag * s[..., None]
    return found


def _modes(linear, inertia, kappa):
    """The modes of two states or more, as roots of the characteristic polynomial."""
    S_v, s, rs = linear.direct, linear.rates, linear.evolution * linear.rates
    pairs = [np.stack([np.ones_like(x), x], axis=-1) for x in np.moveaxis(s, -1, 0)]
    n = len(pairs)
    slow = product([np.stack([S_v, kappa], axis=-1), *pairs])
    for k in range(n):
        part = product([pair for j, pair in enumerate(pairs) if j != k])
        slow[..., 1:-1] -= rs[..., k, None] * part
    light = inertia < LIGHTEST
    whole = np.concatenate([np.zeros((*slow.shape[:-1], 1)), slow], axis=-1)
    whole[..., : n + 1] += inertia[..., None] * product(pairs)
    found = np.empty((*S_v.shape, n + 2), complex)
    found[light] = np.concatenate(
        [roots(slow[light]), np.full((*slow[light].shape[:-1], 1), -np.inf)], axis=-1
    )
    found[~light] = roots(whole[~light])
    order = np.lexsort((-found.imag, -found.real), axis=-1)
    return np.take_along_axis(found, order, -1)
