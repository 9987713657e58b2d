"""What happens inside an accepted step, read off its dense output.

Where V = V_lp the spring stress is extreme, because dx/dT = kappa (w_lp - w).  An upward
crossing is a stress maximum and closes a cycle; a downward one is its minimum.

The dense output of a step are polynomials in the fraction of the step that is over, 0 to 1.  Their
coefficients, the constant first, stand in rows of the lane buffer: of degree 4 after a step of
Rodas5P, of `taylor.ORDER` after one of the Taylor method.
"""

from ..friction.functions import log
from . import rows as R
from .periodicity import close_cycle
from .rows import FOUND, call_point

#: by how much extreme forces may be off, over the tolerance of a step
ENOUGH = 0.01
#: what `of_step` finds
FORCE, SPEED, LEAD = 0, 1, 2
# Parts of x, the stress S that opposes motion, the strength N and friction R: `units.force`.
NONE, INERTIAL_FORCE, FRICTION = (0.0, 0.0, 0.0, 0.0), (1.0, -1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)
WITH_STRENGTH = (1.0, 0.0, 1.0, 0.0)
NO_LOAD = (0.0, 0.0)
#: a speed of the load point that stands for rest
LEAST = 1e-300


def component(run, l, i, at):
    """Number i of (x, v, psi...) at a place in the lane's step, and its derivative by the place."""
    s, shape = run.s, run.shape
    row = shape.c + i * shape.terms * R.LANES + l
    last = (shape.terms if s[R.TAYLOR + l] > 0.0 else R.OF_RODAS5P) - 1
    y, dy = s[row + last * R.LANES], 0.0
    for k in range(1, last + 1):
        dy = y + at * dy
        y = s[row + (last - k) * R.LANES] + at * y
    return y, dy


def state_at(run, l, at, work, place):
    """Put x, v and each psi at a place in the lane's step into `work`, and their derivatives."""
    n = 2 + run.shape.states
    for i in range(n):
        work[place + i], work[place + n + i] = component(run, l, i, at)


def of_step(run, l, what, parts, load, at):
    """A number at a place in the lane's step, and what is to vanish where `root` finds it.

    =====  ==========================================================================
    FORCE  a sum of parts of x, S, N and R, and its slope
    SPEED  the speed, as of `kinematics.order_of_speed`, and its slope
    LEAD   the same, and how far v is ahead of the load point's, of which `load` holds
           the speed at the start of the step and its change in the step
    =====  ==========================================================================
    """
    work = run.work
    if what == FORCE:
        work[0] = at
        work[1], work[2], work[3], work[4] = parts
        state_at(run, l, at, work, 5)
        call_point(run.units.force, run.s, l, work)
        return work[FOUND], work[FOUND + 1]
    w_lp = load[0] + load[1] * at
    if run.shape.reverses == 0:
        v, slope = component(run, l, 1, at)
        return v, slope if what == SPEED else v - log(max(w_lp, LEAST))
    work[0] = w_lp
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
    return root(run, l, SPEED, NONE, NO_LOAD, 0.0, 1.0, 0.0)


def crossing(run, l, load, low, high):
    """Where from low to high the speed is the load point's, which the caller has seen it cross."""
    at, _ = root(run, l, LEAD, NONE, load, low, high, 0.0)
    return at


def observe(run, l):
    """Extremes of V, |g|, f and x + N inside the step; `commit` sees to its end.

    Returns where in the step, 0 to 1, V has one, or -1.
    """
    s = run.s
    enough, events, at = ENOUGH * s[R.TOLERANCE + l], int(s[R.EVENTS + l]), -1.0
    if events & R.V_EXTREME > 0:
        at, v = extreme_speed(run, l)
        s[R.V_HIGH + l] = max(s[R.V_HIGH + l], v)
        s[R.V_LOW + l] = min(s[R.V_LOW + l], v)
    if events & R.G_EXTREME > 0:
        force = extreme_value(run, l, INERTIAL_FORCE, enough)
        s[R.G_HIGH + l] = max(s[R.G_HIGH + l], abs(force))
    if events & R.F_EXTREME > 0:
        s[R.F_LOW + l] = min(s[R.F_LOW + l], extreme_value(run, l, FRICTION, enough))
    if events & R.XF_EXTREME > 0:
        s[R.XF_LOW + l] = min(s[R.XF_LOW + l], extreme_value(run, l, WITH_STRENGTH, enough))
    return at


def speed_at(run, l, at):
    """w at a place in the lane's step."""
    work = run.work
    work[0] = 1.0
    state_at(run, l, at, work, 1)
    call_point(run.units.speed, run.s, l, work)
    return work[FOUND]


def cross(run, l, rises, low, high):
    """Record that V crosses V_lp from low to high in the step: a maximum of stress if it rises."""
    s = run.s
    h = s[R.H_USED + l]
    at = crossing(run, l, (s[R.W_LP + l], h * s[R.RAMP + l]), low, high)
    x, _ = component(run, l, 0, at)
    if rises:
        close_cycle(run, l, s[R.T_LOW + l] + at * h, x)
    else:
        s[R.X_LOW + l] = x


def handle(run, l):
    """Everything of interest in the lane's accepted step, before it is committed."""
    s = run.s
    w_lp, dw = s[R.W_LP + l], s[R.H_USED + l] * s[R.RAMP + l]
    events, at = int(s[R.EVENTS + l]), -1.0  # where V is extreme
    if s[R.OBSERVE + l] > 0.0:
        at = observe(run, l)
    elif events & R.GRAZES > 0:
        at, _ = extreme_speed(run, l)
    if run.shape.rigid:
        return
    above = s[R.W_NEW + l] >= w_lp + dw
    if (s[R.W + l] < w_lp) == above:
        cross(run, l, above, 0.0, 1.0)
    elif at > 0.0 and (speed_at(run, l, at) < w_lp + dw * at) == above:  # there and back
        cross(run, l, not above, 0.0, at)
        cross(run, l, above, at, 1.0)
    if events & R.BEYOND > 0:
        call_point(run.units.outrun, s, l, run.work)
