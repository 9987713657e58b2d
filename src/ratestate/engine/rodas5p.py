"""One step of Rodas5P: Rosenbrock, 8 stages, order 5(4), stiffly accurate, with dense output.

The method is written out in `tableau`, the system in `model`: y = (x, v, psi).  Two things are done
with its shape.

* J is an arrow (x and psi each couple to v alone), so one scalar pivot solves each stage.
* The v row is multiplied by m = eta0 w(v at the start), which turns dv/dT = g/(eta0 w) into
  m dv/dT = g w_start/w.  Nothing overflows as V -> 0, and eta0 = 0 is a regular case: the row
  then reads k_v = k_x - beta k_psi and a linearly implicit method keeps v = x - beta psi.
  What remains is this same method on the two variables x and psi, so the quasi-static limit
  needs no code of its own.

Beside the state, a step integrates the load-point work and the frictional dissipation with the
weights `B` that the method implies for a pure quadrature.
"""

from typing import Any

from .exp import LIMIT, exp, exp_and_inverse
from .jit import inlined
from .tableau import DRIFT, GAMMA, NODES, A, B, C, D, H

ZERO = (0.0, 0.0, 0.0)


@inlined
def plus(y, a, k):
    """y + a k for triples (x, v, psi)."""
    return y[0] + a * k[0], y[1] + a * k[1], y[2] + a * k[2]


@inlined
def times(a, k):
    """a k for a triple."""
    return a * k[0], a * k[1], a * k[2]


@inlined
def plus_sum(y, c, k):
    """y + sum_i c_i k_i for one to eight triples k, summed from the left.

    The length of a tuple is known to the compiler, which leaves out what does not apply.
    """
    y = plus(y, c[0], k[0])
    if len(k) > 1:
        y = plus(y, c[1], k[1])
    if len(k) > 2:
        y = plus(y, c[2], k[2])
    if len(k) > 3:
        y = plus(y, c[3], k[3])
    if len(k) > 4:
        y = plus(y, c[4], k[4])
    if len(k) > 5:
        y = plus(y, c[5], k[5])
    if len(k) > 6:
        y = plus(y, c[6], k[6])
    if len(k) > 7:
        y = plus(y, c[7], k[7])
    return y


@inlined
def sum_of(c, k):
    """sum_i c_i k_i for one to eight triples k."""
    if len(k) == 1:
        return times(c[0], k[0])
    return plus_sum(ZERO, c, k)


@inlined
def exponentials(u, law):
    """w = e**v and 1/w, and e = e**-psi, or 0 in its place where the law does not need it."""
    w, w_inverse = exp_and_inverse(u[1])
    return w, w_inverse, (exp(-u[2]) if law.heals_at_rest() else 0.0)


@inlined
def prepare(y, w, e, h, p):
    """What the first point y of a step fixes: the arrow matrix, and its pivot.

    With f_v and f_psi the derivatives of the law's rate, these seven numbers: w, m = eta0 w,
    gamma h, kappa w, f_v, a_psi = gamma h/(1 - gamma h f_psi), and one over the pivot.
    """
    law, kappa, beta, eta0 = p
    f_v, f_psi = law.rate_partials(w, y[1], y[2], e)
    gamma_h = GAMMA * h
    m = eta0 * w
    kappa_w = kappa * w
    a_psi = gamma_h / (1.0 - gamma_h * f_psi)
    # -(eta0 w) d/dv of g/(eta0 w); at rest w is a constant (exp.py)
    diagonal = 1.0 + (y[0] - y[1] - beta * y[2] if y[1] > -LIMIT else 0.0)
    pivot = 1.0 / (m / gamma_h + diagonal + gamma_h * kappa_w + beta * a_psi * f_v)
    return w, m, gamma_h, kappa_w, f_v, a_psi, pivot


@inlined
def solve_arrow(r_x, r_v, r_psi, beta, start):
    """The triple k that solves the arrow matrix of `prepare` for this right-hand side."""
    _, _, gamma_h, kappa_w, s_v, a_psi, pivot = start
    k_v = pivot * (r_v + gamma_h * r_x - (beta * a_psi) * r_psi)
    return gamma_h * (r_x - kappa_w * k_v), k_v, a_psi * (r_psi + s_v * k_v)


@inlined
def on_manifold(y_new, v_start, m_end, beta, h):
    """y_new with v held on x - beta psi, and whether it is, where inertia is below rounding.

    Over a step in which w changes by orders of magnitude, J sees a deviation at its start and
    not at its end.
    """
    x, v, psi = y_new
    held = x - beta * psi
    negligible = m_end * max(1.0, abs(v - v_start)) < 1e-14 * h
    return (x, held if negligible else v, psi), negligible


@inlined
def increment(u, at, w_lp, rest, p, start):
    """Increment k of a stage at u, given rest = sum_j (C_ij/h) k_j + h d_i df/dT.

    at : w, 1/w and e at u; p = (law, kappa, beta, eta0); start : what `prepare` gave
    """
    law, kappa, beta, _ = p
    x, v, psi = u
    w, w_inverse, e = at
    r_x = kappa * (w_lp - w) + rest[0]
    r_v = (x - v - beta * psi) * (start[0] * w_inverse) + start[1] * rest[1]
    r_psi = law.rate(w, v, psi, e) + rest[2]
    return solve_arrow(r_x, r_v, r_psi, beta, start)


