"""The lanes: one buffer holding many sliders side by side, and the loops that SIMD runs.

A lane is a column of the buffer `s`, a flat array in which row R of lane l is ``s[R + l]``.  One
buffer with constant row offsets (rather than an array a row) is what lets LLVM see that no row
aliases another.  Every loop here runs over all `LANES` lanes, idle ones too, so that a slider
goes through the same instructions, and gets the same bits, wherever it sits.
"""

import math

from numba import njit

from ..laws import AGING, SLIP
from .model import RUNNING, state_rate
from .rodas5p import step as rodas5p_step

LANES = 16

# fmt: off
(
    X, V, PSI, W, E,                             # state, e**v, e**-psi
    KAPPA, BETA, ETA0,                      # parameters (model.py)
    W_LP, RAMP, LOG_W_LP,                        # load point now: speed, its rate, ln of a constant speed
    T, T_LOW, LAND, H,                           # time in two parts, next forced landing, next step size
    RTOL, MEMORY,                                # tolerance; err**(1/16) of the last accepted step
    SAVE_AT, V_LIMIT, STEADY,                    # next saved time; runaway ln w; steady-state tolerance
    OBSERVE, EVERY_STEP,                         # 1 where extremes are wanted; where each step is
    X_NEW, V_NEW, PSI_NEW, W_NEW, E_NEW,         # the step's outcome
    X_1, V_1, PSI_1, X_2, V_2, PSI_2, X_3, V_3, PSI_3,  # its dense output
    D_LOAD, D_FRICTION, ERROR, H_USED, H_NEXT, MEMORY_NEW, OK, CALL, BAD, TURN,
    LOAD_WORK, DISSIPATION, STEPS, REJECTED, FAILURES,  # accumulated
    V_HIGH, V_LOW, G_HIGH,                       # extremes of ln w and |g|
    X_HIGH, X_LOW, CROSS_T, CROSS_LOW,           # last stress extremes; last upward crossing V = V_lp
    AMPLITUDE, PERIOD, CYCLES, CHANGE,           # last complete cycle and its change from the one before
    WINDOW_AMPLITUDE, WINDOW_PERIOD, WINDOW_CHANGE,  # the same over windows of cycles (events.py)
    MODE, CYCLE_TOL, STATUS, CASE, SEGMENT, SAVED, T_END, MAX_STEPS, DT,
) = range(0, 74 * LANES, LANES)
# fmt: on
ROWS = 74
SIZE = ROWS * LANES

# Rejections in a row that no step size can explain: 5**-60 is far below any time scale.
TOO_MANY_FAILURES = 60.0

# A factor below 1/5 or above 5 says more about the estimate than about the solution.
SAFETY, SHRINK, GROW = 0.85, 0.2, 5.0


@njit(forceinline=True, error_model="numpy", fastmath={"contract"})
def turning(g, f_x, f_psi, w, beta, eta0):
    """Numbers whose signs change where V, and where |g|, has an extreme.

    dv/dT has the sign of g, or of f_x - beta f_psi where there is no inertia; dg/dT that of
    eta0 w (f_x - beta f_psi) - g.
    """
    drive = f_x - beta * f_psi
    return (g if eta0 > 0.0 else drive), eta0 * w * drive - g


@njit(forceinline=True, error_model="numpy", fastmath={"contract"})
def step_size(h, land, t, t_low):
    """The step to try: never past the next landing, nor so near it that a crumb remains."""
    left = (land - t) - t_low
    return left if h * (1.0 + 1e-9) >= left else h


