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
MAX_STEPS_OF_FIT = 1e5


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
        # without inertia V may run away; with a free mass it cannot
        self.v_limit = np.log(V_LIMIT / self.V0) if self.fixed["M"] == 0.0 else np.inf
        #: step of a central difference in each coordinate that the motion depends on
        self.steps = {n: PARAMETERS[n].step(record) for n in names if n not in LINEAR}

    def friction(self, points):
        """(n, m) friction at the record's samples for coordinates (n, k); NaN without a motion.

        Friction is level + (tau/sigma or mu, less its value in steady sliding at the record's
        first speed) + trend times slip or time.
        """
        return self.parts(points)[0]

    def jacobian(self, point):
        """(m,) friction at a point (k,), and (m, k) its derivatives by the coordinates.

        NaN without a motion; derivatives are one-sided where there is none on the other side.
        """
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
        along = np.broadcast_to(self.record.trend_variable, x.shape)
        if self.record.trend == "slip":
            along = along - (a * self.sigma / K) * (x - x[:, :1])
        regressors = self.record.regressors(along)
        for name, regressor in regressors.items():
            friction = friction + values[name][:, None] * regressor
        self.evaluations += len(friction)
        return friction, regressors

    def values(self, points):
        """name -> (n,) values of all `PARAMETERS` [SI]; of `START` logarithms of ratios."""
        fixed = dict.fromkeys(PARAMETERS, 0.0) | self.fixed
        values = {name: np.full(len(points), float(value)) for name, value in fixed.items()}
        with np.errstate(over="ignore"):
            for i, name in enumerate(self.names):
                moved = points[:, i]
                values[name] = np.exp(moved) if PARAMETERS[name].is_log else moved
        if np.isinf(self.fixed["K"]) and "K" not in self.names:
            # the march has no rigid machine, but one that is practically rigid
            values["K"] = RIGID * values["a"] * self.sigma / values["Dc"]
        return values

    def _motion(self, values):
        """(n, m, 3) x, v, psi at the samples."""
        a, b, Dc, K, M = (values[symbol] for symbol in ("a", "b", "Dc", "K", "M"))
        v, psi = (values[name] for name in START)
        times, which, end = self.record.t[None], np.zeros(a.size, np.int64), self.record.t[-1]
        if "lag" in self.names:
            # samples from before the start take the value at the start
            times, which = self.record.t - values["lag"][:, None], np.arange(a.size)
            end = np.maximum(times[:, -1], 1e-9 * end)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            per_stress = 1.0 / (a * self.sigma)
            cases = cases_of(
                kappa=K * Dc * per_stress,
                p=self.law.coefficient_array(self.V0, values),
                eta0=M * self.V0**2 * per_stress / Dc,
                scale=self.V0 / Dc,
                V0=self.V0,
                y=np.stack([v + b / a * psi, v, psi], axis=1),
                t_end=end,
                times=which,
                rtol=RTOL,
                v_limit=self.v_limit,
                max_steps=MAX_STEPS_OF_FIT,
            )
        return marched(self.law, cases, self.loads, times, alone=a.size == 1)


def cases_of(*, kappa, **columns):
    """`Cases` of n sliders under one loading; a column may be one value for all of them."""
    columns = {"dt": 0.0, "loading": 0, "observe": 0.0, "kappa": kappa} | columns
    each = {k: np.full(kappa.size, v) if np.ndim(v) == 0 else v for k, v in columns.items()}
    return Cases(**each)


def marched(law, cases, loads, times, *, alone=False):
    """(n, m, 3) x, v, psi (engine/model.py) of the cases at these times; NaN where a run fails."""
    which = np.arange(cases.kappa.size)
    results = dispatch.run_march(RODAS5P, law, cases, loads, times, which, alone)
    results.saved[results.status != FINISHED] = np.nan
    return results.saved


def _difference(above, centre, below, step):
    """A derivative from both sides, or from the only one on which there is motion."""
    if np.isfinite(above[-1]) and np.isfinite(below[-1]):
        return (above - below) / (2.0 * step)
    if np.isfinite(below[-1]):
        return (centre - below) / step
    return (above - centre) / step
