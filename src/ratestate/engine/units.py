"""What the engine does under one law, as functions of a lane: the units, called by the control.

Units of lanes go over whole vectors.  Those of one lane are given numbers and find some; which
these are is said of each.  They are written as code by `code`, and run in Python as they are.
"""

from collections import namedtuple
from typing import Any

import numpy as np

from ..friction.functions import larger, smaller, sqrt, where
from ..friction.tuples import dot, dot_onto, grouped, minus_dot, plus, times, total
from . import lanes, return_lanes, rigid, taylor_lanes, waveform
from . import rows as R
from .equations import exponentials, force_slopes, forces, in_omega, inertial_force
from .model import NOT_FINITE, RUNAWAY, SLAVED
from .rows import FOUND, load_each, read_rows, rows_of, write_rows
from .taylor import has_recurrences

#: addresses of a law's units for a march on a spring; 0 where it has none of that name
MarchUnits = namedtuple(
    "MarchUnits",
    "step taylor commit first_step force orders "
    "begin speed outrun "  # on a spring
    "state note "  # without one; `note` also under normal stress that varies
    "enter_stress jump pull",  # under normal stress that varies
)


class RigidUnits(MarchUnits):
    """The same where the slider moves with its load point (rigid.py)."""


#: the same for a return map
ReturnUnits = namedtuple(
    "ReturnUnits",
    "step taylor commit begin first_step force speed outrun "
    "add_rodas5p add_taylor land perturbed perturbed_taylor outcome",
)


def note(s, l, law):
    """Let exponentials and extremes of V, |g|, f and x + N be those of the lane's state too."""
    rows = rows_of(law)
    y, p = read_rows(s, rows.y, l), read_rows(s, rows.p, l)
    w, _, e = exponentials(y, law, p)
    s[R.W + l] = w
    write_rows(s, rows.e, l, e)
    speed = law.order_of_speed(y[1], w)
    s[R.V_HIGH + l] = larger(s[R.V_HIGH + l], speed)
    s[R.V_LOW + l] = smaller(s[R.V_LOW + l], speed)
    s[R.F_LOW + l] = smaller(s[R.F_LOW + l], law.resistance_in_v(y[1], w, y[2:], p))
    strength = law.strength_in_v(y[1], w, y[2:], p)
    s[R.XF_LOW + l] = smaller(s[R.XF_LOW + l], y[0] + strength)
    force = y[0] - law.stress_in_v(y[1], w, y[2:], p)
    s[R.G_HIGH + l] = larger(s[R.G_HIGH + l], abs(force))
    return ()


def begin(s, l, law):
    """`note`, and the limit of speed that the law can tell."""
    note(s, l, law)
    p = read_rows(s, rows_of(law).p, l)
    s[R.V_LIMIT + l] = law.resolved(s[R.V_LIMIT + l], p)
    return ()


def first_step(s, l, law):
    """Set the lane's next step: small beside the time in which the state, or the load, changes."""
    rows, w, w_lp = rows_of(law), s[R.W + l], s[R.W_LP + l]
    y, e, p = read_rows(s, rows.y, l), read_rows(s, rows.e, l), read_rows(s, rows.p, l)
    f_psi = law.rates_in_v(y[1], w, y[2:], e, p)
    fastest = abs(s[R.KAPPA + l] * (w_lp - w)) + total(map(abs, f_psi))
    fastest = fastest + law.speed_slope(w, e) + abs(w_lp)
    fastest = fastest + total(map(abs, law.strength_drift(y[1], w, y[2:], p)))
    h = 0.1 * sqrt(sqrt(s[R.TOLERANCE + l])) / fastest
    s[R.H + l], s[R.MEMORY + l] = smaller(s[R.BREAKPOINT + l] - s[R.T + l], h), 1.0
    return ()


def force(s, l, law, at, *given):
    """A sum of parts of x, S, N and R at a place in the lane's step; its slope.

    given : four parts, x, v, psi... there, and their derivatives by the place
    """
    n = 2 + len(law.states)
    parts, y, dy, h = given[:4], given[4 : 4 + n], given[4 + n : 4 + 2 * n], s[R.H_USED + l]
    p = law.later(read_rows(s, rows_of(law).p, l), at * h)
    w, c_inverse, e = exponentials(y, law, p)
    change = in_omega(dy, law.shares(w, c_inverse, p))
    slopes = force_slopes(y, w, e, change, h, law, p)
    return dot(parts, forces(y, w, law, p)), dot(parts, slopes)


def speed(s, l, law, w_lp, *given):
    """w at a place in the lane's step, its slope, and how far v is ahead of that at w_lp.

    given : x, v, psi... there, and their derivatives by the place
    """
    n = 2 + len(law.states)
    y, dy, p = given[:n], given[n : 2 * n], read_rows(s, rows_of(law).p, l)
    w, c_inverse, e = exponentials(y, law, p)
    _, d_omega, *_ = in_omega(dy, law.shares(w, c_inverse, p))
    return w, law.speed_slope(w, e) * d_omega, y[1] - law.v_at(w_lp, y[2:], p)


