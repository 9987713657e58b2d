"""One step of Rodas5P together with its derivative in some directions (variational equation).

A Rosenbrock method applied to y' = f(y), z' = J(y) z, with the exact Jacobian of both, is the
derivative of the same method's step at fixed step size.  So the matrix is the one of `rodas5p`,
and a stage of z needs no exponential of its own:

    (1/(gamma h) - J) dk_i = J(u_i) du_i + sum_j (C_ij/h) dk_j + (J'(y) z) k_i

with the load point at constant speed.  The v row is scaled as there, by m = eta0 w at the start.

Beside them the step integrates the trace of J, which by Liouville's formula is the rate at which
the logarithm of a volume of states grows.
"""

from ..friction.expressions import LIMIT
from ..friction.functions import where
from ..friction.tuples import dot, minus_dot, plus, plus_sum, product, sum_of, times, total
from . import reversing
from .equations import exponentials, inertial_force
from .rodas5p import end_of_step, increment, next_point, prepare, solve_arrow
from .tableau import NODES, A, B


def change_of_g(z, S_v, S_psi):
    """How g = x - S changes in the direction z."""
    return minus_dot(z[0] - S_v * z[1], S_psi, z[2:])


def second_derivatives(shares, y, w, e, z, system):
    """J'(y) z: how J, its v row times eta0 w, changes in the direction z.

    By row and column: -xv, -vx, vv; v psi, psi v and psi psi are tuples, a number a state.
    At rest w is a constant (exp.py).

    shares : of `kinematics`, () where slip never reverses: else as in `reversing`
    """
    if len(shares) > 0:
        return reversing.second_derivatives(y, w, e, z, system)
    law, kappa, _, p = system
    s_vv, s_vpsi, s_psipsi = law.rate_partials_2(y[1], w, y[2:], e, p)
    S_vv, S_vpsi, S_psipsi = law.stress_partials_2(y[1], w, y[2:], p)
    g, S_v, S_psi = inertial_force(y, w, e, law, p)
    moves = y[1] > -LIMIT
    dv = where(moves, z[1], 0.0)
    dS_v = S_vv * z[1] + dot(S_vpsi, z[2:])
    dS_psi = plus(times(z[1], S_vpsi), tuple(dot(row, z[2:]) for row in S_psipsi))
    v_v = where(moves, (S_v + g) * dv - (dS_v + change_of_g(z, S_v, S_psi)), 0.0)
    v_psi = plus(times(dv, S_psi), times(-1.0, dS_psi))
    s_v = plus(times(z[1], s_vv), product(s_vpsi, z[2:]))
    s_psi = plus(times(z[1], s_vpsi), product(s_psipsi, z[2:]))
    return kappa * w * dv, dv, v_v, v_psi, s_v, s_psi


def trace_along(shares, y, w, e, dy, system):
    """The derivative of the trace of J in the direction dy."""
    if len(shares) > 0:
        return reversing.trace_along(y, w, e, dy, system)
    _, _, v_v, _, _, s_psi = second_derivatives(shares, y, w, e, dy, system)
    return total(s_psi) + v_v * (1.0 / (system[2] * w))


def slopes(shares, u, at, system, start):
    """What `right_hand_side` needs of J at a stage's point, and the trace of J there.

    at : w, 1/c and e at u
    """
    if len(shares) > 0:
        return reversing.slopes(u, at, system, start)
    w, w_inverse, e = at
    law, kappa, eta0, p = system
    f_v, f_psi = law.rate_partials(u[1], w, u[2:], e, p)
    g, S_v, S_psi = inertial_force(u, w, e, law, p)
    g = where(u[1] > -LIMIT, g, 0.0)
    trace = total(f_psi) - (S_v + g) * (w_inverse / eta0)
    return (start.c * w_inverse, g, kappa * w, S_v, S_psi, f_v, f_psi), trace


