"""The lanes: many sliders side by side in one buffer (rows.py): a step of each, and its events.

Code of these goes over whole vectors of lanes, idle ones too, so that a slider goes through the
same instructions, and gets the same bits, wherever it sits.
"""

import math

from ..friction.functions import larger, sqrt, where
from ..friction.tuples import dot, largest, plus, select, size_of, times, total
from . import rows as R
from .equations import force_slopes, inertial_force, later
from .model import RUNNING
from .rodas5p import step as rodas5p_step
from .rows import read_rows, rows_of, store_each, write_rows

# Rejections in a row that no step size can explain: 5**-400 is below any eta0 w.
TOO_MANY_FAILURES = 400.0

# Errors of a step, relative to x and psi, that rounding feigns: no tolerance below them is kept.
ROUNDING = 1e-15

# Of x and of the parts of friction, by which g = x - f may be off.
ROUNDING_OF_FORCE = 1e-13

# A factor below 1/5 or above 5 says more about the estimate than about the solution.
SAFETY, SHRINK, GROW = 0.85, 0.2, 5.0


def extremum_conditions(y, w, e, w_lp, system):
    """Four numbers with the signs of dw/dT, dg/dT, df/dT and d(x + N)/dT.

    dw/dT has the sign of g or, where inertia is lost in rounding, of f_x - S_psi f_psi; then x = S.
    The others follow from eta0 dw/dT = g, friction f = R, the strength N and g = x - S.
    """
    law, kappa, eta0, p = system
    f_x, f_psi = kappa * (w_lp - w), law.rates_in_v(y[1], w, y[2:], e, p)
    g, S_v, S_psi = inertial_force(y, w, e, law, p)
    drift = law.strength_drift(y[1], w, y[2:], p)
    drive = f_x - dot(S_psi, f_psi) - total(drift)
    lost = abs(g) <= ROUNDING_OF_FORCE * (abs(y[0]) + abs(S_v * y[1]) + size_of(S_psi, y[2:]))
    m = eta0 * law.speed_slope(w, e)
    # d omega/dT is `by` over `unit`
    by, unit = select(lost, (drive, S_v), (g, m))
    change = unit * f_x, by, *times(unit, f_psi)
    _, _, strength, friction = force_slopes(y, w, e, change, unit, law, p)
    return by, m * drive - S_v * g, friction, strength + unit * f_x


def extrema(s, l, law):
    """Whether V and g have an extreme in the step, f and x + N a minimum: four bools."""
    rows, system = rows_of(law), system_of(s, l, law)
    w_lp = s[R.W_LP + l]
    w_lp_new = w_lp + s[R.H_USED + l] * s[R.RAMP + l]
    y0, e0 = read_rows(s, rows.y, l), read_rows(s, rows.e, l)
    y1, e1 = read_rows(s, rows.y_new, l), read_rows(s, rows.e_new, l)
    a0, b0, c0, d0 = extremum_conditions(y0, s[R.W + l], e0, w_lp, system)
    at_end = later(system, s[R.H_USED + l])
    a1, b1, c1, d1 = extremum_conditions(y1, s[R.W_NEW + l], e1, w_lp_new, at_end)
    f_extremum, xf_extremum = (c0 < 0.0) & (c1 >= 0.0), (d0 < 0.0) & (d1 >= 0.0)
    return (a0 < 0.0) ^ (a1 < 0.0), (b0 < 0.0) ^ (b1 < 0.0), f_extremum, xf_extremum


def saves(s, l):
    """Whether the next saved time lies in the step.

    Written as in `step_size`, so that a saved time at a breakpoint lies in the step to it.
    """
    return s[R.H_USED + l] >= (s[R.SAVE_AT + l] - s[R.T + l]) - s[R.T_LOW + l]


def nears_load_point(s, l, law):
    """Whether V, at the rate of the step's start, comes up to V_lp within the step."""
    rows = rows_of(law)
    y, p = read_rows(s, rows.y, l), read_rows(s, rows.p, l)
    gap, g = s[R.W_LP + l] - s[R.W + l], y[0] - law.stress_in_v(y[1], s[R.W + l], y[2:], p)
    return (gap * g > 0.0) & (abs(gap) * s[R.ETA0 + l] < abs(g) * s[R.H_USED + l])


def steadies(s, l, law):
    """Whether the step ends within the lane's tolerance of steady sliding.

    Never in a march, whose lanes have the tolerance 0.
    """
    rows = rows_of(law)
    off = plus(read_rows(s, rows.y_new, l), times(-1.0, read_rows(s, rows.steady, l)))
    return largest(off) < s[R.STEADY + l]


