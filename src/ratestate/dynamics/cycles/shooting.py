"""Turns: from one stress maximum of a steadily driven slider to the next, and their derivative.

Everything is in units of V_lp, Dc and a sigma (V0 := V_lp in engine/model.py), so that a slider
is three numbers kappa, beta = b/a, eta, and steady sliding is x = v = psi = 0.  A turn begins and
ends on the section V = V_lp, V rising, where the stress has its maximum.  Its points are given by

    u = (psi, G),     G = dv/dT = (x - beta psi)/eta,     x = beta psi + eta G,

in which nothing cancels, neither for small eta, where inertia is lost in rounding and G follows
from psi (G = -beta dpsi/dT), nor near steady sliding.  A limit cycle is a fixed point of the map
from u to the next u, or of an iterate of it (iterates.py).
"""

from typing import NamedTuple

import numpy as np

from ...engine import dispatch
from ...engine.lanes import ROUNDING
from ...engine.model import FINISHED
from ...engine.return_map import RETURN_NUMBERS, SLAVED, Starts
from ...friction.laws import evolution_law
from ...friction.stability import eta
from ..simulation.cases import V_LIMIT

# Of one turn: a hundred times what a stick-slip cycle over 20 decades of V takes.
MAX_STEPS = 2e5
# Tolerance of a step in x, v and psi that rounding of numbers of order 1 allows.
TIGHTEST = 2e-14


class System(NamedTuple):
    """Sliders driven at V_lp; arrays of one value a slider."""

    law: str
    kappa: np.ndarray  # K Dc/(a sigma)
    beta: np.ndarray  # b/a
    eta: np.ndarray  # M V_lp^2/(a sigma Dc)
    v_limit: np.ndarray  # ln(V/V_lp) beyond which what does not turn back has run away

    def at(self, which):
        """The sliders with these numbers, or where this is true."""
        return System(self.law, *(values[which] for values in self[1:]))

    @property
    def margin(self):
        """(K - K_c) Dc/(a sigma): negative where steady sliding is unstable (eq. 6)."""
        return self.kappa - (self.beta - 1.0) * (1.0 + self.eta)


def system_of(law, *, a, b, Dc, sigma, K, M, V_lp, **_):
    """`System` of sliders with these parameters [SI], each (n,); those left over play no part."""
    inertia = eta(V_lp, a=a, Dc=Dc, sigma=sigma, M=M)
    v_limit = np.where(M == 0.0, np.log(V_LIMIT / V_lp), np.inf)
    return System(law, K * Dc / (a * sigma), b / a, inertia, v_limit)


class Turns(NamedTuple):
    """What one turn of each of n sliders did; NaN where it did not come back to the section."""

    status: np.ndarray  # engine.model; FINISHED where it came back
    image: np.ndarray  # (n, 2) the next u
    jacobian: np.ndarray  # (n, 2, 2) d image/d u
    numbers: dict  # engine.return_map.RETURN_NUMBERS, name -> (n,)

    @property
    def came_back(self):
        return self.status == FINISHED


def state(system, u):
    """(n, 3) x, v, psi of the section's points u (n, 2)."""
    psi, G = u.T
    x = system.beta * psi + system.eta * G
    return np.stack([x, np.zeros_like(x), psi], axis=1)


def distance(system, vectors):
    """(n,) length of vectors (n, 2) of (psi, G): what they change in x, beta psi and eta G."""
    with np.errstate(invalid="ignore"):  # no mass, and no step of Newton's method
        return np.hypot(system.beta * vectors[:, 0], system.eta * vectors[:, 1])


def small_amplitude(system, u):
    """(n,) amplitude r of ln V on an orbit through u near steady sliding, of frequency omega_c.

    dx/dT = -kappa v there, so that x = r kappa/omega_c at its maximum.
    """
    x = state(system, u)[:, 0]
    return x * np.sqrt(np.maximum(system.beta - 1.0, 0.0)) / system.kappa


def tightest(system, u):
    """(n,) the smallest tolerance of a turn that rounding of x leaves a meaning."""
    return TIGHTEST * np.maximum(1.0, distance(system, u))


def turn(system, y, rtol, *, alone, steady_tol=0.0, period=None):
    """Take sliders at y (n, 3) to their next stress maximum.

    rtol : (n,) tolerance of a step in x, v and psi
    alone : whether this is the one case of a call, which may take the scalar path
    steady_tol : (n,) distance from steady sliding at which to stop
    period : (n,) periods assumed for the waveform; extremes and waveform are recorded if given
    """
    n = len(y)
    along = np.zeros((n, 2, 3))
    along[:, 0, 0], along[:, 0, 2] = system.beta, 1.0
    along[:, 1, 0] = system.eta
    starts = Starts(
        system.kappa,
        system.beta,
        system.eta,
        np.ascontiguousarray(y),
        along,
        np.broadcast_to(rtol, n).astype(float),
        np.broadcast_to(steady_tol, n).astype(float),
        observe=np.full(n, float(period is not None)),
        period=np.ones(n) if period is None else np.ascontiguousarray(period),
        v_limit=system.v_limit,
        max_steps=np.full(n, MAX_STEPS),
    )
    law = evolution_law(system.law)
    returns = dispatch.run_returns(law.code, starts, alone)
    numbers = dict(zip(RETURN_NUMBERS, returns.numbers.T, strict=True))
    image = np.stack([numbers["psi"], numbers["G"]], axis=1)
    image[returns.status != FINISHED] = np.nan
    jacobian = np.empty((n, 2, 2))
    slaved = system.eta < SLAVED
    eta = np.where(slaved, 1.0, system.eta)
    psi = numbers["psi"]
    with np.errstate(over="ignore", invalid="ignore"):
        slope = -system.beta * law.rate_partials(1.0, 0.0, psi, np.exp(-psi))[1]
    for column, name in enumerate("ab"):
        d_psi = numbers[f"psi_{name}"]
        d_G = (numbers[f"x_{name}"] - system.beta * d_psi) / eta
        jacobian[:, 0, column] = d_psi
        jacobian[:, 1, column] = np.where(slaved, slope * d_psi, d_G)
    return Turns(returns.status, image, jacobian, numbers)


def multipliers(turns):
    """(n, 2) complex Floquet multipliers beside the trivial 1, the larger first.

    Their sum is the trace of the map's derivative, their product, by Liouville's formula, the
    exponential of the integrated trace of the Jacobian: the smaller one so has digits even where
    it is far below the errors of the derivative.
    """
    half = 0.5 * np.trace(turns.jacobian, axis1=1, axis2=2)
    with np.errstate(over="ignore"):
        product = np.exp(np.nan_to_num(turns.numbers["trace"], nan=-np.inf))
    root = np.sqrt(half.astype(complex) ** 2 - product)
    first = half + np.where(half < 0.0, -root, root)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        second = np.where(first == 0.0, 0.0, product / first)
    return np.stack([first, second], axis=1)


def kept_tolerance(turns, tol):
    """(n,) tolerance of the steps of these turns, which rounding bounds from below."""
    extremes = [turns.numbers[name] for name in ("x", "x_low", "v_max")]
    return np.maximum(tol, ROUNDING * np.abs(extremes).max(axis=0))


def newton_step(turns, u):
    """(n, 2) step of Newton's method from u to the fixed point; not finite where it has none."""
    (a, b), (c, d) = np.moveaxis(np.eye(2) - turns.jacobian, 0, -1)
    psi, G = (turns.image - u).T
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.stack([d * psi - b * G, a * G - c * psi], axis=1) / (a * d - b * c)[:, None]