@njit(forceinline=True, error_model="numpy", fastmath={"contract"})
def judge(s, l):
    """Accept or reject by a PI controller; powers by square roots, which vectorise."""
    err, h, planned = s[ERROR + l], s[H_USED + l], s[H + l]
    finite = err < 1e300
    ok = err <= 1.0
    quarter = math.sqrt(math.sqrt(err))
    eighth = math.sqrt(quarter)
    sixteenth = math.sqrt(eighth)
    factor = SAFETY * s[MEMORY + l] / (eighth * sixteenth)
    rejected = SAFETY / quarter
    factor = factor if ok else rejected
    factor = factor if factor < GROW else GROW
    factor = factor if factor > SHRINK else SHRINK
    factor = factor if finite else SHRINK
    h_next = h * factor
    # A step cut short by a landing says nothing against the size planned before it.
    h_next = planned if ok & (h < planned) & (h_next < planned) else h_next
    s[OK + l] = 1.0 if ok else 0.0
    s[BAD + l] = 0.0 if finite else 1.0
    s[H_NEXT + l] = h_next
    s[MEMORY_NEW + l] = sixteenth if sixteenth > 0.05 else 0.05


@njit(forceinline=True, error_model="numpy", fastmath={"contract"})
def needs_attention(s, l, law):
    """Whether the accepted step holds anything that the scalar code must look at."""
    kappa, beta, eta0 = s[KAPPA + l], s[BETA + l], s[ETA0 + l]
    ok, h, w_lp = s[OK + l] > 0.0, s[H_USED + l], s[W_LP + l]
    w_lp_new = w_lp + h * s[RAMP + l]
    x, v, psi, w = s[X_NEW + l], s[V_NEW + l], s[PSI_NEW + l], s[W_NEW + l]
    crosses = (s[W + l] < w_lp) != (w < w_lp_new)
    f_psi0 = state_rate(law, s[W + l], s[V + l], s[PSI + l], s[E + l])
    f_psi1 = state_rate(law, w, v, psi, s[E_NEW + l])
    g0 = s[X + l] - s[V + l] - beta * s[PSI + l]
    g1 = x - v - beta * psi
    a0, b0 = turning(g0, kappa * (w_lp - s[W + l]), f_psi0, s[W + l], beta, eta0)
    a1, b1 = turning(g1, kappa * (w_lp_new - w), f_psi1, w, beta, eta0)
    turns = (((a0 < 0.0) != (a1 < 0.0)) | ((b0 < 0.0) != (b1 < 0.0))) & (s[OBSERVE + l] > 0.0)
    saves = (s[T + l] + s[T_LOW + l]) + h >= s[SAVE_AT + l]
    log_w_lp = s[LOG_W_LP + l]
    distance = max(abs(v - log_w_lp), abs(psi + log_w_lp))
    distance = max(distance, abs(x - (1.0 - beta) * log_w_lp))
    steady = distance < s[STEADY + l]
    flag = crosses | turns | saves | steady | (v > s[V_LIMIT + l]) | (s[EVERY_STEP + l] > 0.0)
    s[CALL + l] = 1.0 if ok & flag else 0.0


@njit(forceinline=True, error_model="numpy", fastmath={"contract"})
def try_step(s, l, law, lone):
    """Try one step of the lane by Rodas5P and record its outcome; law and lone are literals."""
    h = step_size(s[H + l], s[LAND + l], s[T + l], s[T_LOW + l])
    y = (s[X + l], s[V + l], s[PSI + l])
    p = (law, s[KAPPA + l], s[BETA + l], s[ETA0 + l])
    y_new, w_new, e_new, error, k1, k2, k3, load, friction = rodas5p_step(
        y, s[W + l], s[E + l], s[W_LP + l], s[RAMP + l], h, p, lone
    )
    s[X_NEW + l], s[V_NEW + l], s[PSI_NEW + l] = y_new
    s[W_NEW + l], s[E_NEW + l] = w_new, e_new
    s[X_1 + l], s[V_1 + l], s[PSI_1 + l] = k1
    s[X_2 + l], s[V_2 + l], s[PSI_2 + l] = k2
    s[X_3 + l], s[V_3 + l], s[PSI_3 + l] = k3
    s[D_LOAD + l], s[D_FRICTION + l] = load, friction
    s[H_USED + l] = h
    err = max(abs(error[0]), abs(error[1]))
    s[ERROR + l] = max(err, abs(error[2])) / s[RTOL + l]