@inlined
def next_point(y, k):
    """Where the stage after those of the increments k is taken: its u, and sum_j C_ij k_j."""
    i = len(k)
    return plus_sum(y, A[i], k), sum_of(C[i], k)


@inlined
def stage(point, w_lp, r, drift, p, start):
    """A stage at what `next_point` gave: its increment, `works` there, and w.

    r : 1/h; drift : h d_i df/dT, of x; None for 0
    """
    u, c = point
    at = exponentials(u, p[0])
    # (only now: before the branches of `exponentials` no product could be fused with what it is
    # added to, and a slider alone would have other bits than in a lane)
    rest = times(r, c) if drift is None else plus((drift, 0.0, 0.0), r, c)
    return increment(u, at, w_lp, rest, p, start), works(u, at[0], w_lp, p[2]), at[0]


@inlined
def end_of_step(y, k, w, h, p):
    """The state (y, w, e) at the end; whether v is held; the estimated error; K_1, K_2, K_3.

    k : the eight increments; w : of the last stage
    """
    free = plus_sum(y, A[8], k)
    y_new, held = on_manifold(free, y[1], p[3] * w, p[2], h)
    error = (k[7][0], k[7][1] + (y_new[1] - free[1]), k[7][2])
    w_new, _, e_new = exponentials(y_new, p[0])
    return (y_new, w_new, e_new), held, error, (sum_of(H[0], k), sum_of(H[1], k), sum_of(H[2], k))


@inlined
def works(u, w, w_lp, beta):
    """Powers per a sigma V0 beyond their mu0 part: of the load point, x w_lp; of friction."""
    return u[0] * w_lp, (u[1] + beta * u[2]) * w


@inlined
def sum_of_4(c, s):
    """sum_i c_i s_i for four pairs."""
    first = c[0] * s[0][0] + c[1] * s[1][0] + c[2] * s[2][0] + c[3] * s[3][0]
    return first, c[0] * s[0][1] + c[1] * s[1][1] + c[2] * s[2][1] + c[3] * s[3][1]


@inlined
def step(y, w, e, w_lp, ramp, h, p):
    """One step of size h from y = (x, v, psi).

    Parameters
    ----------
    y, w, e : state, e**v and e**-psi at the start
    w_lp, ramp : load-point speed at the start and its rate d w_lp/dT
    p : (law, kappa, beta, eta0)

    Returns
    -------
    new : y, w and e at the end
    error : estimated error of y (triple)
    dense : the dense output's K_1, K_2, K_3 (triples)
    load_work, dissipation : integrals of `works` over the step
    """
    _, kappa, beta, _ = p
    start = prepare(y, w, e, h, p)
    r, dw, drift = 1.0 / h, h * ramp, h * kappa * ramp

    k1 = increment(y, (w, 1.0 / w, e), w_lp, (D[0] * drift, 0.0, 0.0), p, start)
    k: Any = (k1,)
    k2, s2, _ = stage(next_point(y, k), w_lp + NODES[1] * dw, r, D[1] * drift, p, start)
    k = k1, k2
    k3, s3, _ = stage(next_point(y, k), w_lp + NODES[2] * dw, r, D[2] * drift, p, start)
    k = k1, k2, k3
    k4, s4, _ = stage(next_point(y, k), w_lp + NODES[3] * dw, r, D[3] * drift, p, start)
    k = k1, k2, k3, k4
    k5, s5, _ = stage(next_point(y, k), w_lp + NODES[4] * dw, r, D[4] * drift, p, start)
    k = k1, k2, k3, k4, k5
    k6, s6, _ = stage(next_point(y, k), w_lp + dw, r, None, p, start)
    k = k1, k2, k3, k4, k5, k6
    k7, s7, _ = stage(next_point(y, k), w_lp + dw, r, None, p, start)
    k = k1, k2, k3, k4, k5, k6, k7
    k8, s8, w8 = stage(next_point(y, k), w_lp + dw, r, None, p, start)
    k = k1, k2, k3, k4, k5, k6, k7, k8
    new, _, error, dense = end_of_step(y, k, w8, h, p)

    # The two quadratures: s_i = works(u_i) + gradient k_i + h_i d_i d/dT, weighted by B.
    dy = sum_of(B, k)
    friction = y[1] + beta * y[2]
    load_1, friction_1 = sum_of_4(B[:4], (works(y, w, w_lp, beta), s2, s3, s4))
    load_2, friction_2 = sum_of_4(B[4:], (s5, s6, s7, s8))
    load_work = w_lp * dy[0] + DRIFT * dw * y[0] + load_1 + load_2
    dissipation = w * ((1.0 + friction) * dy[1] + beta * dy[2]) + friction_1 + friction_2
    return new, error, dense, h * load_work, h * dissipation
