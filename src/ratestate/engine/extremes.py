"""Where in a step, by its dense output, forces and speeds are extreme, and speeds cross.

Places are fractions of the step, 0 to 1.
"""

from ..friction.functions import log
from .calls import FOUND, call_point
from .dense_output import CONVERGED, component, extreme_of_v, state_at

#: what `of_step` finds: with its slope a force, or a speed; a speed less the load point's
FORCE, SPEED, LEAD = 0, 1, 2
# Parts of x, the stress S that opposes motion, the strength N and friction R: `units.force`.
NONE, INERTIAL_FORCE, FRICTION = (0.0, 0.0, 0.0, 0.0), (1.0, -1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)
WITH_STRENGTH = (1.0, 0.0, 1.0, 0.0)
NO_LOAD = (0.0, 0.0, 0.0)


def v_ahead(run, l, load, at):
    """How far v is above the load point's, and its slope; load : as of `crossing`."""
    w_lp, dw, log_w_lp = load
    v, slope, _ = component(run, l, 1, at)
    if dw == 0.0:
        return v - log_w_lp, slope
    w = w_lp + dw * at
    return v - log(w), slope - dw / w


def crossing_of_v(run, l, load, low, high):
    """Where from low to high v is ln(w_lp + dw at), of speeds > 0; load : as of `crossing`."""
    start, _ = v_ahead(run, l, load, low)
    end, _ = v_ahead(run, l, load, high)
    between = start / (start - end) if (start < 0.0) != (end < 0.0) else 0.5
    at = low + (high - low) * between
    for _ in range(60):
        ahead, slope = v_ahead(run, l, load, at)
        if (ahead < 0.0) == (start < 0.0):
            low = at
        else:
            high = at
        new = at - ahead / slope if slope != 0.0 else 2.0
        if not low < new < high:
            new = 0.5 * (low + high)
        elif abs(new - at) < CONVERGED:
            return new
        at = new
    return at


def of_step(run, l, what, parts, load, at):
    """A force, a sum of parts of x, S, N and R, or a speed, w, at a place in the lane's step.

    And what is to vanish: its slope or, of a LEAD, how far v is ahead of the load point's.
    """
    work = run.work
    if what == FORCE:
        work[0] = at
        work[1], work[2], work[3], work[4] = parts
        state_at(run, l, at, work, 5)
        call_point(run.units.force, run.s, l, work)
        return work[FOUND], work[FOUND + 1]
    work[0] = load[0] + load[1] * at
    state_at(run, l, at, work, 1)
    call_point(run.units.speed, run.s, l, work)
    return work[FOUND], work[FOUND + 1] if what == SPEED else work[FOUND + 2]


def root(run, l, what, parts, load, low, high, enough):
    """Where from low to high the second of what `of_step` gives vanishes, and the first there.

    By regula falsi (Illinois).  Where it has one sign at both ends, the end where it is smaller in
    size.

    enough : the error that the first may have, of which the second is the slope; 0 if it is not
    """
    first, at_low = of_step(run, l, what, parts, load, low)
    here, at_high = of_step(run, l, what, parts, load, high)
    if (at_low < 0.0) == (at_high < 0.0):
        return (low, first) if abs(at_low) < abs(at_high) else (high, here)
    side, at, last = 0, high, 2.0
    for _ in range(100):
        at = (low * at_high - high * at_low) / (at_high - at_low)
        here, off = of_step(run, l, what, parts, load, at)
        if off == 0.0 or abs(at - last) < 1e-14 or abs(off * (at - last)) < enough:
            break
        last = at
        if (off < 0.0) == (at_low < 0.0):
            low, at_low = at, off
            at_high = 0.5 * at_high if side == 1 else at_high
            side = 1
        else:
            high, at_high = at, off
            at_low = 0.5 * at_low if side == -1 else at_low
            side = -1
    return at, here


def extreme_value(run, l, parts, enough):
    """The value of a sum of parts where in the lane's step its slope vanishes, as of `root`."""
    _, value = root(run, l, FORCE, parts, NO_LOAD, 0.0, 1.0, enough)
    return value


def extreme_speed(run, l):
    """Where in the lane's step the speed is extreme, and its `order_of_speed`."""
    if run.shape.reverses:
        return root(run, l, SPEED, NONE, NO_LOAD, 0.0, 1.0, 0.0)
    at = extreme_of_v(run, l)
    v, _, _ = component(run, l, 1, at)
    return at, v


def crossing(run, l, load, low, high):
    """Where from low to high the speed is the load point's, which the caller has seen it cross.

    load : the load point's speed at the start of the step, its change in the step, and, if that is
        0, the logarithm of the speed
    """
    if run.shape.reverses:
        at, _ = root(run, l, LEAD, NONE, load, low, high, 0.0)
        return at
    return crossing_of_v(run, l, load, low, high)
