"""Steady sliding under any friction law: whether it is stable, and how it responds.

Linearised at V, with times in Dc/V and e to the power of L T, small perturbations obey

    eta L + S_v + kappa/L - sum_k r_k s_k/(L + s_k) = 0,

eta = M V^2/(a sigma Dc) (eq. 7), kappa = K Dc/(a sigma), where s_k is the rate at which the k-th
state relaxes, S_v the direct effect, with that of damping, and r_k the evolution effect of that
state, over a.  On the edge of stability L = i omega, with z = omega^2,

    sum_k r_k s_k^2/(z + s_k^2) = S_v,      kappa = z (eta + sum_k r_k s_k/(z + s_k^2)).

For laws of one length this is eq. 6, and the closed forms of stability.py are used, which lose no
digits if b is near a.

Frequencies are Omega = omega Dc/V, and sigma(t) = sigma s.  Small oscillations e^(i Omega T) of
w_lp and of s about 1 move the slider as

    i Omega x = kappa (w_lp - v)
    i Omega eta v = x - S_v v - sum_k S_k psi_k - (mu/a) s
    i Omega psi_k = f_v v + f_k psi_k + i Omega h_k s

where h_k is the jump of a state with ln s: -alpha/b for theta (Linker & Dieterich 1992).  So v is
the force from outside divided by the mechanical impedance of the slider on its spring.

Sources: Linker & Dieterich (1992) doi:10.1029/92JB00017; without mass Perfettini, Schmittbuhl, Rice
& Cocco (2001) doi:10.1029/2000JB900336.

Functions take NumPy arrays of one shape, SI units, by their symbols, and check no range.
"""

from typing import NamedTuple

import numpy as np

from . import stability
from .roots import polynomial_roots
from .tuples import dot

# Smallest eta with a finite fastest mode.
LIGHTEST = 1e-290
# Largest ratio of evolution effect to direct effect, less 1, that may be rounding.
NEUTRAL = 1e-15
# Largest imaginary part of a root, as a part of its modulus, that may be rounding.
IMAGINARY = 1e-9


class Linearisation(NamedTuple):
    """Steady sliding linearised, dimensionless: arrays of one shape, states along a last axis."""

    direct: np.ndarray  # S_v
    evolution: np.ndarray  # (..., n) r_k
    rates: np.ndarray  # (..., n) s_k


def linearisation(law, p):
    """The `Linearisation` of steady sliding at V_ref, under a law with these coefficients."""
    at = law.steady(p)
    (by_v, by_psi), (S_v, *S_psi) = at.f_slopes, at.S_slopes
    shape = np.shape(p[0])
    by_v, by_psi, S_psi = (
        np.stack([np.broadcast_to(x, shape) for x in parts], axis=-1)
        for parts in (by_v, by_psi, S_psi)
    )
    return Linearisation(np.broadcast_to(S_v, shape), S_psi * by_v / by_psi, -by_psi)


class Edges(NamedTuple):
    """Stiffnesses at which steady sliding at one speed changes stability, along the last axis.

    As K falls to kappa, `pairs` more pairs of eigenvalues, 1 or -1, become unstable; 0 if there is
    no edge.
    """

    z: np.ndarray  # (..., n) omega^2
    per_z: np.ndarray  # kappa/z, less eta
    pairs: np.ndarray

    def kappa(self, inertia):
        """kappa of each edge, for eta (...)."""
        return self.z * (inertia[..., None] + self.per_z)

    def margin(self, stiffness, inertia):
        """(...) |kappa - edge|/(kappa + |edge|) of the nearest edge; < 0 if sliding is unstable.

        stiffness, inertia : kappa and eta (...)
        """
        kappa, stiffness = self.kappa(inertia), stiffness[..., None]
        ratio = kappa / stiffness
        apart = np.where(self.pairs == 0, 1.0, np.abs(1.0 - ratio) / (1.0 + np.abs(ratio)))
        unstable_pairs = (self.pairs * (stiffness <= kappa)).sum(axis=-1)
        return np.where(unstable_pairs > 0, -1.0, 1.0) * apart.min(axis=-1)


