"""Compute the return map, from one stress maximum to the next, and Floquet multipliers.

A return begins and ends on the section V = V_lp, V rising, at points u whose units and symbols
system.py has.  A limit cycle that closes after m returns is a fixed point of the m-th iterate of
the map.
"""

from typing import NamedTuple

import numpy as np

from ...engine import dispatch
from ...engine.lanes import ROUNDING
from ...engine.model import FINISHED
from ...engine.return_map import DERIVATIVES, RETURN_NUMBERS, Starts
from ...friction.point import point_at
from .system import is_slaved, state

# A hundred times the steps of a stick-slip cycle over 20 decades of V.
MAX_STEPS_OF_RETURN = 2e5
# Complex numbers below this have no inverse.
TINY = np.finfo(float).tiny
#: numbers that add up over several returns
SUMS = ("period", "trace", "slow", "mean", "square", "steps")


class Returns(NamedTuple):
    """One return of each of n sliders, in units of Dc/V_lp (time) and a sigma (stress).

    If the slider did not come back to the section, `image` is NaN, and `jacobian` and `numbers`
    belong to the place where the orbit ended.
    """

    status: np.ndarray  # engine.model; FINISHED if it came back
    image: np.ndarray  # (n, k) the next u
    jacobian: np.ndarray  # (n, k, k) d image/d u
    #: engine.return_map.RETURN_NUMBERS, and x_high, the stress at the start; name -> (n,)
    numbers: dict
    #: derivatives of engine.return_map.DERIVATIVES and of x_high by u, name -> (n, k)
    gradients: dict

    @property
    def has_returned(self):
        """Whether each slider came back to the section."""
        return self.status == FINISHED


def return_map(system, y, atol, *, steady_tol=0.0, observe=False, period=None):
    """Return the `Returns` of sliders from y (n, len(y)) to their next stress maximum.

    The status is STEADY_SLIDING if `steady_tol` stopped it, STEP_LIMIT after 200,000 steps.

    atol : (n,) tolerance of a step in x, v and psi
    steady_tol : (n,) distance from steady sliding at which to stop
    observe : whether extremes are recorded; else they mean nothing
    period : (n,) periods assumed for the waveform; without them it means nothing
    """
    n, k = len(y), y.shape[1] - 1
    _, by_psi = system.slopes(y[:, 2:])
    directions = np.zeros((n, k, k + 1))  # d(x, v, psi)/d u
    directions[:, range(k - 1), range(2, k + 1)] = 1.0
    directions[:, :-1, 0], directions[:, -1, 0] = by_psi, system.eta
    on_section = point_at(system.friction_law, system.coefficients, tuple(y.T))
    for i, share in enumerate(on_section.omega_by_psi):
        directions[:, i, 1] = -share
    starts = Starts(
        system.kappa,
        np.ascontiguousarray(system.p),
        system.eta,
        np.ascontiguousarray(y),
        directions,
        system.rest,
        unstable=(~system.stable).astype(float),
        atol=np.broadcast_to(atol, n).astype(float),
        steady_tol=np.broadcast_to(steady_tol, n).astype(float),
        observe=np.full(n, float(observe)),
        period=np.zeros(n) if period is None else np.ascontiguousarray(period),
        v_limit=system.v_limit,
        max_steps=np.full(n, MAX_STEPS_OF_RETURN),
    )
    results = dispatch.run_returns(system.friction_law, starts)
    numbers = dict(zip(RETURN_NUMBERS, results.numbers.T, strict=True))
    gradients = dict(zip(DERIVATIVES, np.moveaxis(results.gradients, -1, 0), strict=True))
    numbers["x_high"], gradients["x_high"] = y[:, 0], directions[:, :, 0]
    image = np.concatenate([results.psi - system.steady, numbers["G"][:, None]], axis=1)
    image[results.status != FINISHED] = np.nan
    d_psi = np.swapaxes(results.psi_gradients, 1, 2)
    jacobian = _jacobian(system, results.psi, numbers["G"], gradients["x"], d_psi)
    return Returns(results.status, image, jacobian, numbers, gradients)


def _jacobian(system, psi, G, d_x, d_psi):
    """Return d(next u)/d u; the row of G comes from the rates if rounding hides inertia.

    psi, G : (n, n_states) and (n,) at the return
    d_x, d_psi : (n, k) and (n, n_states, k) derivatives by u
    """
    slaved = is_slaved(system, psi, system.eta * G)
    _, by_psi = system.slopes(psi)
    with np.errstate(over="ignore", invalid="ignore"):
        d_G = d_x - (by_psi[:, :, None] * d_psi).sum(axis=1)
        d_G = d_G / np.where(slaved, 1.0, system.eta)[:, None]
        if slaved.any():
            at = system.friction_law.at_speed(0.0, tuple(psi.T), system.coefficients)
            slope = np.stack(at.slaved_slopes, axis=1)
            d_G = np.where(slaved[:, None], (slope[:, :, None] * d_psi).sum(axis=1), d_G)
    return np.concatenate([d_psi, d_G[:, None]], axis=1)


