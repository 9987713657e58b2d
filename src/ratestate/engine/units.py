"""Code written for a law: all that depends on it, as functions of a lane.

Units of lanes run over whole vectors.  Units of one lane have input and output numbers, as their
docstrings say.  `code` turns these functions into machine code; they also run as plain Python.
"""

from collections import namedtuple
from typing import Any

import numpy as np

from ..friction.functions import expm1, larger, smaller, sqrt, where
from ..friction.tuples import dot, grouped, plus, times, total
from . import lanes, rigid, tangent, taylor, waveform
from . import rows as R
from .model import NOT_FINITE, RUNAWAY, SLAVED
from .rows import OUTPUT, load_each, read_rows, rows_of, write_rows

#: addresses of a law's units for a march on a spring; 0 if the law has no such unit
MarchUnits = namedtuple(
    "MarchUnits",
    "step taylor commit first_step state force v_extremes "
    "begin speed lead check_runaway "  # only on a spring
    "refresh "  # only without a spring, or if normal stress varies
    "enter_stress stress_jump excess_stress",  # only if normal stress varies
)


class RigidUnits(MarchUnits):
    """Units for a march of a slider that moves with its load point (rigid.py)."""


#: addresses of a law's units for a return map
ReturnUnits = namedtuple(
    "ReturnUnits",
    "step taylor commit begin first_step force speed lead check_runaway "
    "add_rodas5p add_taylor move_to_section speed_derivatives speed_derivatives_taylor outcome",
)


#: w_lp that stands for rest, since ln 0 is not a number
REST_SPEED = 1e-300


def refresh(s, l, law):
    """Compute the lane's speed and exponentials from its state; update the extremes."""
    at = lanes.read_point(s, l, law)
    at = at.at(at.y)
    lanes.write_point(s, l, at)
    for row, x in lanes.extremes(s, l, at).items():
        s[row + l] = x
    return ()


def begin(s, l, law):
    """Call `refresh`, and lower the speed limit to one that the law can resolve."""
    refresh(s, l, law)
    p = read_rows(s, rows_of(law).p, l)
    s[R.V_LIMIT + l] = law.largest_resolved_v(s[R.V_LIMIT + l], p)
    return ()


def first_step(s, l, law):
    """Choose a first step that is short compared with changes of state or loading."""
    at, w_lp = lanes.read_point(s, l, law), s[R.W_LP + l]
    fastest = abs(at.x_rate(w_lp)) + total(map(abs, at.f)) + at.c + abs(w_lp)
    fastest = fastest + total(map(abs, at.N_drift))
    h = 0.1 * sqrt(sqrt(s[R.TOLERANCE + l])) / fastest
    s[R.H + l], s[R.MEMORY + l] = smaller(s[R.BREAKPOINT + l] - s[R.T + l], h), 1.0
    return ()


def state(s, l, law, fraction):
    """Return x, v and each psi at a fraction of the step."""
    y, _ = lanes.evaluate_dense_output(s, l, rows_of(law).c, fraction)
    return y


def force(s, l, law, fraction, *weights):
    """Return a weighted sum of x, S, N and R at a fraction of the step; its slope."""
    h, (y, dy) = s[R.H_USED + l], lanes.evaluate_dense_output(s, l, rows_of(law).c, fraction)
    at = lanes.read_point(s, l, law).at(y, fraction * h)
    return dot(weights, at.forces), dot(weights, at.changes_of_forces(at.in_omega(dy), h))


def speed(s, l, law, fraction):
    """Return `Point.speed_measure` at a fraction of the step, and its slope."""
    if not law.reverses:
        (v,), (slope,) = lanes.evaluate_dense_output(s, l, rows_of(law).c[1:2], fraction)
        return v, slope
    y, dy = lanes.evaluate_dense_output(s, l, rows_of(law).c, fraction)
    at = lanes.read_point(s, l, law).at(y)
    return at.w, at.c * at.in_omega(dy)[1]


