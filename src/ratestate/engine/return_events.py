"""What happens inside a step of a return map that the step control accepts, by dense output.

A step that holds a crossing of the section is taken back, and repeated to end there: so the map
is as accurate as the steps are.
"""

from . import rows as R
from .calls import FOUND, call_point
from .dense_output import state_at
from .events import observe
from .extremes import crossing
from .model import FINISHED, RUNAWAY, STEADY_SLIDING
from .waveform import LOG_SLOW_BELOW, SLOW_BELOW

# A crossing nearer to the start of a step than this part of it is landed on by extrapolation.
NEAREST = 1e-6
SECTION, SLOW = (1.0, 0.0, 0.0), (SLOW_BELOW, 0.0, LOG_SLOW_BELOW)


def split(run, l):
    """Set SLOW_PART, where it is wanted, if the step crosses the speed that is slow."""
    s = run.s
    slow = s[R.W_NEW + l] < SLOW_BELOW
    if s[R.GUESS + l] > 0.0 and slow != (s[R.W + l] < SLOW_BELOW):
        at = crossing(run, l, SLOW, 0.0, 1.0)
        s[R.SLOW_PART + l] = 1.0 - at if slow else at


def end_at_crossing(run, l):
    """Move the end of a step that was cut at a crossing onto the section, and record it."""
    s, shape = run.s, run.shape
    call_point(run.units.land, s, l, run.work)
    s[R.H_NEXT + l] = s[R.H_PLANNED + l]
    s[R.LANDING_STEP + l], s[R.SINCE + l] = 0.0, -1.0  # 0 once this step is committed
    s[R.EVERY_STEP + l] = 0.0
    if s[R.W + l] < 1.0:  # it rises
        s[R.STATUS + l] = FINISHED
    else:
        s[R.X_LOW + l] = s[R.X_NEW + l]
        for j in range(shape.states + 1):
            of_x = s[shape.z_new + j * (2 + shape.states) * R.LANES + l]
            s[shape.x_low + j * R.LANES + l] = of_x


def perturbed(run, l, at, row):
    """Put the perturbations of the speed, as of `v_of_order`, at a place in the step into rows.

    By the dense output of the Taylor method; that of Rodas5P has none of perturbations, and its
    step is repeated.

    row : the first of them
    """
    s, shape, work = run.s, run.shape, run.work
    n = 2 + shape.states
    if s[R.TAYLOR + l] > 0.0:
        state_at(run, l, at, work, 0)
        for i in range(n * (n - 1)):
            first, z = shape.c_z + i * shape.terms * R.LANES + l, 0.0
            for k in range(shape.terms):
                z = s[first + (shape.terms - 1 - k) * R.LANES] + at * z
            work[n + i] = z
        call_point(run.units.perturbed_taylor, s, l, work)
    else:
        work[0] = at
        call_point(run.units.perturbed, s, l, work)
    for j in range(n - 1):
        s[row + j * R.LANES + l] = work[FOUND + j]


def observe_step(run, l):
    """`observe`, with the derivatives of what it finds of V.

    They are those of V at that time: where it is extreme, a shift along the orbit does not count.
    Where V stops falling at once, as at a sudden arrest, they hang on where in the step that is
    thought to be, and may be off by a factor of 4.
    """
    s, shape = run.s, run.shape
    high, low = s[R.V_HIGH + l], s[R.V_LOW + l]
    at = observe(run, l)
    if s[R.V_HIGH + l] > high:
        perturbed(run, l, at, shape.v_high)
    elif s[R.V_LOW + l] < low:
        perturbed(run, l, at, shape.v_low)


def handle_events(run, l):
    """Record what happens in the lane's step, or take it back, to end it at a crossing."""
    s = run.s
    split(run, l)
    landing_step = s[R.LANDING_STEP + l]
    if landing_step > 0.0 and s[R.H_USED + l] >= landing_step:
        if s[R.OBSERVE + l] > 0.0:
            observe_step(run, l)
        end_at_crossing(run, l)
        return
    s[R.LANDING_STEP + l] = 0.0
    rises = s[R.W_NEW + l] >= 1.0
    if (s[R.W + l] < 1.0) == rises and s[R.SINCE + l] > 0.0:
        at = max(crossing(run, l, SECTION, 0.0, 1.0), NEAREST)
        s[R.H_PLANNED + l] = s[R.H_NEXT + l]
        s[R.H_NEXT + l] = s[R.LANDING_STEP + l] = at * s[R.H_USED + l]
        s[R.EVERY_STEP + l], s[R.OK + l], s[R.CHANGES + l] = 1.0, 0.0, 0.0
        return
    s[R.EVERY_STEP + l] = 0.0
    if s[R.OBSERVE + l] > 0.0:
        observe_step(run, l)
    events = int(s[R.EVENTS + l])
    if events & R.BEYOND > 0:
        # Where steady sliding is unstable what turns back once more runs away at last.
        if s[R.UNSTABLE + l] > 0.0:
            s[R.STATUS + l] = RUNAWAY
        else:
            call_point(run.units.outrun, s, l, run.work)
    elif events & R.STEADIES > 0:
        s[R.STATUS + l] = STEADY_SLIDING
