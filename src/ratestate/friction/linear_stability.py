"""Steady sliding under any friction law: stability, and response to oscillations.

Linearised at V, with times in Dc/V, small perturbations that grow as exp(L T) obey

    eta L + S_v + kappa/L - sum_k r_k s_k/(L + s_k) = 0,

with eta = M V^2/(a sigma Dc) (eq. 7) and kappa = K Dc/(a sigma).  s_k is the relaxation rate of
the k-th state.  S_v, the direct effect plus damping, and r_k, the evolution effect of that state,
are divided by a.  On the edge of stability L = i omega, and with z = omega^2

    sum_k r_k s_k^2/(z + s_k^2) = S_v,      kappa = z (eta + sum_k r_k s_k/(z + s_k^2)).

For laws of one length this is eq. 6.  The formulas in closed_forms.py are used for them, because
they lose no digits if b is near a.

Frequencies are Omega = omega Dc/V, and sigma(t) = sigma s.  Small oscillations exp(i Omega T) of
w_lp and of s about 1 move the slider:

    i Omega x = kappa (w_lp - v)
    i Omega eta v = x - S_v v - sum_k S_k psi_k - (mu/a) s
    i Omega psi_k = f_v v + f_k psi_k + i Omega h_k s

with h_k, the jump of a state with ln s: -alpha/b for theta (Linker & Dieterich 1992).  So v is
the external force divided by the mechanical impedance of the slider on its spring.

Sources: Linker & Dieterich (1992) doi:10.1029/92JB00017; without mass Perfettini, Schmittbuhl, Rice
& Cocco (2001) doi:10.1029/2000JB900336.

The functions take NumPy arrays of one shape in SI units, by their symbols, and check no ranges.
"""

from typing import NamedTuple

import numpy as np

from . import closed_forms
from .roots import polynomial_roots
from .tuples import dot

# Smallest eta for which the fastest mode is finite.
SMALLEST_ETA = 1e-290
# Largest ratio of evolution effect to direct effect, minus 1, that rounding may cause.
ROUNDING = 1e-15
# Largest imaginary part of a root, divided by its modulus, that rounding may cause.
ROUNDING_OF_ROOT = 1e-9


class Linearisation(NamedTuple):
    """Steady sliding linearised, dimensionless: arrays, states along the last axis."""

    direct: np.ndarray  # S_v
    evolution: np.ndarray  # (..., n) r_k
    rates: np.ndarray  # (..., n) s_k


def linearisation(law, p):
    """Return the `Linearisation` of steady sliding at V_ref, with coefficients p."""
    at = law.steady(p)
    (by_v, by_psi), (S_v, *S_psi) = at.f_slopes, at.S_slopes
    shape = np.shape(p[0])
    by_v, by_psi, S_psi = (
        np.stack([np.broadcast_to(x, shape) for x in parts], axis=-1)
        for parts in (by_v, by_psi, S_psi)
    )
    return Linearisation(np.broadcast_to(S_v, shape), S_psi * by_v / by_psi, -by_psi)


class Edges(NamedTuple):
    """Stiffnesses at which steady sliding at one speed changes stability (last axis).

    As K falls to kappa, `pairs` (1 or -1) more pairs of eigenvalues become unstable; 0: no edge.
    """

    z: np.ndarray  # (..., n) omega^2
    per_z: np.ndarray  # kappa/z - eta
    pairs: np.ndarray

    def kappa(self, inertia):
        """Return kappa of each edge, for eta (...)."""
        return self.z * (inertia[..., None] + self.per_z)

    def margin(self, stiffness, inertia):
        """Return |kappa - edge|/(kappa + |edge|) of the nearest edge, < 0 if unstable.

        stiffness, inertia : kappa and eta (...)
        """
        kappa, stiffness = self.kappa(inertia), stiffness[..., None]
        ratio = kappa / stiffness
        distance = np.where(self.pairs == 0, 1.0, np.abs(1.0 - ratio) / (1.0 + np.abs(ratio)))
        unstable_pairs = (self.pairs * (stiffness <= kappa)).sum(axis=-1)
        return np.where(unstable_pairs > 0, -1.0, 1.0) * distance.min(axis=-1)


