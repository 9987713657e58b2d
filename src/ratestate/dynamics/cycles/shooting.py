"""The return map: from one stress maximum of a steadily driven slider to the next.

Everything is in units of V_lp, Dc and a sigma (V0 := V_lp in engine/model.py), so that a slider
is three numbers kappa, beta = b/a, eta, and steady sliding is x = v = psi = 0.  A return begins and
ends on the section V = V_lp, V rising, where the stress has its maximum.  Points of the section are

    u = (psi, G),     G = dv/dT = (x - beta psi)/eta,     x = beta psi + eta G,

Nothing cancels in these, neither for small eta, where inertia is lost in rounding and G follows
from psi (G = -beta dpsi/dT), nor near steady sliding.  A limit cycle is a fixed point of the map
from u to the next u, or of an iterate of it (iterates.py).
"""

from typing import NamedTuple

import numpy as np

from ...engine import dispatch
from ...engine.lanes import ROUNDING
from ...engine.model import FINISHED, SLAVED
from ...engine.return_map import RETURN_NUMBERS, Starts
from ...friction.laws import evolution_law
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
    beta: np.ndarray  # b/a
    eta: np.ndarray  # M V_lp^2/(a sigma Dc)
    #: ln(V/V_lp) beyond which a slider that does not slow down has run away; inf if M > 0
    v_limit: np.ndarray

    def at(self, which):
        """The sliders with these numbers, or where this is true."""
        return select(self, which)

    @property
    def margin(self):
        """(n,) (K - K_c) Dc/(a sigma): negative where steady sliding is unstable (eq. 6)."""
        return self.kappa - (self.beta - 1.0) * (1.0 + self.eta)


def select(cases, which):
    """A named tuple of arrays, at these numbers or where this is true; what is no array stays."""
    return type(cases)(*(x[which] if isinstance(x, np.ndarray) else x for x in cases))


def system_of(law, *, a, b, Dc, sigma, K, M, V_lp, **_):
    """`System` of sliders with these parameters [SI], each (n,) and not checked.

    Others are ignored.
    """
    inertia = eta(V_lp, a=a, Dc=Dc, sigma=sigma, M=M)
    v_limit = np.where(M == 0.0, np.log(V_LIMIT / V_lp), np.inf)
    return System(law, K * Dc / (a * sigma), b / a, inertia, v_limit)


class Returns(NamedTuple):
    """One return of each of n sliders, in units of Dc/V_lp (time) and a sigma (stress).

    Where it did not come back to the section only `image` is NaN: `jacobian` and `numbers` are
    those of the place where it ended.
    """

    status: np.ndarray  # engine.model; FINISHED where it came back
    image: np.ndarray  # (n, 2) the next u
    jacobian: np.ndarray  # (n, 2, 2) d image/d u
    numbers: dict  # engine.return_map.RETURN_NUMBERS, name -> (n,)

    @property
    def came_back(self):
        """(n,) whether it came back to the section."""
        return self.status == FINISHED


def state(system, u):
    """(n, 3) x, v, psi of the section's points u (n, 2)."""
    psi, G = u.T
    x = system.beta * psi + system.eta * G
    return np.stack([x, np.zeros_like(x), psi], axis=1)


def distance(system, vectors):
    """(n,) length of vectors (n, 2) of (psi, G), measured by the changes of beta psi and eta G."""
    with np.errstate(invalid="ignore"):  # without mass, where Newton's method has no step
        return np.hypot(system.beta * vectors[:, 0], system.eta * vectors[:, 1])


