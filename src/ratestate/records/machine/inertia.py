"""Mass and damping of a machine from the frequency and decay of its ring-downs.

A small oscillation exp(lambda t) of stress about steady sliding at V obeys

    M lambda^2 + (damping + G(lambda)) lambda + K = 0,
    G = (sigma/V) (a - b/(1 + lambda Dc/V)),

with G the friction of a law with one state: numerics of `friction.stability`, with lambda in 1/s.
Its imaginary part gives M and its real part the damping, without further approximation.  Without a
slider G is 0: then M = K/|lambda|^2, and the damping has friction in it.
"""

import numpy as np


def mass_and_damping(K, ring_down, sigma, slider):
    """(M [kg/m^2], damping [Pa s/m]) of a `RingDown`, their derivatives (2, 2) by omega and decay,
    and (2,) by K.  slider : its a, b and Dc, or None for no friction
    """

    def values(omega, decay):
        rate = -decay + 1j * omega
        G = _friction(rate, ring_down.V, sigma, slider)
        per_K = 1.0 / abs(rate) ** 2
        M = K * per_K - G.imag / omega
        return np.array([M, M * decay + K * decay * per_K - G.real])

    omega, decay = ring_down.omega, ring_down.decay
    steps = 1e-6 * omega, 1e-6 * decay
    by_omega = (values(omega + steps[0], decay) - values(omega - steps[0], decay)) / 2 / steps[0]
    by_decay = (values(omega, decay + steps[1]) - values(omega, decay - steps[1])) / 2 / steps[1]
    by_K = np.array([1.0, 2.0 * decay]) / (omega**2 + decay**2)
    return values(omega, decay), np.column_stack([by_omega, by_decay]), by_K


def _friction(rate, V, sigma, slider):
    """G [Pa s/m] of an oscillation exp(rate t); 0 at rest."""
    if slider is None or not V > 0.0:
        return 0j
    return sigma / V * (slider.a - slider.b / (1.0 + rate * slider.Dc / V))
