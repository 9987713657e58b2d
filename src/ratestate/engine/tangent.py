"""One step of Rodas5P together with its derivative in two directions.

A Rosenbrock method applied to y' = f(y), z' = J(y) z, with the exact Jacobian of both, is the
derivative of the same method's step at fixed step size.  So the matrix is the one of `rodas5p`,
and a stage of z needs no exponential of its own:

    (1/(gamma h) - J) dk_i = J(u_i) du_i + sum_j (C_ij/h) dk_j + (J'(y) z) k_i

with the load point at constant speed.  The v row is scaled as there, by m = eta0 w at the start.

Beside them the step integrates the trace of J, which by Liouville's formula is the rate at which
the logarithm of a volume of states grows.
"""

from .exp import LIMIT
from .jit import inlined
from .model import state_rate_partials, state_rate_partials_2
from .rodas5p import (
    ZERO,
    A,
    B,
    C,
    H,
    dot,
    exponentials,
    on_manifold,
    plus,
    prepare,
    solve,
    stage,
    sum2,
    sum3,
    sum4,
    sum5,
    sum6,
    sum7,
    times,
)


@inlined
def second_derivatives(y, w, e, z, p):
    """J'(y) z: how J, its v row times eta0 w, changes in the direction z.

    By row and column: -xv, -vx, vv, v psi, psi v, psi psi.  At rest w is a constant (exp.py).
    """
    law, kappa, beta, _ = p
    s_vv, s_vpsi, s_psipsi = state_rate_partials_2(law, w, y[1], y[2], e)
    g = y[0] - y[1] - beta * y[2]
    dg = z[0] - z[1] - beta * z[2]
    moves = y[1] > -LIMIT
    dv = z[1] if moves else 0.0
    s_v = s_vv * z[1] + s_vpsi * z[2]
    s_psi = s_vpsi * z[1] + s_psipsi * z[2]
    return kappa * w * dv, dv, (1.0 + g) * dv - dg if moves else 0.0, beta * dv, s_v, s_psi


@inlined
def tangent(u, du, at, k, rest, curvature, r, p, start):
    """Increment dk of a stage, given rest = sum_j C_ij dk_j.

    As V falls, v's perturbation grows like 1/w and h shrinks like w: m/h comes before it.

    at : what `slopes` gave at u; curvature : what `second_derivatives` gave; r : 1/h
    """
    beta = p[2]
    ratio, g, kappa_w, f_v, f_psi = at
    x_v, v_x, v_v, v_psi, s_v, s_psi = curvature
    dg = du[0] - du[1] - beta * du[2]
    r_x = r * rest[0] - kappa_w * du[1] - x_v * k[1]
    r_v = (dg - g * du[1]) * ratio + (start[1] * r) * rest[1]
    r_v += v_v * k[1] + v_psi * k[2] - v_x * k[0]
    r_psi = f_v * du[1] + f_psi * du[2] + r * rest[2] + s_v * k[1] + s_psi * k[2]
    return solve(r_x, r_v, r_psi, beta, start)


@inlined
def slopes(u, w, w_inverse, e, p, start):
    """What `tangent` needs of J(u), and the trace of J(u)."""
    law, kappa, beta, eta0 = p
    f_v, f_psi = state_rate_partials(law, w, u[1], u[2], e)
    g = u[0] - u[1] - beta * u[2] if u[1] > -LIMIT else 0.0
    trace = f_psi - (1.0 + g) * (w_inverse / eta0)
    return (start[0] * w_inverse, g, kappa * w, f_v, f_psi), trace


