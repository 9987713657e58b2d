"""Lanes: many sliders side by side in one buffer; their steps, step sizes and events.

The buffer is described in rows.py.  The functions run over whole vectors of lanes, idle lanes
included.  So a slider goes through the same instructions, and gets the same bits, in any lane.
"""

import math

from ..friction.functions import larger, smaller, sqrt, where
from ..friction.point import Point
from ..friction.tuples import largest, plus, times, total
from . import rows as R
from .model import RUNNING
from .rodas5p import step as rodas5p_step
from .rows import read_rows, rows_of, store_each, write_rows

# More rejections in a row cannot be due to the step size: 5**-400 is below any eta0 w.
TOO_MANY_FAILURES = 400.0

# Error of a step, relative to x and psi, that may be due to rounding: no tolerance is smaller.
ROUNDING = 1e-15

# A factor below 1/5 or above 5 says more about the estimate than about the solution.
SAFETY, SHRINK, GROW = 0.85, 0.2, 5.0


def rows_of_point(law, at_end=False):
    """Return the rows of y, w and e at the start or at the end of the lane's step."""
    rows = rows_of(law)
    return (rows.y_new, R.W_NEW, rows.e_new) if at_end else (rows.y, R.W, rows.e)


def read_point(s, l, law, at_end=False):
    """Return the `Point` at the start or at the end of the lane's step.

    The coefficients are those at the start.  If normal stress varies, call `later` for the end.
    """
    y, w, e = rows_of_point(law, at_end)
    y, e, p = (read_rows(s, part, l) for part in (y, e, rows_of(law).p))
    return Point(law, p, y, s[w + l], e, None, s[R.KAPPA + l], s[R.ETA0 + l])


def write_point(s, l, at, at_end=False):
    """Store the state, the speed and the exponentials of a `Point` in the lane."""
    y, w, e = rows_of_point(at.law, at_end)
    write_rows(s, y, l, at.y)
    write_rows(s, e, l, at.e)
    s[w + l] = at.w


def evaluate_dense_output(s, l, rows, fraction):
    """Return values and derivatives of the dense output at a fraction of the step.

    The degree is 4 after a step of Rodas5P, and `rows.ORDER` after a Taylor step.

    rows : a tuple for each polynomial, with the rows of its coefficients, the constant first
    """
    values, derivatives = [], []
    is_taylor = s[R.TAYLOR + l] > 0.0
    for coefficients in rows:
        y = dy = 0.0
        for k, row in reversed([*enumerate(coefficients)]):
            c = s[row + l] if k < R.RODAS5P_TERMS else where(is_taylor, s[row + l], 0.0)
            y, dy = c + fraction * y, y + fraction * dy
        values.append(y)
        derivatives.append(dy)
    return tuple(values), tuple(derivatives)


def extremes(s, l, at):
    """Return row -> extreme of V, |g|, f or x + N so far, including the `Point` `at`."""
    return {
        R.V_HIGH: larger(s[R.V_HIGH + l], at.speed_measure),
        R.V_LOW: smaller(s[R.V_LOW + l], at.speed_measure),
        R.G_HIGH: larger(s[R.G_HIGH + l], abs(at.g)),
        R.F_LOW: smaller(s[R.F_LOW + l], at.R),
        R.XF_LOW: smaller(s[R.XF_LOW + l], at.x + at.N),
    }


def extremum_conditions(at, w_lp):
    """Return four numbers with the signs of dw/dT, dg/dT, df/dT and d(x + N)/dT.

    They follow from eta0 dw/dT = g, friction f = R, the strength N and g = x - S.
    """
    # d omega/dT is `d_omega` divided by `unit`
    d_omega, unit = at.acceleration(w_lp, at.is_balanced)
    of_x = unit * at.x_rate(w_lp)
    change = of_x, d_omega, *times(unit, at.f)
    _, _, strength, friction = at.changes_of_forces(change, unit)
    return d_omega, at.m * at.g_rate(w_lp) - at.S_slopes[0] * at.g, friction, strength + of_x


def has_save_time(s, l):
    """Return whether the next saved time lies in the step.

    The arithmetic is as in `step_size`, so that a step up to a breakpoint contains a time there.
    """
    return s[R.H_USED + l] >= (s[R.SAVE_AT + l] - s[R.T + l]) - s[R.T_LOW + l]


def flag_events(s, l, law):
    """Set EVENTS; set CALL if the step is accepted and the control must handle it."""
    h, w_lp = s[R.H_USED + l], s[R.W_LP + l]
    w_lp_end = w_lp + h * s[R.RAMP + l]
    start, end = read_point(s, l, law), read_point(s, l, law, True).later(h)
    crosses = (start.w < w_lp) ^ (end.w < w_lp_end)
    # whether V and g have an extreme in the step, and f and x + N a minimum
    a0, b0, c0, d0 = extremum_conditions(start, w_lp)
    a1, b1, c1, d1 = extremum_conditions(end, w_lp_end)
    v, g = (a0 < 0.0) ^ (a1 < 0.0), (b0 < 0.0) ^ (b1 < 0.0)
    f, xf = (c0 < 0.0) & (c1 >= 0.0), (d0 < 0.0) & (d1 >= 0.0)
    # whether V would reach V_lp within the step at its initial rate
    gap = w_lp - start.w
    near_V_lp = (gap * start.g > 0.0) & (abs(gap) * start.eta0 < abs(start.g) * h)
    beyond = end.log_jump_rate > s[R.V_LIMIT + l]
    # (never in a march, for which the tolerance STEADY is 0)
    deviation = plus(end.y, times(-1.0, read_rows(s, rows_of(law).steady, l)))
    steady = largest(deviation) < s[R.STEADY + l]
    bits = 0.0
    for bit, event in zip(R.BITS, (v, g, f, xf, v & near_V_lp, beyond, steady), strict=True):
        bits = bits + where(event, float(bit), 0.0)
    s[R.EVENTS + l] = bits
    extreme = (v | g | f | xf) & (s[R.OBSERVE + l] > 0.0)
    call = crosses | (v & near_V_lp) | extreme | has_save_time(s, l) | steady | beyond
    call = call | (s[R.EVERY_STEP + l] > 0.0)
    s[R.CALL + l] = where((s[R.OK + l] > 0.0) & call, 1.0, 0.0)