def beyond_limit(s, l, law):
    """Whether the step ends at a speed beyond the lane's limit."""
    rows = rows_of(law)
    y_new = read_rows(s, rows.y_new, l)
    v_new = law.log_of_faster(y_new[1], y_new[2:], read_rows(s, rows.p, l))
    return v_new > s[R.V_LIMIT + l]


def has_event(s, l, law):
    """Set EVENTS, and CALL: whether the step is accepted and holds anything for the control."""
    w_lp = s[R.W_LP + l]
    crosses = (s[R.W + l] < w_lp) ^ (s[R.W_NEW + l] < w_lp + s[R.H_USED + l] * s[R.RAMP + l])
    v, g, f, xf = extrema(s, l, law)
    grazes, beyond = v & nears_load_point(s, l, law), beyond_limit(s, l, law)
    steady = steadies(s, l, law)
    bits = 0.0
    for bit, event in zip(R.BITS, (v, g, f, xf, grazes, beyond, steady), strict=True):
        bits = bits + where(event, float(bit), 0.0)
    s[R.EVENTS + l] = bits
    extreme = (v | g | f | xf) & (s[R.OBSERVE + l] > 0.0)
    flag = crosses | grazes | extreme | saves(s, l) | steady | beyond
    flag = flag | (s[R.EVERY_STEP + l] > 0.0)
    s[R.CALL + l] = where((s[R.OK + l] > 0.0) & flag, 1.0, 0.0)


def system_of(s, l, law):
    """(law, kappa, eta0, p) of the lane's slider, for which a step is taken."""
    return law, s[R.KAPPA + l], s[R.ETA0 + l], read_rows(s, rows_of(law).p, l)


def record(s, l, law, h, new, error, dense):
    """Put the outcome of a step into its rows.

    new : y_new, w_new, e_new; error : tuple; dense : the dense output
    """
    rows = rows_of(law)
    write_rows(s, rows.y_new, l, new[0])
    s[R.W_NEW + l] = new[1]
    write_rows(s, rows.e_new, l, new[2])
    store_each(s, rows.c, l, dense)
    s[R.H_USED + l] = h
    # (v is far larger at rest, and means nothing there)
    size = larger(abs(new[0][0]), largest(new[0][2:]))
    fastest = s[R.V_HIGH + l], s[R.V_LOW + l], s[R.W_LP + l]
    allowed = larger(s[R.TOLERANCE + l], ROUNDING * size)
    p, inertia = read_rows(s, rows.p, l), s[R.ETA0 + l] / h
    of_v = law.error_of_v(error, new[1], new[2], p, fastest)
    of_v = law.without_rounding(of_v, *new, p, inertia, ROUNDING, size, allowed)
    largest_error = larger(larger(abs(error[0]), abs(of_v)), largest(error[2:]))
    # of a NaN and a number either may be the larger: it hangs on their order, and on the machine
    finite = abs(total(new[0]) + total(error)) < math.inf
    s[R.ERROR + l] = where(finite, largest_error / allowed, math.inf)


def try_step(s, l, law):
    """Try one step of the lane by Rodas5P and record its outcome."""
    h = step_size(s[R.H + l], s[R.BREAKPOINT + l], s[R.T + l], s[R.T_LOW + l])
    rows = rows_of(law)
    y, e = read_rows(s, rows.y, l), read_rows(s, rows.e, l)
    new, error, dense, s[R.D_LOAD + l], s[R.D_FRICTION + l] = rodas5p_step(
        y, s[R.W + l], e, s[R.W_LP + l], s[R.RAMP + l], h, system_of(s, l, law)
    )
    record(s, l, law, h, new, error, dense)


def step_size(h, t_break, t, t_low):
    """The step to try, in T: never past the next breakpoint, nor just short of it."""
    left = (t_break - t) - t_low
    return where(h * (1.0 + 1e-9) >= left, left, h)


