"""One step of Rodas5P together with its derivative in some directions (variational equation).

A Rosenbrock method applied to y' = f(y), z' = J(y) z, with the exact Jacobian of both, is the
derivative of the same method's step at fixed step size.  So the matrix is the one of `rodas5p`,
and a stage of z needs no exponential of its own:

    (1/(gamma h) - J) dk_i = J(u_i) du_i + sum_j (C_ij/h) dk_j + (J'(y) z) k_i

with the load point at constant speed.  The v row is scaled as there, by m = eta0 w at the start.

Beside them the step integrates the trace of J, which by Liouville's formula is the rate at which
the logarithm of a volume of states grows.
"""

import functools

from ..friction.expressions import LIMIT
from ..friction.functions import where
from ..friction.motion import product
from ..friction.tuples import dot, dot_onto, minus_dot, plus_sum, sum_of, times, total
from .equations import derived, exponentials, in_omega
from .rodas5p import end_of_step, increment, next_point, prepare, solve_arrow
from .tableau import NODES, A, B


def right_hand_side(du, jacobian, k, rest, curvature, r, m):
    """Of the increment of the perturbation du at a stage's point, its v row times m.

    As V falls, v's perturbation grows like 1/w and h shrinks like w: m/h comes before it.

    =================  =========================================================================
    jacobian           there, its v row times m (`motion.Motion`)
    k, curvature       increment of the state, and how the Jacobian matrix changes along the
                       perturbation, both at the start of the step
    rest, r            sum_j C_ij dk_j, and 1/h
    =================  =========================================================================

    du and k are of x, omega and psi.
    """
    first, second = product(jacobian, du), product(curvature, k)
    scaled = r * rest[0], (m * r) * rest[1], *times(r, rest[2:])
    return tuple(a + b + c for a, b, c in zip(first, scaled, second, strict=True))


def trace_of(jacobian, shares, unit):
    """The trace in x, v and psi of a matrix in x, omega and psi; unit : one over m."""
    _, of_v, *of_psi = jacobian
    by_psi = [row[k] for k, row in enumerate(of_psi, 2)]
    return dot_onto(total(by_psi) + unit * of_v[1], shares, [row[1] for row in of_psi])


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
    law, kappa, eta0, p = system
    start = prepare(y, w, e, h, system)
    r, c_inverse = 1.0 / h, 1.0 / start.c
    moves = where(law.log_of_faster(y[1], y[2:], p) > -LIMIT, 1.0, 0.0)
    at_start = functools.partial(derived, y=y, w=w, e=e, law=law, p=p, moves=moves, kappa=kappa)
    curvatures = [at_start("curvature", z=one, q=1.0, m=start.m) for one in z]
    at: tuple = (w, c_inverse, e)
    k: tuple = ()
    dk: list[tuple] = [() for _ in z]
    traces: list = []
    for _ in NODES:
        u, c = next_point(y, k)
        at = exponentials(u, law, p) if k else at
        numbers = {"q": start.c * at[1], "m": start.m, "kappa": kappa}
        jacobian = derived("jacobian", u, at[0], at[2], law, p, **numbers)
        shares = law.shares(at[0], at[1], p)
        k_new = increment(u, at, w_lp, times(r, c), (), system, start)
        k_omega = in_omega(k_new, start.shares)
        for j, (one, curvature) in enumerate(zip(z, curvatures, strict=True)):
            du, rest = next_point(one, dk[j])
            du = in_omega(du, shares)
            rows = right_hand_side(du, jacobian, k_omega, rest, curvature, r, start.m)
            dk[j] = *dk[j], solve_arrow(rows, start)
        k, traces = (*k, k_new), [*traces, trace_of(jacobian, shares, 1.0 / start.m)]
    new, held, error, dense = end_of_step(y, k, at, h, system)
    S_v, S_psi = law.stress_slopes(new[0][1], new[1], new[0][2:], new[2], p)
    shares = law.shares(new[1], 1.0 / law.speed_slope(new[1], new[2]), p)
    z_new = tuple(
        step_end(one, of_one, held, S_v, S_psi, shares) for one, of_one in zip(z, dk, strict=True)
    )
    # The trace's quadrature as in `rodas5p.step`: B weighs trace(u_i) + gradient k_i.
    (gradient,) = at_start("change_of_trace", z=sum_of(B, k), q=moves * c_inverse / eta0, m=1.0)
    return new, z_new, error, dense, h * (gradient + dot(B, traces))
