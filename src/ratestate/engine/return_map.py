"""The return map: from a point of the section V = V_lp to the next, with its derivative.

Speeds are in units of a constant V_lp and times in Dc/V_lp, so the section is v = 0.  On it dx/dT
vanishes: an upward crossing is a maximum of the stress and the point to return to, a downward
one its minimum.  A step that holds a crossing is cut to end there, so that the map is as
accurate as the steps are.
"""

import math
from collections import namedtuple
from typing import NamedTuple

import numpy as np

from ..friction.laws import AGING, SLIP
from . import lanes as L
from . import rows as R
from .events import components, crossing, observe, outrun, polynomial
from .exp import exp_alone
from .jit import inlined, inner, kernel, lanewise
from .lanes import steadies
from .march import IDLE, choose_first_step, fill, next_case, stuck
from .model import FINISHED, RUNAWAY, RUNNING, STEADY_SLIDING, state_rate
from .tangent import step as tangent_step

# Below this eta, G = dv/dT on the section is better known as -beta dpsi/dT, which it is to within
# eta of itself, than from x - beta psi, whose rounding is divided by eta.
SLAVED = 1e-7
# ln(V/V_lp) below which the slider counts as sticking.
STICKING = -2.302585092994046
# A crossing nearer to the start of a step than this part of it is landed on by extrapolation.
NEAREST = 1e-6
# Gauss-Legendre nodes on 0..1 are 0.5 and 0.5 -+ ASIDE, of weights CENTRE and (1 - CENTRE)/2.
ASIDE, CENTRE = 0.3872983346207417, 0.4444444444444444


class Starts(NamedTuple):
    """From where each slider sets out; arrays of one value a case unless a shape is given."""

    kappa: np.ndarray
    beta: np.ndarray
    eta: np.ndarray
    y: np.ndarray  # (n, 3) x, v, psi
    along: np.ndarray  # (n, 2, 3) two perturbations of it
    rtol: np.ndarray
    steady_tol: np.ndarray
    observe: np.ndarray  # 1 where extremes and waveform are wanted
    period: np.ndarray  # assumed for the waveform
    v_limit: np.ndarray  # ln(V/V_lp) beyond which an orbit that does not turn back has run away
    max_steps: np.ndarray


class Returns(NamedTuple):
    """Where each slider came back to the section, and what happened on the way."""

    numbers: np.ndarray  # (n, len(RETURN_NUMBERS))
    status: np.ndarray  # (n,) int8


#: _a and _b: derivatives along the two perturbations
Numbers = namedtuple(
    "Numbers",
    "period x psi G x_low period_a x_a psi_a x_low_a period_b x_b psi_b x_low_b trace v_max v_min "
    "g_max slow mean square cosine sine steps v_max_a v_max_b v_min_a v_min_b f_min xf_min",
)
RETURN_NUMBERS = Numbers._fields


def empty_returns(n):
    """`Returns` of n cases that are to run."""
    return Returns(np.full((n, len(RETURN_NUMBERS)), np.nan), np.full(n, RUNNING, np.int8))


@inlined
def step_of_lane(s, l, law, h):
    """What `tangent.step` gives for a step of size h from where the lane is."""
    y = (s[R.X + l], s[R.V + l], s[R.PSI + l])
    a = (s[R.X_A + l], s[R.V_A + l], s[R.PSI_A + l])
    b = (s[R.X_B + l], s[R.V_B + l], s[R.PSI_B + l])
    p = (law, s[R.KAPPA + l], s[R.BETA + l], s[R.ETA0 + l])
    return tangent_step(y, s[R.W + l], s[R.E + l], a, b, 1.0, h, p)


@inlined
def try_step(s, l, law):
    """Try one step of the lane, perturbations included, and record its outcome."""
    h = s[R.H + l]
    new, a_new, b_new, error, dense, s[R.D_TRACE + l] = step_of_lane(s, l, law, h)
    s[R.X_A_NEW + l], s[R.V_A_NEW + l], s[R.PSI_A_NEW + l] = a_new
    s[R.X_B_NEW + l], s[R.V_B_NEW + l], s[R.PSI_B_NEW + l] = b_new
    L.record(s, l, h, new, error, dense)


@lanewise
def advance(s, law, n):
    """Try one step in the first n lanes, accept or reject it, and see whether it holds events."""
    if law == SLIP:
        for l in range(n):
            try_step(s, l, SLIP)
    else:
        for l in range(n):
            try_step(s, l, AGING)
    L.assess(s, law, n)