@inlined
def step(y, w, e, y1, y2, w_lp, h, p):
    """One step of size h from y = (x, v, psi), and of small perturbations y1, y2 of it.

    Parameters
    ----------
    y, w, e : state, e**v and e**-psi at the start
    y1, y2 : perturbations (triples)
    w_lp : speed of the load point, a constant
    p : (law, kappa, beta, eta0), law a literal where this is compiled, eta0 > 0

    Returns
    -------
    y_new, w_new, e_new : the state at the end
    z1, z2 : the perturbations there
    error : the state's estimated error (triple)
    dense : its dense output's K_1, K_2, K_3 (triples)
    trace : integral of the trace of J
    """
    law, _, beta, eta0 = p
    start = prepare(y, w, e, h, p)
    curvature1, curvature2 = second_derivatives(y, w, e, y1, p), second_derivatives(y, w, e, y2, p)
    r = 1.0 / h

    i_u = 1.0 / w
    k1 = stage(y, w, i_u, e, w_lp, ZERO, p, start)
    at, t1 = slopes(y, w, i_u, e, p, start)
    a1 = tangent(y, y1, at, k1, ZERO, curvature1, r, p, start)
    b1 = tangent(y, y2, at, k1, ZERO, curvature2, r, p, start)

    u = plus(y, A[1][0], k1)
    w_u, i_u, e_u = exponentials(u, law)
    k2 = stage(u, w_u, i_u, e_u, w_lp, times(r * C[1][0], k1), p, start)
    at, t2 = slopes(u, w_u, i_u, e_u, p, start)
    d = plus(y1, A[1][0], a1)
    a2 = tangent(u, d, at, k2, times(C[1][0], a1), curvature1, r, p, start)
    d = plus(y2, A[1][0], b1)
    b2 = tangent(u, d, at, k2, times(C[1][0], b1), curvature2, r, p, start)

    u = sum2(y, A[2], k1, k2)
    w_u, i_u, e_u = exponentials(u, law)
    k3 = stage(u, w_u, i_u, e_u, w_lp, times(r, sum2(ZERO, C[2], k1, k2)), p, start)
    at, t3 = slopes(u, w_u, i_u, e_u, p, start)
    d = sum2(y1, A[2], a1, a2)
    a3 = tangent(u, d, at, k3, sum2(ZERO, C[2], a1, a2), curvature1, r, p, start)
    d = sum2(y2, A[2], b1, b2)
    b3 = tangent(u, d, at, k3, sum2(ZERO, C[2], b1, b2), curvature2, r, p, start)

    u = sum3(y, A[3], k1, k2, k3)
    w_u, i_u, e_u = exponentials(u, law)
    k4 = stage(u, w_u, i_u, e_u, w_lp, times(r, sum3(ZERO, C[3], k1, k2, k3)), p, start)
    at, t4 = slopes(u, w_u, i_u, e_u, p, start)
    d = sum3(y1, A[3], a1, a2, a3)
    a4 = tangent(u, d, at, k4, sum3(ZERO, C[3], a1, a2, a3), curvature1, r, p, start)
    d = sum3(y2, A[3], b1, b2, b3)
    b4 = tangent(u, d, at, k4, sum3(ZERO, C[3], b1, b2, b3), curvature2, r, p, start)

    u = sum4(y, A[4], k1, k2, k3, k4)
    w_u, i_u, e_u = exponentials(u, law)
    k5 = stage(u, w_u, i_u, e_u, w_lp, times(r, sum4(ZERO, C[4], k1, k2, k3, k4)), p, start)
    at, t5 = slopes(u, w_u, i_u, e_u, p, start)
    d = sum4(y1, A[4], a1, a2, a3, a4)
    a5 = tangent(u, d, at, k5, sum4(ZERO, C[4], a1, a2, a3, a4), curvature1, r, p, start)
    d = sum4(y2, A[4], b1, b2, b3, b4)
    b5 = tangent(u, d, at, k5, sum4(ZERO, C[4], b1, b2, b3, b4), curvature2, r, p, start)

    u = sum5(y, A[5], k1, k2, k3, k4, k5)
    w_u, i_u, e_u = exponentials(u, law)
    rest = times(r, sum5(ZERO, C[5], k1, k2, k3, k4, k5))
    k6 = stage(u, w_u, i_u, e_u, w_lp, rest, p, start)
    at, t6 = slopes(u, w_u, i_u, e_u, p, start)
    d1 = sum5(y1, A[5], a1, a2, a3, a4, a5)
    rest = sum5(ZERO, C[5], a1, a2, a3, a4, a5)
    a6 = tangent(u, d1, at, k6, rest, curvature1, r, p, start)
    d2 = sum5(y2, A[5], b1, b2, b3, b4, b5)
    rest = sum5(ZERO, C[5], b1, b2, b3, b4, b5)
    b6 = tangent(u, d2, at, k6, rest, curvature2, r, p, start)

    u, d1, d2 = plus(u, 1.0, k6), plus(d1, 1.0, a6), plus(d2, 1.0, b6)
    w_u, i_u, e_u = exponentials(u, law)
    rest = times(r, sum6(ZERO, C[6], k1, k2, k3, k4, k5, k6))
    k7 = stage(u, w_u, i_u, e_u, w_lp, rest, p, start)
    at, t7 = slopes(u, w_u, i_u, e_u, p, start)
    rest = sum6(ZERO, C[6], a1, a2, a3, a4, a5, a6)
    a7 = tangent(u, d1, at, k7, rest, curvature1, r, p, start)
    rest = sum6(ZERO, C[6], b1, b2, b3, b4, b5, b6)
    b7 = tangent(u, d2, at, k7, rest, curvature2, r, p, start)

    u, d1, d2 = plus(u, 1.0, k7), plus(d1, 1.0, a7), plus(d2, 1.0, b7)
    w_u, i_u, e_u = exponentials(u, law)
    rest = times(r, sum7(ZERO, C[7], k1, k2, k3, k4, k5, k6, k7))
    k8 = stage(u, w_u, i_u, e_u, w_lp, rest, p, start)
    at, t8 = slopes(u, w_u, i_u, e_u, p, start)
    rest = sum7(ZERO, C[7], a1, a2, a3, a4, a5, a6, a7)
    a8 = tangent(u, d1, at, k8, rest, curvature1, r, p, start)
    rest = sum7(ZERO, C[7], b1, b2, b3, b4, b5, b6, b7)
    b8 = tangent(u, d2, at, k8, rest, curvature2, r, p, start)

    free = plus(u, 1.0, k8)
    y_new, held = on_manifold(free, y[1], eta0 * w_u, beta, h)
    error = (k8[0], k8[1] + (y_new[1] - free[1]), k8[2])
    w_new, _, e_new = exponentials(y_new, law)
    z1, z2 = plus(d1, 1.0, a8), plus(d2, 1.0, b8)
    z1 = (z1[0], z1[0] - beta * z1[2] if held else z1[1], z1[2])
    z2 = (z2[0], z2[0] - beta * z2[2] if held else z2[1], z2[2])

    dense1 = dot(H[0], k1, k2, k3, k4, k5, k6, k7, k8)
    dense2 = dot(H[1], k1, k2, k3, k4, k5, k6, k7, k8)
    dense3 = dot(H[2], k1, k2, k3, k4, k5, k6, k7, k8)
    # The trace's quadrature as in `rodas5p.step`: B weighs trace(u_i) + gradient k_i.
    k = dot(B, k1, k2, k3, k4, k5, k6, k7, k8)
    _, s_vpsi, s_psipsi = state_rate_partials_2(law, w, y[1], y[2], e)
    g = y[0] - y[1] - beta * y[2]
    trace = (k[1] * (2.0 + g) - k[0] + beta * k[2]) * (1.0 / (eta0 * w))
    trace += s_vpsi * k[1] + s_psipsi * k[2]
    trace += B[0] * t1 + B[1] * t2 + B[2] * t3 + B[3] * t4
    trace += B[4] * t5 + B[5] * t6 + B[6] * t7 + B[7] * t8
    return y_new, w_new, e_new, z1, z2, error, dense1, dense2, dense3, h * trace
