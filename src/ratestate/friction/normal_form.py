"""The Hopf bifurcation of steady sliding to third order, in dimensionless form.

With V0 := V_lp and time T = t V_lp/Dc, sliding near the bifurcation is

    v = ln(V/V_lp) = r cos(phase) + O(r^2),    dr/dT = growth r + lyapunov_1 r^3.

The growth rate is 0 at K = K_c, so small cycles have r^2 = -growth/lyapunov_1.  They attract
(supercritical) if lyapunov_1 < 0.  Kuznetsov (2004), doi:10.1007/978-1-4757-3978-7, section 5.4,
gives the first Lyapunov coefficient of any system with the Jacobian A,

    Re[<p, C(q,q,q')> - 2 <p, B(q, A^-1 B(q,q'))> + <p, B(q', (2 i omega - A)^-1 B(q,q))>]/8,

here with q scaled to 1 in v (' means conjugate), so that v = z + z' and r = 2 |z|.

`lyapunov_1_of_law` evaluates this formula under any law.  Its terms cancel: for slow sliding their
sum is of the order of eta.  So `lyapunov_1` is the closed form for laws of one length, in which
terms cancel only at the zero itself.  The tests compare both with 60 digits.
"""

import functools
import math

import numpy as np

from .expressions import Graph
from .functions import exp
from .laws import friction_law
from .rewriting import Derivative, values_of
from .tuples import dot

# Rounding error of eta, beta - 1 and a law's coefficients, relative to the terms of a sum
ROUNDING = 1e-14


def law_curvatures(law):
    """Return h''(0) and h'''(0), two floats, of a law of one length by name.

    The law's rate is d psi/dT = w h(v + psi), with h(0) = 0 and h'(0) = -1.  ParameterError for an
    unknown law.
    """
    c2, c3, *_ = friction_law(law).series
    return 2.0 * c2, 6.0 * c3


