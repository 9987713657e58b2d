"""The return map: from one stress maximum of a steadily driven slider to the next.

A return begins and ends on the section V = V_lp, V rising, at points u = (psi - psi_ss, G), whose
units and symbols system.py has.  A limit cycle is a fixed point of the map from u to the next u, or
of an iterate of it (iterates.py).
"""

from typing import NamedTuple

import numpy as np

from ...engine import dispatch
from ...engine.lanes import ROUNDING
from ...engine.model import FINISHED
from ...engine.return_map import DERIVATIVES, RETURN_NUMBERS, Starts
from ...friction.point import point_at
from .system import is_slaved

# A hundred times what a stick-slip cycle over 20 decades of V takes.
MAX_STEPS_OF_RETURN = 2e5
# Complex numbers below this have no inverse.
TINY = np.finfo(float).tiny


class Returns(NamedTuple):
    """One return of each of n sliders, in units of Dc/V_lp (time) and a sigma (stress).

    Where it did not come back to the section only `image` is NaN: `jacobian` and `numbers` are
    those of the place where it ended.
    """

    status: np.ndarray  # engine.model; FINISHED where it came back
    image: np.ndarray  # (n, k) the next u
    jacobian: np.ndarray  # (n, k, k) d image/d u
    #: engine.return_map.RETURN_NUMBERS, and x_high, the stress at which it began; name -> (n,)
    numbers: dict
    #: derivatives of engine.return_map.DERIVATIVES and of x_high by u, name -> (n, k)
    gradients: dict

    @property
    def came_back(self):
        """(n,) whether it came back to the section."""
        return self.status == FINISHED


def return_map(system, y, atol, *, steady_tol=0.0, observe=False, period=None):
    """`Returns` of sliders from y (n, 3) to their next stress maximum.

    STEADY_SLIDING where `steady_tol` stops it; after 200,000 steps STEP_LIMIT.

    atol : (n,) tolerance of a step in x, v and psi
    steady_tol : (n,) distance from steady sliding at which to stop
    observe : whether extremes are recorded, which else mean nothing
    period : (n,) periods assumed for the waveform; without them that means nothing
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
    """(n, k, k) derivatives of the next u; of G by the rates if inertia is lost in rounding.

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


def change_along(gradients, step):
    """(n, m) first-order changes, by a step (n, k), of what has the gradients (n, m, k)."""
    # (no product of matrices: numpy rounds it otherwise for one case than for several)
    return sum(gradients[:, :, i] * step[:, i, None] for i in range(step.shape[1]))


def multipliers(returns):
    """(n, k) complex Floquet multipliers beside the trivial 1, the largest first.

    Their sum is the trace of the map's derivative, their product, by Liouville's formula, the
    exponential of the integrated trace of the Jacobian.  So the smallest one has digits even where
    it is far below the errors of the derivative.  Without mass it is 0.
    """
    with np.errstate(over="ignore", invalid="ignore"):  # (NaN where it did not come back)
        product = np.exp(np.nan_to_num(returns.numbers["trace"], nan=-np.inf))
        if returns.jacobian.shape[1] > 2:
            return _many_multipliers(returns.jacobian, product)
        half = 0.5 * np.trace(returns.jacobian, axis1=1, axis2=2)
    root = np.sqrt(half.astype(complex) ** 2 - product)
    first = half + np.where(half < 0.0, -root, root)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        second = np.where(np.abs(first) < TINY, 0.0, product / first)
    return np.stack([first, second], axis=1)


def _many_multipliers(jacobian, product):
    """`multipliers` of maps in more than two dimensions, the last one by the product of all."""
    finite = np.isfinite(jacobian).all(axis=(1, 2))
    found = np.linalg.eigvals(np.where(finite[:, None, None], jacobian, 0.0)).astype(complex)
    found = np.take_along_axis(found, np.argsort(-np.abs(found), axis=1, kind="stable"), axis=1)
    others = np.prod(found[:, :-1], axis=1)
    alone = found[:, -1].imag == 0.0  # (else it is one of a pair, and known as well as that)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        last = np.where(np.abs(others) < TINY, 0.0, product / others)
    found[:, -1] = np.where(alone, last, found[:, -1])
    found[~finite] = np.nan
    return found


def effective_tolerance(returns, tol):
    """(n,) tolerance that the steps of these returns kept, which rounding bounds from below.

    The returns must have their extremes recorded, which is not checked.
    """
    extremes = [returns.numbers[name] for name in ("x", "x_low", "v_max")]
    return np.maximum(tol, ROUNDING * np.abs(extremes).max(axis=0))


def newton_step(returns, u):
    """(n, k) step of Newton's method from u to the fixed point; not finite where it has none."""
    matrix, off = np.eye(u.shape[1]) - returns.jacobian, returns.image - u
    if u.shape[1] == 2:
        (a, b), (c, d) = np.moveaxis(matrix, 0, -1)
        psi, G = off.T
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            return np.stack([d * psi - b * G, a * G - c * psi], axis=1) / (a * d - b * c)[:, None]
    return solve_each(matrix, off)


def solve_each(matrices, vectors):
    """(n, k) solutions of n linear systems (n, k, k), (n, k); NaN where there is not just one."""
    solvable = np.isfinite(matrices).all(axis=(1, 2)) & np.isfinite(vectors).all(axis=1)
    solvable[solvable] = np.linalg.det(matrices[solvable]) != 0.0
    solution = np.full(vectors.shape, np.nan)
    solution[solvable] = np.linalg.solve(matrices[solvable], vectors[solvable][:, :, None])[:, :, 0]
    return solution
