"""The state of a slider that moves as its load point does, and the forces on it."""

from typing import NamedTuple

import numpy as np

from ...engine.compilation import call
from ...engine.rigid import states
from ...errors import SolverError
from ...friction.functions import weighted_sum
from ...friction.normal_stress import FREQUENCY, S
from .rigid_times import stress_jumps

# Of the state, where a law does not know it in closed form.
RTOL = 1e-11


class Point(NamedTuple):
    """Where a slider is on its path; arrays of one length, as of `kinematics`."""

    v: np.ndarray
    w: np.ndarray
    psi: tuple
    e: tuple
    p: tuple
    k: np.ndarray  # number of the segment


# Sums of friction R, of the strength N, and of x: how much of each
FRICTION, WITH_STRENGTH = (1.0, 0.0, 0.0), (0.0, 1.0, 1.0)


class Path:
    """A law's state along the history of one slider, with parameters p."""

    def __init__(self, law, loads, row, p):
        self.law, self.p, self.starts = law, p, loads.t
        self.V, self.rate = loads.V[row], loads.rate[row]
        self.coefficients, self.scale = law.coefficients(p.V0, p), p.V0 / p.Dc
        self.varies = bool(loads.sigma.size)
        if self.varies:
            self.s, self.s_end = loads.sigma[row] / p.sigma, loads.sigma_end[row] / p.sigma
        self.stress_jumps = stress_jumps(loads, row)
        self.ends = np.minimum(np.append(self.starts[1:], np.inf), p.t_end)
        used = self.starts < p.t_end
        # (a jump of normal stress at the very end has not happened)
        self.used = self.starts[used] if self.varies else self.starts
        last = self.V + self.rate * (self.ends - self.starts)
        #: speeds at the ends of all segments [m/s]
        self.reached = np.concatenate([self.V[used], last[used]])
        #: M dV_lp/dt over a sigma in each segment
        self.inertia = p.M * self.rate / (p.a * p.sigma)

    def at(self, t, psi, k=None):
        """The `Point` at times t and in states psi, in segments k, or those that begin then."""
        if k is None:
            k = np.searchsorted(self.used, t, side="right") - 1
        law, p = self.law, self.history(t, k)
        w = (self.V[k] + self.rate[k] * (t - self.starts[k])) / self.p.V0
        v, psi = law.v_at(w, psi, p), tuple(psi)
        back = tuple(np.exp(x) for x in law.backward_exponent(v, psi, p))
        own = (np.exp(x) for x in law.own_exponents(v, w, psi, back, p))
        return Point(v, w, psi, (*back, *own), p, k)

    def history(self, t, k):
        """The law's coefficients at times t in segments k."""
        if not self.varies:
            return self.coefficients
        lasting = np.diff(self.starts, append=np.inf)[k]
        rate, since = (self.s_end[k] - self.s[k]) / lasting, t - self.starts[k]
        phase = self.coefficients[FREQUENCY] * self.scale * t
        base = self.s[k] + rate * since
        return self.law.at_time(self.coefficients, base, rate / self.scale, phase)

    def states(self, psi0, t):
        """The variables psi at times t, a tuple, from psi0 at time 0 on; SolverError."""
        if self.law.gives("relaxed") and not self.varies:
            psi, segments = np.empty(len(t)), (self.starts, self.V, self.rate)
            call(states, self.law, psi0[0], t, *segments, self.p.Dc, self.p.V0, psi)
            return (psi,)
        return tuple(self._integrated(psi0, t).T)

    def _integrated(self, psi0, t):
        """(m, n_states) psi, integrated over each segment, and after a jump where there is one."""
        psi = np.array(psi0, float)
        out = np.tile(psi, (len(t), 1))  # (for the times at which a segment of no length begins)
        for k, begin in enumerate(self.used):
            end = min(self.ends[k], t[-1])
            if begin > end:
                break
            psi = self._after_jump(k, psi)
            out[t == begin] = psi
            if begin == end:
                continue
            inside = (t > begin) & (t <= end)
            times = np.unique(np.append(t[inside], [begin, end]))
            run = self._followed(k, psi, times)
            out[inside] = run[np.searchsorted(times, t[inside])]
            psi = run[-1]
        return out

    def _followed(self, k, psi, times):
        """(m, n_states) psi at times from the first of them on, all in segment k."""
        from scipy.integrate import solve_ivp  # slow to import, and some laws do without

        def rates(since, psi):
            at = self.at(times[0] + since, psi, k)
            return [self.scale * rate for rate in self.law.rates_in_v(*at[:5])]

        since, row = np.unique(times - times[0], return_inverse=True)  # (some are 1 ulp apart)
        run = solve_ivp(rates, (0.0, since[-1]), psi, "LSODA", t_eval=since, rtol=RTOL, atol=RTOL)
        if not run.success:
            raise SolverError(f"the state at K = inf could not be followed: {run.message}")
        return run.y.T[row]

    def _after_jump(self, k, psi):
        """psi after what normal stress does where segment k begins."""
        if not self.varies or k == 0:
            return psi
        t = self.starts[k]
        before, after = (self.at(t, psi, i) for i in (k - 1, k))
        rise = np.log(after.p[S] / before.p[S])
        return np.array(self.law.after_jump(*after[:5], rise))

    def order(self, speed):
        """v at psi = 0 and a speed [m/s]."""
        return self.law.v_at(speed / self.p.V0, self.law.reference_state, self.coefficients)

    def force(self, at):
        """x at these points."""
        return self.law.stress_in_v(at.v, at.w, at.psi, at.p) + self.inertia[at.k]

    def sums(self, parts, at):
        """Sums of parts of R, N and x."""
        of = at.v, at.w, at.psi, at.p
        friction, strength = self.law.resistance_in_v(*of), self.law.strength_in_v(*of)
        return parts[0] * friction + parts[1] * strength + parts[2] * self.force(at)

    def rises(self, parts, at):
        """d/dT of `sums`."""
        law, of = self.law, at[:5]
        rates, d_w = law.rates_in_v(*of), self.rate[at.k] / (self.p.V0 * self.scale)
        d_omega = d_w / law.speed_slope(at.w, at.e)
        drift = sum(law.strength_drift(at.v, at.w, at.psi, at.p))
        slopes = law.resistance_slopes(*of), law.strength_slopes(*of), law.stress_slopes(*of)
        friction, strength, stress = (
            by_omega * d_omega + weighted_sum(by_psi, rates) for by_omega, by_psi in slopes
        )
        return parts[0] * friction + parts[1] * (strength + drift) + parts[2] * (stress + drift)

    def lowest(self, parts, t, psi):
        """The smallest of `sums` of these parts, at times t (m,), or in a minimum between two."""
        begin, end, first = t[:-1], t[1:], psi[:, :-1]
        jumps = np.isin(end, self.starts[self.stress_jumps])  # (of times just before them)
        last = np.where(jumps, first, psi[:, 1:])
        k = np.searchsorted(self.starts, begin, side="right") - 1
        sides = self.at(begin, first, k), self.at(end, last, k)
        values = [self.sums(parts, side) for side in sides]
        slopes = [self.rises(parts, side) for side in sides]
        lowest = np.minimum(*values)
        inside = np.flatnonzero((slopes[0] < 0.0) & (slopes[1] > 0.0))
        if self.varies:  # the points are dense
            length = self.scale * (end - begin)[inside]
            first, last, falls, rises = (x[inside] for x in (*values, *slopes))
            between = _lowest_of_cubics(first, last, falls, rises, length)
            return min(lowest.min(), between.min(initial=np.inf))
        for i in inside:
            lowest[i] = self._minimum(parts, first[:, i], begin[i], end[i], k[i])
        return lowest.min()

    def _minimum(self, parts, psi, begin, end, k):
        """The minimum of `sums` between two times in segment k, from psi at the first."""
        from scipy.optimize import brentq  # slow to import, and no other run needs it

        def slope(when):
            return self.rises(parts, self._between(when, psi, begin, k))

        # (where it does not rise there it was rounding, at the end of a relaxation)
        at = brentq(slope, begin, end) if slope(end) > 0.0 else end
        return self.sums(parts, self._between(at, psi, begin, k))

    def _between(self, t, psi, begin, k):
        """The `Point` at one time in segment k, from psi at `begin`, in the same, on."""
        if t > begin:
            if self.law.gives("relaxed") and not self.varies:
                found, since = np.empty(1), np.array([t - begin])
                V = self.V[k] + self.rate[k] * (begin - self.starts[k])
                segment = np.zeros(1), np.array([V]), self.rate[k : k + 1]
                call(states, self.law, psi[0], since, *segment, self.p.Dc, self.p.V0, found)
                psi = found
            else:
                psi = self._followed(k, psi, np.array([begin, t]))[-1]
        return self.at(t, tuple(psi), k)


def _lowest_of_cubics(first, last, falls, rises, length):
    """Minima of cubics that have these values and slopes, < 0 and > 0, at the ends of a length."""
    mean = (last - first) / length
    c, d = (3.0 * mean - 2.0 * falls - rises) / length, (falls + rises - 2.0 * mean) / length**2
    root = np.sqrt(np.maximum(c * c - 3.0 * d * falls, 0.0))
    at = np.clip(-falls / (c + root), 0.0, length)
    return first + at * (falls + at * (c + at * d))
