"""What the paper's scheme (eqs 8, 9) does at a given time step: its V_c and its limit cycles.

Steps are given as omega dt, omega = sqrt(K/M): 0.1 is the largest that the script published by
the scheme's author accepts without a warning.
"""

import math

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from .. import Loading, SolverError
from ..dynamics.results import parameter
from .scheme_run import im2017, numbers_of, state_of, step

LARGEST, FINER = 0.1, 0.01  # omega dt
LAST = 0.1  # s at the end of a step of Fig. 2 that show how it oscillates: two cycles or more
#: The scheme as its author published it: whether the law's state is by backward Euler.
EULER = {"slip": False, "aging": True}
# Of ln V, psi and u/A, to difference the map: rounding then costs 1e-8 of a multiplier.
PERTURBATION = 1e-5
# Of V_c, between which the scheme's critical velocity is searched for.
BRACKET = (0.2, 1.05)


def time_step(slider, omega_dt):
    """The time step dt [s] that is omega_dt in units of sqrt(M/K); 0 if M = 0 or K = inf."""
    return omega_dt * math.sqrt(slider.M / slider.K)


def multiplier(slider, V_lp, omega_dt, euler):
    """Spectral radius of one step, linearised about the scheme's own steady sliding.

    Above 1 that is unstable.  For V_lp > 0, M > 0 and K finite; SolverError where the scheme has no
    step.
    """
    numbers = A, B, h, one_c, sine = numbers_of(slider, time_step(slider, omega_dt))
    v, w = math.log(V_lp / slider.Dc), V_lp / slider.Dc
    # the spring's stress there is not the friction: it is what makes eq. 8 repeat itself
    steady = np.array([(A - B) * v + ((1.0 - one_c) * h - sine) * w / one_c, v, -v])

    def after(y):
        x, speed, psi = y.tolist()
        *new, found = step(state_of(slider, euler), x, speed, psi, w * h, numbers)
        if not found:
            raise SolverError(f"the scheme has no step at omega dt = {omega_dt:g}; reduce it")
        return np.array(new)

    moves = PERTURBATION * np.diag([A, 1.0, 1.0])
    columns = [(after(steady + one) - after(steady - one)) / (2.0 * one.sum()) for one in moves]
    return float(np.abs(np.linalg.eigvals(np.transpose(columns))).max())


def critical_velocity(slider, omega_dt, euler=None):
    """The V_lp [m/s] at which the scheme's steady sliding turns unstable.

    To 1e-7 V_c, by bisection from 0.2 to 1.05 V_c of eq. 10; SolverError where it turns outside of
    these, or the scheme has no step.  V_c = 0 or inf is returned as it is.

    euler : None is that of `EULER`
    """
    V_c, euler = float(slider.V_c), EULER[slider.law] if euler is None else euler
    if V_c in (0.0, math.inf):
        return V_c
    # the scheme is anti-damped: its V_c lies below the true one
    low, high = (part * V_c for part in BRACKET)
    for V_lp, stable in ((low, True), (high, False)):
        if (multiplier(slider, V_lp, omega_dt, euler) < 1.0) != stable:
            raise SolverError(
                f"the scheme's steady sliding is {'unstable' if stable else 'stable'} at "
                f"V_lp = {V_lp:.4g} m/s = {V_lp / V_c:.3g} V_c, at omega dt = {omega_dt:g}: its "
                f"critical velocity is not between {BRACKET[0]:g} and {BRACKET[1]:g} V_c; reduce "
                f"omega dt"
            )
    while high - low > 1e-7 * V_c:
        middle = 0.5 * (low + high)
        if multiplier(slider, middle, omega_dt, euler) < 1.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def step_response(slider, V_start, V_lp, duration, omega_dt, euler=None, last=LAST):
    """The Dataset of a velocity step at t = 0 by the scheme, at its steps in the `last` [s].

    It ends at the first step not before `duration` [s].  euler: None is that of `EULER`.
    """
    dt = time_step(slider, omega_dt)
    n = math.ceil(duration / dt)
    euler = EULER[slider.law] if euler is None else euler
    run = im2017(slider, Loading.constant(V_lp), n * dt, dt, V_start=V_start, euler=euler)
    return run.isel(time=slice(n - math.ceil(last / dt), None))


def last_cycle(run):
    """Amplitude of tau/sigma [1] and frequency [Hz] of the last cycle in a run of the scheme.

    Between two steps tau is the cubic that has its slopes there.
    """
    t, tau = run.time.values, run.tau.values
    slope = parameter(run, "K") * (run.V_load - run.V).values
    rises = slope > 0.0

    def turn(i):
        """When tau turns between steps i and i + 1, and its value there."""
        two = slice(i, i + 2)
        piece = CubicHermiteSpline(t[two], tau[two], slope[two])
        (at,) = piece.derivative().roots(extrapolate=False)
        return at, piece(at)

    one, other = np.flatnonzero(rises[:-1] & ~rises[1:])[-2:]
    between = np.flatnonzero(~rises[one:other] & rises[one + 1 : other + 1])[-1]
    (start, _), (_, lowest), (end, highest) = map(turn, (one, one + between, other))
    return float(highest - lowest) / parameter(run, "sigma"), 1.0 / float(end - start)
