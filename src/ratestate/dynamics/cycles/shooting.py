"""The return map: from one stress maximum of a steadily driven slider to the next.

Everything is in units of V_lp, Dc and a sigma (V0 := V_lp in engine/model.py), so that a slider
is kappa, eta and the coefficients p of its law, b/a first.  A return begins and ends on the section
V = V_lp, V rising, where the stress has its maximum.  Points of the section are

    u = (psi - psi_ss, G),   G = dv/dT = (x - R(psi))/eta,   x = R(psi) + eta G,

with R the friction at V_lp and a psi for each of the law's variables; the steady psi_ss are 0 for
most laws.  Nothing cancels in these, neither for small eta, where inertia is lost in rounding and G
follows from psi (R_v G = -R_psi dpsi/dT), nor near steady sliding.  A limit cycle is a fixed point
of the map from u to the next u, or of an iterate of it (iterates.py).
"""

import functools
from typing import NamedTuple

import numpy as np

from ...engine import dispatch
from ...engine.lanes import ROUNDING
from ...engine.model import FINISHED, SLAVED
from ...engine.return_map import DERIVATIVES, RETURN_NUMBERS, Starts
from ...friction.laws import friction_law
from ...friction.linear_stability import edges, linearisation
from ...friction.stability import eta
from ..simulation.cases import V_LIMIT

# A hundred times what a stick-slip cycle over 20 decades of V takes.
MAX_STEPS_OF_RETURN = 2e5
# Tolerance of a step in x, v and psi that rounding of numbers of order 1 allows.
TIGHTEST = 2e-14


class System(NamedTuple):
    """Sliders driven at V_lp; dimensionless arrays (n,), one value a slider, not checked."""

    law: str
    kappa: np.ndarray  # K Dc/(a sigma)
    p: np.ndarray  # (n, k) coefficients of the law
    eta: np.ndarray  # M V_lp^2/(a sigma Dc)
    #: ln(V/V_lp) beyond which a slider that does not slow down has run away; inf if M > 0
    v_limit: np.ndarray

    def at(self, which):
        """The sliders with these numbers, or where this is true."""
        return select(self, which)

    @property
    def friction(self):
        """The law itself."""
        return friction_law(self.law)

    @property
    def coefficients(self):
        """The law's coefficients, a tuple of arrays (n,)."""
        return tuple(self.p.T)

    @property
    def beta(self):
        """(n,) b/a, of a law of one length."""
        return self.p[:, 0]

    @property
    def steady(self):
        """(n, n_states) the law's variables in steady sliding at V_lp."""
        if self.friction.one_length:
            return np.zeros((len(self.kappa), 1))
        return np.stack(self.friction.steady_variables(self.coefficients), axis=1)

    @property
    def margin(self):
        """(n,) (K - K_c) Dc/(a sigma): negative where steady sliding is unstable (eq. 6)."""
        if self.friction.one_length:
            return self.kappa - (self.beta - 1.0) * (1.0 + self.eta)
        found = edges(self.friction, self.coefficients)
        return self.kappa - found.kappa(self.eta).max(axis=1)

    @property
    def stable(self):
        """(n,) whether steady sliding is; by laws of one length on the edge of it too."""
        if self.friction.one_length:
            return self.margin >= 0.0
        found = edges(self.friction, self.coefficients)
        return found.unstable_pairs(self.kappa, self.eta) <= 0

    @property
    def may_cycle(self):
        """(n,) whether there may be a cycle; under a law of one length only where b > a."""
        weakens = self.beta > 1.0 if self.friction.one_length else True
        return np.isfinite(self.kappa) & weakens

    @property
    def omega(self):
        """(n,) angular frequency of the Hopf bifurcation; another where there is none."""
        if self.friction.one_length:
            return np.sqrt(np.maximum(self.beta - 1.0, 0.0))
        found = edges(self.friction, self.coefficients)
        last = found.kappa(self.eta).argmax(axis=1)[:, None]
        z = np.take_along_axis(found.z, last, axis=1)[:, 0]
        return np.sqrt(np.where(z > 0.0, z, 1.0))

    @property
    def cancellation(self):
        """(n,) the sum of the evolution effects over what they exceed the direct one by."""
        if self.friction.one_length:
            return self.beta / (self.beta - 1.0)
        linear = linearisation(self.friction, self.coefficients)
        excess = np.abs(linear.evolution.sum(axis=1) - linear.direct)
        return np.abs(linear.evolution).sum(axis=1) / excess

    def slopes(self, psi):
        """R_v (n,) and R_psi (n, n_states) at V_lp and the variables psi (n, n_states)."""
        by_v, by_psi = self.friction.resistance_partials(0.0, 1.0, tuple(psi.T), self.coefficients)
        n = len(self.kappa)
        return np.broadcast_to(by_v, n), np.stack([np.broadcast_to(x, n) for x in by_psi], axis=1)