def outrun(s, l, law):
    """End the case of a lane beyond its limit of speed, unless the motion will turn back.

    Its status is then RUNAWAY or, where it is lost, NOT_FINITE.
    """
    rows = rows_of(law)
    y, p = read_rows(s, rows.y_new, l), read_rows(s, rows.p, l)
    v, kappa = law.log_of_faster(y[1], y[2:], p), law.stiffness(s[R.KAPPA + l], p)
    w, e = s[R.W_NEW + l], read_rows(s, rows.e_new, l)
    away = law.runs_away(v, y[2:], kappa, p) | law.outruns_spring(v, w, y[2:], e, kappa, p)
    lost = where(law.is_lost(v, p), float(NOT_FINITE), s[R.STATUS + l])
    s[R.STATUS + l] = where(away, float(RUNAWAY), lost)
    return ()


def orders(s, l, law):
    """v of the largest and of the smallest speed so far."""
    rows = rows_of(law)
    psi, p = read_rows(s, rows.y[2:], l), read_rows(s, rows.p, l)
    high, low = s[R.V_HIGH + l], s[R.V_LOW + l]
    return law.v_of_order(high, psi, p), law.v_of_order(low, psi, p)


# Of varying normal stress


def enter_stress(s, l, law, start, rate):
    """Let normal stress, but for its sinusoid, and its rate be these; s before, and now."""
    rows = rows_of(law)
    p = read_rows(s, rows.p, l)
    now = law.at_time(p, start, rate, p[law.PHASE])
    write_rows(s, rows.history, l, law.history(now))
    return p[law.S], now[law.S]


def jump(s, l, law, rise):
    """Change psi as a jump of ln sigma by `rise` does; v of the same speed."""
    rows, w = rows_of(law), s[R.W + l]
    y, e, p = read_rows(s, rows.y, l), read_rows(s, rows.e, l), read_rows(s, rows.p, l)
    psi = law.after_jump(y[1], w, y[2:], e, p, rise)
    write_rows(s, rows.y[2:], l, psi)
    return (law.v_at(w, psi, p) if law.reverses else y[1],)


def pull(s, l, law, v):
    """x - S at another v, the logarithm of that speed, and 1 where it would run away."""
    rows = rows_of(law)
    x, _, *psi = read_rows(s, rows.y, l)
    p = read_rows(s, rows.p, l)
    w, _, _ = exponentials((x, v, *psi), law, p)
    log_w = law.log_of_faster(v, tuple(psi), p)
    away = law.runs_away(log_w, tuple(psi), law.stiffness(s[R.KAPPA + l], p), p)
    return x - law.stress_in_v(v, w, tuple(psi), p), log_w, where(away, 1.0, 0.0)


# Of a return map


def rates(s, l, law, y, w, e):
    """dx/dT, dv/dT and dpsi/dT, a tuple, if the load point's speed is 1."""
    _, kappa, eta, p = lanes.system_of(s, l, law)
    f_x = kappa * (1.0 - w)
    f_psi = law.rates_in_v(y[1], w, y[2:], e, p)
    g, S_v, S_psi = inertial_force(y, w, e, law, p)
    c = law.speed_slope(w, e)
    slaved = (eta <= 0.0) | (larger(eta, abs(g)) < SLAVED * sqrt(abs(S_v) / c))
    f_omega = where(slaved, (f_x - dot(S_psi, f_psi)) / S_v, g / (eta * c))
    return f_x, minus_dot(f_omega, law.shares(w, 1.0 / c, p), f_psi), *f_psi


def land(s, l, law):
    """Move the end of a step that was cut at a crossing onto the section."""
    rows = rows_of(law)
    y = read_rows(s, rows.y_new, l)
    e, p = read_rows(s, rows.e_new, l), read_rows(s, rows.p, l)
    f_x, *others = rates(s, l, law, y, s[R.W_NEW + l], e)
    shares = law.shares(s[R.W_NEW + l], 1.0 / law.speed_slope(s[R.W_NEW + l], e), p)
    omega = dot_onto(others[0], shares, others[1:])
    dt = -(y[1] - law.v_at(1.0, y[2:], p)) / omega
    psi = plus(y[2:], times(dt, others[1:]))
    # (dx/dT vanishes at the section)
    end = (y[0] + 0.5 * f_x * dt, law.v_at(1.0, psi, p), *psi)
    write_rows(s, rows.y_new, l, end)
    _, _, e = exponentials(end, law, p)
    s[R.W_NEW + l] = 1.0
    write_rows(s, rows.e_new, l, e)
    s[R.H_USED + l] = s[R.H_USED + l] + dt
    return ()


def order_slopes(law, y, w, e, z, p):
    """How perturbations z change the speed, as of `v_of_order`."""
    shares = law.shares(w, 1.0 / law.speed_slope(w, e), p)
    return times(law.order_slope(w, y[2:], e, p), return_lanes.changes_of_speed(z, shares))