def small_amplitude(system, u):
    """(n,) amplitude r of ln V on an orbit through u near steady sliding, of frequency omega_c.

    dx/dT = -kappa v there, so that x = r kappa/omega_c at its maximum.  Of the sign of x; 0 where
    b <= a.
    """
    x = state(system, u)[:, 0]
    return x * np.sqrt(np.maximum(system.beta - 1.0, 0.0)) / system.kappa


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
    n = len(y)
    directions = np.zeros((n, 2, 3))  # d(x, v, psi)/d(psi, G)
    directions[:, 0, 0], directions[:, 0, 2] = system.beta, 1.0
    directions[:, 1, 0] = system.eta
    starts = Starts(
        system.kappa,
        system.beta,
        system.eta,
        np.ascontiguousarray(y),
        directions,
        np.broadcast_to(atol, n).astype(float),
        np.broadcast_to(steady_tol, n).astype(float),
        observe=np.full(n, float(period is not None)),
        period=np.ones(n) if period is None else np.ascontiguousarray(period),
        v_limit=system.v_limit,
        max_steps=np.full(n, MAX_STEPS_OF_RETURN),
    )
    results = dispatch.run_returns(evolution_law(system.law), starts, alone)
    numbers = dict(zip(RETURN_NUMBERS, results.numbers.T, strict=True))
    image = np.stack([numbers["psi"], numbers["G"]], axis=1)
    image[results.status != FINISHED] = np.nan
    return Returns(results.status, image, _jacobian(system, numbers), numbers)


def _jacobian(system, numbers):
    """(n, 2, 2) derivatives of the next u; of G by psi's rate where inertia is lost in rounding."""
    slaved, psi = system.eta < SLAVED, numbers["psi"]
    with np.errstate(over="ignore", invalid="ignore"):
        partials = evolution_law(system.law).rate_partials(1.0, 0.0, psi, np.exp(-psi))
        slope = -system.beta * partials[1]
    d_psi = gradient(numbers, "psi")
    d_G = gradient(numbers, "x") - system.beta[:, None] * d_psi
    d_G = d_G / np.where(slaved, 1.0, system.eta)[:, None]
    d_G = np.where(slaved[:, None], slope[:, None] * d_psi, d_G)
    return np.stack([d_psi, d_G], axis=1)


def gradient(numbers, name):
    """(n, 2) derivatives of one of a return's numbers with respect to u = (psi, G).

    There are some of period, x, psi, x_low, v_max and v_min, and of `iterated_map`'s x_high.
    """
    return np.stack([numbers[f"{name}_a"], numbers[f"{name}_b"]], axis=1)


def change_along(gradients, step):
    """(n, m) first-order changes, by a step (n, k), of what has the gradients (n, m, k)."""
    # (no product of matrices: numpy rounds it otherwise for one case than for several)
    return sum(gradients[:, :, i] * step[:, i, None] for i in range(step.shape[1]))


def multipliers(returns):
    """(n, 2) complex Floquet multipliers beside the trivial 1, the larger first.

    Their sum is the trace of the map's derivative, their product, by Liouville's formula, the
    exponential of the integrated trace of the Jacobian.  So the smaller one has digits even where
    it is far below the errors of the derivative.  Without mass it is 0.
    """
    half = 0.5 * np.trace(returns.jacobian, axis1=1, axis2=2)
    with np.errstate(over="ignore"):
        product = np.exp(np.nan_to_num(returns.numbers["trace"], nan=-np.inf))
    root = np.sqrt(half.astype(complex) ** 2 - product)
    first = half + np.where(half < 0.0, -root, root)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        second = np.where(first == 0.0, 0.0, product / first)
    return np.stack([first, second], axis=1)


def effective_tolerance(returns, tol):
    """(n,) tolerance that the steps of these returns kept, which rounding bounds from below.

    The returns must have their extremes recorded, which is not checked.
    """
    extremes = [returns.numbers[name] for name in ("x", "x_low", "v_max")]
    return np.maximum(tol, ROUNDING * np.abs(extremes).max(axis=0))


def newton_step(returns, u):
    """(n, 2) step of Newton's method from u to the fixed point; not finite where it has none."""
    (a, b), (c, d) = np.moveaxis(np.eye(2) - returns.jacobian, 0, -1)
    psi, G = (returns.image - u).T
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.stack([d * psi - b * G, a * G - c * psi], axis=1) / (a * d - b * c)[:, None]
