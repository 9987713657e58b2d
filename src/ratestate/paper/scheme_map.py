"""What the paper's scheme (eqs 8, 9) does at a given time step: its V_c and its limit cycles.

Steps are given as omega dt, omega = sqrt(K/M): 0.1 is the largest that the script published by
the scheme's author accepts without a warning.
"""

import math

import numpy as np

from .. import Loading, SolverError, simulate
from ..engine.im2017 import solve_force_balance
from ..engine.model import METHODS
from ..friction.laws import friction_law
from ..friction.stability import eta

LARGEST, FINER = 0.1, 0.01  # omega dt
LAST = 0.1  # s at the end of a step of Fig. 2 that show how it oscillates: two cycles or more
#: The scheme as its author published it: the aging law's state by backward Euler.
METHOD = {"slip": "im2017", "aging": "im2017_euler"}
# Of ln V, psi and x, to difference the map: rounding then costs 1e-8 of a multiplier.
PERTURBATION = 1e-5
# Of V_c, between which the scheme's critical velocity is searched for.
BRACKET = (0.2, 1.05)


def time_step(slider, omega_dt):
    """The time step dt [s] that is omega_dt in units of sqrt(M/K); 0 if M = 0 or K = inf."""
    return omega_dt * math.sqrt(slider.M / slider.K)


def multiplier(slider, V_lp, omega_dt, method):
    """Spectral radius of one step, linearised about the scheme's own steady sliding.

    Above 1 that is unstable.  For V_lp > 0, M > 0 and K finite; SolverError where the scheme has no
    step.
    """
    law, code = friction_law(slider.law), METHODS[method].code
    kappa, p = slider.K * slider.Dc / (slider.a * slider.sigma), (slider.b / slider.a,)
    omega = math.sqrt(kappa / eta(V_lp, a=slider.a, Dc=slider.Dc, sigma=slider.sigma, M=slider.M))
    h = omega_dt / omega  # V0 is V_lp here, so that w, V0 theta/Dc and the load's speed are 1
    # the spring's stress there is not the friction: it is what makes eq. 8 repeat itself
    bias = kappa * (math.cos(omega_dt) * h - math.sin(omega_dt) / omega)
    steady = np.array([bias / (2.0 * math.sin(0.5 * omega_dt) ** 2), 0.0, 0.0])

    def step(y):
        w = math.exp(y[1])
        new, found = solve_force_balance(law, code, kappa, p, tuple(y), w, h, h, omega)
        if not found:
            raise SolverError(f"the scheme has no step at omega dt = {omega_dt:g}; reduce it")
        return np.array(new)

    moves = PERTURBATION * np.eye(3)
    columns = [step(steady + move) - step(steady - move) for move in moves]
    jacobian = np.array(columns).T / (2.0 * PERTURBATION)
    return float(np.abs(np.linalg.eigvals(jacobian)).max())


def critical_velocity(slider, omega_dt, method=None):
    """The V_lp [m/s] at which the scheme's steady sliding turns unstable.

    To 1e-7 V_c, by bisection from 0.2 to 1.05 V_c of eq. 10; SolverError where it turns outside of
    these, or the scheme has no step.  V_c = 0 or inf is returned as it is.

    method : None is that of `METHOD`
    """
    V_c, method = float(slider.V_c), method or METHOD[slider.law]
    if V_c in (0.0, math.inf):
        return V_c
    # the scheme is anti-damped: its V_c lies below the true one
    low, high = (part * V_c for part in BRACKET)
    for V_lp, stable in ((low, True), (high, False)):
        if (multiplier(slider, V_lp, omega_dt, method) < 1.0) != stable:
            raise SolverError(
                f"the scheme's steady sliding is {'unstable' if stable else 'stable'} at "
                f"V_lp = {V_lp:.4g} m/s = {V_lp / V_c:.3g} V_c, at omega dt = {omega_dt:g}: its "
                f"critical velocity is not between {BRACKET[0]:g} and {BRACKET[1]:g} V_c; reduce "
                f"omega dt"
            )
    while high - low > 1e-7 * V_c:
        middle = 0.5 * (low + high)
        if multiplier(slider, middle, omega_dt, method) < 1.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def step_response(slider, V_start, V_lp, duration, omega_dt, method=None, last=0.0):
    """The Dataset of a velocity step at t = 0 by the scheme, saved at its steps in `last` [s].

    It ends at the first step not before `duration` [s].  method: None is that of `METHOD`.
    """
    dt = time_step(slider, omega_dt)
    n = math.ceil(duration / dt)
    times = np.arange(n - math.ceil(last / dt), n + 1) * dt
    steps = {"times": times, "method": method or METHOD[slider.law], "dt": dt}
    return simulate(slider, Loading.constant(V_lp), n * dt, V_start=V_start, **steps)
