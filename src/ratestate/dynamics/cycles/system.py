"""Steadily driven sliders in dimensionless form, and points on the section V = V_lp.

The units are V_lp, Dc and a sigma (V0 := V_lp in engine/model.py), so that kappa, eta and the
coefficients p of its law, b/a first, describe a slider.  On the section V = V_lp, where V rises and
the stress has its maximum, a point is

    u = (psi - psi_ss, G),   G = dv/dT = (x - S(psi))/eta,   x = S(psi) + eta G,

with S the stress that opposes motion at V_lp, and one psi for each state of the law; the steady
psi_ss are 0 for most laws.  These coordinates avoid cancellation near steady sliding.  They also
avoid it for small eta, where rounding hides inertia, and G follows from psi (S_v G = -S_psi
dpsi/dT).
"""

import dataclasses
import functools

import numpy as np

from ...engine.model import SLAVED
from ...friction import linear_stability
from ...friction.closed_forms import eta
from ...friction.composition import composed_law
from ..simulation.engine_cases import V_LIMIT

# Tolerance of a step in x, v and psi that rounding of numbers of order 1 allows.
TIGHTEST = 2e-14


@dataclasses.dataclass(frozen=True, eq=False)
class System:
    """Sliders driven at V_lp: dimensionless arrays with one value a slider, not checked.

    Derived quantities are computed once, on first use, so the arrays must not be changed.
    """

    law: str
    kappa: np.ndarray  # K Dc/(a sigma)
    p: np.ndarray  # (n, k) coefficients of the law
    eta: np.ndarray  # M V_lp^2/(a sigma Dc)
    #: ln(V/V_lp) beyond which a slider that does not slow down has run away; inf if M > 0
    v_limit: np.ndarray

    def at(self, rows):
        """Return the sliders with these numbers, or where `rows` is True.

        If these are all sliders in order, it is this system, with the quantities derived so far.
        """
        all_rows = np.arange(len(self.kappa))
        if np.array_equal(all_rows[rows], all_rows):
            return self
        parts = (values[rows] for values in (self.kappa, self.p, self.eta, self.v_limit))
        return System(self.law, *parts)

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
        """b/a, for a law of one length."""
        return self.p[:, 0]

    @functools.cached_property
    def steady(self):
        """(n, n_states) psi in steady sliding at V_lp."""
        if self.friction_law.one_length:
            return np.zeros((len(self.kappa), 1))
        return np.stack(self.friction_law.steady(self.coefficients).psi, axis=1)

    @functools.cached_property
    def critical(self):
        """`linear_stability.Critical` of steady sliding at V_lp."""
        return linear_stability.critical(self.friction_law, self.coefficients, self.eta)

    @functools.cached_property
    def margin(self):
        """(K - K_c) Dc/(a sigma): negative where steady sliding is unstable (eq. 6)."""
        return self.kappa - self.critical.kappa

    @functools.cached_property
    def stable(self):
        """Whether steady sliding is stable; for laws of one length also at K = K_c."""
        if self.friction_law.one_length:
            return self.margin >= 0.0
        found = linear_stability.edges(self.friction_law, self.coefficients)
        return found.margin(self.kappa, self.eta) > 0.0

    @property
    def may_cycle(self):
        """Whether a cycle may exist; for a law of one length only where b > a."""
        weakens = self.beta > 1.0 if self.friction_law.one_length else True
        return np.isfinite(self.kappa) & weakens

    @property
    def cancellation(self):
        """Sum of the evolution effects, divided by their excess over the direct effect."""
        linear = linear_stability.linearisation(self.friction_law, self.coefficients)
        excess = np.abs(linear.evolution.sum(axis=1) - linear.direct)
        return np.abs(linear.evolution).sum(axis=1) / excess

    @functools.cached_property
    def weights(self):
        """(n, k) change of x with each component of u in steady sliding: S_psi, and eta for G."""
        _, by_psi = self.slopes(self.steady)
        return np.concatenate([by_psi, self.eta[:, None]], axis=1)

    @functools.cached_property
    def rest(self):
        """(n, len(y)) x, v and psi of steady sliding at V_lp."""
        return state(self, np.zeros((len(self.kappa), self.steady.shape[1] + 1)))

    @functools.cached_property
    def omega(self):
        """Frequency omega_c [V_lp/Dc]; 1 where steady sliding is stable at any K."""
        omega = self.critical.omega
        return np.where(omega > 0.0, omega, 1.0)

    def slopes(self, psi):
        """Return S_v (n,) and S_psi (n, n_states) at V_lp and psi (n, n_states)."""
        psi = tuple(psi.T)
        by_v, *by_psi = self.friction_law.at_speed(0.0, psi, self.coefficients).S_slopes
        n = len(self.kappa)
        S_psi = np.stack([np.broadcast_to(values, n) for values in by_psi], axis=1)
        return np.full(n, by_v), S_psi


