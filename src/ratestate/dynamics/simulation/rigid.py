"""The rigid limit K = inf: V = V_lp at all times, and only the state evolves."""

import itertools
from typing import NamedTuple

import numpy as np

from ...engine.compilation import call
from ...engine.rigid import states
from ...errors import ParameterError, SolverError
from ...friction.functions import weighted_sum
from ...friction.normal_stress import FREQUENCY, S

# Of the state, where a law does not know it in closed form.
RTOL = 1e-11
# Times in a period of the normal stress, and most periods.
PER_PERIOD, MOST = 32, 5000


def period_of(p):
    """The period of the normal stress [s], inf for none; p : a case's values as attributes."""
    return getattr(p, "sigma_period", np.inf)


def rigid_motion(law, psi0, t, loads, row, p):
    """States (m, len(y)) x, v, psi at times t, and the numbers of a run as the engine reports them.

    Returns None where the load point rests at any time before t_end.  tau includes the force
    M dV_lp/dt that a ramp takes; the impulse of a jump is not shown.  SolverError where the state
    cannot be followed.

    law : as the engine needs it
    psi0 : (n_states,) the law's variables at t = 0
    loads, row : `Loads`, and the row of this slider in its tables
    p : the slider's parameters and t_end [SI] as attributes
    """
    path = _Path(law, loads, row, p)
    if not (path.reached > 0.0).all():
        return None
    sampled = grid(loads, row, p.t_end, p.Dc, period_of(p))
    times = np.union1d(t, sampled)
    followed = np.array(path.states(psi0, times))
    psi = followed[:, np.searchsorted(times, t)]
    of_all = sampled, followed[:, np.searchsorted(times, sampled)]
    # The load point's work is friction's, by V = V_lp: no energy_residual.
    numbers = dict.fromkeys("steps energy_residual amplitude cycles returns".split(), 0.0) | {
        "t": p.t_end,
        "v_max": path.order(path.reached.max()),
        "v_min": path.order(path.reached.min()),
        "g_max": np.abs(path.inertia[loads.t < p.t_end]).max(),
        "f_min": path.lowest(FRICTION, *of_all),
        "xf_min": path.lowest(WITH_STRENGTH, *of_all),
    }
    at = path.at(t, psi)
    return np.stack([path.force(at), at.v, *psi], axis=-1), numbers


class _Point(NamedTuple):
    """Where a slider is on its path; arrays of one length, as of `kinematics`."""

    v: np.ndarray
    w: np.ndarray
    psi: tuple
    e: tuple
    p: tuple
    k: np.ndarray  # number of the segment


# Sums of friction R, of the strength N, and of x: how much of each
FRICTION, WITH_STRENGTH = (1.0, 0.0, 0.0), (0.0, 1.0, 1.0)


class _Path:
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
        self.used = self.starts[used]  # a jump at the very end has not happened
        last = self.V + self.rate * (self.ends - self.starts)
        #: speeds at the ends of all segments [m/s]
        self.reached = np.concatenate([self.V[used], last[used]])
        #: M dV_lp/dt over a sigma in each segment
        self.inertia = p.M * self.rate / (p.a * p.sigma)

    def at(self, t, psi, k=None):
        """The `_Point` at times t and in states psi, in segments k, or those that begin then."""
        if k is None:
            k = np.searchsorted(self.used, t, side="right") - 1
        law, p = self.law, self.history(t, k)
        w = (self.V[k] + self.rate[k] * (t - self.starts[k])) / self.p.V0
        v, psi = law.v_at(w, psi, p), tuple(psi)
        back = tuple(np.exp(x) for x in law.backward_exponent(v, psi, p))
        own = (np.exp(x) for x in law.own_exponents(v, w, psi, back, p))
        return _Point(v, w, psi, (*back, *own), p, k)

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
        """The `_Point` at one time in segment k, from psi at `begin`, in the same, on."""
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


def stress_jumps(loads, row):
    """(segments,) whether normal stress jumps where each begins."""
    jumps = np.zeros(loads.t.size, bool)
    if loads.sigma.size:
        before, after = loads.sigma_end[row, :-1], loads.sigma[row, 1:]
        jumps[1:] = ~np.isclose(after, before, rtol=1e-12, atol=0.0)
    return jumps


def grid(loads, row, t_end, Dc, period=np.inf):
    """Times [s] at which a run is shown by default: dense over 10 Dc of slip after breakpoints.

    And `PER_PERIOD` in each period [s] of an oscillation; ParameterError for more than `MOST`.

    (n,) distinct, from 0 to t_end: each segment in 100 parts, and in 200 its first 10 Dc at the
    speed of its start.  More than 100 breakpoints, 0 and t_end among them: these alone.  A segment
    that starts at rest: the 100 parts alone.  Before each jump of V also the last time that is
    still before it, so that the motion has both of its sides.
    """
    starts, V, rate = loads.t, loads.V[row], loads.rate[row]
    breaks = np.append(starts[starts < t_end], t_end)
    jump = ~np.isclose(V[1:], V[:-1] + rate[:-1] * np.diff(starts), rtol=1e-9, atol=0.0)
    jump |= stress_jumps(loads, row)[1:]
    jumps = starts[1:][jump & (starts[1:] < t_end)]
    pieces = [np.zeros(1), np.nextafter(jumps, 0.0)]
    if t_end / period > MOST:
        raise ParameterError(
            f"K = inf: {t_end:.6g} s are {t_end / period:.6g} periods of the normal stress, and "
            f"{MOST} at most are followed; shorten t_end, or give a large K"
        )
    if np.isfinite(period):
        pieces.append(np.arange(0.0, t_end, period / PER_PERIOD))
    if len(breaks) > 100:  # a sampled record: its own rows
        return np.unique(np.concatenate([*pieces, breaks]))
    for k, (begin, end) in enumerate(itertools.pairwise(breaks)):
        near = begin + np.linspace(0.0, 10.0 * Dc / max(V[k], 1e-300), 201)[1:]
        pieces += [near[near < end], np.linspace(begin, end, 101)[1:]]
    return np.unique(np.concatenate(pieces))
