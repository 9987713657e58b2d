"""The three eigenvalues of steady sliding, in dimensionless form and to full precision.

Equation numbers are those of Im, Marone & Elsworth (2019).
"""

import numpy as np


def steady_modes(eta, kappa, beta, margin):
    """Eigenvalues, in units of V/Dc, of small perturbations of steady sliding.

    The force balance (eq. 4) with either evolution law, linearised at theta = Dc/V:

        eta L^3 + (1 + eta) L^2 + (1 - beta + kappa) L + kappa = 0

    Complex array: three along a last axis, by descending real part, a conjugate pair with its
    positive imaginary part first.  Each is good to a few units in the last place of its modulus
    unless it is nearly a double one; at eta = 0 the last is -inf.  Ranges are not checked.

    ======  =======================================================================
    eta     M V^2/(sigma a Dc) (eq. 7), >= 0
    kappa   K Dc/(a sigma), > 0, finite
    beta    b/a
    margin  (K - K_c) Dc/(a sigma) = kappa - (beta - 1)(1 + eta); given by the caller, because all
            digits that it loses are lost by the growth rate
    ======  =======================================================================
    """
    rho = _isolated_root(eta, kappa, beta)
    # With L = -rho/eta known, the other two solve L^2 + p L + q = 0.  In this form of p nothing
    # cancels but the margin itself, so that the growth rate has its sign whatever the rounding.
    p = margin * rho / ((1 + eta) * rho**2 + kappa * eta**2)
    q = kappa / rho
    half, discriminant = -p / 2, p**2 / 4 - q
    root = np.sqrt(np.abs(discriminant))
    paired = discriminant < 0
    outer = half + np.copysign(root, half)
    modes = np.empty((*np.shape(rho), 3), complex)
    with np.errstate(divide="ignore"):
        real = [np.where(paired, half, outer), np.where(paired, half, q / outer), -rho / eta]
    modes.real = np.stack(real, -1)
    modes.imag = np.where(paired, root, 0.0)[..., None] * [1, -1, 0]
    order = np.argsort(-modes.real, axis=-1, kind="stable")
    return np.take_along_axis(modes, order, -1)


def _isolated_root(eta, kappa, beta):
    """A positive root of x^3 - (1+eta) x^2 + eta (kappa+1-beta) x - eta^2 kappa, far from others.

    There is one, as the sign changes between 0 and infinity.  Of three real roots the one on the
    emptier side of their mean cannot be a double root, and a single real root lies on that
    side too; from beyond it Newton's method descends without overshooting.  At eta = 0 the
    double root at x = 0 is the pair of the quasi-static system, and x = 1 is returned.
    """
    c2, c1, c0 = -(1 + eta), eta * (kappa + 1 - beta), -(eta**2) * kappa
    mean = -c2 / 3
    value = ((mean + c2) * mean + c1) * mean + c0
    slope = (3 * mean + 2 * c2) * mean + c1
    # y = x - mean solves y^3 + slope y + value = 0, so |y| is below this (1.3248^3 = 1.3248 + 1)
    bound = np.maximum(np.cbrt(np.abs(value)), np.sqrt(np.maximum(-slope, 0)))
    x = mean + np.where(value > 0, -1.3248, 1.3248) * bound
    done = np.zeros(np.shape(x), bool)  # each by itself: what lies beside it changes no digit
    for _ in range(200):  # a third nearer each time at worst; mostly five to ten are enough
        derivative = (3 * x + 2 * c2) * x + c1
        step = (((x + c2) * x + c1) * x + c0) / np.where(derivative == 0, np.inf, derivative)
        x = np.where(done, x, x - step)
        done |= np.abs(step) <= 4e-16 * np.abs(x)
        if np.all(done):
            break
    return x
