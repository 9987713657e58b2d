"""The dimensionless equations, parameters and statuses that compiled code and Python share.

With w = V/V0, v = ln w, psi = ln(V0 theta/Dc), x = (tau/sigma - mu_ref)/a and T = t V0/Dc,

    dx/dT   = kappa (w_lp - w)               kappa = K Dc/(a sigma)
    dv/dT   = (x - S(v, psi))/(eta0 w)       eta0  = M V0**2/(a sigma Dc)
    dpsi/dT = f(v, psi)

These are eqs 1-4 of Im, Marone & Elsworth (2019).  The friction law gives the stress S that opposes
motion and the rates f (friction/equations_of_motion.py).  Without damping S is the friction
R = (mu - mu_ref)/a.  There is one psi for each state variable: y = (x, v, psi) is the state.
g = x - S is the inertial force divided by a sigma.  If slip may reverse, w is another function of v
and psi (friction/point.py), and the equation of v differs.
"""

import tomllib
from pathlib import Path
from typing import NamedTuple

import numpy as np

# Status of a case.  0 and 1 are answers; each other one names the reason why the case stopped.
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

# On the section G = dv/dT equals -S_psi f/S_v with a relative error of eta/S_v or g/S_v, whichever
# is larger, where g = x - S.  This is more accurate than g/eta, which has the rounding of g, if eta
# and g are below SLAVED sqrt(S_v).
SLAVED = 1e-7

_TABLE = tomllib.loads(Path(__file__).with_name("statuses.toml").read_text("utf-8"))
#: status code -> (name, what happened and what helps)
STATUSES = {row["code"]: (name, row["message"]) for name, row in _TABLE.items()}

#: name of a method -> whether steps that are not stiff may use the Taylor method
METHODS = {"auto": True, "rodas5p": False}


class Cases(NamedTuple):
    """Parameters of each slider's run; arrays of one value a case unless stated."""

    kappa: np.ndarray
    p: np.ndarray  # (n, number of coefficients) coefficients of the law
    eta0: np.ndarray
    scale: np.ndarray  # V0/Dc [1/s]: T = scale t
    V0: np.ndarray  # [m/s]
    y: np.ndarray  # (n, len(y)) initial x, v, psi
    t_end: np.ndarray  # [s]
    sigma: np.ndarray  # initial normal stress [Pa]
    loading: np.ndarray  # row of the Loads tables
    times: np.ndarray  # row of the saved times
    rtol: np.ndarray
    observe: np.ndarray  # 1 if extremes of V, friction and the inertial force are wanted
    v_limit: np.ndarray  # ln(V/V0) beyond which a run that does not turn back has run away
    max_steps: np.ndarray


class Loads(NamedTuple):
    """Piecewise-linear histories in S segments, one row each [s, m/s, m/s^2, Pa].

    A sinusoid of normal stress is among the coefficients of each case.
    """

    t: np.ndarray  # (S,) start times
    V: np.ndarray  # (n, S) speed of the load point at the start of each segment
    rate: np.ndarray  # (n, S) acceleration in each segment
    # (n, S) normal stress at the ends of each segment, without sinusoid; (1, 0) if constant
    sigma: np.ndarray = np.empty((1, 0))
    sigma_end: np.ndarray = np.empty((1, 0))


class Results(NamedTuple):
    """Results of a march; if a case fails, its `final` and `saved` are NaN."""

    final: np.ndarray  # (n, len(y)) x, v, psi at the end
    saved: np.ndarray  # (n, n_times, len(y))
    numbers: np.ndarray  # (n, len(NUMBERS))
    status: np.ndarray  # (n,)


class Numbers(NamedTuple):
    """A row of `Results.numbers`; if a case fails, up to the time reached."""

    t: float  # time reached [s]
    steps: float  # accepted
    rejected: float
    load_work: float  # without its mu_ref part, divided by a sigma Dc
    dissipation: float  # without its mu_ref part, divided by a sigma Dc
    amplitude: float  # max - min of x in the last period; 0 before the first period
    period: float  # duration of the last period in T; inf before the first period
    cycles: float  # returns to V = V_lp since the last jump of the loading
    v_max: float  # ln(V/V0); if slip may reverse, v at psi = 0 (`Point.reference_v_slope`)
    v_min: float
    g_max: float  # largest |g|
    returns: float  # in the last period; 0 if there is none or it is irregular (`step_events`)
    f_min: float
    xf_min: float  # smallest x + N


NUMBERS = Numbers._fields


def empty_results(y, n_times):
    """Return `Results` before a run from y with n_times saved times: NaN, RUNNING."""
    n, size = y.shape
    return Results(
        np.full((n, size), np.nan),
        np.full((n, n_times, size), np.nan),
        np.full((n, len(NUMBERS)), np.nan),
        np.full(n, RUNNING),
    )
