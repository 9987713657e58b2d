"""What happens inside an accepted step, read off its dense output.

Where V = V_lp the spring stress is extreme, because dx/dT = kappa (w_lp - w).  An upward
crossing is a stress maximum and closes a cycle; a downward one is its minimum.
"""

from . import rows as R
from .dense_output import component, state
from .equations import speed_alone
from .extremes import (
    FRICTION,
    INERTIAL_FORCE,
    WITH_STRENGTH,
    crossing,
    extreme_speed,
    extreme_value,
)
from .jit import inner
from .lanes import beyond_limit, extrema
from .model import NOT_FINITE, RUNAWAY
from .periodicity import close_cycle
from .rows import rows_of
from .tuples import read_rows

#: by how much extreme forces may be off, over the tolerance of a step
ENOUGH = 0.01


@inner
def observe(s, l, law):
    """Extremes of V, |g|, f and x + N inside the step; `commit` sees to its end.

    Returns where in the step, 0 to 1, V has one, or -1.
    """
    enough = ENOUGH * s[R.TOLERANCE + l]
    v_extremum, g_extremum, f_extremum, xf_extremum = extrema(s, l, law)
    at = -1.0
    if v_extremum:
        at, v = extreme_speed(s, l, law)
        s[R.V_HIGH + l] = max(s[R.V_HIGH + l], v)
        s[R.V_LOW + l] = min(s[R.V_LOW + l], v)
    # in one place, so that threads of a GPU that search for unlike forces do it side by side
    while g_extremum or f_extremum or xf_extremum:
        parts = INERTIAL_FORCE if g_extremum else FRICTION if f_extremum else WITH_STRENGTH
        force = extreme_value(s, l, law, parts, enough)
        if g_extremum:
            s[R.G_HIGH + l], g_extremum = max(s[R.G_HIGH + l], abs(force)), False
        elif f_extremum:
            s[R.F_LOW + l], f_extremum = min(s[R.F_LOW + l], force), False
        else:
            s[R.XF_LOW + l], xf_extremum = min(s[R.XF_LOW + l], force), False
    return at


@inner
def outrun(s, l, law):
    """End the case of a lane beyond its limit of speed, unless the motion will turn back.

    Its status is then RUNAWAY or, where it is lost, NOT_FINITE.
    """
    rows = rows_of(law)
    y, p = read_rows(s, rows.y_new, l), read_rows(s, rows.p, l)
    v, kappa = law.log_of_faster(y[1], y[2:], p), law.stiffness(s[R.KAPPA + l], p)
    w, e = s[R.W_NEW + l], read_rows(s, rows.e_new, l)
    if law.runs_away(v, y[2:], kappa, p) or law.outruns_spring(v, w, y[2:], e, kappa, p):
        s[R.STATUS + l] = RUNAWAY
    elif law.is_lost(v, p):
        s[R.STATUS + l] = NOT_FINITE


@inner
def cross(s, l, law, rises, low, high):
    """Record that V crosses V_lp from low to high in the step: a maximum of stress if it rises."""
    h, of_x = s[R.H_USED + l], rows_of(law).c[0]
    load = s[R.W_LP + l], h * s[R.RAMP + l], s[R.LOG_W_LP + l]
    at = crossing(s, l, law, load, low, high)
    x = component(s, l, of_x, at)
    if rises:
        close_cycle(s, l, law, s[R.T_LOW + l] + at * h, x)
    else:
        s[R.X_LOW + l] = x


@inner
def handle_events(s, l, law):
    """Everything of interest in the lane's accepted step, before it is committed."""
    w_lp, dw = s[R.W_LP + l], s[R.H_USED + l] * s[R.RAMP + l]
    at = -1.0  # where V is extreme
    if s[R.OBSERVE + l] > 0.0:
        at = observe(s, l, law)
    elif s[R.GRAZES + l] > 0.0:
        at, _ = extreme_speed(s, l, law)
    above = s[R.W_NEW + l] >= w_lp + dw
    if (s[R.W + l] < w_lp) == above:
        cross(s, l, law, above, 0.0, 1.0)
    elif at > 0.0:
        w, _ = speed_alone(state(s, l, law, at), law, read_rows(s, rows_of(law).p, l))
        if (w < w_lp + dw * at) == above:  # there and back
            cross(s, l, law, not above, 0.0, at)
            cross(s, l, law, above, at, 1.0)
    if beyond_limit(s, l, law):
        outrun(s, l, law)
