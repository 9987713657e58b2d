"""Steadily driven sliders in dimensionless form, and the points of the section V = V_lp.

Everything is in units of V_lp, Dc and a sigma (V0 := V_lp in engine/model.py), so that a slider
is kappa, eta and the coefficients p of its law, b/a first.  Points of the section V = V_lp, V
rising, where the stress has its maximum, are

    u = (psi - psi_ss, G),   G = dv/dT = (x - S(psi))/eta,   x = S(psi) + eta G,

with S the stress that opposes motion at V_lp and a psi for each of the law's variables; the steady
psi_ss are 0 for most laws.  Nothing cancels in these, neither for small eta, where inertia is lost
in rounding and G follows from psi (S_v G = -S_psi dpsi/dT), nor near steady sliding.
"""

import dataclasses
import functools

import numpy as np

from ...engine.model import SLAVED
from ...friction import linear_stability
from ...friction.composition import composed_law
from ...friction.stability import eta
from ..simulation.cases import V_LIMIT

# Tolerance of a step in x, v and psi that rounding of numbers of order 1 allows.
TIGHTEST = 2e-14


@dataclasses.dataclass(frozen=True, eq=False)
class System:
    """Sliders driven at V_lp; dimensionless arrays (n,), one value a slider, not checked.

    What follows from them is computed once, when it is first asked for; no array may be written to.
    """

    law: str
    kappa: np.ndarray  # K Dc/(a sigma)
    p: np.ndarray  # (n, k) coefficients of the law
    eta: np.ndarray  # M V_lp^2/(a sigma Dc)
    #: ln(V/V_lp) beyond which a slider that does not slow down has run away; inf if M > 0
    v_limit: np.ndarray

    def at(self, which):
        """The sliders with these numbers, or where this is true.

        The system itself, and with it what was computed, if these are all its sliders in order.
        """
        every = np.arange(len(self.kappa))
        if np.array_equal(every[which], every):
            return self
        return System(
            self.law, self.kappa[which], self.p[which], self.eta[which], self.v_limit[which]
        )

    @functools.cached_property
    def friction_law(self):
        """The law itself."""
        return composed_law(self.law)

    @functools.cached_property
    def coefficients(self):
        """The law's coefficients, a tuple of arrays (n,)."""
        return tuple(self.p.T)

    @property
    def beta(self):
        """(n,) b/a, of a law of one length."""
        return self.p[:, 0]

    @functools.cached_property
    def steady(self):
        """(n, n_states) the law's variables in steady sliding at V_lp."""
        if self.friction_law.one_length:
            return np.zeros((len(self.kappa), 1))
        return np.stack(self.friction_law.steady(self.coefficients).psi, axis=1)

    @functools.cached_property
    def critical(self):
        """`linear_stability.Critical` of steady sliding at V_lp, arrays (n,)."""
        return linear_stability.critical(self.friction_law, self.coefficients, self.eta)

    @functools.cached_property
    def margin(self):
        """(n,) (K - K_c) Dc/(a sigma): negative where steady sliding is unstable (eq. 6)."""
        return self.kappa - self.critical.kappa

    @functools.cached_property
    def stable(self):
        """(n,) whether steady sliding is; by laws of one length on the edge of it too."""
        if self.friction_law.one_length:
            return self.margin >= 0.0
        found = linear_stability.edges(self.friction_law, self.coefficients)
        return found.margin(self.kappa, self.eta) > 0.0

    @property
    def may_cycle(self):
        """(n,) whether there may be a cycle; under a law of one length only where b > a."""
        weakens = self.beta > 1.0 if self.friction_law.one_length else True
        return np.isfinite(self.kappa) & weakens

    @property
    def modes(self):
        """(n, n_states + 2) eigenvalues [V_lp/Dc] of steady sliding, least stable first."""
        return linear_stability.modes(self.friction_law, self.coefficients, self.kappa, self.eta)

    @property
    def cancellation(self):
        """(n,) the sum of the evolution effects over what they exceed the direct one by."""
        linear = linear_stability.linearisation(self.friction_law, self.coefficients)
        excess = np.abs(linear.evolution.sum(axis=1) - linear.direct)
        return np.abs(linear.evolution).sum(axis=1) / excess

    @functools.cached_property
    def weights(self):
        """(n, k) the changes of x with each of u, at steady sliding: S_psi, and eta for G."""
        _, by_psi = self.slopes(self.steady)
        return np.concatenate([by_psi, self.eta[:, None]], axis=1)

    @functools.cached_property
    def rest(self):
        """(n, len(y)) x, v and psi of steady sliding at V_lp."""
        return state(self, np.zeros((len(self.kappa), self.steady.shape[1] + 1)))

    def slopes(self, psi):
        """S_v (n,) and S_psi (n, n_states) at V_lp and the variables psi (n, n_states)."""
        psi = tuple(psi.T)
        by_v, *by_psi = self.friction_law.at_speed(0.0, psi, self.coefficients).S_slopes
        n = len(self.kappa)
        S_psi = np.empty((n, len(psi)))
        for k, values in enumerate(by_psi):
            S_psi[:, k] = values
        return np.full(n, by_v), S_psi


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
    unlimited = (M > 0.0) | (values.get("damping", 0.0) > 0.0)
    v_limit = np.where(unlimited, np.inf, np.log(V_LIMIT / V_lp))
    p = np.stack(composed_law(law).coefficient_arrays(V_lp, {"sigma": sigma, **values}), axis=-1)
    return System(law, K * Dc / (a * sigma), p, inertia, v_limit)