def lead(s, l, law, fraction, w_lp, change):
    """Return v at a fraction of the step, and its excess over v at the load point's speed.

    w_lp, change : the load point's speed at the start of the step, and its change in the step
    """
    (_, v, *psi), _ = lanes.evaluate_dense_output(s, l, rows_of(law).c, fraction)
    w_lp = w_lp + fraction * change
    if not law.reverses:
        w_lp = larger(w_lp, REST_SPEED)
    return v, v - law.v_at(w_lp, psi, read_rows(s, rows_of(law).p, l))


def check_runaway(s, l, law):
    """End a lane's case beyond its speed limit, unless the motion will turn back.

    The status becomes RUNAWAY, or NOT_FINITE if the law cannot follow the motion (`law.must_stop`).
    """
    at = lanes.read_point(s, l, law, True)
    v, kappa = at.log_jump_rate, law.stiffness(at.kappa, at.p)
    runs_away = law.runs_away(v, at.psi, kappa, at.p) | law.weakens_faster_than_spring(at, kappa)
    status = where(law.must_stop(v, at.p), float(NOT_FINITE), s[R.STATUS + l])
    s[R.STATUS + l] = where(runs_away, float(RUNAWAY), status)
    return ()


def v_extremes(s, l, law):
    """Return v of the largest and of the smallest speed so far, at psi = 0."""
    order, psi = (s[R.V_HIGH + l], s[R.V_LOW + l]), law.reference_state
    if not law.reverses:
        return order
    p = read_rows(s, rows_of(law).p, l)
    return tuple(law.v_at(v, psi, p) for v in order)


# Units for varying normal stress


def enter_stress(s, l, law, start, rate):
    """Set sigma (without sinusoid) and its rate; return the ratio s before and after."""
    rows = rows_of(law)
    p = read_rows(s, rows.p, l)
    p_new = law.at_time(p, start, rate, p[law.PHASE])
    write_rows(s, rows.history, l, law.history(p_new))
    return p[law.S], p_new[law.S]


def stress_jump(s, l, law, rise):
    """Change psi as a jump of ln s by `rise` at constant V does; return v at this V.

    R changes in proportion to the jumps of psi, which depend on R: hence the exponential.
    """
    at = lanes.read_point(s, l, law)
    growth = rise * at.jump_growth
    grows = abs(growth) > 0.0
    effective = rise * where(grows, expm1(growth) / where(grows, growth, 1.0), 1.0)
    psi = plus(at.psi, times(effective, at.jumps))
    write_rows(s, rows_of(law).y[2:], l, psi)
    return (law.v_at(at.w, psi, at.p) if law.reverses else at.v,)


def excess_stress(s, l, law, v):
    """Return x - S at another v, the speed's logarithm, and 1 if it would run away."""
    at = lanes.read_point(s, l, law)
    at = at.at((at.x, v, *at.psi))
    kappa = law.stiffness(at.kappa, at.p)
    runs_away = law.runs_away(at.log_jump_rate, at.psi, kappa, at.p)
    return at.g, at.log_jump_rate, where(runs_away, 1.0, 0.0)


# Units for a return map, whose load point moves at a speed of 1


def d_omega(at):
    """Return d omega/dT, without inertia if G is more accurate so (`model.SLAVED`)."""
    by_omega, size = abs(at.S_slopes[0]), larger(at.eta0, abs(at.g))
    drive, unit = at.acceleration(1.0, (at.eta0 <= 0.0) | (size < SLAVED * sqrt(by_omega / at.c)))
    return drive / unit


def move_to_section(s, l, law):
    """Move the end of a step that was cut at a crossing onto the section."""
    at = lanes.read_point(s, l, law, True)
    dt = -(at.v - law.v_at(1.0, at.psi, at.p)) / d_omega(at)
    psi = plus(at.psi, times(dt, at.f))
    # dx/dT falls to 0 at the section, so its mean over dt is half of its value
    end = at.at((at.x + 0.5 * at.x_rate(1.0) * dt, law.v_at(1.0, psi, at.p), *psi))
    lanes.write_point(s, l, end, True)
    s[R.W_NEW + l], s[R.H_USED + l] = 1.0, s[R.H_USED + l] + dt
    return ()


def v_changes(at, z):
    """Return the change by each perturbation z of v at psi = 0 and the same speed."""
    return times(at.reference_v_slope, tuple(at.in_omega(change)[1] for change in z))


