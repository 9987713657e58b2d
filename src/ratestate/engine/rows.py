"""The layout of the lane buffer.

A lane is a column of the buffer `s`, a flat array in which row R of lane l is ``s[R + l]``.  One
buffer with constant row offsets, rather than an array a row, is what lets LLVM see that no row
aliases another, so that it vectorises.
"""

LANES = 16
ROWS = 74
SIZE = ROWS * LANES

# fmt: off
(
    X, V, PSI, W, E,                        # state, e**v, e**-psi
    KAPPA, BETA, ETA0,                      # parameters (model.py)
    W_LP, RAMP, LOG_W_LP,                   # load point: speed, its rate, ln of a constant speed
    T, T_LOW, LAND, H,                      # time in two parts, next landing, next step size
    RTOL, MEMORY,                           # tolerance, err**(1/16) of the last accepted step
    SAVE_AT, V_LIMIT, STEADY,               # next saved time, runaway ln w, steady-state tolerance
    OBSERVE, EVERY_STEP,                    # 1 where extremes are wanted; where each step is
    X_NEW, V_NEW, PSI_NEW, W_NEW, E_NEW,    # the step's outcome
    X_1, V_1, PSI_1,                        # its dense output
    X_2, V_2, PSI_2,
    X_3, V_3, PSI_3,
    D_LOAD, D_FRICTION,                     # its works
    ERROR, H_USED, H_NEXT, MEMORY_NEW,      # for step control
    OK, CALL, BAD, TURN,                    # 1 if accepted; eventful; not finite; landed or lost
    LOAD_WORK, DISSIPATION,                 # accumulated works
    STEPS, REJECTED, FAILURES,              # counts; rejections in a row
    V_HIGH, V_LOW, G_HIGH,                  # extremes of ln w and |g|
    X_HIGH, X_LOW,                          # last stress extremes
    CROSS_T, CROSS_LOW,                     # time in two parts of the last rise of V through V_lp
    AMPLITUDE, PERIOD, CYCLES, CHANGE,      # last cycle, its number, its change from the one before
    WINDOW_AMPLITUDE, WINDOW_PERIOD,        # the same a window of cycles ago (events.py)
    WINDOW_CHANGE, MODE, CYCLE_TOL, STATUS,
    CASE, SEGMENT, SAVED, T_END, MAX_STEPS, DT,
) = range(0, SIZE, LANES)
# fmt: on