@inlined
def commit_lane(s, l, law):
    """`lanes.commit_lane` for what a return map adds, once that is done.

    A perturbation along the orbit is a shift in time.  It grows and shrinks with the speed of the
    state, by twenty orders of magnitude in a stick-slip cycle, and would take all digits of the
    rest: it is taken out after each step.

    ================  ===================================================
    f_x, f_v, f_psi   speed of the state, d/dT
    pace              the largest of these; r_x, r_v, r_psi: their parts of it
    a_x, ...; b_x     the two perturbations after the step
    along_a, along_b  what they have along the orbit, over pace
    ================  ===================================================
    """
    ok = s[R.OK + l] > 0.0
    beta, w = s[R.BETA + l], s[R.W + l]
    x, v, psi = s[R.X + l], s[R.V + l], s[R.PSI + l]
    f_x = s[R.KAPPA + l] * (1.0 - w)
    f_psi = state_rate(law, w, v, psi, s[R.E + l])
    g = x - v - beta * psi
    rounding = 1e-13 * (abs(x) + abs(v) + abs(beta * psi))
    m = s[R.ETA0 + l] * w
    f_v = f_x - beta * f_psi if (abs(g) <= rounding) | (m == 0.0) else g / m
    pace = max(max(abs(f_x), abs(f_v)), max(abs(f_psi), 1e-300))
    r_x, r_v, r_psi = f_x / pace, f_v / pace, f_psi / pace
    share = 1.0 / (r_x * r_x + r_v * r_v + r_psi * r_psi)
    a_x, a_v, a_psi = s[R.X_A_NEW + l], s[R.V_A_NEW + l], s[R.PSI_A_NEW + l]
    b_x, b_v, b_psi = s[R.X_B_NEW + l], s[R.V_B_NEW + l], s[R.PSI_B_NEW + l]
    along_a = share * (a_x * r_x + a_v * r_v + a_psi * r_psi)
    along_b = share * (b_x * r_x + b_v * r_v + b_psi * r_psi)
    s[R.X_A + l] = a_x - along_a * r_x if ok else s[R.X_A + l]
    s[R.V_A + l] = a_v - along_a * r_v if ok else s[R.V_A + l]
    s[R.PSI_A + l] = a_psi - along_a * r_psi if ok else s[R.PSI_A + l]
    s[R.X_B + l] = b_x - along_b * r_x if ok else s[R.X_B + l]
    s[R.V_B + l] = b_v - along_b * r_v if ok else s[R.V_B + l]
    s[R.PSI_B + l] = b_psi - along_b * r_psi if ok else s[R.PSI_B + l]
    s[R.EARLY_A + l] += along_a / pace if ok else 0.0
    s[R.EARLY_B + l] += along_b / pace if ok else 0.0
    s[R.TRACE + l] += s[R.D_TRACE + l] if ok else 0.0
    s[R.SINCE + l] += s[R.OK + l]


@lanewise
def commit(s, law, n):
    """`commit_lane` in the first n lanes."""
    if law == SLIP:
        for l in range(n):
            commit_lane(s, l, SLIP)
    else:
        for l in range(n):
            commit_lane(s, l, AGING)


@inner
def load(s, l, law, i, starts):
    """Put case i into lane l."""
    fill(s, l, i, R.RETURN_SIZE, starts, starts.eta[i])
    s[R.X_A + l], s[R.V_A + l], s[R.PSI_A + l] = starts.along[i, 0]
    s[R.X_B + l], s[R.V_B + l], s[R.PSI_B + l] = starts.along[i, 1]
    s[R.W_LP + l] = 1.0
    s[R.T_END + l] = s[R.BREAKPOINT + l] = s[R.SAVE_AT + l] = math.inf
    s[R.STEADY + l], s[R.GUESS + l] = starts.steady_tol[i], starts.period[i]
    s[R.EVERY_STEP + l] = starts.observe[i]
    s[R.X_LOW + l] = s[R.X_A_LOW + l] = s[R.X_B_LOW + l] = math.nan
    # A start on the section is a crossing already made: the step from it leads to no other.
    s[R.SINCE + l] = 0.0 if s[R.V + l] == 0.0 else 1.0
    choose_first_step(s, l, law)


@inner
def rates(s, l, law):
    """dx/dT, dv/dT and dpsi/dT at the end of the lane's step."""
    beta, eta = s[R.BETA + l], s[R.ETA0 + l]
    x, v, psi, w = s[R.X_NEW + l], s[R.V_NEW + l], s[R.PSI_NEW + l], s[R.W_NEW + l]
    f_x = s[R.KAPPA + l] * (1.0 - w)
    f_psi = state_rate(law, w, v, psi, s[R.E_NEW + l])
    f_v = f_x - beta * f_psi if eta < SLAVED else (x - v - beta * psi) / (eta * w)
    return f_x, f_v, f_psi