def one_length_system(law, kappa, beta, eta, v_limit):
    """`System` of sliders, arrays (n,), under a law of one length."""
    return System(law, kappa, beta[:, None].copy(), eta, v_limit)


def select(cases, which):
    """A named tuple of arrays, at these numbers or where this is true; what is no array stays."""
    return type(cases)(*(x[which] if isinstance(x, np.ndarray) else x for x in cases))


def system_of(law, *, sigma, K, M, V_lp, **values):
    """`System` of sliders with these parameters [SI], each (n,) and not checked.

    Others are ignored.
    """
    a, Dc = values["a"], values["Dc"]
    inertia = eta(V_lp, a=a, Dc=Dc, sigma=sigma, M=M)
    v_limit = np.where(M == 0.0, np.log(V_LIMIT / V_lp), np.inf)
    p = friction_law(law).coefficient_array(V_lp, values)
    return System(law, K * Dc / (a * sigma), p, inertia, v_limit)


class Returns(NamedTuple):
    """One return of each of n sliders, in units of Dc/V_lp (time) and a sigma (stress).

    Where it did not come back to the section only `image` is NaN: `jacobian` and `numbers` are
    those of the place where it ended.
    """

    status: np.ndarray  # engine.model; FINISHED where it came back
    image: np.ndarray  # (n, k) the next u
    jacobian: np.ndarray  # (n, k, k) d image/d u
    numbers: dict  # engine.return_map.RETURN_NUMBERS, name -> (n,)
    #: derivatives of engine.return_map.DERIVATIVES by u, name -> (n, k)
    gradients: dict

    @property
    def came_back(self):
        """(n,) whether it came back to the section."""
        return self.status == FINISHED


def state(system, u):
    """(n, len(y)) x, v and psi of the section's points u (n, k)."""
    psi = u[:, :-1] + system.steady
    zero = np.zeros(len(u))
    x = system.friction.resistance(0.0, 1.0, tuple(psi.T), system.coefficients)
    return np.stack([x + system.eta * u[:, -1], zero, *psi.T], axis=1)


def steady_sliding_at(system, w):
    """(n, len(y)) x, v, psi of steady sliding at w (n,) times V_lp."""
    law, p, v = system.friction, system.coefficients, np.log(w)
    there = law.rescaled(p, w)
    states = law.log_states(0.0, law.steady_variables(there), there)
    psi = law.variables(v, tuple(state - v for state in states), p)
    return np.stack([law.resistance(v, w, psi, p), v, *psi], axis=1)


def weights(system):
    """(n, k) the changes of x with each of u, at steady sliding: R_psi, and eta for G."""
    _, by_psi = system.slopes(system.steady)
    return np.concatenate([by_psi, system.eta[:, None]], axis=1)


def distance(system, vectors):
    """(n,) length of vectors (n, k) of u, measured by the changes of R and of eta G."""
    with np.errstate(invalid="ignore"):  # without mass, where Newton's method has no step
        return functools.reduce(np.hypot, (weights(system) * vectors).T)


def small_amplitude(system, u):
    """(n,) amplitude r of ln V on an orbit through u near steady sliding, of frequency omega_c.

    dx/dT = -kappa v there, so that x, less that of steady sliding, is r kappa/omega_c at its
    maximum.  Of the sign of x.
    """
    x = (weights(system) * u).sum(axis=1)
    return x * system.omega / system.kappa


def tightest(system, u):
    """(n,) the smallest tolerance of a return that is above the rounding of x; NaN where u is."""
    return TIGHTEST * np.maximum(1.0, distance(system, u))


