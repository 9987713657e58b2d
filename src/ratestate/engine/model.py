"""The contract with compiled code: the dimensionless system, its parameters, codes and statuses.

With w = V/V0, v = ln w, psi = ln(V0 theta/Dc), x = (tau/sigma - mu_ref)/a and T = t V0/Dc,

    dx/dT   = kappa (w_lp - w)               kappa = K Dc/(a sigma)
    dv/dT   = (x - S(v, psi))/(eta0 w)       eta0  = M V0**2/(a sigma Dc)
    dpsi/dT = f(v, psi)

which is eqs 1-4 of Im, Marone & Elsworth (2019).  The stress S that opposes motion, which is the
friction R = (mu - mu_ref)/a unless there is damping too, and the rates f are the friction law's
(friction/motion.py), with one psi or more: y = (x, v, psi) has as many numbers.  g = x - S is the
inertial force over a sigma.  Where slip may reverse another w follows from v and psi, which
friction/point.py has, and with it another equation of v.
"""

import tomllib
from pathlib import Path
from typing import NamedTuple

import numpy as np

# How a case ended.  0 and 1 are answers; the rest name what stopped it.
FINISHED = 0
STEADY_SLIDING = 1
NOT_FINITE = 2
STEP_UNDERFLOW = 3
STEP_LIMIT = 4
RUNAWAY = 5
NO_CONVERGENCE = 7
RIGID_REST = 8
CRASHED = 9
RUNNING = -1

# G = dv/dT on the section is -S_psi f/S_v to within the larger of eta/S_v and g/S_v of itself,
# with g = x - S.  It is better known from that than as g/eta, with the rounding of g, if eta and g
# are below this times sqrt(S_v).
SLAVED = 1e-7

_TABLE = tomllib.loads(Path(__file__).with_name("statuses.toml").read_text("utf-8"))
#: status code -> (name, what happened and what helps)
STATUSES = {row["code"]: (name, row["message"]) for name, row in _TABLE.items()}

#: name of a method -> whether steps that are not stiff may be of the Taylor method
METHODS = {"auto": True, "rodas5p": False}


class Cases(NamedTuple):
    """Each slider, and what its run needs; arrays of one value a case unless a shape is given."""

    kappa: np.ndarray
    p: np.ndarray  # (n, number of coefficients) of the law
    eta0: np.ndarray
    scale: np.ndarray  # V0/Dc [1/s]: T = scale t
    V0: np.ndarray  # [m/s]
    y: np.ndarray  # (n, len(y)) initial x, v, psi
    t_end: np.ndarray  # [s]
    sigma: np.ndarray  # initial normal stress [Pa]
    loading: np.ndarray  # row of the Loads tables
    times: np.ndarray  # row of the saved times
    rtol: np.ndarray
    observe: np.ndarray  # 1 where extremes of V, friction and the inertial force are wanted
    v_limit: np.ndarray  # ln(V/V0) beyond which a run that does not turn back has run away
    max_steps: np.ndarray


class Loads(NamedTuple):
    """Piecewise-linear histories: S segments, one row a history [s, m/s, m/s^2, Pa].

    Where normal stress varies its sinusoid, if any, is among the law's coefficients of each case.
    """

    t: np.ndarray  # (S,) start times
    V: np.ndarray  # (n, S) speed of the load point at the start of each segment
    rate: np.ndarray  # (n, S) acceleration in it
    # (n, S) normal stress at the start and end of each, but for the sinusoid; (1, 0): none
    sigma: np.ndarray = np.empty((1, 0))
    sigma_end: np.ndarray = np.empty((1, 0))


class Results(NamedTuple):
    """What a march leaves behind; of a failed case `final` and `saved` are NaN."""

    final: np.ndarray  # (n, len(y)) x, v, psi at the end
    saved: np.ndarray  # (n, n_times, len(y))
    numbers: np.ndarray  # (n, len(NUMBERS))
    status: np.ndarray  # (n,)


class Numbers(NamedTuple):
    """A row of `Results.numbers`; of a failed case, as far as it came."""

    t: float  # [s] reached
    steps: float  # accepted
    rejected: float
    load_work: float  # this and the next beyond their mu_ref part, over a sigma Dc
    dissipation: float
    amplitude: float  # max - min of x in the last period; 0 before there is one
    period: float  # its T; inf before there is one
    cycles: float  # returns to V = V_lp since the last jump of the loading
    v_max: float  # ln(V/V0); where slip may reverse v at psi = 0 (`Point.reference_v_slope`)
    v_min: float
    g_max: float  # of |g|
    returns: float  # in the last period; 0: none, or irregular (`events.last_period`)
    f_min: float
    xf_min: float  # of x + N


NUMBERS = Numbers._fields


def empty_results(y, n_times):
    """`Results` of cases that are to run from y, n_times saved times each: NaN, status RUNNING."""
    n, size = y.shape
    return Results(
        np.full((n, size), np.nan),
        np.full((n, n_times, size), np.nan),
        np.full((n, len(NUMBERS)), np.nan),
        np.full(n, RUNNING),
    )
