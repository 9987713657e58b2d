"""What happens inside an accepted step, read off its dense output.

Where V = V_lp the spring stress is extreme, because dx/dT = kappa (w_lp - w).  An upward
crossing is a stress maximum and closes a cycle; a downward one is its minimum.
"""

from . import rows as R
from .calls import FOUND, call_point
from .dense_output import component, state_at
from .extremes import (
    FRICTION,
    INERTIAL_FORCE,
    WITH_STRENGTH,
    crossing,
    extreme_speed,
    extreme_value,
)
from .periodicity import close_cycle

#: by how much extreme forces may be off, over the tolerance of a step
ENOUGH = 0.01


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
    load = s[R.W_LP + l], h * s[R.RAMP + l], s[R.LOG_W_LP + l]
    at = crossing(run, l, load, low, high)
    x, _, _ = component(run, l, 0, at)
    if rises:
        close_cycle(run, l, s[R.T_LOW + l] + at * h, x)
    else:
        s[R.X_LOW + l] = x


def handle_events(run, l):
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