def store_step(s, l, h, new, error, dense):
    """Store the outcome of a Rodas5P step in the rows of its lane.

    new : a `Point`; error : tuple; dense : the dense output
    """
    write_point(s, l, new, True)
    store_each(s, rows_of(new.law).c, l, dense)
    s[R.H_USED + l] = h
    # (without v, whose size has no meaning at rest)
    scale = larger(abs(new.x), largest(new.psi))
    fastest = s[R.V_HIGH + l], s[R.V_LOW + l], s[R.W_LP + l]
    allowed = larger(s[R.TOLERANCE + l], ROUNDING * scale)
    error_of_v, inertia = new.error_of_v(error, fastest), s[R.ETA0 + l] / h
    error_of_v = new.law.discount_rounding(new, error_of_v, inertia, ROUNDING, scale, allowed)
    largest_error = larger(larger(abs(error[0]), abs(error_of_v)), largest(error[2:]))
    # Test a sum, because which one of NaN and a number is larger depends on order and processor.
    finite = abs(total(new.y) + total(error)) < math.inf
    s[R.ERROR + l] = where(finite, largest_error / allowed, math.inf)


def try_step(s, l, law):
    """Try one step of the lane by Rodas5P and store its outcome."""
    h = step_size(s[R.H + l], s[R.BREAKPOINT + l], s[R.T + l], s[R.T_LOW + l])
    new, error, dense, s[R.D_LOAD + l], s[R.D_FRICTION + l] = rodas5p_step(
        read_point(s, l, law), s[R.W_LP + l], s[R.RAMP + l], h
    )
    store_step(s, l, h, new, error, dense)


def step_size(h, t_break, t, t_low):
    """Return the step to try, in T; it never ends beyond or just before a breakpoint."""
    remaining = (t_break - t) - t_low
    return where(h * (1.0 + 1e-9) >= remaining, remaining, h)


def control_step(s, l):
    """Accept or reject the step (OK, BAD); choose the next size by a PI controller.

    Powers are computed by square roots, which vectorise.
    """
    err, h, planned = s[R.ERROR + l], s[R.H_USED + l], s[R.H + l]
    finite = err < 1e300
    ok = err <= 1.0
    quarter = sqrt(sqrt(err))
    eighth = sqrt(quarter)
    sixteenth = sqrt(eighth)
    factor = SAFETY * s[R.MEMORY + l] / (eighth * sixteenth)
    factor_if_rejected = SAFETY / quarter
    factor = where(ok, factor, factor_if_rejected)
    factor = where(factor < GROW, factor, GROW)
    factor = where(factor > SHRINK, factor, SHRINK)
    factor = where(finite, factor, SHRINK)
    h_next = h * factor
    # A step that was cut short by a breakpoint does not reduce the size that was planned before.
    h_next = where(ok & (h < planned) & (h_next < planned), planned, h_next)
    s[R.OK + l] = where(ok, 1.0, 0.0)
    s[R.BAD + l] = where(finite, 0.0, 1.0)
    s[R.H_NEXT + l] = h_next
    s[R.MEMORY_NEW + l] = where(sixteenth > 0.05, sixteenth, 0.05)


def commit_lane(s, l, law):
    """Make the end of an accepted step the lane's state; time has two parts (Kahan).

    BREAK is set if the lane has reached a breakpoint or cannot continue.
    """
    rows, accepted, h = rows_of(law), s[R.OK + l], s[R.H_USED + l]
    ok, end = accepted > 0.0, read_point(s, l, law, True).later(h)
    increment = s[R.T_LOW + l] + h
    t = s[R.T + l] + increment
    low = increment - (t - s[R.T + l])
    outcome = {
        R.T: t,
        R.T_LOW: low,
        R.W: end.w,
        R.W_LP: s[R.W_LP + l] + h * s[R.RAMP + l],
        R.LOAD_WORK: s[R.LOAD_WORK + l] + s[R.D_LOAD + l],
        R.DISSIPATION: s[R.DISSIPATION + l] + s[R.D_FRICTION + l],
        **dict(zip((*rows.y, *rows.e), (*end.y, *end.e), strict=True)),
        **dict(zip(rows.history, law.history(end.p), strict=True)),
        **extremes(s, l, end),
    }
    for row, x in outcome.items():
        s[row + l] = where(ok, x, s[row + l])
    arrived = ok & ((s[R.BREAKPOINT + l] - t) - low <= 1e-12 * h)
    is_exhausted = s[R.STEPS + l] + s[R.REJECTED + l] + 1.0 >= s[R.MAX_STEPS + l]
    failures = (s[R.FAILURES + l] + 1.0) * (1.0 - accepted)
    is_over = arrived | is_exhausted | (failures > TOO_MANY_FAILURES) | (s[R.STATUS + l] != RUNNING)
    s[R.BREAK + l], s[R.FAILURES + l] = where(is_over, 1.0, 0.0), failures
    s[R.STEPS + l] += accepted
    s[R.REJECTED + l] += 1.0 - accepted
    s[R.H + l], s[R.MEMORY + l] = s[R.H_NEXT + l], where(ok, s[R.MEMORY_NEW + l], 1.0)
