"""The fit by hand: SciPy solves the equations and lmfit minimises, with its own differences.

In log variables relative to the sliding before the step.  A slider without mass has ln V and
ln theta as its states, one with mass tau as well.  Solved apart before and after the step, with
values at the samples only.
"""

import math
import warnings
from collections.abc import Callable
from typing import NamedTuple

import lmfit
import numpy as np
from fit_problems import FREE, NOISE, Fitted
from numba import njit
from report import power
from rivals import jacobian, quiet, rates, rhs
from scipy.integrate import odeint, solve_ivp

FAR = 1e6  # residual where a solver fails


class Equations(NamedTuple):
    """Right-hand side and Jacobian, functions of t, y and the numbers of rivals.py."""

    rhs: Callable
    jacobian: Callable | None = None


@njit(error_model="numpy")
def rhs_massless(t, y, p):
    """d/dt of v and psi, for x = v + beta psi where there is no mass."""
    dx, _, dpsi = rates(0.0, y[0], y[1], p)
    return np.array([dx - p[1] * dpsi, dpsi])


@njit(error_model="numpy")
def jacobian_massless(t, y, p):
    """Its Jacobian, of the slip law."""
    v, psi = y
    w = np.exp(v)
    J = np.empty((2, 2))
    J[1, 0] = -p[3] * w * (v + psi + 1.0)
    J[1, 1] = -p[3] * w
    J[0, 0] = -p[3] * p[0] * w - p[1] * J[1, 0]
    J[0, 1] = -p[1] * J[1, 1]
    return J


def python_rhs(t, y, p):
    """`rhs` as one writes it in Python."""
    kappa, beta, eta0, scale, w_lp, _ = p
    x, v, psi = y
    w = math.exp(v)
    return [
        scale * kappa * (w_lp - w),
        scale * (x - v - beta * psi) / (eta0 * w),
        -scale * w * (v + psi),
    ]


def python_rhs_massless(t, y, p):
    """`rhs_massless` likewise."""
    kappa, beta, _, scale, w_lp, _ = p
    v, psi = y
    w = math.exp(v)
    dpsi = -scale * w * (v + psi)
    return [scale * kappa * (w_lp - w) - beta * dpsi, dpsi]


#: equations of the slider with mass, and without
PYTHON = Equations(python_rhs), Equations(python_rhs_massless)
COMPILED = Equations(rhs, jacobian), Equations(rhs_massless, jacobian_massless)


def by_solve_ivp(equations, y, t, p, method, tol):
    """(n - 1, states) at the times t (n,), of which the first is that of the start y."""
    keys = {"jac": equations.jacobian} if equations.jacobian else {}
    keys |= {"t_eval": t[1:], "rtol": tol, "atol": tol, "args": (p,)}
    return solve_ivp(equations.rhs, (t[0], t[-1]), y, method, **keys).y.T


def by_odeint(equations, y, t, p, method, tol):
    """The same by SciPy's older interface to LSODA, whose loop over the steps is compiled."""
    keys = {"Dfun": equations.jacobian, "tfirst": True, "rtol": tol, "atol": tol}
    return odeint(equations.rhs, y, t, (p,), **keys)[1:]


class Rival(NamedTuple):
    """How the motion is solved for."""

    solve: Callable
    equations: tuple
    method: str
    tol: float

    def fitted(self, problem):
        """What lmfit's leastsq comes to from the problem's start."""
        model = Model(problem, self)
        names = [*FREE, "level"]
        parameters = lmfit.Parameters()
        for name, value in zip(names, problem.start, strict=True):
            parameters.add(name, value)

        def residual(now):
            return model.residual(np.array([now[name].value for name in names]))

        with warnings.catch_warnings(), quiet():
            warnings.simplefilter("ignore")
            found = lmfit.minimize(residual, parameters)
        point = np.array([found.params[name].value for name in names])
        return Fitted(point, model.motions, model.friction(point))


class Model:
    """Friction at the samples of a FitProblem.

    The last motion is kept, so that the level's column of the Jacobian costs nothing.
    """

    def __init__(self, problem, rival):
        self.problem, self.rival, self.motions = problem, rival, 0
        self.equations = rival.equations[0 if problem.slider.M else 1]
        before = problem.t < problem.t_step
        self.before = np.append(problem.t[before], problem.t_step)
        self.after = np.append(problem.t_step, problem.t[~before])
        self.kept = {}

    def friction(self, point):
        """(m,) at a point (5,)."""
        key = tuple(point[:4])
        if key not in self.kept:
            self.kept = {key: self._change(*key)}
        return point[4] + self.kept[key]

    def residual(self, point):
        """(m,) what lmfit minimises."""
        try:
            friction = self.friction(point)
        except (ArithmeticError, ValueError):
            return np.full(self.problem.t.size, FAR)
        residual = (friction - self.problem.data.friction.values) / NOISE.white
        return np.where(np.isfinite(residual), residual, FAR)

    def _change(self, ln_a, b, ln_Dc, ln_K):
        """(m,) friction less its value before the step."""
        self.motions += 1
        slider, (V_1, V_2) = self.problem.slider, self.problem.speeds
        a, Dc, K = np.exp([ln_a, ln_Dc, ln_K])
        eta0 = slider.M * V_1**2 / (a * slider.sigma * Dc)
        p = np.array([K * Dc / (a * slider.sigma), b / a, eta0, V_1 / Dc, 1.0, 0.0])
        steady = np.zeros((1, 3 if slider.M else 2))
        first = self._solved(steady[0], self.before, p)
        p[4] = V_2 / V_1
        then = self._solved(first[-1], self.after, p)
        y = np.concatenate([steady, first[:-1], then])
        return a * (y[:, 0] if slider.M else y[:, 0] + p[1] * y[:, 1])

    def _solved(self, y, t, p):
        return self.rival.solve(self.equations, y, t, p, self.rival.method, self.rival.tol)


def fit_rivals():
    """name -> Rival."""
    found = {}
    for name, solve, equations, method in (
        ("LSODA (solve_ivp), in Python", by_solve_ivp, PYTHON, "LSODA"),
        ("LSODA (solve_ivp), compiled", by_solve_ivp, COMPILED, "LSODA"),
        ("Radau (solve_ivp), compiled", by_solve_ivp, COMPILED, "Radau"),
        ("LSODA (odeint), compiled", by_odeint, COMPILED, "LSODA"),
    ):
        for tol in (1e-6, 1e-8):
            found[f"lmfit, {name}, {power(tol)}"] = Rival(solve, equations, method, tol)
    return found
