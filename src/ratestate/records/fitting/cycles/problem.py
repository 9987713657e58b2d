"""The least squares of features of cycles: coordinates, residuals and starting points.

Coordinates are logarithms of the free parameters, and mu0, which only moves the level.  The
amplitude of a cycle follows from how far the stiffness is below K_c.  Near K_c it changes by a
factor of a hundred if parameters change by a few per cent.  So b, or else a, moves as

    ln(K_c/K - LOWEST_RATIO)

at the record's lowest speed.  This coordinate changes the amplitude, and the others change the
shape of the cycle, so that least squares need not follow a curved valley.
"""

import copy
import functools
import operator
from typing import NamedTuple

import numpy as np
import scipy

from ....friction.closed_forms import K_c, a_of_K_c, b_of_K_c
from ....model.quantities import readable
from ...messages import fitting as sentences
from ..forward import ForwardModel
from ..problem import LeastSquares
from ..quantities import ReportedQuantity
from ..unknowns import Unknowns, distinct, motion_symbols
from .waves import FEATURES, LEVEL, cycle_features

# Parameters that have no effect on cycles, and why.
WITHOUT_EFFECT = {
    "alpha": "a change of normal stress, which is constant here,",
    "lag": "a delay of a load point that moves steadily",
}
# Largest distance of a coordinate from the start of a search.
REACH = np.log(1e3)
# K_c/K below which no cycle exists: a little above K_c, cycles coexist with steady sliding.
LOWEST_RATIO = 0.98
# Step of finite differences.
STEP = 1e-3
# Ranges from which starts are drawn.
A_RANGE = (3e-4, 0.03)  # a
EXCESS_RANGE = (0.01, 20.0)  # K_c/K - LOWEST_RATIO
SLIP_RANGE = (2.0, 200.0)  # slip in a cycle divided by Dc
STIFFNESS_RANGE = (0.9, 60.0)  # K divided by the sawtooth's amplitude sigma/(V_lp period)
PERIOD_RANGE = (1e-10, 1.0)  # (natural period/period)^2
OWN_RANGE = 1.1  # half width of the range about the slider's own values, as a logarithm
# Number of points of the cloud, most starts among them, least distance between two starts.
CLOUD, STARTS, DISTANCE, SEED = 512, 4, 0.3, 20190117
# Least relative error of features in the choice of starts, for which shapes matter, not digits.
ROUGH = 0.1


def check_slider(slider, free):
    """Raise a ParameterError for a useless parameter, or a slider without cycles.

    A slider has no cycles if M = 0, K = inf, or b <= a and neither is free.
    """
    for name in free:
        if name in WITHOUT_EFFECT:
            raise sentences.refusal("cycles.no_part", name=name, what=WITHOUT_EFFECT[name])
    if slider.M == 0.0:
        raise sentences.refusal("cycles.massless")
    if np.isinf(slider.K):
        raise sentences.refusal("cycles.rigid")
    if not {"a", "b"} & set(free) and slider.b <= slider.a:
        raise sentences.refusal("cycles.strengthening", a=float(slider.a), b=float(slider.b))


