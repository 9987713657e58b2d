"""Steps of a return map: the state and its derivatives along some directions.

A Rosenbrock method applied to y' = f(y), z' = J(y) z, with the exact Jacobian of both, is the
derivative of the method's step at fixed step size.  So y and z share one matrix
(`rodas5p.Arrow`), and a stage of z needs no exponential of its own:

    (1/(gamma h) - J) dk_i = J(u_i) du_i + sum_j (C_ij/h) dk_j + (J'(y) z) k_i

with the load point at constant speed.  As in `rodas5p`, the v row is scaled by m at the start.

The step also integrates the trace of J.  By Liouville's formula, this trace is the rate at which
the logarithm of a volume of states grows.
"""

import functools

from ..friction.equations_of_motion import matrix_product
from ..friction.expressions import LIMIT
from ..friction.functions import larger, smaller, where
from ..friction.tuples import (
    dot,
    dot_onto,
    grouped,
    largest,
    minus_dot,
    pairwise_sum,
    plus,
    plus_sum,
    product,
    select,
    sum_of,
    times,
    total,
)
from . import lanes as L
from . import rows as R
from . import taylor
from .rodas5p import A, Arrow, B, end_of_step, stage_start, stages
from .rows import load_each, read_rows, rows_of, store_each, write_rows


def right_hand_side(du, jacobian, k, rest, curvature, r, m):
    """Return the right-hand side of a stage for the perturbation du, v's row times m.

    As V falls, the perturbation of v grows like 1/w and h shrinks like w: m/h is formed first.

    =================  =========================================================================
    jacobian           Jacobian matrix at the stage, its v row times m (see `Motion`)
    k, curvature       increment of the state, and the change of the Jacobian matrix along the
                       perturbation, both at the start of the step
    rest, r            sum_j C_ij dk_j, and 1/h
    =================  =========================================================================

    du and k are changes of x, omega and psi.
    """
    first, second = matrix_product(jacobian, du), matrix_product(curvature, k)
    scaled = r * rest[0], (m * r) * rest[1], *times(r, rest[2:])
    return tuple(a + b + c for a, b, c in zip(first, scaled, second, strict=True))


def trace_of(jacobian, shares, unit):
    """Return the trace in x, v and psi of a matrix in x, omega and psi; unit : 1/m."""
    _, of_v, *of_psi = jacobian
    by_psi = [row[k] for k, row in enumerate(of_psi, 2)]
    return dot_onto(total(by_psi) + unit * of_v[1], shares, [row[1] for row in of_psi])


def perturbation_at_end(new, is_slaved, z):
    """Return a perturbation at the end of a step; if v is slaved, v follows the others."""
    S_v, *S_psi = new.S_slopes
    of_slaved = new.in_v((z[0], minus_dot(z[0], S_psi, z[2:]) / S_v, *z[2:]))
    return z[0], where(is_slaved, of_slaved[1], z[1]), *z[2:]


def step(start, z, h):
    """Take one step of size h with small perturbations z of its start; w_lp is 1.

    Parameters
    ----------
    start : the slider at the start, a `Point` with eta0 > 0
    z : perturbations (a tuple of tuples)

    Returns
    -------
    new : the slider at the end
    z_new : the perturbations there
    error : estimated error of y (tuple)
    dense : the dense output, as from `rodas5p.dense_output`
    trace : integral of the trace of J
    """
    arrow, r = Arrow(start, h), 1.0 / h
    moves = where(start.log_jump_rate > -LIMIT, 1.0, 0.0)
    at_start = functools.partial(start.derived, moves=moves, kappa=start.kappa)
    curvatures = [at_start("curvature", z=z_i, q=1.0, m=start.m) for z_i in z]
    k: tuple = ()
    dk: list[tuple] = [() for _ in z]
    traces: list = []
    for at, _, k in stages(arrow, h, 1.0):
        jacobian = at.derived("jacobian", q=start.c * at.c_inverse, m=start.m, kappa=start.kappa)
        k_omega = start.in_omega(k[-1])
        for j, (z_i, curvature) in enumerate(zip(z, curvatures, strict=True)):
            du, rest = stage_start(z_i, dk[j])
            du = at.in_omega(du)
            rows = right_hand_side(du, jacobian, k_omega, rest, curvature, r, start.m)
            dk[j] = *dk[j], arrow.solve(rows)
        traces.append(trace_of(jacobian, at.omega_by_psi, 1.0 / start.m))
    new, is_slaved, error, dense = end_of_step(start, k, at, h)
    ends = (plus_sum(z_i, A[8], dk_i) for z_i, dk_i in zip(z, dk, strict=True))
    z_new = tuple(perturbation_at_end(new, is_slaved, z_i) for z_i in ends)
    # The trace is integrated as in `rodas5p.step`: B weights trace(u_i) + gradient k_i.
    q = moves * start.c_inverse / start.eta0
    gradient = at_start("change_of_trace", z=sum_of(B, k), q=q, m=1.0)
    return new, z_new, error, dense, h * (gradient + dot(B, traces))


