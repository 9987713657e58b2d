"""The problems: P1 to P4a, each one slider, and the 156 of Fig. 3; and the engine run on them."""

import copy

import numpy as np

from ratestate.dynamics.simulation.engine_cases import engine_cases, run_cases
from ratestate.engine.model import Loads
from ratestate.friction.laws import LAWS, friction_law
from ratestate.model.arrays import Batch
from ratestate.model.initial_state import initial_state
from ratestate.model.parameters import logspace
from ratestate.paper.parameters import FIG2, FIG3_M, FIG3_V_LP, FIG4

# What counts as exact.
REFERENCE = 1e-12


class Problem:
    """Sliders driven at constant speeds V_lp from steady sliding at V_start, for t_end seconds.

    slider and V_lp may hold named DataArrays; `n` is the number of cases, `which` their numbers.
    """

    def __init__(self, slider, V_lp, V_start, t_end):
        self.slider, self.V_lp, self.V_start, self.t_end = slider, V_lp, V_start, t_end
        values = {k: v for k, v in slider.parameters.items() if k != "law"}
        self.batch = Batch({**values, "V_lp": V_lp, "V_start": V_start})
        self.law = friction_law(slider.law)
        self.n = self.batch.n
        self.which = np.arange(self.n)
        self._reference = self._numbers = None

    def part(self, which):
        """The problem of these cases alone."""
        part = copy.copy(self)
        part.which, part.n = np.asarray(which), len(which)
        part._reference = part._numbers = None
        return part

    def cases(self, rtol, observe=0.0):
        """The engine's `Cases`."""
        return engine_cases(
            self.law,
            self.batch,
            initial_state(self.law, self.batch, self.batch.flat("V_lp")),
            t_end=np.full(self.batch.n, self.t_end),
            loading=np.arange(self.batch.n),
            times=np.zeros(self.batch.n, np.int64),
            rtol=rtol,
            observe=observe,
        )

    def job(self, rtol=1e-6, observe=0.0, method="auto"):
        """A function of nothing that marches the problem by the engine and returns `Results`."""
        cases = self.cases(rtol, observe)
        V_lp = self.batch.flat("V_lp")[:, None].copy()
        loads, none = Loads(np.zeros(1), V_lp, np.zeros_like(V_lp)), np.empty((1, 0))
        return lambda: run_cases(method, self.law, cases, loads, none, self.which)

    def numbers(self):
        """(n, 6) kappa, beta, eta0, V0/Dc, V_lp/V0, law; (n, 3) x, v, psi at t = 0."""
        if self._numbers is None:
            cases = self.cases(1e-6)
            w_lp = self.batch.flat("V_lp") / cases.V0
            law = np.full(len(w_lp), float(list(LAWS).index(self.law.name)))
            rows = [cases.kappa, cases.p[:, 0], cases.eta0, cases.scale, w_lp, law]
            numbers = np.ascontiguousarray(np.transpose(rows)[self.which])
            self._numbers = numbers, cases.y[self.which]
        return self._numbers

    def errors(self, final):
        """(n,) largest error at t_end in tau/(a sigma), ln V and psi; NaN where final is."""
        if self._reference is None:
            self._reference = self.job(REFERENCE, method="rodas5p")().final[self.which]
        return np.abs(final - self._reference).max(axis=1)


def lone():
    """P1 to P4a: name -> Problem; the parameters of Figs. 2 and 4 at their time scales."""
    return {
        "P1": Problem(FIG2, 3.2e-3, 1e-4, 10.0),
        "P2": Problem(FIG4.replace(K=0.96e9), 1e-5, 5e-6, 330.0),
        "P3": Problem(FIG4.replace(K=0.96e9), 1e-7, 5e-8, 46000.0),
        "P4a": Problem(FIG2.replace(law="aging"), 3.2e-3, 1e-4, 10.0),
    }


def own_parameters(law):
    """Values of the parameters that a law, by name, has beside the common ones: its examples."""
    known = LAWS[law].parameters
    return {symbol: parameter.example.strip("'") for symbol, parameter in known.items()}


def fig3(law, finer=1):
    """Fig. 3: 12 masses, 13 loading velocities, 10 s each from steady sliding at 0.1 mm/s.

    finer : how many times more of both, over the same ranges
    """
    masses, speeds = ((*ends, finer * n) for *ends, n in (FIG3_M, FIG3_V_LP))
    slider = FIG2.replace(law=law, M=logspace("M", *masses), **own_parameters(law))
    return Problem(slider, logspace("V_lp", *speeds), 1e-4, 10.0)