def edges(law, p):
    """The `Edges` of steady sliding at V_ref, under a law with these coefficients.

    Under laws of one state z, and so kappa, is negative if there is no edge.
    """
    linear = linearisation(law, p)
    S_v, r, s = linear.direct[..., None], linear.evolution, linear.rates
    if s.shape[-1] == 1:
        # (friction may be so regularized that none is left, in double precision)
        excess = r / np.where(S_v == 0.0, 1.0, S_v) - 1.0
        z = s**2 * np.where(np.abs(excess) <= NEUTRAL, 0.0, excess)
        return Edges(z, S_v / s, (z > 0.0).astype(int))
    z = polynomial_roots(_numerator(S_v, r * s**2, s**2))
    is_edge = (np.abs(z.imag) <= IMAGINARY * np.abs(z)) & (z.real > 0.0)
    z = np.where(is_edge, z.real, 0.0)
    apart = np.where(is_edge, z, 1.0)[..., None] + (s**2)[..., None, :]
    per_z = ((r * s)[..., None, :] / apart).sum(axis=-1)
    direction = ((r * s**2)[..., None, :] / apart**2).sum(axis=-1)
    return Edges(z, per_z, np.where(is_edge, np.sign(direction), 0.0).astype(int))


def _numerator(head, residues, poles, power=0):
    """The numerator of head - x^power sum_k residues_k/(x + poles_k).

    Polynomials (..., m) have their highest power first; residues, poles : (..., n)
    """
    total, product = head, np.ones_like(poles[..., :1])
    for k in range(poles.shape[-1]):
        pole, end = poles[..., k, None], head.shape[-1] + k + 1 - power
        total = _times_factor(total, pole)
        total[..., end - k - 1 : end] -= residues[..., k, None] * product
        product = _times_factor(product, pole)
    return total


def _times_factor(c, pole):
    """x + pole times a polynomial."""
    zero = np.zeros_like(c[..., :1])
    return np.concatenate([c, zero], axis=-1) + pole * np.concatenate([zero, c], axis=-1)


class Critical(NamedTuple):
    """The largest K at which steady sliding at one speed changes stability, dimensionless."""

    kappa: np.ndarray  # K_c Dc/(a sigma): not above 0 if sliding is stable at any K
    omega: np.ndarray  # angular frequency there [V/Dc]; NaN if there is no such K


def critical(law, p, inertia):
    """`Critical` of steady sliding at V_ref under a law with these coefficients, for eta."""
    found = edges(law, p)
    kappa = found.kappa(inertia)
    last = kappa.argmax(axis=-1)[..., None]
    z, kappa = (np.take_along_axis(x, last, axis=-1)[..., 0] for x in (found.z, kappa))
    return Critical(kappa, np.sqrt(np.where(z > 0.0, z, np.nan)))


def K_c(law, V, *, sigma, M, **values):
    """Critical stiffness [Pa/m] at V: the largest K at which steady sliding changes stability.

    It is not above 0 if sliding is stable at any K.
    """
    if law.one_length:
        return stability.K_c(V, sigma=sigma, M=M, **values)
    p, inertia = _at_speed(law, V, sigma=sigma, M=M, **values)
    return critical(law, p, inertia).kappa * values["a"] * sigma / values["Dc"]


def omega_c(law, V, *, sigma, M, **values):
    """Angular frequency [rad/s] on the edge of stability, at K = K_c; NaN if there is none."""
    if law.one_length:
        return stability.omega_c(V, **values)
    return V / values["Dc"] * critical(law, *_at_speed(law, V, sigma=sigma, M=M, **values)).omega


def _at_speed(law, V, *, sigma, M, **values):
    """The law's coefficients at V, a tuple of arrays, and eta (eq. 7)."""
    inertia = stability.eta(V, a=values["a"], Dc=values["Dc"], sigma=sigma, M=M)
    return law.coefficient_arrays(V, {"sigma": sigma, **values}), inertia


def is_stable(law, V, *, sigma, K, M, **values):
    """Whether steady sliding at V is stable; it is not on the edge."""
    if law.one_length:
        return stability.K_c(V, sigma=sigma, M=M, **values) < K
    return stability_margin(law, V, sigma=sigma, K=K, M=M, **values) > 0.0


def stability_margin(law, V, *, sigma, K, M, **values):
    """`Edges.margin` of steady sliding at V."""
    p, inertia = _at_speed(law, V, sigma=sigma, M=M, **values)
    return edges(law, p).margin(K * values["Dc"] / (values["a"] * sigma), inertia)


