"""The return map: from a point of the section V = V_lp to the next, with its derivative.

Speeds are in units of a constant V_lp and times in Dc/V_lp, so the section is v = 0.  On it dx/dT
vanishes: an upward crossing is a maximum of the stress and the point to return to, a downward
one its minimum.
"""

import math
from collections import namedtuple
from typing import NamedTuple

import numpy as np

from . import lanes as L
from . import rows as R
from .jit import inner, kernel
from .lane_case import IDLE, choose_first_step, fill, next_case, stuck
from .model import RUNNING, SLAVED
from .return_events import handle_events
from .return_lanes import advance, commit


class Starts(NamedTuple):
    """From where each slider sets out; arrays of one value a case unless a shape is given."""

    kappa: np.ndarray
    beta: np.ndarray
    eta: np.ndarray
    y: np.ndarray  # (n, 3) x, v, psi
    along: np.ndarray  # (n, 2, 3) two perturbations of it
    atol: np.ndarray  # of a step in x, v and psi
    steady_tol: np.ndarray
    observe: np.ndarray  # 1 where extremes and waveform are wanted
    period: np.ndarray  # assumed for the waveform
    v_limit: np.ndarray  # ln(V/V_lp) beyond which an orbit that does not turn back has run away
    max_steps: np.ndarray


class ReturnResults(NamedTuple):
    """Where each slider came back to the section, and what happened on the way.

    Where the status is not FINISHED, the numbers are those of where it stopped.
    """

    numbers: np.ndarray  # (n, len(RETURN_NUMBERS))
    status: np.ndarray  # (n,) int8


#: _a and _b: derivatives along the two perturbations.  Dimensionless; G is dv/dT at the return,
#: v_max and v_min are ln(V/V_lp), slow is the time below V_lp/10, and the four after it integrals
#: over T of x, x^2, x cos and x sin (2 pi T/`Starts.period`).  x_low is NaN without a stress
#: minimum.  Where `Starts.observe` is 0, slow and the integrals are 0, and extremes those of the
#: ends of steps.
ReturnNumbers = namedtuple(
    "ReturnNumbers",
    "period x psi G x_low period_a x_a psi_a x_low_a period_b x_b psi_b x_low_b trace v_max v_min "
    "g_max slow mean square cosine sine steps v_max_a v_max_b v_min_a v_min_b f_min xf_min",
)
RETURN_NUMBERS = ReturnNumbers._fields


def empty_return_results(n):
    """`ReturnResults` of n cases that are to run: NaN, status RUNNING."""
    return ReturnResults(np.full((n, len(RETURN_NUMBERS)), np.nan), np.full(n, RUNNING, np.int8))


@inner
def load(s, l, law, i, starts):
    """Put case i into lane l."""
    fill(s, l, i, R.RETURN_SIZE, starts)
    s[R.ETA0 + l], s[R.TOLERANCE + l] = starts.eta[i], starts.atol[i]
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
def finish(s, l, law, results):
    """Write the outcome of the lane's case; derivatives are those of the section's points."""
    i = int(s[R.CASE + l])
    status = int(s[R.STATUS + l])
    results.status[i] = status if status != RUNNING else stuck(s, l)
    eta, beta = s[R.ETA0 + l], s[R.BETA + l]
    x, psi, w = s[R.X + l], s[R.PSI + l], s[R.W + l]
    f_psi = law.rate(w, s[R.V + l], psi, s[R.E + l])
    slope = -beta * f_psi if eta < SLAVED else (x - beta * psi) / eta
    earlier_a, earlier_b = s[R.V_A + l] / slope, s[R.V_B + l] / slope
    numbers = ReturnNumbers(
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
        results.numbers[i, k] = numbers[k]
    s[R.CASE + l] = IDLE


@kernel
def march_to_section(law, alone, s, queue, position, starts, results, budget):
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
                finish(s, l, law, results)
                position[1] += 1
                vacant = True
    return False
