"""The Hopf bifurcation of steady sliding to third order, in dimensionless form.

With V0 := V_lp and time T = t V_lp/Dc, sliding near the bifurcation is

    v = ln(V/V_lp) = r cos(phase) + O(r^2),    dr/dT = growth r + lyapunov_1 r^3,

where the growth rate is 0 at kappa_c = (beta - 1) (1 + eta), so that small cycles have
r^2 = -growth/lyapunov_1; they attract (supercritical) where lyapunov_1 < 0.

The law's rate is taken to be d psi/dT = w h(v + psi), as in `formulas.dtheta_dt`, with its
scales chosen such that h(0) = 0 and h'(0) = -1; h2 and h3 are the second and third derivatives of h
at 0, which are the law's own with respect to psi in steady sliding.  Kuznetsov (2004),
doi:10.1007/978-1-4757-3978-7, section 5.4, gives the first Lyapunov coefficient of any system,

    Re[<p, C(q,q,q')> - 2 <p, B(q, A^-1 B(q,q'))> + <p, B(q', (2 i omega - A)^-1 B(q,q))>]/8,

here with q scaled to 1 in v (' means conjugate), so that v = z + z' and r = 2 |z|.  As numbers
its terms would cancel: what remains of them is of the order of eta for slow sliding.  So
`lyapunov_1` is that formula worked out for the slider, in which nothing cancels for either law
but at the zero itself; the tests compare the two in 60 digits.
"""

import numpy as np

from .laws import friction_law

# Rounding of eta and beta - 1, and of the sum below, relative to its terms
ROUNDING = 1e-14


def law_curvatures(law):
    """h2 and h3, two floats, of a law of one length by name; ParameterError for an unknown one."""
    c2, c3, *_ = friction_law(law).series
    return 2.0 * c2, 6.0 * c3


def third_order(b1, h2, h3):
    """Coefficients of 1, eta, eta^2 and eta^3 in `lyapunov_1`, whose sign is opposite to the sum.

    slip: 2 beta^2 (0, 1, 10, 9); aging: 2 beta (0, -1, 6, 3 + 4 beta)
    """
    return (
        b1 * (h2**2 + h3),
        b1**2 * 2 * (h2 - 1) ** 2 + b1 * (6 * h2**2 - 8 * h2 + 4 * h3 + 4) + 2 - 4 * h2,
        b1**2 * (12 * h2**2 - 28 * h2 + 4 * h3 + 20)
        + b1 * (13 * h2**2 - 36 * h2 + 5 * h3 + 40)
        + (20 - 8 * h2),
        b1**2 * (14 * h2**2 - 16 * h2 + 8 * h3 + 18)
        + b1 * (8 * h2**2 - 20 * h2 + 2 * h3 + 36)
        + (18 - 4 * h2),
    )


def lyapunov_1(eta, b1, h2, h3):
    """First Lyapunov coefficient [V/Dc] at the Hopf bifurcation, and its rounding error.

    Two arrays, or floats; ranges are not checked.

    eta, b1 : M V^2/(sigma a Dc) (eq. 7), >= 0, and b/a - 1, > 0; h2, h3 : see `law_curvatures`
    """
    powers = 1.0, eta, eta**2, eta**2 * eta
    terms = [c * power for c, power in zip(third_order(b1, h2, h3), powers, strict=True)]
    size = b1 / (16 * (1 + b1) * _damping(1, eta, b1) * _damping(2, eta, b1))
    return 0.0 - size * sum(terms), ROUNDING * size * sum(map(np.abs, terms))


def _damping(k, eta, b1):
    """What the linear problem leaves of the k-th harmonic, squared: (1+eta)^2 + b1 (k eta)^2."""
    return (1 + eta) ** 2 + b1 * (k * eta) ** 2


def growth_slopes(eta, b1):
    """d growth rate [V/Dc]/d ln V at constant K, and /d ln K at constant V, at the bifurcation."""
    fastest = b1 / _damping(1, eta, b1)
    return eta * fastest, -(1 + eta) / 2 * fastest


def stress_swing(eta, b1):
    """Max - min of tau/(a sigma) for r = 1: ln V swings by 2, x by kappa_c/omega times as much."""
    return 2 * np.sqrt(b1) * (1 + eta)


def turning_point(b1, h2, h3):
    """Smallest eta > 0 at which `lyapunov_1` of the number b1 is zero; NaN where there is none."""
    roots = np.roots(third_order(b1, h2, h3)[::-1])
    return min(roots.real[(roots.imag == 0) & (roots.real > 0)], default=np.nan)