def speed_derivatives(s, l, law, fraction):
    """Return `v_changes` at a fraction of the step, by a Rodas5P step up to there."""
    end, z, _, _, _ = tangent.step_from_lane(s, l, law, fraction * s[R.H_USED + l])
    return v_changes(end, z)


def speed_derivatives_taylor(s, l, law, fraction):
    """Return `v_changes` at a fraction of a Taylor step, by its dense output."""
    y, _ = lanes.evaluate_dense_output(s, l, rows_of(law).c, fraction)
    z, _ = lanes.evaluate_dense_output(s, l, rows_of(law).c_z, fraction)
    return v_changes(lanes.read_point(s, l, law).at(y), grouped(z, y))


def outcome(s, l, law):
    """Return G; v of the largest and smallest speed; shifts to the section; d psi/dT."""
    at = lanes.read_point(s, l, law)
    omega = d_omega(at)
    changes = tuple(at.in_omega(z)[1] for z in load_each(s, rows_of(law).z, l))
    return omega * at.c, *v_extremes(s, l, law), *times(1.0 / omega, changes), *at.f


# Units for a slider without a spring


def refresh_rigid(s, l, law):
    """Set the lane's x and v from its load point's speed, and call `refresh`."""
    at = rigid.point(s, l, law, 0.0, read_rows(s, rows_of(law).y[2:], l))
    lanes.write_point(s, l, at)
    return refresh(s, l, law)


def lane_units(law, kind):
    """Return name -> functions of (s, l, law) that run in turn on vectors of lanes."""
    returns, events = kind is ReturnUnits, rigid if kind is RigidUnits else lanes
    step = tangent.try_step if returns else events.try_step
    taylor_step = tangent.try_taylor_step if returns else taylor.try_step
    has_taylor = law.has_recurrences and kind is not RigidUnits

    def control(s, l, law):
        lanes.control_step(s, l)
        events.flag_events(s, l, law)
        if has_taylor:
            taylor.choose_method(s, l, law)

    commit_tangent = [tangent.commit_lane] if returns else []
    slow = [waveform.set_slow_part] if returns else []
    units = {"step": [step, control, *slow], "commit": [lanes.commit_lane, *commit_tangent]}
    if has_taylor:
        units["taylor"] = [taylor_step, lanes.flag_events, *slow]
    if returns:
        units["add_rodas5p"] = [waveform.add_rodas5p]
    if returns and has_taylor:
        units["add_taylor"] = [waveform.add_taylor]
    return units


def point_units(law, kind):
    """Return name -> a function of (s, l, law, *inputs), and its number of inputs."""
    units: dict[str, Any] = {"first_step": (first_step, 0)}
    if kind is RigidUnits:
        units |= {"refresh": (refresh_rigid, 0), "force": (rigid.force, 5)}
    else:
        units |= {"begin": (begin, 0), "check_runaway": (check_runaway, 0)}
        units |= {"force": (force, 5), "speed": (speed, 1), "lead": (lead, 3)}
    if kind is ReturnUnits:
        units |= {"move_to_section": (move_to_section, 0)}
        units |= {"speed_derivatives": (speed_derivatives, 1), "outcome": (outcome, 0)}
        if law.has_recurrences:
            units["speed_derivatives_taylor"] = speed_derivatives_taylor, 1
        return units
    units["state"] = rigid.state if kind is RigidUnits else state, 1
    units["v_extremes"] = v_extremes, 0
    if rows_of(law).history:
        units |= {"enter_stress": (enter_stress, 2), "stress_jump": (stress_jump, 1)}
        units["excess_stress"] = excess_stress, 1
        units.setdefault("refresh", (refresh, 0))
    return units


def unit_names(law, kind):
    """Return the names of a law's units; kind : the class of the units."""
    return [*lane_units(law, kind), *point_units(law, kind)]


def in_python(law, kind):
    """Return a law's units as Python functions that are called like machine code."""
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
        output = body(s, l, law, *work[:count])
        work[OUTPUT : OUTPUT + len(output)] = output

    return unit
