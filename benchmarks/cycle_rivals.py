"""Limit cycles by other means: marching until cycles repeat; SciPy, by shooting and collocation.

Each is given what its user would not have: marching the period, the other two the answer, 10 %
off.  All solve the system of ratestate/shooting.py, in units of V_lp, Dc and a sigma.
"""

import warnings
from typing import NamedTuple

import numpy as np
import xarray
from numba import njit
from rivals import jacobian, rates, rhs
from scipy.integrate import solve_bvp, solve_ivp
from scipy.optimize import root

import ratestate as rs
from ratestate.dynamics.cycles.system import System
from ratestate.friction.laws import law_name, one_length_laws

# Tolerances of Rodas5P and SciPy that leave errors of at most about 1e-6.
MARCHING, RADAU, COLLOCATION = 1e-7, 1e-6, 1e-6
OFF = 1.1  # a guess, over the answer
# Below this eta the orbit forgets G = dv/dT at the start of a turn: psi is the one unknown.
SLAVED = 1e-3
MOST_PERIODS = 2**16
MAX_NODES = 4000


def marched(slider, V_lp, period, agree=1e-6):
    """March from steady sliding at V_lp/10 until the last cycles of two stretches agree.

    slider : of one dimension
    period : (n,) [s]; of these a stretch takes 3, 3, 6, 12, ..., so that slow convergence shows

    Returns the last cycles' periods [s] and amplitudes (2, n), NaN where MOST_PERIODS did not do.
    """
    (dim,) = slider.K.dims
    loading = rs.Loading.constant(V_lp)
    found = np.full((2, period.size), np.nan)
    which, last, state = np.arange(period.size), None, None
    length = 3
    while which.size and length <= MOST_PERIODS:
        part = slider.replace(K=slider.K[which], M=slider.M[which])
        t_end = xarray.DataArray(length * period[which], dims=dim)
        run = rs.simulate(part, loading, t_end, V_start=V_lp / 10, initial=state, rtol=MARCHING)
        with np.errstate(divide="ignore"):
            new = np.stack([1.0 / run.frequency.values, run.amplitude.values])
        settled = np.full(which.size, False)
        if last is not None:
            settled = (np.abs(new - last) <= agree * np.abs(new)).all(axis=0)
            length *= 2
        found[:, which[settled]] = new[:, settled]
        goes_on = ~settled & (run.status.values == 0)
        end = run.isel(time=-1, drop=True)
        state = {name: end[name][{dim: goes_on}] for name in ("V", "theta", "tau")}
        which, last = which[goes_on], new[:, goes_on]
    return found


@njit(error_model="numpy")
def flow(x, v, psi, p):
    """`rates` of many states at once."""
    return rates(x, v, psi, p)


@njit(error_model="numpy")
def jacobians(y, p):
    """`jacobian` of many states (3, m) at once, (3, 3, m)."""
    J = np.empty((3, 3, y.shape[1]))
    for i in range(y.shape[1]):
        J[:, :, i] = jacobian(0.0, y[:, i], p)
    return J


def numbers(system):
    """kappa, beta, eta, V_lp/Dc, V_lp/V0 and law, as rivals.py has them."""
    law = one_length_laws().index(law_name(system.law))
    kappa, beta, eta = (values[0] for values in (system.kappa, system.beta, system.eta))
    return np.array([kappa, beta, eta, 1.0, 1.0, law], float)


class Case(NamedTuple):
    """A slider and its cycle."""

    slider: rs.SpringSlider
    system: System  # of one
    u: np.ndarray  # (psi, dv/dT) at the stress maximum
    t: np.ndarray  # (m,) in a period
    y: np.ndarray  # (3, m) x, v, psi


def case_of(slider, system, u, period):
    """`Case` with a waveform as SciPy's Radau samples it."""
    p = numbers(system)
    found = solve_ivp(rhs, (0.0, period), section(p, *u), "Radau", **_options(p, RADAU))
    return Case(slider, system, u, found.t, found.y)


def section(p, psi, G):
    """x, v, psi at a stress maximum."""
    return np.array([p[1] * psi + p[2] * G, 0.0, psi])


def _options(p, tol):
    return {"jac": jacobian, "rtol": tol, "atol": tol, "args": (p,)}


def shooting(case):
    """Period and amplitude of x; NaN where the cycle is not found.

    The return map is `solve_ivp`'s, its fixed point `root`'s.
    """
    p = numbers(case.system)
    _, beta, eta = p[:3]
    unknown = 1 if eta < SLAVED else 2
    psi, G_last = OFF * case.u

    def turn(psi, G):
        """From one stress maximum to the next: period, x and psi there, x at the minimum."""
        events, options = (maximum, minimum), _options(p, RADAU)
        start = section(p, psi, G)
        found = solve_ivp(rhs, (0.0, np.inf), start, "Radau", events=events, **options)
        (x, _, psi), (x_low, _, _) = (y[-1] for y in found.y_events)
        return found.t_events[0][-1], x, psi, x_low

    def defect(z):
        nonlocal G_last
        psi, G = z if unknown == 2 else (z[0], G_last)
        _, x, psi_new, _ = turn(psi, G)
        G_last = (x - beta * psi_new) / eta
        return np.array([psi_new - psi, G_last - G])[:unknown]

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            guess = np.array([psi, G_last])[:unknown]
            z = root(defect, guess, method="hybr", options={"eps": RADAU, "xtol": 1e-6}).x
            period, x, _, x_low = turn(z[0], z[1] if unknown == 2 else G_last)
    except (ArithmeticError, ValueError, IndexError, np.linalg.LinAlgError):
        return np.full(2, np.nan)
    return np.array([period, x - x_low])


def maximum(t, y, p):
    """V = V_lp, V rising; not at the start, which is one."""
    return y[1] if t > 0.0 else 1.0


def minimum(t, y, p):
    """V = V_lp, V falling."""
    return y[1]


maximum.terminal, maximum.direction, minimum.direction = True, 1.0, -1.0


def collocation(case):
    """Period and amplitude of x by `solve_bvp`, period unknown; NaN where it is not found."""
    p, t = numbers(case.system), case.t

    def of_phase(s, y, T):
        return T[0] * np.stack(flow(*y, p))

    def of_phase_jacobian(s, y, T):
        return T[0] * jacobians(y, p), np.stack(flow(*y, p))[:, None]

    def ends(start, end, T):
        return np.append(end - start, start[1])

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = solve_bvp(
            of_phase,
            ends,
            t / t[-1],
            OFF * case.y,
            [OFF * t[-1]],
            fun_jac=of_phase_jacobian,
            tol=COLLOCATION,
            max_nodes=MAX_NODES,
        )
    if not found.success:
        return np.full(2, np.nan)
    s = found.x[np.argmin(found.y[0])] + np.linspace(-0.01, 0.01, 2001)
    low = found.sol(np.clip(s, 0.0, 1.0))[0].min()
    return np.array([found.p[0], found.y[0, 0] - low])