def return_map(system, y, atol, *, alone, steady_tol=0.0, period=None):
    """`Returns` of sliders from y (n, 3) to their next stress maximum.

    STEADY_SLIDING where `steady_tol` stops it; after 200,000 steps STEP_LIMIT.

    atol : (n,) tolerance of a step in x, v and psi
    alone : whether this is the one case of a call, which may take the scalar path
    steady_tol : (n,) distance from steady sliding at which to stop
    period : (n,) periods assumed for the waveform; if given, extremes and waveform are recorded,
        else these numbers mean nothing
    """
    n, k = len(y), y.shape[1] - 1
    _, by_psi = system.slopes(y[:, 2:])
    directions = np.zeros((n, k, k + 1))  # d(x, v, psi)/d u
    directions[:, range(k - 1), range(2, k + 1)] = 1.0
    directions[:, :-1, 0], directions[:, -1, 0] = by_psi, system.eta
    rest = state(system, np.zeros((n, k)))
    starts = Starts(
        system.kappa,
        np.ascontiguousarray(system.p),
        system.eta,
        np.ascontiguousarray(y),
        directions,
        rest,
        unstable=(~system.stable).astype(float),
        atol=np.broadcast_to(atol, n).astype(float),
        steady_tol=np.broadcast_to(steady_tol, n).astype(float),
        observe=np.full(n, float(period is not None)),
        period=np.ones(n) if period is None else np.ascontiguousarray(period),
        v_limit=system.v_limit,
        max_steps=np.full(n, MAX_STEPS_OF_RETURN),
    )
    results = dispatch.run_returns(system.friction, starts, alone)
    numbers = dict(zip(RETURN_NUMBERS, results.numbers.T, strict=True))
    gradients = dict(zip(DERIVATIVES, np.moveaxis(results.along, -1, 0), strict=True))
    image = np.concatenate([results.psi - system.steady, numbers["G"][:, None]], axis=1)
    image[results.status != FINISHED] = np.nan
    jacobian = _jacobian(system, results.psi, gradients["x"], np.swapaxes(results.psi_along, 1, 2))
    return Returns(results.status, image, jacobian, numbers, gradients)


def _jacobian(system, psi, d_x, d_psi):
    """(n, k, k) derivatives of the next u; of G by the rates where inertia is lost in rounding.

    psi, d_x, d_psi : (n, n_states) at the return; (n, k) and (n, n_states, k) derivatives by u
    """
    slaved = system.eta < SLAVED
    _, by_psi = system.slopes(psi)
    with np.errstate(over="ignore", invalid="ignore"):
        d_G = d_x - (by_psi[:, :, None] * d_psi).sum(axis=1)
        d_G = d_G / np.where(slaved, 1.0, system.eta)[:, None]
        if slaved.any():
            slope = _slaved_slope(system, psi)
            d_G = np.where(slaved[:, None], (slope[:, :, None] * d_psi).sum(axis=1), d_G)
    return np.concatenate([d_psi, d_G[:, None]], axis=1)


def _slaved_slope(system, psi):
    """(n, n_states) derivatives of G = -R_psi f/R_v by psi at V_lp, with f the rates of psi."""
    law, p, states = system.friction, system.coefficients, tuple(psi.T)
    at = 0.0, 1.0, states, law.exponentials(0.0, 1.0, states, p), p
    rates, (_, f_psi) = law.rates(*at), law.rate_partials(*at)
    R_v, R_psi = system.slopes(psi)
    _, R_vpsi, R_psipsi = law.resistance_partials_2(0.0, 1.0, states, p)
    slopes = []
    for j in range(len(states)):
        bends = sum(row[j] * rate for row, rate in zip(R_psipsi, rates, strict=True))
        drive = sum(R_psi[:, k] * rate for k, rate in enumerate(rates))
        slopes.append((drive * R_vpsi[j] / R_v - bends - R_psi[:, j] * f_psi[j]) / R_v)
    return np.stack(slopes, axis=1)


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
        second = np.where(first == 0.0, 0.0, product / first)
    return np.stack([first, second], axis=1)


def _many_multipliers(jacobian, product):
    """`multipliers` of maps in more than two dimensions, the last one by the product of all."""
    finite = np.isfinite(jacobian).all(axis=(1, 2))
    found = np.linalg.eigvals(np.where(finite[:, None, None], jacobian, 0.0)).astype(complex)
    found = np.take_along_axis(found, np.argsort(-np.abs(found), axis=1, kind="stable"), axis=1)
    others = np.prod(found[:, :-1], axis=1)
    alone = found[:, -1].imag == 0.0  # (else it is one of a pair, and known as well as that)
    with np.errstate(divide="ignore", invalid="ignore"):
        last = np.where(others == 0.0, 0.0, product / others)
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
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.stack([d * psi - b * G, a * G - c * psi], axis=1) / (a * d - b * c)[:, None]
    solvable = np.isfinite(matrix).all(axis=(1, 2)) & np.isfinite(off).all(axis=1)
    solvable[solvable] = np.linalg.det(matrix[solvable]) != 0.0
    step = np.full(u.shape, np.nan)
    step[solvable] = np.linalg.solve(matrix[solvable], off[solvable][:, :, None])[:, :, 0]
    return step
