"""The linear response of steady sliding to small oscillations of speed and normal stress.

With times in Dc/V, frequencies Omega = omega Dc/V and sigma(t) = sigma s, small oscillations
e^(i Omega T) of w_lp and of s about 1 move the slider as

    i Omega x = kappa (w_lp - v)
    i Omega eta v = x - S_v v - sum_k S_k psi_k - (mu/a) s
    i Omega psi_k = f_v v + f_k psi_k + i Omega h_k s

where h_k is how a state jumps with ln s: for theta -alpha/b (Linker & Dieterich 1992).  So v is the
force that comes from outside over the mechanical impedance of the slider on its spring.

Sources: Linker & Dieterich (1992) doi:10.1029/92JB00017; without mass Perfettini, Schmittbuhl, Rice
& Cocco (2001) doi:10.1029/2000JB900336.
"""

from typing import NamedTuple

import numpy as np

from .tuples import dot


class Response(NamedTuple):
    """Complex amplitudes per unit of the oscillation that makes them; arrays of one shape."""

    v: np.ndarray  # of V/V_lp - 1
    x: np.ndarray  # of tau/(a sigma)
    f: np.ndarray  # of friction, mu/a


def responses(law, p, kappa, inertia, mu, h, Omega):
    """`Response` to w_lp, and to s, of steady sliding at V_ref.

    law, p : the law, and its coefficients for V_ref, a tuple of arrays
    kappa, inertia : K Dc/(a sigma), inf where the slider moves as the load point does, and eta
    mu : friction in steady sliding, over a
    h : tuple, d psi_k/d ln s of each variable
    Omega : omega Dc/V_ref
    """
    psi = law.steady_variables(p)
    f_v, f_psi = law.rate_partials(0.0, 1.0, psi, law.exponentials(0.0, 1.0, psi, p), p)
    S_v, S_psi = law.stress_partials(0.0, 1.0, psi, p)
    R_v, R_psi = law.resistance_partials(0.0, 1.0, psi, p)
    i = 1j * Omega
    by_v = [slope / (i - own) for slope, own in zip(f_v, f_psi, strict=True)]
    by_s = [i * jump / (i - own) for jump, own in zip(h, f_psi, strict=True)]
    resisting = i * inertia + S_v + dot(S_psi, by_v)
    push = mu + dot(S_psi, by_s)
    with np.errstate(divide="ignore"):
        soft = i / kappa  # 0 where the slider moves as the load point does

    def of(w_lp, s):
        v = (w_lp - soft * push * s) / (1.0 + soft * resisting)
        x = (resisting * w_lp + push * s) / (1.0 + soft * resisting)
        f = (R_v + dot(R_psi, by_v)) * v + dot(R_psi, by_s) * s
        return Response(v, x, f)

    return of(1.0, 0.0), of(0.0, 1.0)
