"""What happens inside an accepted step, read off its dense output.

Where V = V_lp the spring stress is extreme, because dx/dT = kappa (w_lp - w).  An upward
crossing is a stress maximum and closes a cycle; a downward one is its minimum.
"""

from . import rows as R
from .dense_output import components, polynomial
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


@inner
def observe(s, l, law, c):
    """Extremes of V, |g|, f and x + N inside the step; `commit` sees to its end.

    Returns where in the step, 0 to 1, V has one, or -1.

    c : the polynomials of x, v and psi
    """
    p, h = read_rows(s, rows_of(law).p, l), s[R.H_USED + l]
    v_extremum, g_extremum, f_extremum, xf_extremum = extrema(s, l, law)
    at = -1.0
    if v_extremum:
        at, v = extreme_speed(c, law, p)
        s[R.V_HIGH + l] = max(s[R.V_HIGH + l], v)
        s[R.V_LOW + l] = min(s[R.V_LOW + l], v)
    if g_extremum:
        s[R.G_HIGH + l] = max(s[R.G_HIGH + l], abs(extreme_value(c, INERTIAL_FORCE, h, law, p)))
    if f_extremum:
        s[R.F_LOW + l] = min(s[R.F_LOW + l], extreme_value(c, FRICTION, h, law, p))
    if xf_extremum:
        s[R.XF_LOW + l] = min(s[R.XF_LOW + l], extreme_value(c, WITH_STRENGTH, h, law, p))
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
def handle_events(s, l, law):
    """Everything of interest in the lane's accepted step, before it is committed."""
    c = components(s, l, law)
    h, w_lp = s[R.H_USED + l], s[R.W_LP + l]
    dw = h * s[R.RAMP + l]
    if s[R.OBSERVE + l] > 0.0:
        observe(s, l, law, c)
    rises = s[R.W_NEW + l] >= w_lp + dw
    if (s[R.W + l] < w_lp) == rises:
        p = read_rows(s, rows_of(law).p, l)
        at = crossing(c, w_lp, dw, s[R.LOG_W_LP + l], law, p)
        if rises:
            close_cycle(s, l, law, s[R.T_LOW + l] + at * h, polynomial(c[0], at))
        else:
            s[R.X_LOW + l] = polynomial(c[0], at)
    if beyond_limit(s, l, law):
        outrun(s, l, law)
