"""How far beyond K_c a limit cycle coexists with stable steady sliding: K_fold.

From a subcritical Hopf bifurcation the branch of cycles leads to larger stiffness, turns back in a
fold, and goes on as the stable cycles of softer springs.  Between K_c and the fold, steady sliding
and a cycle are both stable.  Beyond the Bautin point the branch begins towards softer springs; with
b/a above some 7 it may still come back to stiffer ones.

The branch folds as a function of the stiffness, but not of the cycle's size.  So the size is given,
as psi at the stress maximum, and Newton's method finds the stiffness at which the cycle closes: the
fold is the maximum of that stiffness.
"""

from typing import NamedTuple

import numpy as np

from ...friction.laws import friction_law
from ...friction.linear_stability import linearisation
from ...friction.normal_form import growth_slopes, law_curvatures, lyapunov_1
from ..cycles.shooting import return_map
from ..cycles.system import TIGHTEST, one_length_system, state
from .bifurcations import illinois

# Amplitude of ln V of the first cycle tried, and ratio of the sizes of neighbours.
SMALLEST, RATIO = 0.02, 1.3
# Number of sizes tried, and K/K_c - 1 below which a branch is not expected to come back.
MAX_SIZES, FLOOR = 40, -0.03
# Relative accuracy of K/K_c - 1 and of G: of the cycles on the way, and of the fold.
ROUGH, FINE = 1e-2, 1e-5
# Steps of Newton's method, and of the search between two sizes.
MAX_NEWTON_STEPS, MAX_SEARCH_STEPS = 12, 40
# Tolerance of a step divided by eta, and the loosest: K_fold/K_c - 1 is of the order of eta.
TOL, LOOSEST = 1e-6, 1e-9
# Below this eta the strip is narrower than 1e-4 K_c, and G is lost in the errors of a return.
LEAST_ETA = 1e-6
# Least K/K_c - 1 of a fold: near the Bautin point, maxima may be rounding.
LEAST_EXCESS = 1e-7


class Folds(NamedTuple):
    """The cycles of n sliders at which their branches fold; NaN if they do not."""

    kappa: np.ndarray  # (n,) K Dc/(a sigma)
    u: np.ndarray  # (n, 2) psi and G = dv/dT at the stress maximum


class SizedCycles(NamedTuple):
    """A limit cycle of each of n sliders, dimensionless; NaN if Newton's method failed."""

    psi: np.ndarray  # (n,) at the stress maximum
    G: np.ndarray  # (n,) dv/dT there
    excess: np.ndarray  # (n,) K/K_c - 1
    G_slope: np.ndarray  # (n,) dG/d(ln psi) along the branch
    excess_slope: np.ndarray  # (n,)

    def of_size(self, psi):
        """Return the cycles of these psi (n,) > 0, estimated to first order in ln psi."""
        change = np.log(psi / self.psi)
        G = self.G * np.exp(self.G_slope / self.G * change)
        return self._replace(psi=psi, G=G, excess=self.excess + self.excess_slope * change)

    def where(self, condition, other):
        """Return these cycles where the condition (n,) holds, and the others elsewhere."""
        return SizedCycles(*(np.where(condition, x, y) for x, y in zip(self, other, strict=True)))


def folds(law, beta, eta):
    """Return the `Folds`, at the largest stiffness with a cycle beside stable steady sliding.

    K_fold/K_c - 1 has a relative error of 1e-4.  It is NaN if no cycle of the branch from the Hopf
    point has K > K_c (1 + 1e-7), and at eta < 1e-6.

    beta, eta : b/a > 1 and M V_lp^2/(a sigma Dc) >= 0, not checked; (n,), or one of them a float
    """
    beta, eta = np.broadcast_arrays(np.asarray(beta, float), np.asarray(eta, float))
    curvatures = law_curvatures(law)
    rows = np.flatnonzero(eta >= LEAST_ETA)
    top = np.full((len(SizedCycles._fields), len(eta)), np.nan)
    b1 = beta[rows] - 1.0
    linear = linearisation(friction_law(law), (beta[rows],))
    slope, _ = growth_slopes(linear, b1 * (1.0 + eta[rows]), eta[rows], np.sqrt(b1))
    curvature = -lyapunov_1(eta[rows], b1, *curvatures)[0] / slope
    brackets = _bracket_maximum(law, beta[rows], eta[rows], curvature)
    folding = np.isfinite(brackets[0].psi)
    rows = rows[folding]
    left, right = (SizedCycles(*np.array(side)[:, folding]) for side in brackets)
    top[:, rows] = _maximum(law, beta[rows], eta[rows], left, right)
    psi, G, excess = np.where(top[2] > LEAST_EXCESS, top[:3], np.nan)
    kappa = (beta - 1.0) * (1.0 + eta) * (1.0 + excess)
    return Folds(kappa, np.stack([psi, G], axis=1))