def eigenvalues(law, V, *, sigma, K, M, **values):
    """(..., n + 2) eigenvalues [1/s] of steady sliding at V, least stable first.

    Modes of infinite rate are -inf: one at M = 0, two at K = inf, where V is imposed.
    """
    if law.one_length:
        return stability.eigenvalues(V, sigma=sigma, K=K, M=M, **values)
    p, inertia = _at_speed(law, V, sigma=sigma, M=M, **values)
    found = modes(law, p, K * values["Dc"] / (values["a"] * sigma), inertia)
    rate = (V / values["Dc"])[..., None]
    found.real, found.imag = found.real * rate, found.imag * rate  # -inf times a complex is nan
    return found


def modes(law, p, kappa, inertia):
    """`eigenvalues` [V/Dc] of steady sliding at V_ref, under a law with these coefficients.

    kappa, inertia : K Dc/(a sigma), and eta
    """
    S_v, r, s = linearisation(law, p)
    if s.shape[-1] == 1:  # by a change of units those of eq. 1 and a law of one length
        rate = s[..., 0]
        eta, kappa, beta = inertia * rate / S_v, kappa / (rate * S_v), r[..., 0] / S_v
        found = stability.steady_modes(eta, kappa, beta, kappa - (beta - 1.0) * (1.0 + eta))
        found.real, found.imag = found.real * s, found.imag * s
        return found
    rigid, light = np.isinf(kappa), inertia < LIGHTEST
    head = np.stack([inertia, S_v, np.where(rigid, 1.0, kappa)], axis=-1)
    whole = _numerator(head, r * s, s, power=1)
    found = np.full((*S_v.shape, whole.shape[-1] - 1), -np.inf, complex)
    found[light, :-1] = polynomial_roots(whole[light, 1:])
    found[~light] = polynomial_roots(whole[~light])
    order = np.lexsort((-found.imag, -found.real), axis=-1)
    found = np.take_along_axis(found, order, -1)
    found[rigid] = -np.inf
    found[rigid, :-2] = -np.sort(s[rigid], axis=-1)
    return found


def beside_the_pair(modes, omega):
    """(n, k - 2) the `modes` (n, k) without the two whose frequency is nearest to omega (n,)."""
    order = np.argsort(np.abs(np.abs(modes.imag) - omega[:, None]), axis=1)
    return np.take_along_axis(modes, np.sort(order[:, 2:], axis=1), axis=1)


class Response(NamedTuple):
    """Complex amplitudes per unit of the oscillation that makes them; arrays of one shape."""

    v: np.ndarray  # of V/V_lp - 1
    x: np.ndarray  # of tau/(a sigma)
    f: np.ndarray  # of friction, mu/a


def responses(law, p, kappa, inertia, mu, h, Omega):
    """`Response` to w_lp, and to s, of steady sliding at V_ref.

    law, p : the law, and its coefficients for V_ref, a tuple of arrays
    kappa, inertia : K Dc/(a sigma), inf if the slider moves as the load point does, and eta
    mu : friction in steady sliding, divided by a
    h : tuple, d psi_k/d ln s of each variable
    Omega : omega Dc/V_ref
    """
    at = law.steady(p)
    (f_v, f_psi), (S_v, *S_psi), (R_v, *R_psi) = at.f_slopes, at.S_slopes, at.R_slopes
    i = 1j * Omega
    by_v = [slope / (i - own) for slope, own in zip(f_v, f_psi, strict=True)]
    by_s = [i * jump / (i - own) for jump, own in zip(h, f_psi, strict=True)]
    resisting = i * inertia + S_v + dot(S_psi, by_v)
    push = mu + dot(S_psi, by_s)
    with np.errstate(divide="ignore"):
        soft = i / kappa  # 0 if the slider moves as the load point does

    def of(w_lp, s):
        v = (w_lp - soft * push * s) / (1.0 + soft * resisting)
        x = (resisting * w_lp + push * s) / (1.0 + soft * resisting)
        f = (R_v + dot(R_psi, by_v)) * v + dot(R_psi, by_s) * s
        return Response(v, x, f)

    return of(1.0, 0.0), of(0.0, 1.0)