def iterated_map(system, u, atol, count, *, steady_tol=0.0, observe=False, period=None):
    """Return the `Returns` of `count` (n,) >= 1 returns in a row from u (n, k).

    Numbers, gradients and `period` belong to all returns together.  x_high is the largest stress
    maximum from u on, but not the last one, which on a cycle is the first again.  A slider that
    does not come back keeps the status of that return.  Other arguments are as in `return_map`.
    """
    n = len(u)
    atol, steady_tol = np.broadcast_to(atol, n), np.broadcast_to(steady_tol, n)
    periods = np.ones(n) if period is None else period / count

    def one_return(rows, u):
        """Return one return of the sliders with these numbers."""
        part = system.at(rows)
        y, assumed = state(part, u), None if period is None else periods[rows]
        options = {"steady_tol": steady_tol[rows], "observe": observe, "period": assumed}
        return return_map(part, y, atol[rows], **options)

    returns = one_return(np.arange(n), u)
    for number in range(1, int(count.max(initial=1))):
        rows = np.flatnonzero((count > number) & returns.has_returned)
        _append(returns, rows, one_return(rows, returns.image[rows]), 2.0 * np.pi / periods[rows])
    return returns


def _append(returns, rows, added, omega):
    """Extend the returns of these sliders by one more return, in place.

    omega : (n,) angular frequency of the waveform
    """
    old = {name: values[rows] for name, values in returns.numbers.items()}
    previous, new = returns.jacobian[rows], added.numbers
    joined = dict(new)
    for name in SUMS:
        joined[name] = old[name] + new[name]
    joined["g_max"] = np.maximum(old["g_max"], new["g_max"])
    for name in ("f_min", "xf_min"):
        joined[name] = np.minimum(old[name], new[name])
    slopes = {name: np.einsum("ni,nij->nj", d, previous) for name, d in added.gradients.items()}
    slopes["period"] = returns.gradients["period"][rows] + slopes["period"]
    for name, sign in (("x_low", -1.0), ("x_high", 1.0), ("v_min", -1.0), ("v_max", 1.0)):
        is_new = sign * new[name] > sign * old[name]
        joined[name] = np.where(is_new, new[name], old[name])
        slopes[name] = np.where(is_new[:, None], slopes[name], returns.gradients[name][rows])
    shifted = np.exp(1j * omega * old["period"]) * (new["cosine"] + 1j * new["sine"])
    joined["cosine"], joined["sine"] = old["cosine"] + shifted.real, old["sine"] + shifted.imag
    for found, values in ((returns.numbers, joined), (returns.gradients, slopes)):
        for name, value in values.items():
            found[name][rows] = value
    returns.status[rows], returns.image[rows] = added.status, added.image
    returns.jacobian[rows] = added.jacobian @ previous


def change_along(gradients, step):
    """Return the first-order changes (n, m) by a step (n, k), from gradients (n, m, k)."""
    # (not a product of matrices: numpy rounds it otherwise for one case than for several)
    return sum(gradients[:, :, i] * step[:, i, None] for i in range(step.shape[1]))


def multipliers(returns):
    """Return the complex Floquet multipliers (n, k) beside the trivial 1, the largest first.

    Their sum is the trace of the map's derivative; their product is, by Liouville's formula, the
    exponential of the integrated trace of the Jacobian.  So the smallest one is accurate even if it
    is far below the errors of the derivative.  Without mass it is 0.
    """
    with np.errstate(over="ignore", invalid="ignore"):  # (NaN where it did not come back)
        product = np.exp(np.nan_to_num(returns.numbers["trace"], nan=-np.inf))
        if returns.jacobian.shape[1] > 2:
            return _many_multipliers(returns.jacobian, product)
        half = 0.5 * np.trace(returns.jacobian, axis1=1, axis2=2)
    root = np.sqrt(half.astype(complex) ** 2 - product)
    first = half + np.where(half < 0.0, -root, root)
    return np.stack([first, _quotient(product, first)], axis=1)


def _many_multipliers(jacobian, product):
    """Return the multipliers in more than two dimensions, the last one from their product."""
    finite = np.isfinite(jacobian).all(axis=(1, 2))
    found = np.linalg.eigvals(np.where(finite[:, None, None], jacobian, 0.0)).astype(complex)
    found = np.take_along_axis(found, np.argsort(-np.abs(found), axis=1, kind="stable"), axis=1)
    last = _quotient(product, np.prod(found[:, :-1], axis=1))
    # One of a complex pair is as accurate as the other.
    found[:, -1] = np.where(found[:, -1].imag == 0.0, last, found[:, -1])
    found[~finite] = np.nan
    return found


def _quotient(product, others):
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        return np.where(np.abs(others) < TINY, 0.0, product / others)


def effective_tolerance(returns, tol):
    """Return the tolerance that the steps of these returns kept; rounding bounds it from below.

    The returns must have their extremes recorded, which is not checked.
    """
    extremes = [returns.numbers[name] for name in ("x", "x_low", "v_max")]
    return np.maximum(tol, ROUNDING * np.abs(extremes).max(axis=0))


def newton_step(returns, u):
    """Return the step (n, k) of Newton's method from u to the fixed point; not finite if none."""
    matrix, residual = np.eye(u.shape[1]) - returns.jacobian, returns.image - u
    if u.shape[1] == 2:
        (a, b), (c, d) = np.moveaxis(matrix, 0, -1)
        psi, G = residual.T
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            return np.stack([d * psi - b * G, a * G - c * psi], axis=1) / (a * d - b * c)[:, None]
    return solve_each(matrix, residual)


def solve_each(matrices, vectors):
    """Solve n linear systems (n, k, k), (n, k); the solution is NaN if it is not unique."""
    solvable = np.isfinite(matrices).all(axis=(1, 2)) & np.isfinite(vectors).all(axis=1)
    solvable[solvable] = np.linalg.det(matrices[solvable]) != 0.0
    solution = np.full(vectors.shape, np.nan)
    solution[solvable] = np.linalg.solve(matrices[solvable], vectors[solvable][:, :, None])[:, :, 0]
    return solution
