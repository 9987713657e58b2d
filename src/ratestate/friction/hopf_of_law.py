"""The Hopf bifurcation of steady sliding to third order, under any friction law.

As in `normal_form`, where it is in closed form for laws of one length:

    v = ln(V/V_lp) = r cos(phase) + O(r^2),    dr/dT = growth r + lyapunov_1 r^3,

with times in Dc/V_lp.  Here it is Kuznetsov's (2004) formula as numbers, in which terms cancel, and
so in the longest floating-point numbers that there are.  The Jacobian A is an arrow, so that its
inverses and eigenvectors are written out.

=======  ========================================================================
kappa_c  K_c Dc/(a sigma), and omega the frequency there
y, z     vectors (x, v, psi_1, ...), tuples of complex arrays
q, p     eigenvectors of A and of its transpose to i omega, q scaled to 1 in v, p q = 1
=======  ========================================================================

Without mass x = S(v, psi), and v is a function of the other variables.
"""

import functools
from typing import NamedTuple

import numpy as np

# Rounding of the law's derivatives, which are double precision, relative to the terms of the sum.
ROUNDING = 1e-14


class System(NamedTuple):
    """Steady sliding at its Hopf bifurcation: arrays, and derivatives of the law there."""

    kappa: np.ndarray
    eta: np.ndarray
    stress: tuple  # its derivatives of order 1, 2 and 3, as of the law's methods
    rates: tuple  # likewise

    @property
    def n(self):
        """How many states there are."""
        return len(self.rates[0][0])


@np.errstate(invalid="ignore")  # of sliders without a bifurcation
def lyapunov_1(law, p, kappa, eta, omega):
    """First Lyapunov coefficient [V/Dc] and its rounding error, two arrays; NaN where omega is.

    law, p : the law and its coefficients with V_ref = V_lp, a tuple of arrays
    kappa, eta, omega : arrays, those of the bifurcation; not checked
    """
    system = _system(law, p, kappa, eta)
    L = 1j * _long(omega).astype(np.clongdouble)
    q = _eigenvector(system, L)
    left = _left_eigenvector(system, L)
    q_ = tuple(np.conj(x) for x in q)
    bend = functools.partial(_second, system)
    terms = (
        _third(system, q, q, q_),
        tuple(-2 * x for x in bend(q, _solve(system, 0 * L, bend(q, q_), -1))),
        bend(q_, _solve(system, 2 * L, bend(q, q), 1)),
    )
    parts = [sum(a * b for a, b in zip(left, term, strict=True)).real / 8 for term in terms]
    sizes = [sum(np.abs(a * b) for a, b in zip(left, term, strict=True)) / 8 for term in terms]
    return sum(parts).astype(float), (ROUNDING * sum(sizes)).astype(float)


def growth_slopes(linear, kappa, eta, omega):
    """d Re L/d ln K and /d ln V of the pair at the bifurcation; of V by eta alone.

    linear : `linear_stability.Linearisation`
    """
    L = 1j * omega[..., None]
    rs = linear.evolution * linear.rates
    with np.errstate(divide="ignore", invalid="ignore"):  # of sliders without a bifurcation
        slope = eta - kappa / L[..., 0] ** 2 + (rs / (L + linear.rates) ** 2).sum(axis=-1)
        by_K, by_V = -kappa / L[..., 0] / slope, -2.0 * eta * L[..., 0] / slope
    return by_K.real, by_V.real


def _long(x):
    return np.asarray(x, np.longdouble)


def _system(law, p, kappa, eta):
    """`System` of these sliders."""
    psi = law.steady_variables(p)
    e = law.exponentials(0.0, 1.0, psi, p)
    rates = [law.rate_partials(0.0, 1.0, psi, e, p, order) for order in (1, 2, 3)]
    stress = [law.stress_partials(0.0, 1.0, psi, p, order) for order in (1, 2, 3)]
    return System(_long(kappa), _long(eta), _nested(stress), _nested(rates))


def _nested(values):
    """Numbers and arrays inside tuples, as long ones."""
    if isinstance(values, tuple | list):
        return tuple(map(_nested, values))
    return _long(values)


