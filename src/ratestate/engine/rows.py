"""The layout of the lane buffer.

A lane is a column of the buffer `s`, a flat array in which row R of lane l is ``s[R + l]``.  One
buffer with constant row offsets, rather than an array a row, is what lets LLVM see that no row
aliases another, so that it vectorises.
"""

LANES = 16
RING = 64  # returns to V = V_lp of which a march keeps stress maxima, minima and durations
STATE_SIZE = 67 * LANES  # of what a march and a return map have in common
SIZE = STATE_SIZE + 3 * RING * LANES  # of a march
RETURN_SIZE = STATE_SIZE + 31 * LANES  # of a return map

# fmt: off
(
    X, V, PSI, W, E,                        # state, e**v, e**-psi
    KAPPA, BETA, ETA0,                      # parameters (model.py)
    W_LP, RAMP, LOG_W_LP,                   # load point: speed, its rate, ln of a constant speed
    T, T_LOW, BREAKPOINT, H,                # time in two parts, next breakpoint, next step size
    TOLERANCE, MEMORY,                      # of x, v and psi; err**(1/16) of the last good step
    SAVE_AT, V_LIMIT, STEADY,               # next saved time, runaway ln w, steady-state tolerance
    OBSERVE, EVERY_STEP,                    # 1 where extremes are wanted; where each step is
    X_NEW, V_NEW, PSI_NEW, W_NEW, E_NEW,    # the step's outcome
    X_1, V_1, PSI_1,                        # its dense output
    X_2, V_2, PSI_2,
    X_3, V_3, PSI_3,
    D_LOAD, D_FRICTION,                     # its works
    ERROR, H_USED, H_NEXT, MEMORY_NEW,      # for step control
    OK, CALL, BAD, BREAK,                   # 1 if accepted; eventful; not finite; at a break
    LOAD_WORK, DISSIPATION,                 # accumulated works
    STEPS, REJECTED, FAILURES,              # counts; rejections in a row
    V_HIGH, V_LOW, G_HIGH,                  # extremes of ln w and |g|
    F_LOW, XF_LOW,                          # smallest friction f and x + f (model.py)
    X_LOW,                                  # last stress minimum
    CROSS_T, CROSS_LOW,                     # time in two parts of the last rise of V through V_lp
    CYCLES,                                 # number of returns
    STATUS, CASE, SEGMENT, SAVED, T_END, MAX_STEPS, DT,
) = range(0, STATE_SIZE, LANES)

# Rows of a march: of each return, in turn, its stress maximum, the minimum before, how long it took
HIGHS, LOWS, SPANS = range(STATE_SIZE, SIZE, RING * LANES)

# Rows of a return map (return_lanes.py)
(
    X_A, V_A, PSI_A, X_B, V_B, PSI_B,       # two perturbations of the state
    X_A_NEW, V_A_NEW, PSI_A_NEW,            # the step's outcome for them
    X_B_NEW, V_B_NEW, PSI_B_NEW,
    EARLY_A, EARLY_B,                       # how much earlier they are: shifts along the orbit
    TRACE, D_TRACE,                         # integral of the trace of J; the step's part
    SINCE, LANDING_STEP, H_PLANNED,         # steps since a crossing; length of the step cut to one
    X_A_LOW, X_B_LOW,                       # perturbations of the stress minimum
    V_A_HIGH, V_B_HIGH, V_A_LOW, V_B_LOW,   # and of the extremes of v
    GUESS, SLOW, MEAN, SQUARE, COSINE, SINE,  # waveform: period assumed; integrals
) = range(STATE_SIZE, RETURN_SIZE, LANES)
# fmt: on