# Loops over lanes


def step_from_lane(s, l, law, h):
    """Return the result of `step` for a step of size h from the lane's state."""
    return step(L.read_point(s, l, law), load_each(s, rows_of(law).z, l), h)


def try_step(s, l, law):
    """Try one step of the lane by Rodas5P with perturbations, and store its outcome."""
    h = s[R.H + l]
    new, z_new, error, dense, s[R.D_TRACE + l] = step_from_lane(s, l, law, h)
    store_each(s, rows_of(law).z_new, l, z_new)
    L.store_step(s, l, h, new, error, dense)


def try_taylor_step(s, l, law):
    """Take one step of the lane by the Taylor method, with perturbations."""
    rows, start = rows_of(law), L.read_point(s, l, law)
    y, z, momentum = start.y, load_each(s, rows.z, l), taylor.momentum_of(s, l)
    c, c_z, trace = taylor.variational_coefficients(start, z)
    lengths = taylor.step_lengths(s, l, c)

    def largest_of_order(k):
        """Return the largest ratio of a perturbation's coefficient to the perturbation."""
        coefficients = zip(grouped([row[k] for row in c_z], y), z, strict=True)
        ratios = (taylor.norm(a, momentum) / taylor.norm(b, momentum) for a, b in coefficients)
        return functools.reduce(larger, ratios)

    last, previous = map(largest_of_order, (R.ORDER, R.ORDER - 1))
    by_z = taylor.step_length(last, previous, s[R.TOLERANCE + l])
    h = smaller(smaller(lengths[0], lengths[1]), by_z)
    landing = s[R.LANDING_STEP + l]
    h = where((landing > 0.0) & (landing < h), landing, h)
    h_powers = taylor.powers(h)
    dense = tuple(product(row, h_powers) for row in c_z)
    store_each(s, rows.c_z, l, dense)
    z_new = tuple(map(pairwise_sum, dense))
    store_each(s, rows.z_new, l, grouped(z_new, y))
    (mean_trace,) = taylor.integrals((trace,), h_powers)
    s[R.D_TRACE + l] = h * mean_trace
    taylor.store_step(s, l, start, h, h_powers, c, lengths, total(z_new) + mean_trace)


def commit_lane(s, l, law):
    """Commit the perturbations and the trace; call it after `lanes.commit_lane`.

    A perturbation along the orbit is a shift in time.  It grows and shrinks with the speed of the
    state, by twenty orders of magnitude in a stick-slip cycle, and would hide all digits of the
    other perturbations.  So this part is removed after each step.
    """
    rows, ok, at = rows_of(law), s[R.OK + l] > 0.0, L.read_point(s, l, law)
    d_omega, unit = at.acceleration(1.0, at.is_balanced)
    rates = at.in_v((at.x_rate(1.0), d_omega / unit, *at.f))
    size = larger(largest(rates), 1e-300)
    direction = times(1.0 / size, rates)
    inverse = 1.0 / dot(direction, direction)
    z, z_new = load_each(s, rows.z, l), load_each(s, rows.z_new, l)
    shifts = tuple(inverse * dot(new, direction) for new in z_new)
    for group, old, new, shift in zip(rows.z, z, z_new, shifts, strict=True):
        write_rows(s, group, l, select(ok, plus(new, times(-shift, direction)), old))
    early = read_rows(s, rows.shifts, l)
    write_rows(s, rows.shifts, l, select(ok, plus(early, times(1.0 / size, shifts)), early))
    s[R.TRACE + l] += where(ok, s[R.D_TRACE + l], 0.0)
    s[R.SINCE_CROSSING + l] += s[R.OK + l]