def third_order(b1, h2, h3):
    """Return the coefficients of 1, eta, eta^2, eta^3 in the sum of `lyapunov_1`.

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
    """Return the first Lyapunov coefficient [V/Dc] and its rounding error.

    eta, b1 : M V^2/(sigma a Dc) (eq. 7), >= 0, and b/a - 1, > 0, floats or arrays; not checked
    h2, h3 : see `law_curvatures`
    """
    powers = 1.0, eta, eta**2, eta**2 * eta
    terms = [c * power for c, power in zip(third_order(b1, h2, h3), powers, strict=True)]
    # squared residuals of the linear problem for the first and second harmonic
    residuals = ((1 + eta) ** 2 + b1 * (k * eta) ** 2 for k in (1, 2))
    size = b1 / (16 * (1 + b1) * math.prod(residuals))
    return 0.0 - size * sum(terms), ROUNDING * size * sum(map(np.abs, terms))


def turning_point(b1, h2, h3):
    """Return the smallest eta > 0 at which `lyapunov_1` is 0, or NaN; b1 : float."""
    roots = np.roots(third_order(b1, h2, h3)[::-1])
    return min(roots.real[(roots.imag == 0) & (roots.real > 0)], default=np.nan)


def growth_slopes(linear, kappa, eta, omega):
    """Return d Re L/d ln K and d Re L/d ln V (by eta alone) of the bifurcating pair.

    linear : `linear_stability.Linearisation`
    """
    L = 1j * omega[..., None]
    rs = linear.evolution * linear.rates
    with np.errstate(divide="ignore", invalid="ignore"):  # of sliders without a bifurcation
        slope = eta - kappa / L[..., 0] ** 2 + (rs / (L + linear.rates) ** 2).sum(axis=-1)
        by_K, by_V = -kappa / L[..., 0] / slope, -2.0 * eta * L[..., 0] / slope
    return by_K.real, by_V.real


@np.errstate(all="ignore")  # of sliders without a bifurcation
def lyapunov_1_of_law(law, p, kappa, eta, omega):
    """Return the first Lyapunov coefficient [V/Dc] and its rounding error, arrays.

    law, p : the law and its coefficients with V_ref = V_lp, a tuple of arrays
    kappa, eta, omega : arrays, at the bifurcation; not checked; NaN in omega gives NaN
    """
    kappa, eta, at = _extended(kappa), _extended(eta), law.steady(p)
    (f_v, f_psi), (S_v, *S_psi) = at.f_slopes, at.S_slopes

    def form(*vectors):
        """Return the 2nd or 3rd derivative of the equations along 2 or 3 vectors."""
        derivatives, inputs = _multilinear_forms(law)[len(vectors)]
        numbers = (0.0, 0.0, kappa, *at.psi, *p, *(x for vector in vectors for x in vector))
        return values_of(derivatives, dict(zip(inputs, numbers, strict=True)))

    def by_states(L, r):
        """Return sum_k S_k r_k/(L - f_k)."""
        return dot(S_psi, [r_k / (L - f) for r_k, f in zip(r, f_psi, strict=True)])

    def solve(L, r):
        """Return (L - A)^-1 r, with the v element of r times eta; L may be 0."""
        stiff = kappa + L * (eta * L + S_v + by_states(L, f_v))
        v = (r[0] - L * by_states(L, r[2:]) + L * r[1]) / stiff
        psi = [(r_k + f * v) / (L - g) for r_k, f, g in zip(r[2:], f_v, f_psi, strict=True)]
        return eta * L * v + S_v * v - r[1] + dot(S_psi, psi), v, *psi

    L = 1j * _extended(omega).astype(np.clongdouble)
    ones = np.ones_like(L)
    # eigenvectors of A and of its transpose; `left` multiplies vectors with v elements times eta
    q = (-kappa / L, ones, *(f / (L - g) for f, g in zip(f_v, f_psi, strict=True)))
    left = (ones / L, ones, *(-S / (L - g) for S, g in zip(S_psi, f_psi, strict=True)))
    norm = left[0] * q[0] + eta + dot(left[2:], q[2:])
    q_ = tuple(np.conj(x) for x in q)
    terms = (
        form(q, q, q_),
        [2 * x for x in form(q, solve(0 * L, form(q, q_)))],
        form(q_, solve(2 * L, form(q, q))),
    )
    products = [a * b / norm / 8 for term in terms for a, b in zip(left, term, strict=True)]
    error = ROUNDING * sum(map(np.abs, products))
    return sum(products).real.astype(float), error.astype(float)


def _extended(x):
    """Convert to the longest floating-point format, because terms cancel."""
    return np.asarray(x, np.longdouble)


@functools.cache
def _multilinear_forms(law):
    """Return order -> derivatives of the equations along `order` vectors, and their symbols.

    The vectors are (x, v, psi).  The equations are dx/dT = kappa (1 - w), eta dv/dT = g/w with
    g = x - S, and d psi/dT.  In steady sliding v and g are 0.
    """
    graph = Graph(merges=False)  # of its own, so that it changes no order of terms in units
    kappa, *p = (graph.symbol(("p", k)) for k in range(1 + law.n_coefficients))
    v, g, *psi = (graph.symbol(name, is_constant=False) for name in ("v", "g", *law.states))
    at = law.at_speed(v, psi, p)
    equations = [-kappa * exp(v), g * exp(-v), *at.f]
    inputs, forms = [v, g, kappa, *psi, *p], {}
    for order in (1, 2, 3):
        x, *y = (graph.symbol((order, name)) for name in ("x", "v", *law.states))
        derivative = Derivative(graph, dict(zip((v, *psi), y, strict=True)))
        derivative.derivatives[g] = x - derivative(at.S)
        equations, inputs = [*map(derivative, equations)], [*inputs, x, *y]
        forms[order] = equations, inputs
    return forms
