"""One step of Rodas5P: Rosenbrock, 8 stages, order 5(4), stiffly accurate, with dense output.

The method is written out in `tableau`, the system in `model`: y = (x, v, psi), with a psi for each
of the law's variables.  Two things are done with its shape.

* J is an arrow (x and each psi couple to v alone), so one scalar pivot solves each stage.
* The v row is multiplied by m = eta0 w(v at the start), which turns dv/dT = g/(eta0 w) into
  m dv/dT = g w_start/w.  Nothing overflows as V -> 0, and eta0 = 0 is a regular case: the row
  then reads S_v k_v = k_x - S_psi k_psi and a linearly implicit method keeps x = S(v, psi).
  What remains is this same method on the other variables, so the quasi-static limit needs no code
  of its own.  (Where slip may reverse c takes the place of w, and omega that of v: `kinematics`.)

Beside the state, a step integrates the load-point work and the frictional dissipation with the
weights `B` that the method implies for a pure quadrature.
"""

from typing import NamedTuple

from ..friction.functions import larger, where
from ..friction.tuples import (
    dot_onto,
    minus_dot,
    plus,
    plus_sum,
    product,
    sum_of,
    times,
    total,
)
from .equations import derived, exponentials, inertial_force, later, works
from .tableau import DRIFT, GAMMA, NODES, A, B, C, D, H


class Arrow(NamedTuple):
    """The matrix of a step (`kinematics` has c, slopes and shares)."""

    c: float
    m: float  # eta0 c
    gamma_h: float
    kappa_c: float
    f_v: tuple  # slopes of the law's rates by omega
    g_psi: tuple  # those of -m dv/dT
    a_psi: tuple  # gamma h/(1 - gamma h f_psi)
    pivot: float  # one over it
    shares: tuple


class Drift(NamedTuple):
    """h d/dT of the equations at the start of a step, where x, v and psi are constant."""

    x: float  # of dx/dT: the load point accelerates
    v: tuple  # of m dv/dT, one number
    psi: tuple  # of d psi/dT; this and v are () unless normal stress varies


def prepare(y, w, e, h, system):
    """What the first point y of a step fixes: the arrow matrix, and its pivot."""
    law, kappa, eta0, p = system
    f_v, f_psi = law.rate_slopes(y[1], w, y[2:], e, p)
    c = law.speed_slope(w, e)
    gamma_h = GAMMA * h
    m = eta0 * c
    kappa_c = kappa * c
    a_psi = leaves(gamma_h, f_psi)
    diagonal, *g_psi = derived("inertia_slopes", y, w, e, law, p, q=1.0, m=m)
    pivot = 1.0 / dot_onto(m / gamma_h + diagonal + gamma_h * kappa_c, product(g_psi, a_psi), f_v)
    shares = law.shares(w, 1.0 / c, p)
    return Arrow(c, m, gamma_h, kappa_c, f_v, tuple(g_psi), a_psi, pivot, shares)


def drift_of(y, w, h, ramp, system, start):
    """The `Drift` of a step from y."""
    law, kappa, _, p = system
    psi = times(h, law.rate_drift(y[1], w, y[2:], p))
    strength = times(-h, law.strength_drift(y[1], w, y[2:], p))
    of_v = tuple(minus_dot(one, times(start.m, start.shares), psi) for one in strength)
    return Drift(h * kappa * ramp, of_v, psi)


def with_drift(rest, drift, d):
    """rest + d drift of each state, where there is a drift."""
    return plus(rest, times(d, drift)) if drift else rest


def leaves(gamma_h, f_psi):
    """One over each diagonal element of the arrow that belongs to a state."""
    return tuple(gamma_h / (1.0 - gamma_h * slope) for slope in f_psi)


def solve_arrow(r, start):
    """The k that solves the arrow matrix of `prepare` for this right-hand side (x, v, psi).

    It is an arrow in x, omega and psi, of which v's increment follows.
    """
    _, m, gamma_h, kappa_c, f_v, g_psi, a_psi, pivot, shares = start
    r_v = dot_onto(r[1], times(m, shares), r[2:])
    k_omega = pivot * minus_dot(r_v + gamma_h * r[0], product(g_psi, a_psi), r[2:])
    k_psi = product(a_psi, plus(r[2:], times(k_omega, f_v)))
    return gamma_h * (r[0] - kappa_c * k_omega), minus_dot(k_omega, shares, k_psi), *k_psi


def on_manifold(y, w, e, v_start, h, system):
    """y with v held where friction balances the spring, and whether it is, if inertia is lost.

    It is where m = eta0 c is below rounding.  Over a step in which c changes by orders of
    magnitude, J sees a deviation at its start and not at its end.

    w, e : near the end of the step
    """
    law, _, eta0, p = system
    g, S_v, _ = inertial_force(y, w, e, law, p)
    negligible = eta0 * law.speed_slope(w, e) * larger(1.0, abs(y[1] - v_start)) < 1e-14 * h
    v = where(negligible, y[1] + g / S_v, y[1])
    return (y[0], v, *y[2:]), negligible


