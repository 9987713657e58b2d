"""What the engine does under one law, as functions of a lane: the units, called by the control.

Units of lanes go over whole vectors.  Those of one lane are given numbers and find some; which
these are is said of each.  They are written as code by `code`, and run in Python as they are.
"""

from collections import namedtuple
from typing import Any

import numpy as np

from ..friction.functions import expm1, larger, smaller, sqrt, where
from ..friction.tuples import dot, grouped, plus, times, total
from . import lanes, rigid, tangent, taylor_lanes, waveform
from . import rows as R
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
    at = lanes.read_point(s, l, law)
    at = at.at(at.y)
    lanes.write_point(s, l, at)
    for row, x in lanes.extremes(s, l, at).items():
        s[row + l] = x
    return ()


def begin(s, l, law):
    """`note`, and the limit of speed that the law can tell."""
    note(s, l, law)
    p = read_rows(s, rows_of(law).p, l)
    s[R.V_LIMIT + l] = law.largest_resolved_v(s[R.V_LIMIT + l], p)
    return ()


def first_step(s, l, law):
    """Set the lane's next step: small beside the time in which the state, or the load, changes."""
    at, w_lp = lanes.read_point(s, l, law), s[R.W_LP + l]
    fastest = abs(at.x_rate(w_lp)) + total(map(abs, at.f)) + at.c + abs(w_lp)
    fastest = fastest + total(map(abs, at.N_drift))
    h = 0.1 * sqrt(sqrt(s[R.TOLERANCE + l])) / fastest
    s[R.H + l], s[R.MEMORY + l] = smaller(s[R.BREAKPOINT + l] - s[R.T + l], h), 1.0
    return ()


def force(s, l, law, at, *given):
    """A sum of parts of x, S, N and R at a place in the lane's step; its slope.

    given : four parts, x, v, psi... there, and their derivatives by the place
    """
    n, h = 2 + len(law.states), s[R.H_USED + l]
    parts, y, dy = given[:4], given[4 : 4 + n], given[4 + n : 4 + 2 * n]
    here = lanes.read_point(s, l, law).at(y, at * h)
    return dot(parts, here.forces), dot(parts, here.changes_of_forces(here.in_omega(dy), h))


def speed(s, l, law, w_lp, *given):
    """w at a place in the lane's step, its slope, and how far v is ahead of that at w_lp.

    given : x, v, psi... there, and their derivatives by the place
    """
    n = 2 + len(law.states)
    at = lanes.read_point(s, l, law).at(given[:n])
    _, d_omega, *_ = at.in_omega(given[n : 2 * n])
    return at.w, at.c * d_omega, at.v - law.v_at(w_lp, at.psi, at.p)


def outrun(s, l, law):
    """End the case of a lane beyond its limit of speed, unless the motion will turn back.

    Its status is then RUNAWAY or, where it is lost, NOT_FINITE.
    """
    at = lanes.read_point(s, l, law, True)
    v, kappa = at.log_jump_rate, law.stiffness(at.kappa, at.p)
    away = law.runs_away(v, at.psi, kappa, at.p) | law.weakens_faster_than_spring(at, kappa)
    lost = where(law.must_stop(v, at.p), float(NOT_FINITE), s[R.STATUS + l])
    s[R.STATUS + l] = where(away, float(RUNAWAY), lost)
    return ()


def orders(s, l, law):
    """v, at psi = 0 if slip may reverse, of the largest and of the smallest speed so far."""
    found, psi = (s[R.V_HIGH + l], s[R.V_LOW + l]), law.reference_state
    if not law.reverses:
        return found
    p = read_rows(s, rows_of(law).p, l)
    return tuple(law.v_at(one, psi, p) for one in found)


# Of varying normal stress


def enter_stress(s, l, law, start, rate):
    """Let normal stress, but for its sinusoid, and its rate be these; s before, and now."""
    rows = rows_of(law)
    p = read_rows(s, rows.p, l)
    now = law.at_time(p, start, rate, p[law.PHASE])
    write_rows(s, rows.history, l, law.history(now))
    return p[law.S], now[law.S]