class CyclesForward(ForwardModel):
    """Features of the limit cycles of sliders, at the speeds of a record.

    measured : `MeasuredFeatures` of each segment; the features that it resolves are compared
    """

    def __init__(self, slider, free, measured):
        super().__init__((*free, "level"), dict.fromkeys(free, STEP))
        symbols = motion_symbols(slider.friction_law)
        self.fixed = {symbol: float(getattr(slider, symbol)) for symbol in symbols}
        self.sigma, self.used = float(slider.sigma), np.array([m.used for m in measured])
        # the parameter whose coordinate is ln(K_c/K - LOWEST_RATIO)
        self.replaced = "b" if "b" in free else "a" if "a" in free else None
        self.V_lp = np.array([m.segment.V_lp for m in measured])
        bins = [m.cycles.profile.size for m in measured]
        self.model = functools.partial(
            cycle_features, slider.law, V_lp=self.V_lp, bins=bins, V0=slider.V0
        )
        #: (segments, 2) last cycles.  Starting from them keeps the search on a cycle if
        #: cycles coexist with steady sliding.
        self.near = None

    # searches may try values far from all sliders, which overflow and have no cycle
    @np.errstate(over="ignore", divide="ignore", invalid="ignore")
    def values(self, points):
        """Return symbol -> (n,) [SI] of the slider at points (n, k), and the level."""
        values = {symbol: np.full(len(points), value) for symbol, value in self.fixed.items()}
        moved = np.exp(np.clip(points[:, :-1].T, -700.0, 700.0))
        values |= zip(self.names[:-1], moved, strict=True)
        if self.replaced:
            excess = values[self.replaced]  # K_c/K - LOWEST_RATIO
            known = {s: values[s] for s in ("a", "b", "Dc", "M") if s != self.replaced}
            solve = b_of_K_c if self.replaced == "b" else a_of_K_c
            critical = (excess + LOWEST_RATIO) * values["K"]
            values[self.replaced] = solve(self.V_lp.min(), critical, sigma=self.sigma, **known)
        return values | {"level": points[:, -1]}

    def coordinates(self, values):
        """Return coordinates (n, k) of values, symbol -> (n,), with b > a; level is 0."""
        columns = {s: np.log(values[s]) for s in self.names[:-1] if s != self.replaced}
        if self.replaced:
            of_K_c = {s: values[s] for s in ("a", "b", "Dc", "M")}
            ratio = K_c(self.V_lp.min(), sigma=self.sigma, **of_K_c) / values["K"]
            columns[self.replaced] = np.log(np.maximum(ratio - LOWEST_RATIO, EXCESS_RANGE[0]))
        columns["level"] = np.zeros_like(values["a"])
        return np.stack([columns[name] for name in self.names], axis=1)

    def cycles(self, points):
        """Return features (n, s, 6) and waves (n, s, q); NaN without a cycle."""
        values = self.values(points) | {"sigma": np.full(len(points), self.sigma)}
        features, near, waves = self.model(values, near=self.near)
        if self.near is not None and not np.isfinite(features[0]).all():
            features, near, waves = self.model(values)
        if np.isfinite(features[0]).all():
            self.near = near[0]
        level = points[:, -1, None, None]
        self.evaluations += len(points)
        return features + level * (np.arange(len(FEATURES)) == LEVEL), waves + level

    def friction_and_regressors(self, points):
        """Return compared features (n, m), and their derivative by the level."""
        features, _ = self.cycles(points)
        is_level = np.broadcast_to(np.arange(len(FEATURES)) == LEVEL, self.used.shape)[self.used]
        by_level = np.broadcast_to(is_level.astype(float), (len(points), is_level.size))
        return features[:, self.used], {"level": by_level}

    def quantities(self):
        """Return `ReportedQuantity`s: free parameters, mu0, a - b if a or b is free."""
        functions = {self.replaced: lambda values: np.log(values[self.replaced])}
        quantities = [
            ReportedQuantity(name, self, functions.get(name), is_log=True)
            for name in self.names[:-1]
        ]
        quantities.append(ReportedQuantity("mu0", self, operator.itemgetter("level")))
        if self.replaced:
            quantities.append(ReportedQuantity("a_minus_b", self, lambda x: x["a"] - x["b"]))
        return tuple(quantities)


class FeatureNoise(NamedTuple):
    """The errors of features, in place of the `Noise` of samples."""

    root: np.ndarray  # (m, m) lower triangle: root @ root.T is the covariance

    def whiten(self, _, columns):
        """Return columns (m, k) with errors of unit variance, and ln det(covariance)."""
        columns = np.reshape(columns, (len(self.root), -1))
        log_determinant = 2.0 * float(np.log(np.diag(self.root)).sum())
        return scipy.linalg.solve_triangular(
            self.root, columns, lower=True, check_finite=False
        ), log_determinant