def right_hand_side(shares, du, at, k, rest, curvature, r, m):
    """Of the increment of the perturbation du at a stage's point: rest is sum_j C_ij dk_j.

    As V falls, v's perturbation grows like 1/w and h shrinks like w: m/h comes before it.

    =========  ==============================================================================
    at         what `slopes` gave there: ratio w_start/w, g, kappa w, and derivatives of the law
    curvature  what `second_derivatives` gave, row by column of J
    dg         change of g by du
    r_x, ...   right-hand side of each row
    r          1/h
    =========  ==============================================================================
    """
    if len(shares) > 0:
        return reversing.right_hand_side(du, at, k, rest, curvature, r, m)
    ratio, g, kappa_w, S_v, S_psi, f_v, f_psi = at
    x_v, v_x, v_v, v_psi, s_v, s_psi = curvature
    dg = change_of_g(du, S_v, S_psi)
    r_x = r * rest[0] - kappa_w * du[1] - x_v * k[1]
    r_v = (dg - g * du[1]) * ratio + (m * r) * rest[1]
    r_v += v_v * k[1] + dot(v_psi, k[2:]) - v_x * k[0]
    r_psi = plus(times(du[1], f_v), product(f_psi, du[2:]))
    r_psi = plus(r_psi, times(r, rest[2:]))
    r_psi = plus(plus(r_psi, times(k[1], s_v)), product(s_psi, k[2:]))
    return r_x, r_v, *r_psi


def tangent(at, k, du, rest, curvature, r, start):
    """The increment of the perturbation du, as of `right_hand_side`."""
    rows = right_hand_side(start.shares, du, at, k, rest, curvature, r, start.m)
    return solve_arrow(rows, start)


def step_end(z, dk, held, S_v, S_psi, shares):
    """The perturbation z at the end of the step: v's follows the others' where v is held."""
    end = plus_sum(z, A[8], dk)
    omega = minus_dot(end[0], S_psi, end[2:]) / S_v
    return end[0], where(held, minus_dot(omega, shares, end[2:]), end[1]), *end[2:]


def step(y, w, e, z, w_lp, h, system):
    """One step of size h from y = (x, v, psi), and of small perturbations z of it.

    Parameters
    ----------
    y, w, e : state, e**v and the law's exponentials at the start
    z : perturbations (a tuple of tuples)
    w_lp : speed of the load point, a constant
    system : (law, kappa, eta0, p), eta0 > 0

    Returns
    -------
    new : y, w and e at the end
    z_new : the perturbations there
    error : estimated error of y (tuple)
    dense : what `rodas5p.dense_output` gives
    trace : integral of the trace of J
    """
    law, _, _, p = system
    start = prepare(y, w, e, h, system)
    r = 1.0 / h
    curvatures = [second_derivatives(start.shares, y, w, e, one, system) for one in z]
    at: tuple = (w, 1.0 / start.c, e)
    k: tuple = ()
    dk: list[tuple] = [() for _ in z]
    traces: list = []
    for _ in NODES:
        u, c = next_point(y, k)
        at = exponentials(u, law, p) if k else at
        slope, trace = slopes(start.shares, u, at, system, start)
        k_new = increment(u, at, w_lp, times(r, c), (), system, start)
        for j, (one, curvature) in enumerate(zip(z, curvatures, strict=True)):
            du, rest = next_point(one, dk[j])
            dk[j] = *dk[j], tangent(slope, k_new, du, rest, curvature, r, start)
        k, traces = (*k, k_new), [*traces, trace]
    new, held, error, dense = end_of_step(y, k, at, h, system)
    S_v, S_psi = law.stress_slopes(new[0][1], new[1], new[0][2:], new[2], p)
    shares = law.shares(new[1], 1.0 / law.speed_slope(new[1], new[2]), p)
    z_new = tuple(
        step_end(one, of_one, held, S_v, S_psi, shares) for one, of_one in zip(z, dk, strict=True)
    )
    # The trace's quadrature as in `rodas5p.step`: B weighs trace(u_i) + gradient k_i.
    dy = sum_of(B, k)
    integral = trace_along(start.shares, y, w, e, dy, system) + dot(B, traces)
    return new, z_new, error, dense, h * integral