@inner
def end_at_crossing(s, l, law):
    """Move the end of a step that was cut at a crossing onto the section, and book it."""
    f_x, f_v, f_psi = rates(s, l, law)
    dt = -s[R.V_NEW + l] / f_v
    s[R.X_NEW + l] += 0.5 * f_x * dt  # dx/dT vanishes at the section
    s[R.PSI_NEW + l] += f_psi * dt
    s[R.V_NEW + l], s[R.W_NEW + l] = 0.0, 1.0
    s[R.E_NEW + l] = exp_alone(-s[R.PSI_NEW + l])
    s[R.H_USED + l] += dt
    s[R.H_NEXT + l] = s[R.H_PLANNED + l]
    s[R.LAST_STEP + l], s[R.SINCE + l] = 0.0, -1.0  # 0 once this step is committed
    s[R.EVERY_STEP + l] = s[R.OBSERVE + l]
    if f_v > 0.0:
        s[R.STATUS + l] = FINISHED
    else:
        s[R.X_LOW + l] = s[R.X_NEW + l]
        s[R.X_A_LOW + l], s[R.X_B_LOW + l] = s[R.X_A_NEW + l], s[R.X_B_NEW + l]


@inner
def observe_step(s, l, law, cx, cv, cpsi):
    """`observe`, with the derivatives of what it finds of V, and the waveform.

    They are those of V at that time: where it is extreme, a shift along the orbit does not count.
    Where V stops falling at once, as at a sudden arrest, they are good to some ten per cent.
    """
    high, low = s[R.V_HIGH + l], s[R.V_LOW + l]
    at = observe(s, l, law, cx, cv, cpsi)
    if s[R.V_HIGH + l] > high:
        s[R.V_A_HIGH + l], s[R.V_B_HIGH + l] = perturbed(s, l, law, at * s[R.H_USED + l])
    elif s[R.V_LOW + l] < low:
        s[R.V_A_LOW + l], s[R.V_B_LOW + l] = perturbed(s, l, law, at * s[R.H_USED + l])
    record_waveform(s, l, cx, cv)


@inner
def perturbed(s, l, law, h):
    """Perturbations of v a time h after the start of the lane's step."""
    if law == SLIP:
        _, a, b, _, _, _ = step_of_lane(s, l, SLIP, h)
    else:
        _, a, b, _, _, _ = step_of_lane(s, l, AGING, h)
    return a[1], b[1]


@inner
def record_waveform(s, l, cx, cv):
    """Add the step to the time spent sticking and to the Fourier integrals of the stress."""
    h = s[R.H_USED + l]
    sticks, stuck_before = s[R.V_NEW + l] < STICKING, s[R.V + l] < STICKING
    part = 1.0 if sticks else 0.0
    if sticks != stuck_before:
        at = crossing(cv, 0.1, 0.0, STICKING)
        part = 1.0 - at if sticks else at
    s[R.SLOW + l] += part * h
    pace = 2.0 * math.pi / s[R.GUESS + l]
    phase = pace * (s[R.T + l] + (s[R.T_LOW + l] + 0.5 * h))
    c, sin = math.cos(phase), math.sin(phase)
    c_aside, s_aside = math.cos(pace * ASIDE * h), math.sin(pace * ASIDE * h)
    middle = CENTRE * polynomial(cx, 0.5)
    early, late = polynomial(cx, 0.5 - ASIDE), polynomial(cx, 0.5 + ASIDE)
    weight = 0.5 - 0.5 * CENTRE
    total, skew = weight * (late + early), weight * (late - early)
    s[R.MEAN + l] += h * (middle + total)
    s[R.SQUARE + l] += h * (middle * middle / CENTRE + weight * (early * early + late * late))
    s[R.COSINE + l] += h * (c * (middle + total * c_aside) - sin * skew * s_aside)
    s[R.SINE + l] += h * (sin * (middle + total * c_aside) + c * skew * s_aside)