def state(system, u):
    """(n, len(y)) x, v and psi of the section's points u (n, k)."""
    psi = u[:, :-1] + system.steady
    zero = np.zeros(len(u))
    law, states, p = system.friction_law, tuple(psi.T), system.coefficients
    x = law.at_speed(0.0, states, p).S
    return np.stack([x + system.eta * u[:, -1], zero + law.v_at(1.0, states, p), *states], axis=1)


def steady_sliding_at(system, w):
    """(n, len(y)) x, v, psi of steady sliding at w (n,) times V_lp."""
    law, p = system.friction_law, system.coefficients
    at = law.steady(p, np.log(w))
    return np.stack([at.S, law.v_at(w, at.psi, p), *at.psi], axis=1)


def is_slaved(system, psi, g):
    """(n,) whether G is better known from the rates of psi (n, n_states) than as g/eta.

    g : (n,) x - S
    """
    S_v, _ = system.slopes(psi)
    return (system.eta == 0.0) | (np.maximum(system.eta, np.abs(g)) < SLAVED * np.sqrt(np.abs(S_v)))


def slaved_G(system, offset):
    """(n,) G without inertia, from the variables less their steady values, offset (n, n_states)."""
    states = tuple((offset + system.steady).T)
    return system.friction_law.at_speed(0.0, states, system.coefficients).slaved


def distance(system, vectors):
    """(n,) length of vectors (n, k) of u, measured by the changes of S and of eta G."""
    with np.errstate(invalid="ignore"):  # without mass, where Newton's method has no step
        return functools.reduce(np.hypot, (system.weights * vectors).T)


def linear_section(system):
    """(n, k) u of an orbit of unit amplitude in ln V, by the linear equations at frequency omega_c.

    Where steady sliding is stable at any K, for a frequency of 1.
    """
    law, p, psi = system.friction_law, system.coefficients, tuple(system.steady.T)
    omega = frequency(system)
    f_v, f_psi = law.at_speed(0.0, psi, p).f_slopes
    # v = sin(omega T) is 0 there, and rises
    states = [(f / (1j * omega - g)).imag for f, g in zip(f_v, f_psi, strict=True)]
    return np.stack([*states, omega], axis=1)


def small_amplitude(system, u):
    """(n,) amplitude r of ln V on an orbit through u near steady sliding, of frequency omega_c.

    dx/dT = -kappa v there, so that x, less that of steady sliding, is r kappa/omega_c at its
    maximum.  With several states, whose parts of x may cancel, the largest of what each part of u
    says.
    """
    if u.shape[1] > 2:
        return np.abs(u / linear_section(system)).max(axis=1)
    return (system.weights * u).sum(axis=1) * frequency(system) / system.kappa


def frequency(system):
    """(n,) omega_c [V_lp/Dc]; 1 where steady sliding is stable at any K."""
    omega = system.critical.omega
    return np.where(omega > 0.0, omega, 1.0)


def tightest(system, u):
    """(n,) the smallest tolerance of a return that is above the rounding of x; NaN where u is."""
    return TIGHTEST * np.maximum(1.0, distance(system, u))
