"""Friction that a load cell would show, from the coordinates, with its sensitivities.

Sensitivities are central differences between sliders in neighbouring lanes of the march: the
2 k + 1 sliders of one Jacobian cost little more than one, and all laws, masses, loadings and starts
use the same engine.  Neighbours take nearly the same steps, so most of their errors
cancel: with rtol = 1e-8 and differences of 3e-5 sensitivities are right to 1e-6.
"""

import numpy as np

from ...dynamics.simulation.cases import V_LIMIT
from ...engine import dispatch
from ...engine.model import FINISHED, RODAS5P, Cases, Loads
from .unknowns import LINEAR, OF_SLIDER, PARAMETERS, START

RTOL = 1e-8
#: K Dc/(a sigma) of a machine that counts as rigid: friction follows within 1e-8 Dc of slip
RIGID = 1e8
#: of the march, 100 times what a well-fitting slider takes: one that vibrates is no candidate
MAX_STEPS = 1e5


class Forward:
    """Friction of a slider under the loading of a record, for many sliders at once.

    slider : gives the parameters that are not among the names of the coordinates (unknowns.py)
    """

    def __init__(self, record, slider, law, names):
        self.record, self.law, self.names = record, law, names
        self.fixed = {symbol: getattr(slider, symbol) for symbol in OF_SLIDER}
        if np.isinf(slider.K) and "K" not in names:
            self.fixed["M"] = 0.0  # a rigid machine moves its mass as it likes
        self.sigma = slider.sigma
        loading = record.loading
        self.V0 = float(loading.V[0])  # the reference: v = 0 in steady sliding at it
        self.loads = Loads(
            np.ascontiguousarray(loading.t),
            np.ascontiguousarray(loading.V, float)[None],
            np.ascontiguousarray(loading.rate, float)[None],
        )
        self.evaluations = 0
        self.common: dict = {}  # number of sliders -> values of `_common`
        #: step of a central difference in each coordinate that the motion depends on
        self.steps = {n: PARAMETERS[n].step(record) for n in names if n not in LINEAR}

    def friction(self, points):
        """(n, m) friction at the record's samples for coordinates (n, k); NaN without a motion.

        Friction is level + (tau/sigma or mu, less its value in steady sliding at the record's
        first speed) + trend times slip or time.
        """
        return self.parts(points)[0]

    def jacobian(self, point):
        """(m,) friction at a point, and (m, k) its derivatives by the coordinates."""
        moving = [(self.names.index(name), step) for name, step in self.steps.items()]
        points = np.repeat(point[None], 2 * len(moving) + 1, axis=0)
        for j, (i, step) in enumerate(moving):
            points[2 * j + 1, i] += step
            points[2 * j + 2, i] -= step
        friction, regressors = self.parts(points)
        centre = friction[0]
        columns = np.zeros((len(self.names), centre.size))
        for j, (i, step) in enumerate(moving):
            columns[i] = _difference(friction[2 * j + 1], centre, friction[2 * j + 2], step)
        for name, regressor in regressors.items():
            if name in self.names:
                columns[self.names.index(name)] = regressor[0]
        return centre, columns.T

    def parts(self, points):
        """`friction`, and name -> (n, m) its derivative by each linear parameter of the record."""
        values = self.values(points)
        saved = self._motion(values)
        a, b, K = (values[symbol][:, None] for symbol in ("a", "b", "K"))
        x, v, psi = saved[..., 0], saved[..., 1], saved[..., 2]
        friction = a * x if self.record.kind == "tau" else a * v + b * psi
        regressors = {n: np.broadcast_to(r, x.shape) for n, r in self.record.regressors.items()}
        if self.record.trend == "slip":
            behind = (a * self.sigma / K) * (x - x[:, :1])  # the slider, its load point
            regressors["trend"] = regressors["trend"] - behind
        for name, regressor in regressors.items():
            friction = friction + values[name][:, None] * regressor
        self.evaluations += len(friction)
        return friction, regressors

    def values(self, points):
        """name -> (n,) values of everything that `parts` needs."""
        values = dict(self._common(len(points))[0])
        with np.errstate(over="ignore"):
            for i, name in enumerate(self.names):
                moved = points[:, i]
                values[name] = np.exp(moved) if PARAMETERS[name].is_log else moved
        if np.isinf(self.fixed["K"]) and "K" not in self.names:
            # the march has no rigid machine, but one that is practically rigid
            values["K"] = RIGID * values["a"] * self.sigma / values["Dc"]
        return values

    def _common(self, n):
        """Values that are not free and columns of `Cases`, shared by all calls for n sliders."""
        if n in self.common:
            return self.common[n]
        fixed = dict.fromkeys(PARAMETERS, 0.0) | self.fixed
        values = {name: np.full(n, float(value)) for name, value in fixed.items()}
        # without inertia V may run away; with a free mass it cannot
        limit = np.log(V_LIMIT / self.V0) if self.fixed["M"] == 0.0 else np.inf
        columns = {
            "V0": np.full(n, self.V0),
            "t_end": np.full(n, self.record.t[-1]),
            "dt": np.zeros(n),
            "loading": np.zeros(n, np.int64),
            "times": np.zeros(n, np.int64),
            "rtol": np.full(n, RTOL),
            "observe": np.zeros(n),
            "v_limit": np.full(n, limit),
            "max_steps": np.full(n, MAX_STEPS),
        }
        self.common[n] = values, columns
        return values, columns

    def _motion(self, values):
        """(n, m, 3) x, v, psi at the samples."""
        a, b, Dc, K, M = (values[symbol] for symbol in ("a", "b", "Dc", "K", "M"))
        v, psi = (values[name] for name in START)
        n = a.size
        columns, times = self._common(n)[1], self.record.t[None]
        if "lag" in self.names:
            # samples from before the start take the value at the start
            times = self.record.t - values["lag"][:, None]
            ends = np.maximum(times[:, -1], 1e-9 * self.record.t[-1])
            columns = columns | {"times": np.arange(n), "t_end": ends}
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            per_stress = 1.0 / (a * self.sigma)
            beta = b / a
            cases = Cases(
                kappa=K * Dc * per_stress,
                beta=beta,
                eta0=M * self.V0**2 * per_stress / Dc,
                scale=self.V0 / Dc,
                y=np.stack([v + beta * psi, v, psi], axis=1),
                **columns,
            )
        results = dispatch.run_march(
            RODAS5P, self.law, cases, self.loads, times, np.arange(n), n == 1
        )
        saved = results.saved
        saved[results.status != FINISHED] = np.nan
        return saved


def _difference(above, centre, below, step):
    """A derivative from both sides, or from the only one on which there is motion."""
    if np.isfinite(above[-1]) and np.isfinite(below[-1]):
        return (above - below) / (2.0 * step)
    if np.isfinite(below[-1]):
        return (centre - below) / step
    return (above - centre) / step
