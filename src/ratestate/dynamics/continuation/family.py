"""A family of sliders along one parameter, as a map whose fixed points are limit cycles.

The parameter enters as p, its natural logarithm, so that its values stay positive and steps are
relative.  The points of the section are taken as U = (psi, G eta/(1 + eta)), with a psi less its
steady value for each of the law's variables: in these the errors of a return are of one size,
however small eta is.
"""

import dataclasses
from typing import NamedTuple

import numpy as np

from ...friction.composition import composed_law
from ..cycles.attractor import single_returns
from ..cycles.measure import measure
from ..cycles.shooting import return_map
from ..cycles.system import (
    TIGHTEST,
    is_slaved,
    slaved_G,
    small_amplitude,
    state,
    system_of,
    tightest,
)
from .arclength import Steps, follow_branch
from .newton import Problem
from .polish import polished

#: parameters along which a family may be followed, beside those that a law has alone
PARAMETERS = ("V_lp", "K", "M", "sigma", "a", "b", "Dc")
# Sizes of psi and of G's part of U above which steps and errors along a branch are relative.  The
# error of psi is absolute, the tolerance of a return; at large eta psi is small and matters little.
SCALE_PSI, SCALE_G = 0.02, 1e-3
# Divided by rtol: the tolerance of a return, and its error in units of SCALE.
TOLERANCE, NOISE = 0.002, 0.1
# Systems that a family keeps: a step along a branch needs each of a few several times.
KEPT = 8
# So that a branch looks smooth.
STEPS = Steps(largest=0.06)


class MapValues(NamedTuple):
    """The return map of m sliders, as `arclength.follow_branch` needs it; all dimensionless."""

    image: np.ndarray  # (m, k) the next U; NaN where not ok
    jacobian: np.ndarray  # (m, k, k) d image/d U; means nothing where not ok
    ok: np.ndarray  # (m,) whether the orbit came back to the section
    measures: dict  # "period" and "tol", (m,)


@dataclasses.dataclass(frozen=True)
class Family:
    """Sliders that differ in one parameter; nothing is checked here (see `checked_family`)."""

    law: str
    values: dict  # symbol -> float [SI], V_lp among them; that of the parameter is not used
    parameter: str
    rtol: float
    #: bytes of p -> `System`, the last ones that `system` returned
    systems: dict = dataclasses.field(default_factory=dict, repr=False, compare=False)

    def sliders(self, parameter):
        """`System` of the sliders with these values (m,) of the parameter [SI]."""
        m = len(parameter)
        columns = {symbol: np.full(m, value) for symbol, value in self.values.items()}
        with np.errstate(over="ignore"):  # beyond physical values no orbit comes back
            return system_of(self.law, **columns | {self.parameter: parameter})

    def system(self, p):
        """`System` of the sliders at p, (m,) or float, which counts as (1,)."""
        p = np.atleast_1d(np.asarray(p, float))
        key = p.tobytes()
        if key not in self.systems:
            with np.errstate(over="ignore"):
                self.systems[key] = self.sliders(np.exp(p))
            if len(self.systems) > KEPT:
                del self.systems[next(iter(self.systems))]
        return self.systems[key]

    @property
    def smallest(self):
        """(k,) size of U above which distances from it are relative."""
        return np.append(np.full(len(composed_law(self.law).states), SCALE_PSI), SCALE_G)

    def scale(self, U):
        """(m, k) units in which distances from U (m, k) are measured."""
        return self.smallest + np.abs(U)

    def weights(self, U, p):
        """(m, k + 1) units of distances from (psi, G, p), at U (m, k) and p (m,)."""
        scale = self.scale(U)
        scale[:, -1] /= _scale(self.system(p))
        return np.column_stack([scale, np.ones(len(U))])

    def margin(self, p):
        """(K - K_c) Dc/(a sigma) at one p, a float: negative where steady sliding is unstable."""
        return float(self.system(p).margin[0])

    def amplitude(self, U, p):
        """Amplitude of ln V, a float, of a small cycle through U (k,) at p."""
        return float(small_amplitude(self.system(p), self.points(U[None], p))[0])

    def points(self, U, p):
        """(m, k) u of the section's points U (m, k)."""
        system, u = self.system(p), U.copy()
        with np.errstate(divide="ignore", invalid="ignore"):  # without mass
            free = U[:, -1] / _scale(system)
        u[:, -1] = np.where(_is_slaved(system, U), slaved_G(system, U[:, :-1]), free)
        return u

    def chart(self, u, p):
        """(m, k) U of the section's points u (m, k)."""
        return np.column_stack([u[:, :-1], _scale(self.system(p)) * u[:, -1]])

    def tolerance(self, u, p):
        """(m,) tolerance of a step at u (m, k); a return changes a small r by some r^3."""
        system = self.system(p)
        r = np.minimum(1.0, np.abs(small_amplitude(system, u)))
        return np.maximum(TOLERANCE * self.rtol * r**3, tightest(system, u))

    def return_map(self, U, p):
        """`MapValues` of m sliders at U (m, k), p (m,).

        Not ok where there can be no cycle, or G <= 0.
        """
        system, u = self.system(p), self.points(U, p)
        tol = self.tolerance(u, p)
        usable = system.may_cycle & (u[:, -1] > 0.0) & np.isfinite(u).all(axis=1)
        u[~usable] = np.nan
        returns = return_map(system, state(system, u), tol)
        scale = _scale(system)
        jacobian = returns.jacobian.copy()
        jacobian[:, -1, :] *= scale[:, None]
        jacobian[:, :, -1] *= np.where(_is_slaved(system, U), 0.0, 1.0 / scale)[:, None]
        image = np.column_stack([returns.image[:, :-1], scale * returns.image[:, -1]])
        measures = {"period": returns.numbers["period"], "tol": tol}
        return MapValues(image, jacobian, usable & returns.came_back, measures)

    def branch(self, U, p, *, stop, **options):
        """`Branch` by `follow_branch` from U (k,) at p to stop.

        options : fields of `Options` other than `steps`
        """
        # At large eta the stress is large, and its rounding too: in stick-slip tau/(a sigma) varies
        # by some sqrt(kappa eta).
        system = self.system(np.array([p, stop]))
        amplitude = np.sqrt(np.max(np.maximum(1.0, system.kappa * system.eta)))
        noise = max(NOISE * self.rtol, TIGHTEST * amplitude / SCALE_PSI)
        problem = Problem(self.return_map, self.smallest, self.rtol, noise)
        return follow_branch(problem, U, p, stop, steps=STEPS, **options)

    def measures(self, points, exact):
        """The measures of the points of a branch, as by `measure`: name -> (n,) or (n, k).

        Also "parameter", its values (n,) [SI] to which the measures belong.

        points : list of n `Point`s
        exact : special of a point -> the exact value of its parameter
        """
        points = polished(self, points, exact)
        # An error > 0 keeps `measure` from correcting the cycle at constant p.
        error = points.errors[:, :2].max(axis=1) + 1e-16
        cycles = single_returns(points.u, points.tol, points.period, error)
        values = measure(self.sliders(points.parameter), cycles)
        for name, of_speed in zip(("v_max_error", "v_min_error"), points.errors.T[2:], strict=True):
            values[name] = np.maximum(values[name], of_speed)
        return values | {"parameter": points.parameter}


def _scale(system):
    return system.eta / (1.0 + system.eta)


def _is_slaved(system, U):
    return is_slaved(system, U[:, :-1] + system.steady, U[:, -1] * (1.0 + system.eta))