def edges(law, p):
    """Return the `Edges` of steady sliding at V_ref, with coefficients p.

    Under laws of one state z, and so kappa, is negative if no edge exists.
    """
    linear = linearisation(law, p)
    S_v, r, s = linear.direct[..., None], linear.evolution, linear.rates
    if s.shape[-1] == 1:
        # the direct effect of regularized friction may underflow to 0
        excess = r / np.where(S_v == 0.0, 1.0, S_v) - 1.0
        z = s**2 * np.where(np.abs(excess) <= ROUNDING, 0.0, excess)
        return Edges(z, S_v / s, (z > 0.0).astype(int))
    z = polynomial_roots(_numerator(S_v, r * s**2, s**2))
    is_edge = (np.abs(z.imag) <= ROUNDING_OF_ROOT * np.abs(z)) & (z.real > 0.0)
    z = np.where(is_edge, z.real, 0.0)
    divisor = np.where(is_edge, z, 1.0)[..., None] + (s**2)[..., None, :]
    per_z = ((r * s)[..., None, :] / divisor).sum(axis=-1)
    direction = ((r * s**2)[..., None, :] / divisor**2).sum(axis=-1)
    return Edges(z, per_z, np.where(is_edge, np.sign(direction), 0.0).astype(int))


def _numerator(head, residues, poles, power=0):
    """Return the numerator of head - x^power sum_k residues_k/(x + poles_k).

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
    """Multiply a polynomial by x + pole."""
    zero = np.zeros_like(c[..., :1])
    return np.concatenate([c, zero], axis=-1) + pole * np.concatenate([zero, c], axis=-1)


class Critical(NamedTuple):
    """The largest K at which steady sliding at one speed changes stability."""

    kappa: np.ndarray  # K_c Dc/(a sigma); 0 or less if sliding is stable at any K
    omega: np.ndarray  # angular frequency at this K [V/Dc]; NaN if there is no such K


def critical(law, p, inertia):
    """Return `Critical` of steady sliding at V_ref, with coefficients p, for eta."""
    all_edges = edges(law, p)
    kappa = all_edges.kappa(inertia)
    largest = kappa.argmax(axis=-1)[..., None]
    z, kappa = (np.take_along_axis(x, largest, axis=-1)[..., 0] for x in (all_edges.z, kappa))
    return Critical(kappa, np.sqrt(np.where(z > 0.0, z, np.nan)))


def K_c(law, V, *, sigma, M, **values):
    """Return the largest K [Pa/m] at which steady sliding at V changes stability.

    It is 0 or less if sliding is stable at any K.
    """
    if law.one_length:
        return closed_forms.K_c(V, sigma=sigma, M=M, **values)
    p, inertia = _at_speed(law, V, sigma=sigma, M=M, **values)
    return critical(law, p, inertia).kappa * values["a"] * sigma / values["Dc"]


def omega_c(law, V, *, sigma, M, **values):
    """Return the angular frequency [rad/s] at K = K_c; NaN if no such K exists."""
    if law.one_length:
        return closed_forms.omega_c(V, **values)
    return V / values["Dc"] * critical(law, *_at_speed(law, V, sigma=sigma, M=M, **values)).omega


def _at_speed(law, V, *, sigma, M, **values):
    """Return the law's coefficients at V, a tuple of arrays, and eta (eq. 7)."""
    inertia = closed_forms.eta(V, a=values["a"], Dc=values["Dc"], sigma=sigma, M=M)
    return law.coefficient_arrays(V, {"sigma": sigma, **values}), inertia


def is_stable(law, V, *, sigma, K, M, **values):
    """Return whether steady sliding at V is stable; on the edge it is not."""
    if law.one_length:
        return closed_forms.K_c(V, sigma=sigma, M=M, **values) < K
    return stability_margin(law, V, sigma=sigma, K=K, M=M, **values) > 0.0


def stability_margin(law, V, *, sigma, K, M, **values):
    """Return `Edges.margin` of steady sliding at V."""
    p, inertia = _at_speed(law, V, sigma=sigma, M=M, **values)
    return edges(law, p).margin(K * values["Dc"] / (values["a"] * sigma), inertia)