def jump(s, l, law, rise):
    """Let psi be where ln s has risen by `rise` at once, at constant V; v of the same speed.

    R changes in proportion to the jumps of psi, which it makes larger or smaller.
    """
    at = lanes.read_point(s, l, law)
    growth = rise * at.jump_growth
    grows = abs(growth) > 0.0
    effective = rise * where(grows, expm1(growth) / where(grows, growth, 1.0), 1.0)
    psi = plus(at.psi, times(effective, at.jumps))
    write_rows(s, rows_of(law).y[2:], l, psi)
    return (law.v_at(at.w, psi, at.p) if law.reverses else at.v,)


def pull(s, l, law, v):
    """x - S at another v, the logarithm of that speed, and 1 where it would run away."""
    at = lanes.read_point(s, l, law)
    at = at.at((at.x, v, *at.psi))
    kappa = law.stiffness(at.kappa, at.p)
    away = law.runs_away(at.log_jump_rate, at.psi, kappa, at.p)
    return at.g, at.log_jump_rate, where(away, 1.0, 0.0)


# Of a return map, whose load point moves at a speed of 1


def d_omega(at):
    """d omega/dT, without inertia where G is better known so (`model.SLAVED`)."""
    by_omega, size = abs(at.S_slopes[0]), larger(at.eta0, abs(at.g))
    by, unit = at.acceleration(1.0, (at.eta0 <= 0.0) | (size < SLAVED * sqrt(by_omega / at.c)))
    return by / unit


def land(s, l, law):
    """Move the end of a step that was cut at a crossing onto the section."""
    at = lanes.read_point(s, l, law, True)
    dt = -(at.v - law.v_at(1.0, at.psi, at.p)) / d_omega(at)
    psi = plus(at.psi, times(dt, at.f))
    # (dx/dT vanishes at the section)
    end = at.at((at.x + 0.5 * at.x_rate(1.0) * dt, law.v_at(1.0, psi, at.p), *psi))
    lanes.write_point(s, l, end, True)
    s[R.W_NEW + l], s[R.H_USED + l] = 1.0, s[R.H_USED + l] + dt
    return ()


def changes_of_order(at, z):
    """How perturbations z change v at psi = 0 and the speed of a point, a tuple."""
    return times(at.reference_v_slope, tuple(at.in_omega(one)[1] for one in z))


def perturbed(s, l, law, at):
    """`changes_of_order` at a place in the step, by a step of Rodas5P that ends there."""
    end, z, _, _, _ = tangent.step_of_lane(s, l, law, at * s[R.H_USED + l])
    return changes_of_order(end, z)


def perturbed_taylor(s, l, law, *given):
    """`changes_of_order`; given : x, v, psi... and the numbers of each perturbation there."""
    n = 2 + len(law.states)
    at = lanes.read_point(s, l, law).at(given[:n])
    return changes_of_order(at, grouped(given[n : n * n], given[:n]))


def outcome(s, l, law):
    """G; v of the largest and of the smallest speed; shifts to the section; d psi/dT."""
    at = lanes.read_point(s, l, law)
    omega = d_omega(at)
    changes = tuple(at.in_omega(z)[1] for z in load_each(s, rows_of(law).z, l))
    return omega * at.c, *orders(s, l, law), *times(1.0 / omega, changes), *at.f


# Without a spring


def settle(s, l, law):
    """Let the lane's x and v be those at its load point's speed, and `note` them."""
    at = rigid.point(s, l, law, 0.0, read_rows(s, rows_of(law).y[2:], l))
    lanes.write_point(s, l, at)
    return note(s, l, law)


def lane_units(law, kind):
    """name -> functions of (s, l, law) that each vector of lanes goes through, in turn.

    kind : the class of the units
    """
    returns, events = kind is ReturnUnits, rigid if kind is RigidUnits else lanes
    step = tangent.try_step if returns else events.try_step
    taylor_step = tangent.try_taylor_step if returns else taylor_lanes.try_step
    has_taylor = has_recurrences(law) and kind is not RigidUnits

    def control(s, l, law):
        lanes.control_step(s, l)
        events.has_event(s, l, law)
        if has_taylor:
            taylor_lanes.find_calm(s, l, law)

    of_return = [tangent.commit_lane] if returns else []
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
    """The units of a law as functions of Python, which the control calls as it calls machine code.

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