def control_step(s, l):
    """Accept or reject a step of lane l (OK, BAD) and choose the next size, by a PI controller.

    Powers are taken by square roots, which vectorise.
    """
    err, h, planned = s[R.ERROR + l], s[R.H_USED + l], s[R.H + l]
    finite = err < 1e300
    ok = err <= 1.0
    quarter = sqrt(sqrt(err))
    eighth = sqrt(quarter)
    sixteenth = sqrt(eighth)
    factor = SAFETY * s[R.MEMORY + l] / (eighth * sixteenth)
    rejected = SAFETY / quarter
    factor = where(ok, factor, rejected)
    factor = where(factor < GROW, factor, GROW)
    factor = where(factor > SHRINK, factor, SHRINK)
    factor = where(finite, factor, SHRINK)
    h_next = h * factor
    # A step cut short by a breakpoint says nothing against the size planned before it.
    h_next = where(ok & (h < planned) & (h_next < planned), planned, h_next)
    s[R.OK + l] = where(ok, 1.0, 0.0)
    s[R.BAD + l] = where(finite, 0.0, 1.0)
    s[R.H_NEXT + l] = h_next
    s[R.MEMORY_NEW + l] = where(sixteenth > 0.05, sixteenth, 0.05)


def commit_lane(s, l, law):
    """Move an accepted step's outcome into the state; time is summed in two parts (Kahan).

    BREAK is set where the lane has come to a breakpoint or cannot go on.

    Everything is loaded, then selected, then stored: in that order the loop vectorises.
    """
    accepted = s[R.OK + l]
    ok = accepted > 0.0
    h = s[R.H_USED + l]
    t, low = s[R.T + l], s[R.T_LOW + l]
    rows = rows_of(law)
    y, e, w = read_rows(s, rows.y, l), read_rows(s, rows.e, l), s[R.W + l]
    y1, e1, w1 = read_rows(s, rows.y_new, l), read_rows(s, rows.e_new, l), s[R.W_NEW + l]
    v1 = law.order_of_speed(y1[1], w1)
    w_lp, ramp, memory, h_next = s[R.W_LP + l], s[R.RAMP + l], s[R.MEMORY_NEW + l], s[R.H_NEXT + l]
    load, d_load = s[R.LOAD_WORK + l], s[R.D_LOAD + l]
    friction, d_friction = s[R.DISSIPATION + l], s[R.D_FRICTION + l]
    steps, rejected, failures = s[R.STEPS + l], s[R.REJECTED + l], s[R.FAILURES + l]
    v_high, v_low, g_high = s[R.V_HIGH + l], s[R.V_LOW + l], s[R.G_HIGH + l]
    f_low, xf_low = s[R.F_LOW + l], s[R.XF_LOW + l]
    p = read_rows(s, rows.p, l)
    p1 = law.later(p, h)
    f1 = law.resistance_in_v(y1[1], w1, y1[2:], p1)
    s1 = law.stress_in_v(y1[1], w1, y1[2:], p1)
    g1, xf1 = abs(y1[0] - s1), y1[0] + law.strength_in_v(y1[1], w1, y1[2:], p1)
    t_break, status, max_steps = s[R.BREAKPOINT + l], s[R.STATUS + l], s[R.MAX_STEPS + l]
    increment = low + h
    t1 = t + increment
    low1 = increment - (t1 - t)
    w_lp1 = w_lp + h * ramp
    load1 = load + d_load
    friction1 = friction + d_friction
    s[R.T + l], s[R.T_LOW + l] = select(ok, (t1, low1), (t, low))
    write_rows(s, rows.y, l, select(ok, y1, y))
    write_rows(s, rows.e, l, select(ok, e1, e))
    write_rows(s, rows.history, l, select(ok, law.history(p1), law.history(p)))
    s[R.W + l], s[R.W_LP + l] = select(ok, (w1, w_lp1), (w, w_lp))
    s[R.V_HIGH + l] = where(ok & (v1 > v_high), v1, v_high)
    s[R.V_LOW + l] = where(ok & (v1 < v_low), v1, v_low)
    s[R.G_HIGH + l] = where(ok & (g1 > g_high), g1, g_high)
    s[R.F_LOW + l] = where(ok & (f1 < f_low), f1, f_low)
    s[R.XF_LOW + l] = where(ok & (xf1 < xf_low), xf1, xf_low)
    s[R.LOAD_WORK + l] = where(ok, load1, load)
    s[R.DISSIPATION + l] = where(ok, friction1, friction)
    s[R.MEMORY + l] = where(ok, memory, 1.0)
    s[R.STEPS + l], s[R.REJECTED + l] = steps + accepted, rejected + (1.0 - accepted)
    failures = (failures + 1.0) * (1.0 - accepted)
    s[R.FAILURES + l] = failures
    arrived = ok & ((t_break - t1) - low1 <= 1e-12 * h)
    spent = steps + rejected + 1.0 >= max_steps
    over = arrived | spent | (failures > TOO_MANY_FAILURES) | (status != RUNNING)
    s[R.BREAK + l] = where(over, 1.0, 0.0)
    s[R.H + l] = h_next