def _solve(system, L, r, sign):
    """sign (L - A)^-1 r, for numbers L.

    With s = L - f_psi of each state: x = (r_x - kappa v)/L and psi = (r_psi + f_v v)/s.
    """
    (S_v, S_psi), (f_v, f_psi) = system.stress[0], system.rates[0]
    s = [L - f for f in f_psi]
    # L may be 0: the row of v times eta L
    held = r[0] - L * sum(S * rest / one for S, rest, one in zip(S_psi, r[2:], s, strict=True))
    stiff = system.kappa + L * (system.eta * L + S_v)
    stiff = stiff + L * sum(S * f / one for S, f, one in zip(S_psi, f_v, s, strict=True))
    v = (held + L * r[1]) / stiff
    psi = [(rest + f * v) / one for rest, f, one in zip(r[2:], f_v, s, strict=True)]
    x = system.eta * L * v + S_v * v - r[1]
    x = x + sum(S * state for S, state in zip(S_psi, psi, strict=True))
    return tuple(sign * part for part in (x, v, *psi))


def _eigenvector(system, L):
    """q, of the eigenvalue L."""
    f_v, f_psi = system.rates[0]
    one = np.ones_like(L)
    return (-system.kappa / L, one, *(f / (L - g) for f, g in zip(f_v, f_psi, strict=True)))


def _left_eigenvector(system, L):
    """p, which multiplies what `_second` and `_third` give: of the row of v times eta."""
    (_, S_psi), (_, f_psi) = system.stress[0], system.rates[0]
    one = np.ones_like(L)
    left = (one / L, one, *(-S / (L - g) for S, g in zip(S_psi, f_psi, strict=True)))
    q = _eigenvector(system, L)
    norm = left[0] * q[0] + system.eta * left[1] * q[1]
    norm = norm + sum(a * b for a, b in zip(left[2:], q[2:], strict=True))
    return tuple(part / norm for part in left)


def _second(system, y, z):
    """The second derivative of the equations along y and z; the row of v times eta."""
    f_vv, f_vpsi, f_psipsi = system.rates[1]
    bend = _bend_of_stress(system, y, z)
    rates = (
        f_vv[k] * y[1] * z[1]
        + f_vpsi[k] * (y[1] * z[2 + k] + y[2 + k] * z[1])
        + f_psipsi[k] * y[2 + k] * z[2 + k]
        for k in range(system.n)
    )
    g_y, g_z = _change_of_g(system, y), _change_of_g(system, z)
    return -system.kappa * y[1] * z[1], -bend - g_y * z[1] - y[1] * g_z, *rates


def _change_of_g(system, y):
    """How the inertial force changes along y."""
    S_v, S_psi = system.stress[0]
    return y[0] - S_v * y[1] - sum(S * state for S, state in zip(S_psi, y[2:], strict=True))


def _third(system, y, z, u):
    """The third derivative of the equations along y, z and u; the row of v times eta."""
    S_vvv, S_vvpsi, S_vpsipsi, S_psi3 = system.stress[2]
    f_vvv, f_vvpsi, f_vpsipsi, f_psi3 = system.rates[2]
    n, vectors = range(system.n), (y, z, u)
    turns = [(vectors[i], vectors[i - 1], vectors[i - 2]) for i in range(3)]
    bend = S_vvv * y[1] * z[1] * u[1]
    for a, b, c in turns:
        bend = bend + sum(S_vvpsi[k] * a[2 + k] * b[1] * c[1] for k in n)
        bend = bend + sum(S_vpsipsi[j][k] * a[1] * b[2 + j] * c[2 + k] for j in n for k in n)
    bend = bend + sum(
        S_psi3[i][j][k] * y[2 + i] * z[2 + j] * u[2 + k] for i in n for j in n for k in n
    )
    force = -bend
    for a, b, c in turns:
        force = force + _change_of_g(system, a) * b[1] * c[1]
        force = force + _bend_of_stress(system, a, b) * c[1]
    rates = []
    for k in n:
        rate = f_vvv[k] * y[1] * z[1] * u[1] + f_psi3[k] * y[2 + k] * z[2 + k] * u[2 + k]
        for a, b, c in turns:
            rate = rate + f_vvpsi[k] * a[2 + k] * b[1] * c[1]
            rate = rate + f_vpsipsi[k] * a[1] * b[2 + k] * c[2 + k]
        rates.append(rate)
    return -system.kappa * y[1] * z[1] * u[1], force, *rates


def _bend_of_stress(system, y, z):
    """The second derivative of the stress along y and z."""
    S_vv, S_vpsi, S_psipsi = system.stress[1]
    n = range(system.n)
    bend = S_vv * y[1] * z[1]
    bend = bend + sum(S_vpsi[k] * (y[1] * z[2 + k] + y[2 + k] * z[1]) for k in n)
    return bend + sum(S_psipsi[j][k] * y[2 + j] * z[2 + k] for j in n for k in n)