@njit(forceinline=True, error_model="numpy", fastmath={"contract"})
def commit_lane(s, l):
    """Move an accepted step's outcome into the state; time is summed in two parts (Kahan).

    TURN is set where the lane has come to a landing or cannot go on.

    Everything is loaded, then selected, then stored: in that order the loop vectorises.
    """
    accepted = s[OK + l]
    ok = accepted > 0.0
    h = s[H_USED + l]
    t, low = s[T + l], s[T_LOW + l]
    x, v, psi, w, e = s[X + l], s[V + l], s[PSI + l], s[W + l], s[E + l]
    x1, v1, psi1 = s[X_NEW + l], s[V_NEW + l], s[PSI_NEW + l]
    w1, e1 = s[W_NEW + l], s[E_NEW + l]
    w_lp, ramp, memory, h_next = s[W_LP + l], s[RAMP + l], s[MEMORY_NEW + l], s[H_NEXT + l]
    load, d_load = s[LOAD_WORK + l], s[D_LOAD + l]
    friction, d_friction = s[DISSIPATION + l], s[D_FRICTION + l]
    steps, rejected, failures = s[STEPS + l], s[REJECTED + l], s[FAILURES + l]
    land, status, max_steps = s[LAND + l], s[STATUS + l], s[MAX_STEPS + l]
    increment = low + h
    t1 = t + increment
    low1 = increment - (t1 - t)
    w_lp1 = w_lp + h * ramp
    load1 = load + d_load
    friction1 = friction + d_friction
    s[T + l], s[T_LOW + l] = t1 if ok else t, low1 if ok else low
    s[X + l], s[V + l] = x1 if ok else x, v1 if ok else v
    s[PSI + l], s[W + l], s[E + l] = psi1 if ok else psi, w1 if ok else w, e1 if ok else e
    s[W_LP + l] = w_lp1 if ok else w_lp
    s[LOAD_WORK + l] = load1 if ok else load
    s[DISSIPATION + l] = friction1 if ok else friction
    s[MEMORY + l] = memory if ok else 1.0
    s[STEPS + l], s[REJECTED + l] = steps + accepted, rejected + (1.0 - accepted)
    failures = (failures + 1.0) * (1.0 - accepted)
    s[FAILURES + l] = failures
    landed = ok & ((land - t1) - low1 <= 1e-12 * h)
    spent = steps + rejected + 1.0 >= max_steps
    turn = landed | spent | (failures > TOO_MANY_FAILURES) | (status != RUNNING)
    s[TURN + l] = 1.0 if turn else 0.0
    s[H + l] = h_next


@njit(nogil=True, error_model="numpy", fastmath={"contract"})
def advance(s, law):
    """Try one step in every lane, judge it, and look whether it holds anything of interest.

    Three loops, since LLVM vectorises each but not their union; and their length is read off
    the buffer, since a length known at compile time gets a loop unrolled instead of vectorised.
    A loop for each law spares the slip law its unused exponential.
    """
    lanes = s.size // ROWS
    if law == SLIP:
        for l in range(lanes):
            try_step(s, l, SLIP, False)
    else:
        for l in range(lanes):
            try_step(s, l, AGING, False)
    for l in range(lanes):
        judge(s, l)
    for l in range(lanes):
        needs_attention(s, l, law)


@njit(nogil=True, error_model="numpy", fastmath={"contract"})
def advance_alone(s, law):
    """`advance` for lane 0 only, with the C library's exponential."""
    if law == SLIP:
        try_step(s, 0, SLIP, True)
    else:
        try_step(s, 0, AGING, True)
    judge(s, 0)
    needs_attention(s, 0, law)


@njit(nogil=True, error_model="numpy", fastmath={"contract"})
def commit(s):
    """`commit_lane` in every lane."""
    for l in range(s.size // ROWS):
        commit_lane(s, l)
