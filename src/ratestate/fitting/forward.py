"""From coordinates to the friction that a load cell would show, with its sensitivities.

Sensitivities are central differences between sliders in neighbouring lanes of the march: the
2 k + 1 sliders of one Jacobian cost little more than one, and every law, mass, loading and start
is served by the one engine.  With rtol = 1e-8 and steps of 1e-3 they are right to 1e-6.
"""

import numpy as np

from ..cases import V_LIMIT
from ..engine import drive
from ..engine.model import FINISHED, RODAS5P, Cases, Loads
from .unknowns import LINEAR, START

RTOL = 1e-8
#: step of a difference in a coordinate; a logarithm's, or a start's
STEP = 1e-3
#: of the march, 100 times what a well-fitting slider takes: one that vibrates is no candidate
MAX_STEPS = 100_000


class Forward:
    """Friction of a slider under the loading of a record, for many sliders at once.

    Parameters
    ----------
    record : Record
    slider : SpringSlider, which gives the parameters that are not free
    law : int, code
    names : tuple of str, the coordinates (see unknowns.py)
    """

    def __init__(self, record, slider, law, names):
        self.record, self.law, self.names = record, law, names
        self.fixed = {symbol: getattr(slider, symbol) for symbol in ("a", "b", "Dc", "K", "M")}
        self.sigma = slider.sigma
        loading = record.loading
        self.V0 = float(loading.V[0])  # the reference: what slides steadily at it is at rest
        self.loads = Loads(
            np.ascontiguousarray(loading.t),
            np.ascontiguousarray(loading.V, float)[None],
            np.ascontiguousarray(loading.rate, float)[None],
        )
        self.evaluations = 0

    def step(self, name):
        """Step of a central difference in this coordinate."""
        if name == "b":
            return STEP * self.record.scale
        return 0.1 * self.record.spacing if name == "lag" else STEP

    def friction(self, points):
        """(n, m) friction at the record's samples for coordinates (n, k); NaN where none exists.

        Friction is level + (tau/sigma or mu, less its value in steady sliding at the record's
        first speed) + trend times slip or time.
        """
        return self._friction(points)[0]

    def jacobian(self, point):
        """(m,) friction at a point, and (m, k) its derivatives by the coordinates."""
        moving = [i for i, name in enumerate(self.names) if name not in ("level", "trend")]
        points = np.repeat(point[None], 2 * len(moving) + 1, axis=0)
        for j, i in enumerate(moving):
            step = self.step(self.names[i])
            points[2 * j + 1, i] += step
            points[2 * j + 2, i] -= step
        friction, along = self._friction(points)
        here = friction[0]
        columns = np.ones((len(self.names), here.size))  # that of the level stays 1
        for j, i in enumerate(moving):
            columns[i] = _difference(
                friction[2 * j + 1], here, friction[2 * j + 2], self.step(self.names[i])
            )
        if "trend" in self.names:
            columns[self.names.index("trend")] = along[0]
        return here, columns.T

    def _friction(self, points):
        """`friction`, and (n, m) what the trend multiplies: slip or time since the start."""
        values = self._values(points)
        saved = self._motion(values)
        a, b, K = (values[symbol][:, None] for symbol in ("a", "b", "K"))
        x, v, psi = saved[..., 0], saved[..., 1], saved[..., 2]
        along = np.broadcast_to(self.record.along, x.shape)
        if self.record.trend == "slip":
            along = along - (a * self.sigma / K) * (x - x[:, :1])
        change = a * x if self.record.kind == "tau" else a * v + b * psi
        self.evaluations += len(change)
        return values["level"][:, None] + change + values["trend"][:, None] * along, along

    def _values(self, points):
        """name -> (n,) values of everything that `friction` needs."""
        n = len(points)
        nothing = {"level": 0.0, "trend": 0.0, "lag": 0.0, **dict.fromkeys(START, 0.0)}
        values = {k: np.full(n, float(v)) for k, v in {**self.fixed, **nothing}.items()}
        with np.errstate(over="ignore"):
            for i, name in enumerate(self.names):
                plain = name in LINEAR or name in START
                values[name] = points[:, i] if plain else np.exp(points[:, i])
        return values

    def _motion(self, values):
        """(n, m, 3) x, v, psi at the samples."""
        a, b, Dc, K, M = (values[symbol] for symbol in ("a", "b", "Dc", "K", "M"))
        n = a.size
        beta = b / a
        v, psi = (values[name] for name in START)
        times = self.record.t
        rows = np.zeros(n, np.int64)
        if "lag" in self.names:
            # a sample of before the start shows the start
            times = times - values["lag"][:, None]
            rows = np.arange(n)
        times = np.ascontiguousarray(np.atleast_2d(times))
        ends = np.maximum(times[rows, -1], 1e-9 * self.record.t[-1])
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            cases = Cases(
                kappa=K * Dc / (a * self.sigma),
                beta=beta,
                eta0=M * self.V0**2 / (a * self.sigma * Dc),
                scale=self.V0 / Dc,
                V0=np.full(n, self.V0),
                y=np.stack([v + beta * psi, v, psi], axis=1),
                t_end=ends,
                dt=np.zeros(n),
                loading=np.zeros(n, np.int64),
                times=rows,
                rtol=np.full(n, RTOL),
                observe=np.zeros(n),
                v_limit=np.where(M == 0.0, np.log(V_LIMIT / self.V0), np.inf),
                max_steps=np.full(n, MAX_STEPS),
            )
        results = drive.run(RODAS5P, self.law, cases, self.loads, times, np.arange(n), n == 1)
        saved = results.saved
        saved[results.status != FINISHED] = np.nan
        return saved


def _difference(above, here, below, step):
    """A derivative from both sides, or from the one on which there is motion at all."""
    if np.isfinite(above[-1]) and np.isfinite(below[-1]):
        return (above - below) / (2.0 * step)
    if np.isfinite(below[-1]):
        return (here - below) / step
    return (above - here) / step