class CyclesProblem(LeastSquares):
    """The `LeastSquares` of the features that a record resolves."""

    kind, most, enough, is_open_at_bounds = "cycles", 100, 0.01, True

    def __init__(self, slider, free, measured):
        forward = CyclesForward(slider, free, measured)
        observed = np.concatenate([m.values[m.used] for m in measured])
        k = len(forward.names)
        unknowns = Unknowns(forward.names, np.full(k, -np.inf), np.full(k, np.inf))
        super().__init__(slider, forward, unknowns, np.arange(observed.size), observed)
        if len(free) >= observed.size:
            listed = "; ".join(
                f"at {readable('V_lp', m.segment.V_lp)} {', '.join(np.array(FEATURES)[m.used])}"
                for m in measured
            )
            names = {"count": len(free), "names": ", ".join(free)}
            counts = {"features": observed.size, "listed": listed}
            raise sentences.refusal("cycles.few_features", **names, **counts)
        self.measured = measured
        blocks = [m.covariance[np.ix_(m.used, m.used)] for m in measured]
        self.noise = FeatureNoise(np.linalg.cholesky(scipy.linalg.block_diag(*blocks)))

    @property
    def dof(self):
        """Number of features less the number of unknowns."""
        return self.observed.size - len(self.unknowns.names)

    def bounded_about(self, point):
        """Return the problem with bounds at `REACH` from a point (k,)."""
        bounded = copy.copy(self)
        bounded.forward = copy.copy(self.forward)
        reach = np.append(np.full(point.size - 1, REACH), np.inf)
        bounded.unknowns = Unknowns(self.unknowns.names, point - reach, point + reach)
        return bounded


def starting_points(problem):
    """Return distinct points (n, k), n <= `STARTS`, the best of a cloud first."""
    forward = copy.copy(problem.forward)
    points = _cloud(forward, problem.measured[0])
    features, lines = forward.friction_and_regressors(points)
    is_level = lines["level"][0] > 0.0
    residual = problem.observed - features
    points[:, -1] = residual[:, is_level].mean(axis=1)
    variance = np.sum(problem.noise.root**2, axis=1) + ROUGH**2
    misfit = np.sum((residual**2 / variance)[:, ~is_level], axis=1)  # (mu0 adjusts the level)
    best = points[np.argsort(misfit, kind="stable")[: np.isfinite(misfit).sum()]]
    return best[distinct(best[:, :-1], DISTANCE, STARTS)]


def _cloud(forward, first):
    """Return points (n, k): half near the slider, half from the features of `first`."""
    names, n = forward.names[:-1], CLOUD // 2
    amplitude, period = np.exp(first.values[:2])
    V_lp = first.segment.V_lp
    drawn = scipy.stats.qmc.Sobol(2 * len(names), rng=SEED).random(n)
    values = {symbol: np.full(n, value) for symbol, value in forward.fixed.items()}
    about = forward.coordinates(values)
    about[1:, :-1] += OWN_RANGE * (2.0 * drawn[1:, : len(names)] - 1.0)
    parts = dict(zip(names, drawn[:, len(names) :].T, strict=True))

    def within(symbol, low, high):
        return low * (high / low) ** parts[symbol]

    a = forward.fixed["a"]
    if "Dc" in parts:
        values["Dc"] = V_lp * period / within("Dc", *SLIP_RANGE[::-1])
    if "K" in parts:
        values["K"] = amplitude * forward.sigma / (V_lp * period) * within("K", *STIFFNESS_RANGE)
    if "M" in parts:
        values["M"] = values["K"] * (period / (2.0 * np.pi)) ** 2 * within("M", *PERIOD_RANGE)
    if "a" in parts:
        values["a"] = within("a", min(A_RANGE[0], a / 3.0), max(A_RANGE[1], 3.0 * a))
    from_features = forward.coordinates(values)
    if forward.replaced:
        excess = within(forward.replaced, *EXCESS_RANGE)
        from_features[:, names.index(forward.replaced)] = np.log(excess)
    return np.concatenate([about, from_features])
