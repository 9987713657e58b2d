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
from .rodas5p import Arrow, end_of_step, next_point, stages
from .tableau import A, B


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


def perturbation_at_end(new, held, z):
    """A perturbation of the end of a step, where v's follows the others' if v is held."""
    S_v, *S_psi = new.S_slopes
    of_held = new.in_v((z[0], minus_dot(z[0], S_psi, z[2:]) / S_v, *z[2:]))
    return z[0], where(held, of_held[1], z[1]), *z[2:]


def step(start, z, h):
    """One step of size h, and of small perturbations z of its start; w_lp is 1.

    Parameters
    ----------
    start : the slider at the start, a `Point` with eta0 > 0
    z : perturbations (a tuple of tuples)

    Returns
    -------
    new : the slider at the end
    z_new : the perturbations there
    error : estimated error of y (tuple)
    dense : what `rodas5p.dense_output` gives
    trace : integral of the trace of J
    """
    arrow, r = Arrow(start, h), 1.0 / h
    moves = where(start.log_of_faster > -LIMIT, 1.0, 0.0)
    at_start = functools.partial(start.derived, moves=moves, kappa=start.kappa)
    curvatures = [at_start("curvature", z=one, q=1.0, m=start.m) for one in z]
    k: tuple = ()
    dk: list[tuple] = [() for _ in z]
    traces: list = []
    for at, _, k in stages(arrow, h, 1.0):
        jacobian = at.derived("jacobian", q=start.c * at.c_inverse, m=start.m, kappa=start.kappa)
        k_omega = start.in_omega(k[-1])
        for j, (one, curvature) in enumerate(zip(z, curvatures, strict=True)):
            du, rest = next_point(one, dk[j])
            du = at.in_omega(du)
            rows = right_hand_side(du, jacobian, k_omega, rest, curvature, r, start.m)
            dk[j] = *dk[j], arrow.solve(rows)
        traces.append(trace_of(jacobian, at.shares, 1.0 / start.m))
    new, held, error, dense = end_of_step(start, k, at, h)
    ends = (plus_sum(one, A[8], of_one) for one, of_one in zip(z, dk, strict=True))
    z_new = tuple(perturbation_at_end(new, held, one) for one in ends)
    # The trace's quadrature as in `rodas5p.step`: B weighs trace(u_i) + gradient k_i.
    q = moves * start.c_inverse / start.eta0
    gradient = at_start("change_of_trace", z=sum_of(B, k), q=q, m=1.0)
    return new, z_new, error, dense, h * (gradient + dot(B, traces))
