"""One step of Rodas5P together with its derivative in two directions (variational equation).

A Rosenbrock method applied to y' = f(y), z' = J(y) z, with the exact Jacobian of both, is the
derivative of the same method's step at fixed step size.  So the matrix is the one of `rodas5p`,
and a stage of z needs no exponential of its own:

    (1/(gamma h) - J) dk_i = J(u_i) du_i + sum_j (C_ij/h) dk_j + (J'(y) z) k_i

with the load point at constant speed.  The v row is scaled as there, by m = eta0 w at the start.

Beside them the step integrates the trace of J, which by Liouville's formula is the rate at which
the logarithm of a volume of states grows.
"""

from typing import Any

from .exp import LIMIT
from .jit import inlined
from .rodas5p import (
    ZERO,
    end_of_step,
    exponentials,
    increment,
    plus_sum,
    prepare,
    solve_arrow,
    sum_of,
    times,
)
from .tableau import A, B, C


@inlined
def second_derivatives(y, w, e, z, p):
    """J'(y) z: how J, its v row times eta0 w, changes in the direction z.

    By row and column: -xv, -vx, vv, v psi, psi v, psi psi.  At rest w is a constant (exp.py).
    """
    law, kappa, beta, _ = p
    s_vv, s_vpsi, s_psipsi = law.rate_partials_2(w, y[1], y[2], e)
    g = y[0] - y[1] - beta * y[2]
    dg = z[0] - z[1] - beta * z[2]
    moves = y[1] > -LIMIT
    dv = z[1] if moves else 0.0
    s_v = s_vv * z[1] + s_vpsi * z[2]
    s_psi = s_vpsi * z[1] + s_psipsi * z[2]
    return kappa * w * dv, dv, (1.0 + g) * dv - dg if moves else 0.0, beta * dv, s_v, s_psi


@inlined
def slopes(u, at, p, start):
    """What `tangent` needs of J at a stage's point, and the trace of J there.

    at : w, 1/w and e at u
    """
    w, w_inverse, e = at
    law, kappa, beta, eta0 = p
    f_v, f_psi = law.rate_partials(w, u[1], u[2], e)
    g = u[0] - u[1] - beta * u[2] if u[1] > -LIMIT else 0.0
    trace = f_psi - (1.0 + g) * (w_inverse / eta0)
    return (start[0] * w_inverse, g, kappa * w, f_v, f_psi), trace


@inlined
def tangent(du, at, k, rest, curvature, r, p, start):
    """Increment of the perturbation du at a stage's point, given rest = sum_j C_ij dk_j.

    As V falls, v's perturbation grows like 1/w and h shrinks like w: m/h comes before it.

    =========  ==============================================================
    at         what `slopes` gave there: ratio w_start/w, g, kappa w, and the law's derivatives
    curvature  what `second_derivatives` gave, row by column of J
    dg         change of g = x - v - beta psi by du
    r_x, ...   right-hand side of each row
    r          1/h
    =========  ==============================================================
    """
    beta = p[2]
    ratio, g, kappa_w, f_v, f_psi = at
    x_v, v_x, v_v, v_psi, s_v, s_psi = curvature
    dg = du[0] - du[1] - beta * du[2]
    r_x = r * rest[0] - kappa_w * du[1] - x_v * k[1]
    r_v = (dg - g * du[1]) * ratio + (start[1] * r) * rest[1]
    r_v += v_v * k[1] + v_psi * k[2] - v_x * k[0]
    r_psi = f_v * du[1] + f_psi * du[2] + r * rest[2] + s_v * k[1] + s_psi * k[2]
    return solve_arrow(r_x, r_v, r_psi, beta, start)


@inlined
def next_points(y, k, y1, a, y2, b, r):
    """`rodas5p.next_point` of the state, whose load is steady, and of two perturbations.

    k, a, b : increments so far of the state y, and of its perturbations y1 and y2
    """
    i = len(k)
    c = (r * C[1][0], k[0]) if i == 1 else (r, sum_of(C[i], k))
    u = plus_sum(y, A[i], k), c
    u1 = plus_sum(y1, A[i], a), sum_of(C[i], a)
    return u, u1, (plus_sum(y2, A[i], b), sum_of(C[i], b))


@inlined
def stage(points, at, w_lp, c1, c2, r, p, start):
    """Increments of the state and of both perturbations, and the trace of J.

    at : w, 1/w and e at the state's point; c1, c2 : `second_derivatives` along the perturbations
    """
    (u, c), (u1, rest1), (u2, rest2) = points
    k = increment(u, at, w_lp, times(c[0], c[1]), p, start)
    slope, trace = slopes(u, at, p, start)
    a = tangent(u1, slope, k, rest1, c1, r, p, start)
    return k, a, tangent(u2, slope, k, rest2, c2, r, p, start), trace