@inner
def handle_events(s, l, law):
    """Everything of interest in the lane's accepted step, before it is committed."""
    cx, cv, cpsi = components(s, l)
    last_step = s[R.LAST_STEP + l]
    if last_step > 0.0 and s[R.H_USED + l] >= last_step:
        if s[R.OBSERVE + l] > 0.0:
            observe_step(s, l, law, cx, cv, cpsi)
        end_at_crossing(s, l, law)
        return
    s[R.LAST_STEP + l] = 0.0
    rises = s[R.W_NEW + l] >= 1.0
    if (s[R.W + l] < 1.0) == rises and s[R.SINCE + l] > 0.0:
        at = max(crossing(cv, 1.0, 0.0, 0.0), NEAREST)
        s[R.H_PLANNED + l] = s[R.H_NEXT + l]
        s[R.H_NEXT + l] = s[R.LAST_STEP + l] = at * s[R.H_USED + l]
        s[R.EVERY_STEP + l], s[R.OK + l] = 1.0, 0.0
        return
    s[R.EVERY_STEP + l] = s[R.OBSERVE + l]
    if s[R.OBSERVE + l] > 0.0:
        observe_step(s, l, law, cx, cv, cpsi)
    if s[R.V_NEW + l] > s[R.V_LIMIT + l]:
        # Where steady sliding is unstable what turns back once more runs away at last.
        if s[R.KAPPA + l] < s[R.BETA + l] - 1.0:
            s[R.STATUS + l] = RUNAWAY
        else:
            outrun(s, l, law)
    elif steadies(s, l):
        s[R.STATUS + l] = STEADY_SLIDING


@inner
def finish(s, l, law, returns):
    """Write the outcome of the lane's case; derivatives are those of the section's points."""
    i = int(s[R.CASE + l])
    status = int(s[R.STATUS + l])
    returns.status[i] = status if status != RUNNING else stuck(s, l)
    eta, beta = s[R.ETA0 + l], s[R.BETA + l]
    x, psi, w = s[R.X + l], s[R.PSI + l], s[R.W + l]
    f_psi = state_rate(law, w, s[R.V + l], psi, s[R.E + l])
    slope = -beta * f_psi if eta < SLAVED else (x - beta * psi) / eta
    earlier_a, earlier_b = s[R.V_A + l] / slope, s[R.V_B + l] / slope
    numbers = Numbers(
        period=s[R.T + l] + s[R.T_LOW + l],
        x=x,
        psi=psi,
        G=slope,
        x_low=s[R.X_LOW + l],
        period_a=-earlier_a - s[R.EARLY_A + l],
        x_a=s[R.X_A + l],
        psi_a=s[R.PSI_A + l] - f_psi * earlier_a,
        x_low_a=s[R.X_A_LOW + l],
        period_b=-earlier_b - s[R.EARLY_B + l],
        x_b=s[R.X_B + l],
        psi_b=s[R.PSI_B + l] - f_psi * earlier_b,
        x_low_b=s[R.X_B_LOW + l],
        trace=s[R.TRACE + l],
        v_max=s[R.V_HIGH + l],
        v_min=s[R.V_LOW + l],
        g_max=s[R.G_HIGH + l],
        slow=s[R.SLOW + l],
        mean=s[R.MEAN + l],
        square=s[R.SQUARE + l],
        cosine=s[R.COSINE + l],
        sine=s[R.SINE + l],
        steps=s[R.STEPS + l] + s[R.REJECTED + l],
        v_max_a=s[R.V_A_HIGH + l],
        v_max_b=s[R.V_B_HIGH + l],
        v_min_a=s[R.V_A_LOW + l],
        v_min_b=s[R.V_B_LOW + l],
        f_min=s[R.F_LOW + l],
        xf_min=s[R.XF_LOW + l],
    )
    for k in range(len(numbers)):
        returns.numbers[i, k] = numbers[k]
    s[R.CASE + l] = IDLE


@kernel
def return_map(law, alone, s, queue, position, starts, returns, budget):
    """Take the cases of a queue to their next upward crossing of the section; whether all are done.

    Parameters as for `march.march`; s : (RETURN_SIZE,)
    """
    width = 1 if alone else R.LANES
    vacant = True
    for _ in range(budget):
        if vacant:
            active = 0
            for l in range(width):
                i = next_case(s, l, queue, position)
                if i >= 0:
                    load(s, l, law, i, starts)
                active += s[R.CASE + l] != IDLE
            if active == 0:
                return True
            vacant = False
        advance(s, law, width)
        for l in range(width):
            if s[R.CALL + l] > 0.0 and s[R.CASE + l] != IDLE:
                handle_events(s, l, law)
        L.commit(s, width)
        commit(s, law, width)
        for l in range(width):
            if s[R.BREAK + l] > 0.0 and s[R.CASE + l] != IDLE:
                finish(s, l, law, returns)
                position[1] += 1
                vacant = True
    return False
