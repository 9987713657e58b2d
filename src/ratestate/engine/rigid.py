"""A slider that moves with its load point (K = inf): its speed is given, only its states evolve.

    dpsi/dT = f(v, psi),     v that of the speed w_lp(T),     x = S(v, psi) + eta0 dw_lp/dT

Speeds jump with the load point's.  No state is coupled to another, so that the matrix of a step of
Rodas5P (`tableau`) is diagonal.  Its dense output has psi alone, from which x and v follow.
"""

import math

from ..friction.functions import larger, where
from ..friction.tuples import dot, largest, plus, plus_sum, product, sum_of, times, total
from . import rows as R
from .equations import exponentials, force_slopes, forces
from .lanes import ROUNDING, saves, step_size
from .rodas5p import dense_output, leaves, next_point, with_drift
from .rows import read_rows, rows_of, store_each, write_rows
from .tableau import GAMMA, NODES, A, D, H


def point(s, l, law, dT, psi):
    """y, w, e and the law's coefficients at a time dT into the lane's step, where psi is this."""
    p = law.later(read_rows(s, rows_of(law).p, l), dT)
    v = law.v_at(s[R.W_LP + l] + dT * s[R.RAMP + l], psi, p)
    w, _, e = exponentials((0.0, v, *psi), law, p)
    return (law.stress_in_v(v, w, psi, p) + s[R.ETA0 + l] * s[R.RAMP + l], v, *psi), w, e, p


def slopes(y, w, e, p, ramp, law, of_psi):
    """d/dT of x, S, N and R; of_psi : d psi/dT."""
    change = 0.0, ramp / law.speed_slope(w, e), *of_psi
    _, stress, *others = force_slopes(y, w, e, change, 1.0, law, p)
    return stress, stress, *others


def try_step(s, l, law):
    """Try one step of the lane and record its outcome."""
    h = step_size(s[R.H + l], s[R.BREAKPOINT + l], s[R.T + l], s[R.T_LOW + l])
    rows = rows_of(law)
    y, e, p = read_rows(s, rows.y, l), read_rows(s, rows.e, l), read_rows(s, rows.p, l)
    w, psi = s[R.W + l], y[2:]
    by_omega, by_psi = law.rate_slopes(y[1], w, psi, e, p)
    d_omega = s[R.RAMP + l] / law.speed_slope(w, e)
    drift = with_drift(times(d_omega, by_omega), law.rate_drift(y[1], w, psi, p), 1.0)
    pivots = leaves(GAMMA * h, by_psi)
    k: tuple = ()
    for node, d in zip(NODES, D, strict=True):
        u, coupling = next_point(psi, k)
        at, w, e, p = point(s, l, law, node * h, u)
        right = plus(law.rates_in_v(at[1], w, u, e, p), times(1.0 / h, coupling))
        k = *k, product(pivots, plus(right, times(h * d, drift)))
    end = plus_sum(psi, A[8], k)
    y_new, s[R.W_NEW + l], e_new, _ = point(s, l, law, h, end)
    write_rows(s, rows.y_new, l, y_new)
    write_rows(s, rows.e_new, l, e_new)
    store_each(s, rows.c[2:], l, dense_output(psi, end, *(sum_of(row, k) for row in H)))
    s[R.H_USED + l] = h
    allowed = larger(s[R.TOLERANCE + l], ROUNDING * largest(end))
    finite = abs(total(y_new) + total(k[7])) < math.inf
    s[R.ERROR + l] = where(finite, largest(k[7]) / allowed, math.inf)


def has_event(s, l, law):
    """Set EVENTS and CALL, as `lanes.has_event`: R and x + N may have minima inside the step."""
    rows, h, bits = rows_of(law), s[R.H_USED + l], 0.0
    ends = (0.0, R.W, rows.y, rows.e), (h, R.W_NEW, rows.y_new, rows.e_new)
    sides = []
    for dT, w, y, e in ends:
        p = law.later(read_rows(s, rows.p, l), dT)
        w, y, e = s[w + l], read_rows(s, y, l), read_rows(s, e, l)
        rates = law.rates_in_v(y[1], w, y[2:], e, p)
        of_x, _, strength, friction = slopes(y, w, e, p, s[R.RAMP + l], law, rates)
        sides.append((friction, strength + of_x))
    for bit, start, end in zip((R.F_EXTREME, R.XF_EXTREME), *sides, strict=True):
        bits = bits + where((start < 0.0) & (end >= 0.0), float(bit), 0.0)
    s[R.EVENTS + l] = bits
    called = ((bits > 0.0) & (s[R.OBSERVE + l] > 0.0)) | saves(s, l)
    s[R.CALL + l] = where((s[R.OK + l] > 0.0) & called, 1.0, 0.0)


def state(s, l, law, at, *given):
    """x and v at a place in the lane's step; given : x and v, which are ignored, and psi there."""
    y, _, _, _ = point(s, l, law, at * s[R.H_USED + l], given[2:])
    return y[:2]


def force(s, l, law, at, *given):
    """Find the same as `units.force`, but ignore x and v among the given."""
    n, h = 2 + len(law.states), s[R.H_USED + l]
    parts, psi, d_psi = given[:4], given[6 : 4 + n], given[6 + n :]
    y, w, e, p = point(s, l, law, at * h, psi)
    changes = slopes(y, w, e, p, s[R.RAMP + l], law, times(1.0 / h, d_psi))
    return dot(parts, forces(y, w, law, p)), h * dot(parts, changes)