@inlined
def next_stage(points, w_lp, c1, c2, r, p, start):
    """`stage`, and w there."""
    at = exponentials(points[0][0], p[0])
    return stage(points, at, w_lp, c1, c2, r, p, start), at[0]


@inlined
def perturbed(z, a, held, beta):
    """The perturbation at the end of the step: v's follows the others' where v is held."""
    x, v, psi = plus_sum(z, A[8], a)
    return x, x - beta * psi if held else v, psi


@inlined
def step(y, w, e, y1, y2, w_lp, h, p):
    """One step of size h from y = (x, v, psi), and of small perturbations y1, y2 of it.

    Parameters
    ----------
    y, w, e : state, e**v and e**-psi at the start
    y1, y2 : perturbations (triples)
    w_lp : speed of the load point, a constant
    p : (law, kappa, beta, eta0), eta0 > 0

    Returns
    -------
    new : y, w and e at the end
    z1, z2 : the perturbations there
    error : estimated error of y (triple)
    dense : the dense output's K_1, K_2, K_3 (triples)
    trace : integral of the trace of J
    """
    law, _, beta, eta0 = p
    start = prepare(y, w, e, h, p)
    r = 1.0 / h
    c1, c2 = second_derivatives(y, w, e, y1, p), second_derivatives(y, w, e, y2, p)
    # The stages of all three go side by side: their numbers stay in the processor's registers.
    at = w, 1.0 / w, e
    first = stage(((y, (r, ZERO)), (y1, ZERO), (y2, ZERO)), at, w_lp, c1, c2, r, p, start)
    k: Any = (first[0],)
    a: Any = (first[1],)
    b: Any = (first[2],)
    t: Any = (first[3],)
    points = next_points(y, k, y1, a, y2, b, r)
    (k2, a2, b2, t2), _ = next_stage(points, w_lp, c1, c2, r, p, start)
    k, a, b, t = (*k, k2), (*a, a2), (*b, b2), (*t, t2)
    points = next_points(y, k, y1, a, y2, b, r)
    (k3, a3, b3, t3), _ = next_stage(points, w_lp, c1, c2, r, p, start)
    k, a, b, t = (*k, k3), (*a, a3), (*b, b3), (*t, t3)
    points = next_points(y, k, y1, a, y2, b, r)
    (k4, a4, b4, t4), _ = next_stage(points, w_lp, c1, c2, r, p, start)
    k, a, b, t = (*k, k4), (*a, a4), (*b, b4), (*t, t4)
    points = next_points(y, k, y1, a, y2, b, r)
    (k5, a5, b5, t5), _ = next_stage(points, w_lp, c1, c2, r, p, start)
    k, a, b, t = (*k, k5), (*a, a5), (*b, b5), (*t, t5)
    points = next_points(y, k, y1, a, y2, b, r)
    (k6, a6, b6, t6), _ = next_stage(points, w_lp, c1, c2, r, p, start)
    k, a, b, t = (*k, k6), (*a, a6), (*b, b6), (*t, t6)
    points = next_points(y, k, y1, a, y2, b, r)
    (k7, a7, b7, t7), _ = next_stage(points, w_lp, c1, c2, r, p, start)
    k, a, b, t = (*k, k7), (*a, a7), (*b, b7), (*t, t7)
    points = next_points(y, k, y1, a, y2, b, r)
    (k8, a8, b8, t8), w8 = next_stage(points, w_lp, c1, c2, r, p, start)
    k, a, b, t = (*k, k8), (*a, a8), (*b, b8), (*t, t8)
    new, held, error, dense = end_of_step(y, k, w8, h, p)

    # The trace's quadrature as in `rodas5p.step`: B weighs trace(u_i) + gradient k_i.
    dy = sum_of(B, k)
    _, s_vpsi, s_psipsi = law.rate_partials_2(w, y[1], y[2], e)
    g = y[0] - y[1] - beta * y[2]
    trace = (dy[1] * (2.0 + g) - dy[0] + beta * dy[2]) * (1.0 / (eta0 * w))
    trace += s_vpsi * dy[1] + s_psipsi * dy[2]
    trace += B[0] * t[0] + B[1] * t[1] + B[2] * t[2] + B[3] * t[3]
    trace += B[4] * t[4] + B[5] * t[5] + B[6] * t[6] + B[7] * t[7]
    return new, perturbed(y1, a, held, beta), perturbed(y2, b, held, beta), error, dense, h * trace