def eigenvalues(law, V, *, sigma, K, M, **values):
    """Return eigenvalues (..., n + 2) [1/s] of steady sliding, least stable first.

    Modes of infinite rate are -inf: one if M = 0, two if K = inf, because V is then imposed.
    """
    if law.one_length:
        return closed_forms.eigenvalues(V, sigma=sigma, K=K, M=M, **values)
    p, inertia = _at_speed(law, V, sigma=sigma, M=M, **values)
    result = modes(law, p, K * values["Dc"] / (values["a"] * sigma), inertia)
    rate = (V / values["Dc"])[..., None]
    result.real, result.imag = result.real * rate, result.imag * rate  # -inf * complex is NaN
    return result


def modes(law, p, kappa, inertia):
    """Return the `eigenvalues` [V/Dc] of steady sliding at V_ref under a law.

    p : coefficients; kappa, inertia : K Dc/(a sigma), and eta
    """
    S_v, r, s = linearisation(law, p)
    if s.shape[-1] == 1:  # other units turn this into eq. 1 under a law of one length
        rate = s[..., 0]
        eta, kappa, beta = inertia * rate / S_v, kappa / (rate * S_v), r[..., 0] / S_v
        result = closed_forms.steady_modes(eta, kappa, beta, kappa - (beta - 1.0) * (1.0 + eta))
        result.real, result.imag = result.real * s, result.imag * s
        return result
    rigid, light = np.isinf(kappa), inertia < SMALLEST_ETA
    head = np.stack([inertia, S_v, np.where(rigid, 1.0, kappa)], axis=-1)
    polynomial = _numerator(head, r * s, s, power=1)
    result = np.full((*S_v.shape, polynomial.shape[-1] - 1), -np.inf, complex)
    result[light, :-1] = polynomial_roots(polynomial[light, 1:])
    result[~light] = polynomial_roots(polynomial[~light])
    order = np.lexsort((-result.imag, -result.real), axis=-1)
    result = np.take_along_axis(result, order, -1)
    result[rigid] = -np.inf
    result[rigid, :-2] = -np.sort(s[rigid], axis=-1)
    return result


def other_modes(modes, omega):
    """Return all modes (n, k) but the two with frequencies nearest to omega (n,)."""
    order = np.argsort(np.abs(np.abs(modes.imag) - omega[:, None]), axis=1)
    return np.take_along_axis(modes, np.sort(order[:, 2:], axis=1), axis=1)


class Response(NamedTuple):
    """Complex amplitudes per unit amplitude of their cause; arrays of one shape."""

    v: np.ndarray  # of V/V_lp - 1
    x: np.ndarray  # of tau/(a sigma)
    f: np.ndarray  # of friction, mu/a


def responses(law, p, kappa, inertia, mu, h, Omega):
    """Return the `Response` of steady sliding at V_ref to w_lp, and to s.

    law, p : the law, and its coefficients for V_ref, a tuple of arrays
    kappa, inertia : K Dc/(a sigma), inf if the slider moves with the load point, and eta
    mu : friction in steady sliding, divided by a
    h : tuple, d psi_k/d ln s of each variable
    Omega : omega Dc/V_ref
    """
    at = law.steady(p)
    (f_v, f_psi), (S_v, *S_psi), (R_v, *R_psi) = at.f_slopes, at.S_slopes, at.R_slopes
    i = 1j * Omega
    by_v = [f_v_k / (i - f_psi_k) for f_v_k, f_psi_k in zip(f_v, f_psi, strict=True)]
    by_s = [i * jump / (i - f_psi_k) for jump, f_psi_k in zip(h, f_psi, strict=True)]
    impedance = i * inertia + S_v + dot(S_psi, by_v)
    push = mu + dot(S_psi, by_s)
    with np.errstate(divide="ignore"):
        mobility = i / kappa  # of the spring; 0 if the slider moves with the load point

    def of(w_lp, s):
        v = (w_lp - mobility * push * s) / (1.0 + mobility * impedance)
        x = (impedance * w_lp + push * s) / (1.0 + mobility * impedance)
        f = (R_v + dot(R_psi, by_v)) * v + dot(R_psi, by_s) * s
        return Response(v, x, f)

    return of(1.0, 0.0), of(0.0, 1.0)
