"""What happens inside a step of a return map that the step control accepts, by dense output.

A step that holds a crossing of the section is taken back, and repeated to end there: so the map
is as accurate as the steps are.
"""

import math

from . import rows as R
from .dense_output import components, polynomial
from .equations import exponentials_alone, inertial_force
from .events import observe, outrun
from .extremes import crossing
from .jit import inner
from .lanes import beyond_limit, steadies, system_of
from .model import FINISHED, RUNAWAY, SLAVED, STEADY_SLIDING
from .return_lanes import changes_of_speed, step_of_lane
from .rows import rows_of
from .tuples import (
    dot,
    dot_onto,
    load_each,
    minus_dot,
    of_each,
    plus,
    read_rows,
    times,
    write_rows,
)

# V/V_lp below which a part of the cycle is slow (`slow_fraction` of `limit_cycle`), and its ln.
SLOW_BELOW, LOG_SLOW_BELOW = 0.1, -2.302585092994046
# A crossing nearer to the start of a step than this part of it is landed on by extrapolation.
NEAREST = 1e-6
# Gauss-Legendre nodes on 0..1 are 0.5 and 0.5 -+ ASIDE, of weights CENTRE and (1 - CENTRE)/2.
ASIDE, CENTRE = 0.3872983346207417, 0.4444444444444444


@inner
def rates(s, l, law, y, w, e):
    """dx/dT, dv/dT and dpsi/dT, a tuple, where the load point's speed is 1."""
    _, kappa, eta, p = system_of(s, l, law)
    f_x = kappa * (1.0 - w)
    f_psi = law.rates_in_v(y[1], w, y[2:], e, p)
    g, S_v, S_psi = inertial_force(y, w, e, law, p)
    c = law.speed_slope(w, e)
    f_omega = (f_x - dot(S_psi, f_psi)) / S_v if eta < SLAVED else g / (eta * c)
    return f_x, minus_dot(f_omega, law.shares(e, 1.0 / c, p), f_psi), *f_psi


@inner
def end_at_crossing(s, l, law):
    """Move the end of a step that was cut at a crossing onto the section, and record it."""
    rows = rows_of(law)
    y = read_rows(s, rows.y_new, l)
    e, p = read_rows(s, rows.e_new, l), read_rows(s, rows.p, l)
    speeds = rates(s, l, law, y, s[R.W_NEW + l], e)
    shares = law.shares(e, 1.0 / law.speed_slope(s[R.W_NEW + l], e), p)
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
    s[R.EVERY_STEP + l] = s[R.OBSERVE + l]
    if omega > 0.0:
        s[R.STATUS + l] = FINISHED
    else:
        s[R.X_LOW + l] = s[R.X_NEW + l]
        write_rows(s, rows.x_low, l, of_each(load_each(s, rows.z_new, l), 0))


@inner
def observe_step(s, l, law, c):
    """`observe`, with the derivatives of what it finds of V, and the waveform.

    They are those of V at that time: where it is extreme, a shift along the orbit does not count.
    Where V stops falling at once, as at a sudden arrest, they are good to some ten per cent.
    """
    rows = rows_of(law)
    high, low = s[R.V_HIGH + l], s[R.V_LOW + l]
    at = observe(s, l, law, c)
    if s[R.V_HIGH + l] > high:
        write_rows(s, rows.v_high, l, perturbed(s, l, law, at * s[R.H_USED + l]))
    elif s[R.V_LOW + l] < low:
        write_rows(s, rows.v_low, l, perturbed(s, l, law, at * s[R.H_USED + l]))
    record_waveform(s, l, law, c)


@inner
def perturbed(s, l, law, h):
    """The perturbations of the speed, as of `v_of_order`, a time h after the start of the step."""
    new, z, _, _, _ = step_of_lane(s, l, law, h)
    y, w, e = new
    p = read_rows(s, rows_of(law).p, l)
    shares = law.shares(e, 1.0 / law.speed_slope(w, e), p)
    return times(law.order_slope(w, y[2:], e, p), changes_of_speed(z, shares))


@inner
def record_waveform(s, l, law, c):
    """Add the step to the time spent below V_lp/10 (SLOW) and to the integrals of the stress."""
    h = s[R.H_USED + l]
    slow, slow_before = s[R.W_NEW + l] < SLOW_BELOW, s[R.W + l] < SLOW_BELOW
    part = 1.0 if slow else 0.0
    if slow != slow_before:
        p = read_rows(s, rows_of(law).p, l)
        at = crossing(c, (SLOW_BELOW, 0.0, LOG_SLOW_BELOW), law, p, 0.0, 1.0)
        part = 1.0 - at if slow else at
    s[R.SLOW + l] += part * h
    pace = 2.0 * math.pi / s[R.GUESS + l]
    phase = pace * (s[R.T + l] + (s[R.T_LOW + l] + 0.5 * h))
    cos, sin = math.cos(phase), math.sin(phase)
    c_aside, s_aside = math.cos(pace * ASIDE * h), math.sin(pace * ASIDE * h)
    middle = CENTRE * polynomial(c[0], 0.5)
    early, late = polynomial(c[0], 0.5 - ASIDE), polynomial(c[0], 0.5 + ASIDE)
    weight = 0.5 - 0.5 * CENTRE
    total, skew = weight * (late + early), weight * (late - early)
    s[R.MEAN + l] += h * (middle + total)
    s[R.SQUARE + l] += h * (middle * middle / CENTRE + weight * (early * early + late * late))
    s[R.COSINE + l] += h * (cos * (middle + total * c_aside) - sin * skew * s_aside)
    s[R.SINE + l] += h * (sin * (middle + total * c_aside) + cos * skew * s_aside)


@inner
def handle_events(s, l, law):
    """Record what happens in the lane's step, or take it back, to end it at a crossing."""
    c = components(s, l, law)
    landing_step = s[R.LANDING_STEP + l]
    if landing_step > 0.0 and s[R.H_USED + l] >= landing_step:
        if s[R.OBSERVE + l] > 0.0:
            observe_step(s, l, law, c)
        end_at_crossing(s, l, law)
        return
    s[R.LANDING_STEP + l] = 0.0
    rises = s[R.W_NEW + l] >= 1.0
    if (s[R.W + l] < 1.0) == rises and s[R.SINCE + l] > 0.0:
        p = read_rows(s, rows_of(law).p, l)
        at = max(crossing(c, (1.0, 0.0, 0.0), law, p, 0.0, 1.0), NEAREST)
        s[R.H_PLANNED + l] = s[R.H_NEXT + l]
        s[R.H_NEXT + l] = s[R.LANDING_STEP + l] = at * s[R.H_USED + l]
        s[R.EVERY_STEP + l], s[R.OK + l] = 1.0, 0.0
        return
    s[R.EVERY_STEP + l] = s[R.OBSERVE + l]
    if s[R.OBSERVE + l] > 0.0:
        observe_step(s, l, law, c)
    if beyond_limit(s, l, law):
        # Where steady sliding is unstable what turns back once more runs away at last.
        if s[R.UNSTABLE + l] > 0.0:
            s[R.STATUS + l] = RUNAWAY
        else:
            outrun(s, l, law)
    elif steadies(s, l, law):
        s[R.STATUS + l] = STEADY_SLIDING