def one_length_system(law, kappa, beta, eta, v_limit):
    """Return the `System` of sliders under a law of one length; all arguments are arrays (n,)."""
    return System(law, kappa, beta[:, None].copy(), eta, v_limit)


def system_of(law, *, sigma, K, M, V_lp, **values):
    """Return the `System` of sliders with these parameters [SI], arrays (n,), not checked.

    Other parameters are ignored.
    """
    a, Dc = values["a"], values["Dc"]
    inertia = eta(V_lp, a=a, Dc=Dc, sigma=sigma, M=M)
    unlimited = (M > 0.0) | (values.get("damping", 0.0) > 0.0)
    v_limit = np.where(unlimited, np.inf, np.log(V_LIMIT / V_lp))
    p = np.stack(composed_law(law).coefficient_arrays(V_lp, {"sigma": sigma, **values}), axis=-1)
    return System(law, K * Dc / (a * sigma), p, inertia, v_limit)


def select(cases, rows):
    """Return a named tuple with its arrays indexed by `rows`; other fields stay."""
    return type(cases)(*(x[rows] if isinstance(x, np.ndarray) else x for x in cases))


def state(system, u):
    """Return x, v and psi (n, len(y)) of the section's points u (n, k)."""
    psi = u[:, :-1] + system.steady
    zero = np.zeros(len(u))
    law, states, p = system.friction_law, tuple(psi.T), system.coefficients
    x = law.at_speed(0.0, states, p).S
    return np.stack([x + system.eta * u[:, -1], zero + law.v_at(1.0, states, p), *states], axis=1)


def steady_sliding_at(system, w):
    """Return x, v and psi (n, len(y)) of steady sliding at w (n,) times V_lp."""
    law, p = system.friction_law, system.coefficients
    at = law.steady(p, np.log(w))
    return np.stack([at.S, law.v_at(w, at.psi, p), *at.psi], axis=1)


def is_slaved(system, psi, g):
    """Return whether G is more accurate from the rates of psi (n, n_states) than as g/eta.

    g : (n,) x - S
    """
    S_v, _ = system.slopes(psi)
    return (system.eta == 0.0) | (np.maximum(system.eta, np.abs(g)) < SLAVED * np.sqrt(np.abs(S_v)))


def slaved_G(system, offset):
    """Return G without inertia, from psi - psi_ss = offset (n, n_states)."""
    states = tuple((offset + system.steady).T)
    return system.friction_law.at_speed(0.0, states, system.coefficients).slaved


def distance(system, vectors):
    """Return the lengths of vectors (n, k) of u, measured by the changes of S and of eta G."""
    with np.errstate(invalid="ignore"):  # without mass, where Newton's method has no step
        return functools.reduce(np.hypot, (system.weights * vectors).T)


def linear_section(system):
    """Return u (n, k) of an orbit whose ln V has amplitude 1, by the linear equations at omega."""
    law, p, psi = system.friction_law, system.coefficients, tuple(system.steady.T)
    f_v, f_psi = law.at_speed(0.0, psi, p).f_slopes
    # v = sin(omega T) is 0 there, and rises
    states = [(f / (1j * system.omega - g)).imag for f, g in zip(f_v, f_psi, strict=True)]
    return np.stack([*states, system.omega], axis=1)


def small_amplitude(system, u):
    """Return the amplitude r of ln V on an orbit through u near steady sliding.

    dx/dT = -kappa v there, so the maximum of x exceeds its steady value by r kappa/omega.  With
    several states, whose parts of x may cancel, each component of u gives an r, and the largest
    counts.
    """
    if u.shape[1] > 2:
        return np.abs(u / linear_section(system)).max(axis=1)
    return (system.weights * u).sum(axis=1) * system.omega / system.kappa


def tightest(system, u):
    """Return the smallest tolerance of a return that is above the rounding of x; NaN if u is."""
    return TIGHTEST * np.maximum(1.0, distance(system, u))