def perturbed(s, l, law, at):
    """`order_slopes` at a place in the lane's step, by a step of Rodas5P that ends there."""
    (y, w, e), z, _, _, _ = return_lanes.step_of_lane(s, l, law, at * s[R.H_USED + l])
    return order_slopes(law, y, w, e, z, read_rows(s, rows_of(law).p, l))


def perturbed_taylor(s, l, law, *given):
    """`order_slopes`; given : x, v, psi... and the numbers of each perturbation there."""
    n, p = 2 + len(law.states), read_rows(s, rows_of(law).p, l)
    y, z = given[:n], grouped(given[n : n * n], given[:n])
    w, _, e = exponentials(y, law, p)
    return order_slopes(law, y, w, e, z, p)


def outcome(s, l, law):
    """G; v of the largest and of the smallest speed; shifts to the section; d psi/dT."""
    rows = rows_of(law)
    y, e, p = read_rows(s, rows.y, l), read_rows(s, rows.e, l), read_rows(s, rows.p, l)
    speeds = rates(s, l, law, y, s[R.W + l], e)
    c = law.speed_slope(s[R.W + l], e)
    shares = law.shares(s[R.W + l], 1.0 / c, p)
    omega = dot_onto(speeds[1], shares, speeds[2:])
    changes = return_lanes.changes_of_speed(load_each(s, rows.z, l), shares)
    return omega * c, *orders(s, l, law), *times(1.0 / omega, changes), *speeds[2:]


# Without a spring


def settle(s, l, law):
    """Let the lane's x and v be those at its load point's speed, and `note` them."""
    rows = rows_of(law)
    y, _, _, _ = rigid.point(s, l, law, 0.0, read_rows(s, rows.y[2:], l))
    write_rows(s, rows.y, l, y)
    return note(s, l, law)


def lane_units(law, kind):
    """name -> functions of (s, l, law) that each vector of lanes goes through, in turn.

    kind : the class of the units
    """
    returns, events = kind is ReturnUnits, rigid if kind is RigidUnits else lanes
    step = return_lanes.try_step if returns else events.try_step
    taylor_step = return_lanes.try_taylor_step if returns else taylor_lanes.try_step
    has_taylor = has_recurrences(law) and kind is not RigidUnits

    def control(s, l, law):
        lanes.control_step(s, l)
        events.has_event(s, l, law)
        if has_taylor:
            taylor_lanes.find_calm(s, l, law)

    of_return = [return_lanes.commit_lane] if returns else []
    slow = [waveform.find_slow] if returns else []
    found = {"step": [step, control, *slow], "commit": [lanes.commit_lane, *of_return]}
    if has_taylor:
        found["taylor"] = [taylor_step, lanes.has_event, *slow]
    if returns:
        found["add_rodas5p"] = [waveform.add_rodas5p]
    if returns and has_taylor:
        found["add_taylor"] = [waveform.add_taylor]
    return found


def point_units(law, kind):
    """name -> a function of (s, l, law, *given), and how many numbers it is given."""
    n = 2 + len(law.states)
    found: dict[str, Any] = {"first_step": (first_step, 0)}
    if kind is RigidUnits:
        found |= {"note": (settle, 0), "state": (rigid.state, 1 + n)}
        found["force"] = rigid.force, 5 + 2 * n
    else:
        found |= {"begin": (begin, 0), "outrun": (outrun, 0)}
        found |= {"force": (force, 5 + 2 * n), "speed": (speed, 1 + 2 * n)}
    if kind is ReturnUnits:
        found |= {"land": (land, 0), "perturbed": (perturbed, 1), "outcome": (outcome, 0)}
        if has_recurrences(law):
            found["perturbed_taylor"] = perturbed_taylor, n * n
        return found
    found["orders"] = orders, 0
    if rows_of(law).history:
        found |= {"enter_stress": (enter_stress, 2), "jump": (jump, 1), "pull": (pull, 1)}
        found.setdefault("note", (note, 0))
    return found


def unit_names(law, kind):
    """The names of a law's units; kind : their class."""
    return [*lane_units(law, kind), *point_units(law, kind)]


def in_python(law, kind):
    """The units of a law as functions of Python, which `calls` takes as it takes machine code.

    kind : their class
    """
    units = {name: _lanes(law, bodies) for name, bodies in lane_units(law, kind).items()}
    points = {name: _point(law, *unit) for name, unit in point_units(law, kind).items()}
    return kind(**dict.fromkeys(kind._fields, 0) | units | points)


def _lanes(law, bodies):
    @np.errstate(all="ignore")
    def unit(s, l):
        for body in bodies:
            body(s, l, law)

    return unit


def _point(law, body, count):
    @np.errstate(all="ignore")
    def unit(s, l, work):
        found = body(s, l, law, *work[:count])
        work[FOUND : FOUND + len(found)] = found

    return unit
