"""One step of Rodas5P together with its derivative in two directions (variational equation).

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
from .rodas5p import ZERO, end_of_step, first_stage, next_stage, plus_sum, prepare, solve, sum_of
from .tableau import A, B, C


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
def slopes(point, p, start):
    """What `tangent` needs of J at a stage's point, and the trace of J there."""
    u, w, w_inverse, e, _ = point
    law, kappa, beta, eta0 = p
    f_v, f_psi = state_rate_partials(law, w, u[1], u[2], e)
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
    return solve(r_x, r_v, r_psi, beta, start)


@inlined
def next_tangents(k, points, a, b, traces, y, z1, z2, w_lp, h, p, start):
    """One more stage: its increment and point, those of perturbations z1 and z2, the trace of J.

    z1, z2 : perturbations at the start of the step, with their `second_derivatives`
    """
    i = len(a)
    k, points = next_stage(k, points, y, w_lp, None, 0.0, h, p, start)
    r = 1.0 / h
    at, trace = slopes(points[i], p, start)
    a_new = tangent(plus_sum(z1[0], A[i], a), at, k[i], sum_of(C[i], a), z1[1], r, p, start)
    b_new = tangent(plus_sum(z2[0], A[i], b), at, k[i], sum_of(C[i], b), z2[1], r, p, start)
    return k, points, (*a, a_new), (*b, b_new), (*traces, trace)


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
    p : (law, kappa, beta, eta0), law a literal where this is compiled, eta0 > 0

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
    z1, z2 = (y1, second_derivatives(y, w, e, y1, p)), (y2, second_derivatives(y, w, e, y2, p))
    k, points = first_stage(y, w, e, w_lp, 0.0, p, start)
    at, trace = slopes(points[0], p, start)
    a1 = tangent(y1, at, k[0], ZERO, z1[1], 1.0 / h, p, start)
    b1 = tangent(y2, at, k[0], ZERO, z2[1], 1.0 / h, p, start)
    # The stages of all three go side by side: their numbers stay in the processor's registers.
    a, b, t = (a1,), (b1,), (trace,)
    k, points, a, b, t = next_tangents(k, points, a, b, t, y, z1, z2, w_lp, h, p, start)
    k, points, a, b, t = next_tangents(k, points, a, b, t, y, z1, z2, w_lp, h, p, start)
    k, points, a, b, t = next_tangents(k, points, a, b, t, y, z1, z2, w_lp, h, p, start)
    k, points, a, b, t = next_tangents(k, points, a, b, t, y, z1, z2, w_lp, h, p, start)
    k, points, a, b, t = next_tangents(k, points, a, b, t, y, z1, z2, w_lp, h, p, start)
    k, points, a, b, t = next_tangents(k, points, a, b, t, y, z1, z2, w_lp, h, p, start)
    k, points, a, b, t = next_tangents(k, points, a, b, t, y, z1, z2, w_lp, h, p, start)
    new, held, error, dense = end_of_step(y, k, points, h, p)

    # The trace's quadrature as in `rodas5p.step`: B weighs trace(u_i) + gradient k_i.
    dy = sum_of(B, k)
    _, s_vpsi, s_psipsi = state_rate_partials_2(law, w, y[1], y[2], e)
    g = y[0] - y[1] - beta * y[2]
    trace = (dy[1] * (2.0 + g) - dy[0] + beta * dy[2]) * (1.0 / (eta0 * w))
    trace += s_vpsi * dy[1] + s_psipsi * dy[2]
    trace += B[0] * t[0] + B[1] * t[1] + B[2] * t[2] + B[3] * t[3]
    trace += B[4] * t[4] + B[5] * t[5] + B[6] * t[6] + B[7] * t[7]
    return new, perturbed(y1, a, held, beta), perturbed(y2, b, held, beta), error, dense, h * trace
