"""The rigid limit K = inf: V = V_lp at all times, and only the state evolves."""

import itertools

import numpy as np

from ...engine.compilation import call
from ...engine.rigid import states
from ...errors import SolverError

# Of the state, where a law does not know it in closed form.
RTOL = 1e-11


def rigid_motion(law, psi0, t, segments, p):
    """States (m, len(y)) x, v, psi at times t, and the numbers of a run as the engine reports them.

    Returns None where the load point rests at any time before t_end.  tau includes the force
    M dV_lp/dt that a ramp takes; the impulse of a jump is not shown.  SolverError where the state
    cannot be followed.

    psi0 : (n_states,) the law's variables at t = 0
    segments : (k,) starts [s], speeds [m/s] and rates [m/s^2] of the loading
    p : the slider's parameters and t_end [SI] as attributes
    """
    starts, V, rate = segments
    k = np.searchsorted(starts, t, side="right") - 1
    ends = np.minimum(np.append(starts[1:], np.inf), p.t_end)
    used = starts < p.t_end
    reached = np.concatenate([V[used], (V + rate * (ends - starts))[used]])
    if not (reached > 0.0).all():
        return None
    path = _Path(law, p)
    psi = path.states(psi0, t, segments)
    speed = V[k] + rate[k] * (t - starts[k])
    inertia = p.M * rate / (p.a * p.sigma)
    lowest = path.lowest_friction(psi0, [x[used] for x in segments], ends[used])
    # The load point's work is friction's, by V = V_lp: no energy_residual.
    numbers = dict.fromkeys("steps energy_residual amplitude cycles returns".split(), 0.0) | {
        "t": p.t_end,
        "v_max": np.log(reached.max() / p.V0),
        "v_min": np.log(reached.min() / p.V0),
        "g_max": np.abs(inertia[used]).max(),
        "f_min": lowest.min(),
        "xf_min": (2.0 * lowest + inertia[used]).min(),
    }
    x = path.friction(speed, psi) + inertia[k]
    return np.stack([x, np.log(speed / p.V0), *psi], axis=-1), numbers


class _Path:
    """A law's state along the history of speeds of one slider, with parameters p."""

    def __init__(self, law, p):
        self.law, self.p = law, p
        self.coefficients = law.coefficients(p.V0, p)

    def states(self, psi0, t, segments):
        """The variables psi at times t, a tuple, from psi0 at time 0 on; SolverError."""
        if self.law.gives("relaxed"):
            psi = np.empty(len(t))
            call(states, self.law, psi0[0], t, *segments, self.p.Dc, self.p.V0, psi)
            return (psi,)
        return tuple(self._integrated(psi0, t, segments).T)

    def _integrated(self, psi0, t, segments):
        """(m, n_states) psi, integrated over each segment."""
        from scipy.integrate import solve_ivp  # slow to import, and some laws do without

        psi = np.array(psi0, float)
        out = np.tile(psi, (len(t), 1))  # (for the times at which a segment of no length begins)
        starts, V, rate = segments
        for begin, V_begin, slope, end in zip(starts, V, rate, [*starts[1:], np.inf], strict=True):
            end = min(end, t[-1])
            if begin >= end:
                continue

            def rates(since, psi, V_begin=V_begin, slope=slope):
                return self._rates(V_begin + slope * since, tuple(psi))

            inside = (t >= begin) & (t <= end)
            times = np.unique(np.append(t[inside], [begin, end])) - begin
            at = {"t_eval": times, "rtol": RTOL, "atol": RTOL}
            run = solve_ivp(rates, (0.0, times[-1]), psi, "LSODA", **at)
            if not run.success:
                raise SolverError(f"the state at K = inf could not be followed: {run.message}")
            out[inside] = run.y.T[np.searchsorted(times, t[inside] - begin)]
            psi = run.y[:, -1]
        return out

    def _rates(self, speed, psi):
        """dpsi/dt [1/s] at this speed [m/s], a tuple."""
        v, w = np.log(speed / self.p.V0), speed / self.p.V0
        e = self.law.exponentials(v, w, psi, self.coefficients)
        scale = self.p.V0 / self.p.Dc
        return [scale * rate for rate in self.law.rates(v, w, psi, e, self.coefficients)]

    def friction(self, speed, psi):
        """(mu - mu0)/a at this speed [m/s]."""
        v, w = np.log(speed / self.p.V0), speed / self.p.V0
        return self.law.resistance(v, w, psi, self.coefficients)

    def rise(self, speed, psi, rate):
        """d/dt of `friction` [1/s], where the speed changes at this rate [m/s^2]."""
        v, w = np.log(speed / self.p.V0), speed / self.p.V0
        by_v, by_psi = self.law.resistance_partials(v, w, psi, self.coefficients)
        evolution = zip(by_psi, self._rates(speed, psi), strict=True)
        return by_v * rate / speed + sum(one * change for one, change in evolution)

    def lowest_friction(self, psi0, segments, end):
        """(k,) the smallest `friction` in each segment of the loading.

        At one of its ends, or where it has a minimum between them.
        """
        from scipy.optimize import brentq  # slow to import, and no other run needs it

        begin, V, rate = segments
        psi = np.array(self.states(psi0, np.append(begin, end[-1]), segments))
        last = V + rate * (end - begin)
        first, then = tuple(psi[:, :-1]), tuple(psi[:, 1:])
        lowest = np.minimum(self.friction(V, first), self.friction(last, then))
        dips = (self.rise(V, first, rate) < 0.0) & (self.rise(last, then, rate) > 0.0)
        for k in np.flatnonzero(dips):
            segment = (np.zeros(1), V[k : k + 1], rate[k : k + 1])

            def at(t, k=k, segment=segment):
                states = self.states(psi[:, k], np.array([t]), segment)
                return V[k] + rate[k] * t, tuple(state[0] for state in states)

            def rise(t, k=k, at=at):
                speed, states = at(t)
                return self.rise(speed, states, rate[k])

            length = end[k] - begin[k]
            if rise(length) > 0.0:  # (else it was rounding, at the end of a relaxation)
                lowest[k] = self.friction(*at(brentq(rise, 0.0, length)))
        return lowest


def grid(starts, V, rate, t_end, Dc):
    """Times [s] at which a run is shown by default: dense over 10 Dc of slip after breakpoints.

    (n,) distinct, from 0 to t_end: each segment in 100 parts, and in 200 its first 10 Dc at the
    speed of its start.  More than 100 breakpoints, 0 and t_end among them: these alone.  A segment
    that starts at rest: the 100 parts alone.  Before each jump of V also the last time that is
    still before it, so that the motion has both of its sides.
    """
    breaks = np.append(starts[starts < t_end], t_end)
    jump = ~np.isclose(V[1:], V[:-1] + rate[:-1] * np.diff(starts), rtol=1e-9, atol=0.0)
    jumps = starts[1:][jump & (starts[1:] < t_end)]
    pieces = [np.zeros(1), np.nextafter(jumps, 0.0)]
    if len(breaks) > 100:  # a sampled record: its own rows
        return np.unique(np.concatenate([*pieces, breaks]))
    for k, (begin, end) in enumerate(itertools.pairwise(breaks)):
        near = begin + np.linspace(0.0, 10.0 * Dc / max(V[k], 1e-300), 201)[1:]
        pieces += [near[near < end], np.linspace(begin, end, 101)[1:]]
    return np.unique(np.concatenate(pieces))
