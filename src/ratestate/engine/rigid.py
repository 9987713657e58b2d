"""A slider that moves with its load point (K = inf): only its states evolve.

    dpsi/dT = f(v, psi),     v = v(w_lp(T), psi),     x = S(v, psi) + eta0 dw_lp/dT

The speed jumps when the load-point speed jumps.  No state is coupled to another, so the matrix of a
Rodas5P step is diagonal.  The dense output holds psi only; x and v follow from psi.
"""

import math

from ..friction.functions import larger, where
from ..friction.point import point_at
from ..friction.tuples import dot, largest, plus, plus_sum, product, sum_of, times, total
from . import rows as R
from .lanes import (
    ROUNDING,
    evaluate_dense_output,
    has_save_time,
    read_point,
    step_size,
    write_point,
)
from .rodas5p import GAMMA, NODES, A, D, H, dense_output, psi_pivots, stage_start, with_drift
from .rows import read_rows, rows_of, store_each


def point(s, l, law, dT, psi):
    """Return the `Point` with these psi at a time dT into the lane's step."""
    p = law.later(read_rows(s, rows_of(law).p, l), dT)
    v = law.v_at(s[R.W_LP + l] + dT * s[R.RAMP + l], psi, p)
    at = point_at(law, p, (0.0, v, *psi))
    at.y = at.S + s[R.ETA0 + l] * s[R.RAMP + l], *at.y[1:]
    at.x = at.y[0]
    return at


def slopes(at, ramp, of_psi):
    """Return d/dT of x, S, N and R; of_psi : d psi/dT."""
    _, stress, *others = at.changes_of_forces((0.0, ramp / at.c, *of_psi), 1.0)
    return stress, stress, *others


def try_step(s, l, law):
    """Try one step of the lane and store its outcome."""
    h = step_size(s[R.H + l], s[R.BREAKPOINT + l], s[R.T + l], s[R.T_LOW + l])
    start = read_point(s, l, law)
    by_omega, by_psi = start.f_slopes
    drift = with_drift(times(s[R.RAMP + l] / start.c, by_omega), start.f_drift, 1.0)
    pivots = psi_pivots(GAMMA * h, by_psi)
    k: tuple = ()
    for node, d in zip(NODES, D, strict=True):
        u, coupling = stage_start(start.psi, k)
        right = plus(point(s, l, law, node * h, u).f, times(1.0 / h, coupling))
        k = *k, product(pivots, plus(right, times(h * d, drift)))
    end = point(s, l, law, h, plus_sum(start.psi, A[8], k))
    write_point(s, l, end, True)
    dense = dense_output(start.psi, end.psi, *(sum_of(row, k) for row in H))
    store_each(s, rows_of(law).c[2:], l, dense)
    s[R.H_USED + l] = h
    allowed = larger(s[R.TOLERANCE + l], ROUNDING * largest(end.psi))
    finite = abs(total(end.y) + total(k[7])) < math.inf
    s[R.ERROR + l] = where(finite, largest(k[7]) / allowed, math.inf)


def flag_events(s, l, law):
    """Set EVENTS and CALL, as `lanes.flag_events`, for minima of R and x + N."""
    bits, sides = 0.0, []
    for at in (read_point(s, l, law), read_point(s, l, law, True).later(s[R.H_USED + l])):
        of_x, _, strength, friction = slopes(at, s[R.RAMP + l], at.f)
        sides.append((friction, strength + of_x))
    for bit, start, end in zip((R.F_EXTREME, R.XF_EXTREME), *sides, strict=True):
        bits = bits + where((start < 0.0) & (end >= 0.0), float(bit), 0.0)
    s[R.EVENTS + l] = bits
    needs_call = ((bits > 0.0) & (s[R.OBSERVE + l] > 0.0)) | has_save_time(s, l)
    s[R.CALL + l] = where((s[R.OK + l] > 0.0) & needs_call, 1.0, 0.0)


def state(s, l, law, fraction):
    """Return what `units.state` returns."""
    psi, _ = evaluate_dense_output(s, l, rows_of(law).c[2:], fraction)
    return point(s, l, law, fraction * s[R.H_USED + l], psi).y


def force(s, l, law, fraction, *weights):
    """Return what `units.force` returns."""
    h, (psi, d_psi) = s[R.H_USED + l], evaluate_dense_output(s, l, rows_of(law).c[2:], fraction)
    at = point(s, l, law, fraction * h, psi)
    changes = slopes(at, s[R.RAMP + l], times(1.0 / h, d_psi))
    return dot(weights, at.forces), h * dot(weights, changes)