def increment(u, at, w_lp, rest, drift, system, start):
    """Increment k of a stage at u, given rest = sum_j (C_ij/h) k_j + h d_i df/dT.

    at : w, 1/c and e at u; drift : of m dv/dT, h d_i times its d/dT, in a tuple
    system = (law, kappa, eta0, p); start : what `prepare` gave
    """
    law, kappa, _, p = system
    w, c_inverse, e = at
    g = u[0] - law.stress_in_v(u[1], w, u[2:], p)
    f = law.rates_in_v(u[1], w, u[2:], e, p)
    r_x = kappa * (w_lp - w) + rest[0]
    r_v = total((g * (start.c * c_inverse) + start.m * rest[1], *drift))
    r_v = minus_dot(r_v, times(start.m, law.shares(w, c_inverse, p)), f)
    return solve_arrow((r_x, r_v, *plus(f, rest[2:])), start)


def next_point(y, k):
    """Where the stage after those of the increments k is taken: its u, and sum_j C_ij k_j."""
    i = len(k)
    return plus_sum(y, A[i], k), sum_of(C[i], k) if k else (0.0,) * len(y)


def end_of_step(y, k, last, h, system):
    """The state (y, w, e) at the end; whether v is held; the estimated error; dense output.

    k : the eight increments; last : w, 1/c and e of the last stage
    """
    free = plus_sum(y, A[8], k)
    y_new, held = on_manifold(free, last[0], last[2], y[1], h, system)
    error = (k[7][0], k[7][1] + (y_new[1] - free[1]), *k[7][2:])
    w_new, _, e_new = exponentials(y_new, system[0], system[3])
    dense = dense_output(y, y_new, sum_of(H[0], k), sum_of(H[1], k), sum_of(H[2], k))
    return (y_new, w_new, e_new), held, error, dense


def dense_output(y0, y1, k1, k2, k3):
    """Polynomials in the fraction of the step, each a tuple of coefficients, the constant first.

    y0, y1 : the state at the ends of the step; k1, k2, k3 : K_1, K_2, K_3 (tableau.py)
    """
    each = zip(y0, y1, k1, k2, k3, strict=True)
    return tuple((u0, (u1 - u0) + a, b - a, c - b, -c) for u0, u1, a, b, c in each)


def step(y, w, e, w_lp, ramp, h, system):
    """One step of size h from y = (x, v, psi).

    Parameters
    ----------
    y, w, e : state, speed and exponentials (`kinematics`) at the start
    w_lp, ramp : load-point speed at the start and its rate d w_lp/dT
    system : (law, kappa, eta0, p), p the law's coefficients

    Returns
    -------
    new : y, w and e at the end
    error : estimated error of y (tuple)
    dense : what `dense_output` gives
    load_work, dissipation : integrals of `works` over the step
    """
    law, _, _, p = system
    start = prepare(y, w, e, h, system)
    dw, drift = h * ramp, drift_of(y, w, h, ramp, system, start)
    at: tuple = (w, 1.0 / start.c, e)
    k: tuple = ()
    powers: list = []
    for node, d in zip(NODES, D, strict=True):
        u, c = next_point(y, k)
        here, w_lp_here = later(system, node * h), w_lp + node * dw
        at = exponentials(u, law, here[3]) if k else at
        rest = times(1.0 / h, c)
        rest = rest[0] + d * drift.x, rest[1], *with_drift(rest[2:], drift.psi, d)
        powers.append(works(u, at[0], w_lp_here, here))
        k = *k, increment(u, at, w_lp_here, rest, times(d, drift.v), here, start)
    new, _, error, dense = end_of_step(y, k, at, h, later(system, h))

    # The two quadratures: powers_i = works(u_i) + gradient k_i + h_i d_i d/dT, weighted by B.
    dy = sum_of(B, k)
    load_1, friction_1 = sum_of(B[:4], powers[:4])
    load_2, friction_2 = sum_of(B[4:], powers[4:])
    S = law.stress_in_v(y[1], w, y[2:], p)
    S_v, S_psi = law.stress_slopes(y[1], w, y[2:], e, p)
    d_omega = dot_onto(dy[1], start.shares, dy[2:])
    load_work = w_lp * dy[0] + DRIFT * dw * y[0] + load_1 + load_2
    gradient = w * dot_onto(S_v * d_omega, S_psi, dy[2:]) + S * (start.c * d_omega)
    of_drift = times(DRIFT * h * w, law.strength_drift(y[1], w, y[2:], p))
    dissipation = total((gradient, *of_drift)) + friction_1 + friction_2
    return new, error, dense, h * load_work, h * dissipation
