"""The rigid limit K = inf: V = V_lp at all times, and only the state evolves."""

import itertools

import numpy as np

from ...engine.compilation import call
from ...engine.rigid import states


def rigid_motion(law, psi0, t, segments, p):
    """States (m, 3) x, v, psi at times t, and the numbers of a run as the engine reports them.

    Returns None where the load point rests at any time before t_end.  tau includes the force
    M dV_lp/dt that a ramp takes; the impulse of a jump is not shown.

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
    psi = _state(law, psi0, t, segments, p)
    v, beta = np.log((V[k] + rate[k] * (t - starts[k])) / p.V0), p.b / p.a
    inertia = p.M * rate / (p.a * p.sigma)
    lowest = _lowest_friction(law, psi0, [x[used] for x in segments], ends[used], p)
    # The load point's work is friction's, by V = V_lp: no energy_residual.
    numbers = dict.fromkeys("steps energy_residual amplitude cycles returns".split(), 0.0) | {
        "t": p.t_end,
        "v_max": np.log(reached.max() / p.V0),
        "v_min": np.log(reached.min() / p.V0),
        "g_max": np.abs(inertia[used]).max(),
        "f_min": lowest.min(),
        "xf_min": (2.0 * lowest + inertia[used]).min(),
    }
    return np.stack([v + beta * psi + inertia[k], v, psi], axis=-1), numbers


def _state(law, psi0, t, segments, p):
    """psi at times t, from psi0 at time 0 on."""
    psi = np.empty(len(t))
    call(states, law, psi0, t, *segments, p.Dc, p.V0, psi)
    return psi


def _lowest_friction(law, psi0, segments, end, p):
    """(n,) smallest v + beta psi in each segment of the loading.

    At one of its ends, or where it has a minimum between them.
    """
    from scipy.optimize import brentq  # slow to import, and no other run needs it

    begin, V, rate = segments
    beta = p.b / p.a

    def slope(speed, psi, rate):
        w = speed / p.V0
        return rate / speed + beta * p.V0 / p.Dc * law.rate(w, np.log(w), psi, np.exp(-psi))

    def friction(speed, psi):
        return np.log(speed / p.V0) + beta * psi

    psi = _state(law, psi0, np.append(begin, end[-1]), segments, p)
    last = V + rate * (end - begin)
    lowest = np.minimum(friction(V, psi[:-1]), friction(last, psi[1:]))
    dips = (slope(V, psi[:-1], rate) < 0.0) & (slope(last, psi[1:], rate) > 0.0)
    for k in np.flatnonzero(dips):
        segment = (np.zeros(1), V[k : k + 1], rate[k : k + 1])

        def at(t, k=k, segment=segment):
            return V[k] + rate[k] * t, _state(law, psi[k], np.array([t]), segment, p)[0]

        def rise(t, k=k, at=at):
            speed, psi_at_t = at(t)
            return slope(speed, psi_at_t, rate[k])

        lowest[k] = friction(*at(brentq(rise, 0.0, end[k] - begin[k])))
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
