"""The state of a slider that moves as its load point does, and the forces on it."""

from typing import NamedTuple

import numpy as np

from ...engine.compilation import call
from ...engine.rigid import states
from ...engine.rigid_steps import Lines, integrated
from ...errors import SolverError
from ...friction.normal_stress import FREQUENCY


class Point(NamedTuple):
    """Where a slider is on its path; arrays of one length, as of `kinematics`."""

    v: np.ndarray
    w: np.ndarray
    psi: tuple
    e: tuple
    p: tuple
    k: np.ndarray  # number of the segment


class Path:
    """A law's state along the history of one slider, with parameters p."""

    def __init__(self, law, loads, row, p):
        self.law, self.p, self.scale = law, p, p.V0 / p.Dc
        self.coefficients = tuple(map(float, law.coefficients(p.V0, p)))
        self.varies = bool(loads.sigma.size)
        self.lines = lines = _lines(loads, row, p)
        used = lines.t < p.t_end
        ends = np.append(lines.t[1:], p.t_end)
        #: speeds at both ends of the segments before t_end, (2, segments) [m/s]
        self.reached = np.stack([lines.V, lines.V + lines.rate * (ends - lines.t)])[:, used]
        #: M dV_lp/dt over a sigma in each segment
        self.inertia = p.M * lines.rate / (p.a * p.sigma)

    def at(self, t, psi, k=None):
        """The `Point` at times t and in states psi, in segments k, or those that begin then."""
        law, lines = self.law, self.lines
        if k is None:
            k = np.searchsorted(lines.t, t, side="right") - 1
        since, p = t - lines.t[k], self.coefficients
        if self.varies:
            base, rate = lines.s[k] + lines.s_rate[k] * since, lines.s_rate[k] / self.scale
            p = law.at_time(p, base, rate, p[FREQUENCY] * self.scale * t)
        w = (lines.V[k] + lines.rate[k] * since) / self.p.V0
        v, psi = law.v_at(w, psi, p), tuple(psi)
        jumps = tuple(np.exp(x) for x in law.jump_exponents(v, psi, p))
        _, _, kept = law.net_speed(v, w, w, jumps)
        own = (np.exp(x) for x in law.own_exponents(v, w, psi, p))
        return Point(v, w, psi, (*kept, *own), p, k)

    def states(self, psi0, t, lines=None):
        """(n_states, m) psi at increasing times t from psi0 at time 0 on; SolverError.

        lines : `Lines`, by default the path's
        """
        lines = self.lines if lines is None else lines
        law, scales, n = self.law, (self.p.Dc, self.p.V0), len(psi0)
        psi = np.empty(len(t) * n)
        if law.gives("relaxed") and not self.varies:
            call(states, law, psi0[0], t, lines.t, lines.V, lines.rate, *scales, psi)
        else:
            path = tuple(map(float, psi0)), t, lines, tuple(range(n)), self.coefficients, *scales
            if (reached := call(integrated, law, *path, psi)) < len(t):
                raise SolverError(f"K = inf: no state could be found at t = {t[reached]:.6g} s")
        return psi.reshape(-1, n).T

    def order(self, speed):
        """v at psi = 0 and a speed [m/s]."""
        return self.law.v_at(speed / self.p.V0, self.law.reference_state, self.coefficients)

    def force(self, at):
        """x at these points."""
        return self.law.stress_in_v(at.v, at.w, at.psi, at.p) + self.inertia[at.k]


def _lines(loads, row, p):
    """`Lines` of a slider, up to t_end.

    At t_end V jumps, but nothing that jumps with normal stress has happened.
    """
    if not loads.sigma.size:
        kept = loads.t <= p.t_end
        return Lines(loads.t[kept], loads.V[row, kept], loads.rate[row, kept])
    kept = loads.t < p.t_end
    s, s_end = loads.sigma[row] / p.sigma, loads.sigma_end[row] / p.sigma
    s_rate = (s_end - s) / np.diff(loads.t, append=np.inf)
    return Lines(loads.t[kept], loads.V[row, kept], loads.rate[row, kept], s[kept], s_rate[kept])
