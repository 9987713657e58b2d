"""Two velocity steps of 3,000 samples with white noise, and what is sought in them.

Unknown are ln a, b, ln Dc, ln K and the level of friction; whoever fits sees the same residuals,
model less record over the noise, and begins at the same place.
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np
import xarray
from problems import REFERENCE
from scipy.optimize import least_squares

import ratestate as rs
from ratestate.paper.parameters import FIG2
from ratestate.records.fitting.problem import SamplesProblem as Search
from ratestate.records.fitting.problem import samples_of, search, with_best_level
from ratestate.records.fitting.unknowns import to_coordinate, to_value, unknowns_of
from ratestate.records.kit.noise import Noise

SAMPLES, SEED = 3000, 6
FREE = ("a", "b", "Dc", "K")

NOISE = Noise(2e-4)  # of friction
#: what the search begins with, over what is true
OFF = {"a": 1.5, "b": 1.4, "Dc": 2.0, "K": 1.02}


class Fitted(NamedTuple):
    """Where a fit has come to, the motions it took, and its curve."""

    point: np.ndarray  # (5,)
    motions: object
    friction: np.ndarray  # (m,)


class FitProblem:
    """A slider that slides at V_1 until t_step, then is driven at V_2 until t_end [s]."""

    def __init__(self, slider, V_1, V_2, t_step, t_end):
        self.slider, self.speeds, self.t_step = slider, (V_1, V_2), t_step
        self.loading = rs.Loading.steps(V_1, (t_step, V_2))
        self.t = np.linspace(0.0, t_end, SAMPLES)
        self.begin = slider.replace(**{k: off * getattr(slider, k) for k, off in OFF.items()})

    @cached_property
    def data(self):
        """The record: what `simulate` gives, and noise."""
        run = rs.simulate(self.slider, self.loading, self.t[-1], times=self.t, rtol=REFERENCE)
        noise = NOISE.white * np.random.default_rng(SEED).normal(size=SAMPLES)
        friction = run.tau.values / self.slider.sigma + noise
        columns = {"friction": ("time", friction), "delta_lp": ("time", run.delta_lp.values)}
        return xarray.Dataset(columns, {"time": self.t})

    @cached_property
    def search(self):
        """What `fit` minimises, without what it does beside."""
        keys = {"loading": self.loading, "trend": None, "against": "time"}
        record = samples_of(self.data, self.begin, **keys)
        unknowns = unknowns_of(record, self.begin, FREE, start=False)
        return Search(record, self.begin, unknowns)

    @cached_property
    def start(self):
        """(5,) where the search begins, with the level that fits best there."""
        values = [to_coordinate(name, getattr(self.begin, name)) for name in FREE]
        return with_best_level(self.search, np.array([[*values, 0.0]]))[0][0]

    def exact(self, point):
        """(m,) friction at a point, by `simulate` at its tightest."""
        values = {name: to_value(name, point[i]) for i, name in enumerate(FREE)}
        slider = self.slider.replace(**values)
        run = rs.simulate(slider, self.loading, self.t[-1], times=self.t, rtol=REFERENCE)
        tau = run.tau.values / slider.sigma
        return point[4] + tau - tau[0]

    @cached_property
    def best(self):
        """(5,) the estimates of `exact`, and their standard errors."""
        friction = self.data.friction.values
        found = least_squares(
            lambda point: (self.exact(point) - friction) / NOISE.white,
            search(self.search, self.start, NOISE).x,
            jac="3-point",
            diff_step=1e-4,
            x_scale="jac",
            xtol=1e-12,
            ftol=1e-14,
        )
        return found.x, np.sqrt(np.diag(np.linalg.inv(found.jac.T @ found.jac)))


def fit_problems():
    """name -> FitProblem: a slow step of a slider without mass; one that vibrates after it."""
    rock = rs.SpringSlider(a=0.01, b=0.012, Dc=1e-5, sigma=5e6, K=5e9, V0=1e-6)
    return {
        "quasi-static": FitProblem(rock, 1e-6, 1e-5, 30.0, 60.0),
        "with inertia": FitProblem(FIG2, 0.3e-3, 2.5e-3, 0.1, 0.4),
    }
