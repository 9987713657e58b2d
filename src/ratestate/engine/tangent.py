"""One step of Rodas5P together with its derivative in some directions (variational equation).

A Rosenbrock method applied to y' = f(y), z' = J(y) z, with the exact Jacobian of both, is the
derivative of the same method's step at fixed step size.  So the matrix is the one of `rodas5p`,
and a stage of z needs no exponential of its own:

    (1/(gamma h) - J) dk_i = J(u_i) du_i + sum_j (C_ij/h) dk_j + (J'(y) z) k_i

with the load point at constant speed.  The v row is scaled as there, by m = eta0 w at the start.

Beside them the step integrates the trace of J, which by Liouville's formula is the rate at which
the logarithm of a volume of states grows.
"""

from ..friction.kinematics import LIMIT
from . import reversing
from .equations import exponentials, inertial_force
from .jit import inlined, recursive, unrolled
from .rodas5p import end_of_step, increment, next_point, prepare, solve_arrow
from .tableau import A, B
from .tracing import traced
from .tuples import (
    dot,
    dot_each,
    each,
    minus_dot,
    plus,
    plus_sum,
    product,
    sum_of,
    times,
    total,
    zeros,
)


@traced
def change_of_g(z, S_v, S_psi):
    """How g = x - S changes in the direction z."""
    return minus_dot(z[0] - S_v * z[1], S_psi, z[2:])


@recursive
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
    dv = z[1] if moves else 0.0
    dS_v = S_vv * z[1] + dot(S_vpsi, z[2:])
    dS_psi = plus(times(z[1], S_vpsi), 1.0, dot_each(S_psipsi, z[2:]))
    v_v = (S_v + g) * dv - (dS_v + change_of_g(z, S_v, S_psi)) if moves else 0.0
    v_psi = plus(times(dv, S_psi), -1.0, dS_psi)
    s_v = plus(times(z[1], s_vv), 1.0, product(s_vpsi, z[2:]))
    s_psi = plus(times(z[1], s_vpsi), 1.0, product(s_psipsi, z[2:]))
    return kappa * w * dv, dv, v_v, v_psi, s_v, s_psi


@recursive
def trace_along(shares, y, w, e, dy, system):
    """The derivative of the trace of J in the direction dy."""
    if len(shares) > 0:
        return reversing.trace_along(y, w, e, dy, system)
    _, _, v_v, _, _, s_psi = second_derivatives(shares, y, w, e, dy, system)
    return total(s_psi) + v_v * (1.0 / (system[2] * w))


@recursive
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
    g = g if u[1] > -LIMIT else 0.0
    trace = total(f_psi) - (S_v + g) * (w_inverse / eta0)
    return (start.c * w_inverse, g, kappa * w, S_v, S_psi, f_v, f_psi), trace


@recursive
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
    r_psi = plus(times(du[1], f_v), 1.0, product(f_psi, du[2:]))
    r_psi = plus(r_psi, r, rest[2:])
    r_psi = plus(plus(r_psi, k[1], s_v), 1.0, product(s_psi, k[2:]))
    return r_x, r_v, *r_psi


@inlined
def tangent(at, k, du, rest, curvature, r, start):
    """The increment of the perturbation du, as of `right_hand_side`."""
    rows = right_hand_side(start.shares, du, at, k, rest, curvature, r, start.m)
    return solve_arrow(rows, start)


@unrolled
def tangents(z, dk, at, k, curvatures, r, start):
    """The next increment of each perturbation z, after those of dk, at the stage of increment k."""
    arguments = "*next_point(z[#], dk[#]), curvatures[#], r, start"
    return each(f"(*dk[#], tangent(at, k, {arguments}))", z)


@unrolled
def first_tangents(z, at, k, curvatures, r, start):
    """`tangents` at the first stage."""
    return each("(tangent(at, k, z[#], zeros(z[#]), curvatures[#], r, start),)", z)


@unrolled
def curvatures_of(shares, y, w, e, z, system):
    """`second_derivatives` along each perturbation."""
    return each("second_derivatives(shares, y, w, e, z[#], system)", z)


@recursive
def stages(k, dk, traces, y, z, w_lp, curvatures, r, system, start):
    """The increments of all eight stages, of the state (k) and of each perturbation (dk), those so
    far given; the trace of J at each; and w at the last.
    """
    u, c = next_point(y, k)
    at = exponentials(u, system[0], system[3])
    # The stages of all go side by side: their numbers stay in the processor's registers.
    k_new = increment(u, at, w_lp, times(r, c), (), system, start)
    slope, trace = slopes(start.shares, u, at, system, start)
    dk = tangents(z, dk, slope, k_new, curvatures, r, start)
    if len(k) == 7:
        return (*k, k_new), dk, (*traces, trace), at
    return stages((*k, k_new), dk, (*traces, trace), y, z, w_lp, curvatures, r, system, start)


@recursive
def perturbed(z, dk, held, S_v, S_psi, shares):
    """The perturbations at the end of the step: v's follows the others' where v is held."""
    if len(z) == 0:
        return ()
    end = plus_sum(z[0], A[8], dk[0])
    omega = minus_dot(end[0], S_psi, end[2:]) / S_v
    v = minus_dot(omega, shares, end[2:]) if held else end[1]
    return (end[0], v, *end[2:]), *perturbed(z[1:], dk[1:], held, S_v, S_psi, shares)


@inlined
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
    curvatures = curvatures_of(start.shares, y, w, e, z, system)
    at = w, 1.0 / start.c, e
    first = increment(y, at, w_lp, zeros(y), (), system, start)
    slope, trace = slopes(start.shares, y, at, system, start)
    dk = first_tangents(z, slope, first, curvatures, r, start)
    k, dk, traces, last = stages((first,), dk, (trace,), y, z, w_lp, curvatures, r, system, start)
    new, held, error, dense = end_of_step(y, k, last, h, system)
    S_v, S_psi = law.stress_slopes(new[0][1], new[1], new[0][2:], new[2], p)
    shares = law.shares(new[1], 1.0 / law.speed_slope(new[1], new[2]), p)
    z_new = perturbed(z, dk, held, S_v, S_psi, shares)

    # The trace's quadrature as in `rodas5p.step`: B weighs trace(u_i) + gradient k_i.
    dy = sum_of(B, k)
    integral = trace_along(start.shares, y, w, e, dy, system) + dot(B, traces)
    return new, z_new, error, dense, h * integral
