"""What happens inside a step of a return map that the step control accepts, by dense output.

A step that holds a crossing of the section is taken back, and repeated to end there: so the map
is as accurate as the steps are.
"""

import math

from . import rows as R
from .dense_output import state, values
from .equations import exponentials_alone, inertial_force
from .events import observe, outrun
from .extremes import crossing
from .jit import inner, recursive
from .lanes import beyond_limit, steadies, system_of
from .model import FINISHED, RUNAWAY, SLAVED, STEADY_SLIDING
from .return_lanes import changes_of_speed, step_of_lane
from .rows import rows_of
from .tuples import (
    dot,
    dot_onto,
    grouped,
    load_each,
    minus_dot,
    of_each,
    plus,
    read_rows,
    times,
    write_rows,
)
from .waveform import split

# A crossing nearer to the start of a step than this part of it is landed on by extrapolation.
NEAREST = 1e-6


@inner
def rates(s, l, law, y, w, e):
    """dx/dT, dv/dT and dpsi/dT, a tuple, if the load point's speed is 1."""
    _, kappa, eta, p = system_of(s, l, law)
    f_x = kappa * (1.0 - w)
    f_psi = law.rates_in_v(y[1], w, y[2:], e, p)
    g, S_v, S_psi = inertial_force(y, w, e, law, p)
    c = law.speed_slope(w, e)
    slaved = eta == 0.0 or max(eta, abs(g)) < SLAVED * math.sqrt(abs(S_v) / c)
    f_omega = (f_x - dot(S_psi, f_psi)) / S_v if slaved else g / (eta * c)
    return f_x, minus_dot(f_omega, law.shares(w, 1.0 / c, p), f_psi), *f_psi


@inner
def end_at_crossing(s, l, law):
    """Move the end of a step that was cut at a crossing onto the section, and record it."""
    rows = rows_of(law)
    y = read_rows(s, rows.y_new, l)
    e, p = read_rows(s, rows.e_new, l), read_rows(s, rows.p, l)
    speeds = rates(s, l, law, y, s[R.W_NEW + l], e)
    shares = law.shares(s[R.W_NEW + l], 1.0 / law.speed_slope(s[R.W_NEW + l], e), p)
    omega = dot_onto(speeds[1], shares, speeds[2:])
    dt = -(y[1] - law.v_at(1.0, y[2:], p)) / omega
    psi = plus(y[2:], dt, speeds[2:])
    # (dx/dT vanishes at the section)
    end = (y[0] + 0.5 * speeds[0] * dt, law.v_at(1.0, psi, p), *psi)
    write_rows(s, rows.y_new, l, end)
    _, e = exponentials_alone(end, law, p)
    s[R.W_NEW + l] = 1.0
    write_rows(s, rows.e_new, l, e)
    s[R.H_USED + l] += dt
    s[R.H_NEXT + l] = s[R.H_PLANNED + l]
    s[R.LANDING_STEP + l], s[R.SINCE + l] = 0.0, -1.0  # 0 once this step is committed
    s[R.EVERY_STEP + l] = 0.0
    if s[R.W + l] < 1.0:  # it rises
        s[R.STATUS + l] = FINISHED
    else:
        s[R.X_LOW + l] = s[R.X_NEW + l]
        write_rows(s, rows.x_low, l, of_each(load_each(s, rows.z_new, l), 0))


@inner
def observe_step(s, l, law):
    """`observe`, with the derivatives of what it finds of V.

    They are those of V at that time: where it is extreme, a shift along the orbit does not count.
    Where V stops falling at once, as at a sudden arrest, they hang on where in the step that is
    thought to be, and may be off by a factor of 4.
    """
    rows = rows_of(law)
    high, low = s[R.V_HIGH + l], s[R.V_LOW + l]
    at = observe(s, l, law)
    if s[R.V_HIGH + l] > high:
        write_rows(s, rows.v_high, l, perturbed(s, l, law, at))
    elif s[R.V_LOW + l] < low:
        write_rows(s, rows.v_low, l, perturbed(s, l, law, at))


@recursive
def inside(rows, s, l, law, at):
    """The state, its w and e, and the perturbations at a place in the step.

    By the dense output of the Taylor method; that of Rodas5P has none of perturbations, and its
    step is repeated.

    rows : c_z
    """
    if len(rows) == 0:
        return by_rodas5p(s, l, law, at)
    if s[R.TAYLOR + l] > 0.0:
        y = state(s, l, law, at)
        w, e = exponentials_alone(y, law, read_rows(s, rows_of(law).p, l))
        return (y, w, e), grouped(values(load_each(s, rows, l), at), y)
    return by_rodas5p(s, l, law, at)


@inner
def by_rodas5p(s, l, law, at):
    """`inside`, by a step that ends there."""
    new, z, _, _, _ = step_of_lane(s, l, law, at * s[R.H_USED + l])
    return new, z


@inner
def perturbed(s, l, law, at):
    """The perturbations of the speed, as of `v_of_order`, where in the step it is at, 0 to 1."""
    (y, w, e), z = inside(rows_of(law).c_z, s, l, law, at)
    p = read_rows(s, rows_of(law).p, l)
    shares = law.shares(w, 1.0 / law.speed_slope(w, e), p)
    return times(law.order_slope(w, y[2:], e, p), changes_of_speed(z, shares))


@inner
def handle_events(s, l, law):
    """Record what happens in the lane's step, or take it back, to end it at a crossing."""
    split(s, l, law)
    landing_step = s[R.LANDING_STEP + l]
    if landing_step > 0.0 and s[R.H_USED + l] >= landing_step:
        if s[R.OBSERVE + l] > 0.0:
            observe_step(s, l, law)
        end_at_crossing(s, l, law)
        return
    s[R.LANDING_STEP + l] = 0.0
    rises = s[R.W_NEW + l] >= 1.0
    if (s[R.W + l] < 1.0) == rises and s[R.SINCE + l] > 0.0:
        at = max(crossing(s, l, law, (1.0, 0.0, 0.0), 0.0, 1.0), NEAREST)
        s[R.H_PLANNED + l] = s[R.H_NEXT + l]
        s[R.H_NEXT + l] = s[R.LANDING_STEP + l] = at * s[R.H_USED + l]
        s[R.EVERY_STEP + l], s[R.OK + l], s[R.CHANGES + l] = 1.0, 0.0, 0.0
        return
    s[R.EVERY_STEP + l] = 0.0
    if s[R.OBSERVE + l] > 0.0:
        observe_step(s, l, law)
    if beyond_limit(s, l, law):
        # Where steady sliding is unstable what turns back once more runs away at last.
        if s[R.UNSTABLE + l] > 0.0:
            s[R.STATUS + l] = RUNAWAY
        else:
            outrun(s, l, law)
    elif steadies(s, l, law):
        s[R.STATUS + l] = STEADY_SLIDING