def _bracket_maximum(law, beta, eta, curvature):
    """Return neighbours in size between which the stiffness is largest; NaN if there are none.

    curvature : (n,) (K/K_c - 1)/r^2 of the cycles of vanishing amplitude r of ln V
    """
    psi, excess = SMALLEST * np.sqrt(beta - 1.0) / beta, curvature * SMALLEST**2
    G = beta * psi
    cycles = _closed(law, beta, eta, SizedCycles(psi, G, excess, G, 2.0 * excess), ROUGH)
    missing = SizedCycles(*np.full((len(cycles), len(eta)), np.nan))
    left, right = missing, missing
    for _ in range(MAX_SIZES):
        has_excess = cycles.excess > FLOOR
        if not has_excess.any():
            break
        guess = cycles.of_size(RATIO * cycles.psi).where(has_excess, missing)
        previous, cycles = cycles, _closed(law, beta, eta, guess, ROUGH)
        between = (previous.excess_slope > 0.0) & (cycles.excess_slope <= 0.0)
        left, right = previous.where(between, left), cycles.where(between, right)
    return left, right


def _maximum(law, beta, eta, left, right):
    """Return the cycles with the stiffest springs between those on the left and on the right.

    The `illinois` method finds where the slope of the stiffness is 0.  At small eta this is steeper
    by decades on the right: with its arc tangent the search halves the interval.
    """
    scale = np.maximum(np.abs(left.excess), eta * 1e-6)
    left, right = (_closed(law, beta, eta, side, FINE) for side in (left, right))
    low, high = (np.arctan(side.excess_slope / scale) for side in (left, right))
    side = np.zeros(len(eta))
    for _ in range(MAX_SEARCH_STEPS):
        width = np.log(right.psi / left.psi)
        searching = left.excess_slope * width > FINE * np.abs(left.excess)
        if not searching.any():
            break
        part = low / (low - high)
        psi = np.where(searching, left.psi * np.exp(part * width), np.nan)
        guess = left.of_size(psi).where(part < 0.5, right.of_size(psi))
        new = _closed(law, beta, eta, guess, FINE)
        low, high, side = illinois(low, high, np.arctan(new.excess_slope / scale), side)
        left = new.where(searching & (side < 0), left)
        right = new.where(searching & (side > 0), right)
    return left


def _closed(law, beta, eta, guess, accuracy):
    """Return the cycles of given psi near a guess, by Newton's method for G and K."""
    psi, G, excess = (np.array(values) for values in guess[:3])
    result = np.full((len(guess), len(psi)), np.nan)
    rows = np.flatnonzero(np.isfinite(psi * G * excess))
    for _ in range(MAX_NEWTON_STEPS):
        if not len(rows):
            break
        step, slope = _linearised(law, beta[rows], eta[rows], psi[rows], G[rows], excess[rows])
        # not so far that G changes its sign
        step *= np.minimum(1.0, 0.5 * G[rows] / np.abs(step[0]))
        G[rows] += step[0]
        excess[rows] += step[1]
        with np.errstate(invalid="ignore"):
            size = np.abs(step) / (G[rows], np.abs(excess[rows]) + 1e-3 * eta[rows])
        done = (size < accuracy).all(axis=0)
        closed = rows[done]
        result[:, closed] = psi[closed], G[closed], excess[closed], *(psi[closed] * slope[:, done])
        rows = rows[~done & np.isfinite(step).all(axis=0)]
    return SizedCycles(*result)


def _linearised(law, beta, eta, psi, G, excess):
    """Return the steps (2, n) of G and K/K_c - 1 that close a cycle, and their slopes over psi."""
    n = len(eta)
    tol = np.clip(TOL * eta, TIGHTEST, LOOSEST)
    h = np.sqrt(tol)

    kappa = (beta - 1.0) * (1.0 + eta) * (1.0 + np.stack([excess, excess + h]))
    columns = [np.tile(values, 2) for values in (beta, eta, np.full(n, np.inf))]
    system = one_length_system(law, kappa.ravel(), *columns)
    u = np.tile(np.stack([psi, G], axis=1), (2, 1))
    returns = return_map(system, state(system, u), np.tile(tol, 2))
    gap = returns.image - u
    by_psi, by_G = np.moveaxis(returns.jacobian[:n] - np.eye(2), -1, 0)
    by_K = (gap[n:] - gap[:n]) / h[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        return tuple(
            np.stack([_cross(by_K, vector), _cross(vector, by_G)]) / _cross(by_G, by_K)
            for vector in (gap[:n], by_psi)
        )


def _cross(first, second):
    """Return the determinants (n,) of columns (n, 2)."""
    return first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
