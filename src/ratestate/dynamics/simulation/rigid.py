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
    sampled = grid(starts, V, rate, p.t_end, p.Dc)
    of_all = psi0, sampled, segments
    # The load point's work is friction's, by V = V_lp: no energy_residual.
    numbers = dict.fromkeys("steps energy_residual amplitude cycles returns".split(), 0.0) | {
        "t": p.t_end,
        "v_max": path.order(reached.max()),
        "v_min": path.order(reached.min()),
        "g_max": np.abs(inertia[used]).max(),
        "f_min": path.lowest((1.0, 0.0), np.zeros(starts.size), *of_all),
        "xf_min": path.lowest((1.0, 1.0), inertia, *of_all),
    }
    x = path.force((0.0, 1.0), speed, psi) + inertia[k]
    return np.stack([x, law.v_at(speed / p.V0, psi, path.coefficients), *psi], axis=-1), numbers


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

    def order(self, speed):
        """v at psi = 0 and a speed [m/s]."""
        return self.law.v_at(speed / self.p.V0, self.law.reference_state, self.coefficients)

    def force(self, parts, speed, psi):
        """These parts of friction and of the stress that opposes motion, at this speed [m/s]."""
        at = np.log(speed / self.p.V0), speed / self.p.V0, psi, self.coefficients
        return parts[0] * self.law.resistance(*at) + parts[1] * self.law.stress(*at)

    def rise(self, parts, speed, psi, rate):
        """d/dt of `force` [1/s], where the speed changes at this rate [m/s^2]."""
        at = np.log(speed / self.p.V0), speed / self.p.V0, psi, self.coefficients
        rates = self._rates(speed, psi)

        def rise(by_v, by_psi):
            evolution = sum(one * change for one, change in zip(by_psi, rates, strict=True))
            return by_v * rate / speed + evolution

        friction = rise(*self.law.resistance_partials(*at))
        return parts[0] * friction + parts[1] * rise(*self.law.stress_partials(*at))

    def lowest(self, parts, also, psi0, t, segments):
        """The smallest `force` of these parts, and `also` (n,), what is added in each segment.

        At one of the times t (m,), or where it has a minimum between two of them.
        """
        from scipy.optimize import brentq  # slow to import, and no other run needs it

        starts, V, rate = segments
        psi = np.array(self.states(psi0, t, segments))
        begin, end, first, then = t[:-1], t[1:], psi[:, :-1], psi[:, 1:]
        k = np.searchsorted(starts, begin, side="right") - 1
        V, rate, also = V[k] + rate[k] * (begin - starts[k]), rate[k], also[k]
        last = V + rate * (end - begin)
        sides = (V, tuple(first)), (last, tuple(then))
        lowest = np.minimum(*(self.force(parts, *side) for side in sides))
        falls, rises = (self.rise(parts, *side, rate) for side in sides)
        for i in np.flatnonzero((falls < 0.0) & (rises > 0.0)):
            segment = (np.zeros(1), V[i : i + 1], rate[i : i + 1])

            def at(t, i=i, segment=segment):
                states = self.states(first[:, i], np.array([t]), segment)
                return V[i] + rate[i] * t, tuple(state[0] for state in states)

            def slope(t, i=i, at=at):
                speed, states = at(t)
                return self.rise(parts, speed, states, rate[i])

            length = end[i] - begin[i]
            if slope(length) > 0.0:  # (else it was rounding, at the end of a relaxation)
                lowest[i] = self.force(parts, *at(brentq(slope, 0.0, length)))
        return (lowest + also).min()


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
