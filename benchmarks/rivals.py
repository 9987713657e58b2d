"""Other solvers on the same system in log variables, right-hand side and Jacobian compiled.

Each is a function of (problem, tolerance) that returns the final states (n, 3) and None, or what
went wrong.  All get the same rtol and atol.
"""

import contextlib
import functools
import os
import sys
import warnings

import numpy as np
from numba import cfunc, njit, prange
from scipy.integrate import odeint, solve_ivp

MAX_STEPS = 200_000  # far above what a lone problem takes; a stiff one can eat any number


@njit(inline="always", error_model="numpy")
def rates(x, v, psi, p):
    """d/dt of x, v, psi (ratestate/engine/model.py); p = kappa, beta, eta0, V0/Dc, w_lp, law."""
    w = np.exp(v)
    f_psi = -w * (v + psi) if p[5] == 0.0 else np.exp(-psi) - w
    return p[3] * p[0] * (p[4] - w), p[3] * (x - v - p[1] * psi) / (p[2] * w), p[3] * f_psi


@njit(error_model="numpy")
def rhs(t, y, p):
    """The right-hand side for SciPy."""
    return np.array(rates(y[0], y[1], y[2], p))


@njit(error_model="numpy")
def jacobian(t, y, p):
    """Its Jacobian."""
    x, v, psi = y
    w = np.exp(v)
    m = p[2] * w
    J = np.zeros((3, 3))
    J[0, 1] = -p[3] * p[0] * w
    J[1, 0] = p[3] / m
    J[1, 1] = -p[3] * (1.0 + x - v - p[1] * psi) / m
    J[1, 2] = -p[3] * p[1] / m
    J[2, 1] = -p[3] * w * ((v + psi + 1.0) if p[5] == 0.0 else 1.0)
    J[2, 2] = -p[3] * (w if p[5] == 0.0 else np.exp(-psi))
    return J


def outcome(y, ok):
    """The states, NaN where the solver says that it stopped, and what is wrong with them."""
    y = np.where(np.reshape(ok, (-1, 1)), y, np.nan)
    fault = None if np.isfinite(y).all() else "NaN as success" if np.all(ok) else "stops"
    return y, fault


def scipy_solver(method):
    """`solve_ivp` by this method."""

    def solve(problem, tol):
        p, y0 = problem.numbers()
        keys = {"jac": jacobian, "rtol": tol, "atol": tol, "args": (p[0],)}
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                found = solve_ivp(rhs, (0.0, problem.t_end), y0[0], method, **keys)
        except (ArithmeticError, ValueError, np.linalg.LinAlgError):
            return outcome(y0, False)
        return outcome(found.y[:, -1][None], found.success)

    return solve


def scipy_odeint(problem, tol):
    """SciPy's older interface to LSODA, whose loop over the steps is compiled."""
    p, y0 = problem.numbers()
    keys = {"Dfun": jacobian, "tfirst": True, "rtol": tol, "atol": tol, "mxstep": MAX_STEPS}
    with warnings.catch_warnings(), quiet():
        warnings.simplefilter("ignore")
        y, info = odeint(rhs, y0[0], [0, problem.t_end], (p[0],), full_output=True, **keys)
    return outcome(y[-1:], info["message"] == "Integration successful.")


def scipy_solvers():
    """name -> solver."""
    return {
        "SciPy LSODA (solve_ivp)": scipy_solver("LSODA"),
        "SciPy LSODA (odeint)": scipy_odeint,
        "SciPy Radau": scipy_solver("Radau"),
    }


def numbalsoda_solvers(all_cores=False):
    """name -> solver, on one core or on all; none where numbalsoda is not installed."""
    os.environ.setdefault("GFORTRAN_UNBUFFERED_ALL", "1")  # so that `quiet` catches all of it
    try:
        import numbalsoda
    except ImportError:
        return {}
    lsoda, dop853 = numbalsoda.lsoda, numbalsoda.dop853

    @cfunc(numbalsoda.lsoda_sig, error_model="numpy")
    def rhs_c(t, u, du, p):
        du[0], du[1], du[2] = rates(u[0], u[1], u[2], p)

    # One loop a solver: numba cannot inline a call to a function that it is given.
    # (prange is range where nothing is parallel)
    @njit(error_model="numpy", parallel=all_cores)
    def all_by_lsoda(address, y0, p, t, tol, most):
        y, ok = np.empty_like(y0), np.empty(len(y0), np.bool_)
        for i in prange(len(y0)):
            u, ok[i] = lsoda(address, y0[i], t, p[i], tol, tol, most)
            y[i] = u[-1]
        return y, ok

    @njit(error_model="numpy", parallel=all_cores)
    def all_by_dop853(address, y0, p, t, tol, most):
        y, ok = np.empty_like(y0), np.empty(len(y0), np.bool_)
        for i in prange(len(y0)):
            u, ok[i] = dop853(address, y0[i], t, p[i], tol, tol, most)
            y[i] = u[-1]
        return y, ok

    def solver(march):
        def solve(problem, tol):
            p, y0 = problem.numbers()
            t, most = np.array([0.0, problem.t_end]), MAX_STEPS * (1 if len(y0) == 1 else 100)
            with quiet():
                y, ok = march(rhs_c.address, y0, p, t, tol, most)
            return outcome(y, ok)

        return solve

    return {
        "numbalsoda LSODA": solver(all_by_lsoda),
        "numbalsoda dop853": solver(all_by_dop853),
    }


def heyoka_solver():
    """{name: solver} of Taylor series; none where heyoka is not installed.

    An integrator is compiled for a law and a tolerance, which sets its order.
    """
    try:
        import heyoka
    except ImportError:
        return {}

    @functools.cache
    def integrator(law, tol):
        x, v, psi = heyoka.make_vars("x", "v", "psi")
        kappa, beta, eta0, scale, w_lp = (heyoka.par[i] for i in range(5))
        w = heyoka.exp(v)
        f_psi = -w * (v + psi) if law == 0.0 else heyoka.exp(-psi) - w
        response = heyoka.exp(-v) / eta0
        rates = [kappa * (w_lp - w), (x - v - beta * psi) * response, f_psi]
        equations = [(y, scale * rate) for y, rate in zip((x, v, psi), rates, strict=True)]
        return heyoka.taylor_adaptive(equations, [0.0] * 3, pars=[1.0] * 5, tol=tol)

    def solve(problem, tol):
        p, y0 = problem.numbers()
        y, ok = np.empty_like(y0), np.empty(len(y0), bool)
        for i, one in enumerate(p):
            march = integrator(one[5], tol)
            march.time, march.state[:], march.pars[:] = 0.0, y0[i], one[:5]
            outcome = march.propagate_until(problem.t_end, max_steps=100 * MAX_STEPS)[0]
            y[i], ok[i] = march.state, outcome == heyoka.taylor_outcome.time_limit
        return y, ok

    return {"heyoka": lambda problem, tol: outcome(*solve(problem, tol))}


def lsoda_on_all_cores():
    """numbalsoda's LSODA with the cases spread over the cores by prange; None if not installed."""
    return numbalsoda_solvers(all_cores=True).get("numbalsoda LSODA")


@contextlib.contextmanager
def quiet():
    """Drop what compiled code prints; it is told by its outcome."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = [os.dup(1), os.dup(2)]
    null = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(null, 1)
        os.dup2(null, 2)
        yield
    finally:
        for number, copy in zip((1, 2), kept, strict=True):
            os.dup2(copy, number)
            os.close(copy)
        os.close(null)
