"""The rigid limit K = inf: V = V_lp at all times, and only the state evolves."""

import itertools

import numpy as np
from scipy.optimize import brentq

from ...engine import dispatch
from ...engine.rigid import states
from ...friction.laws import SLIP, aging_rate, slip_rate


def follow(law, psi0, t, t_end, segments, *, a, b, Dc, sigma, M, V0):
    """States (m, 3) x, v, psi at times t, and the numbers of a run as the engine reports them.

    Returns None where the load point rests.  tau includes the force M dV_lp/dt that a ramp takes;
    the impulse of a jump is not shown.
    """
    starts, V, rate = segments
    k = np.searchsorted(starts, t, side="right") - 1
    ends = np.minimum(np.append(starts[1:], np.inf), t_end)
    used = starts < t_end
    reached = np.concatenate([V[used], (V + rate * (ends - starts))[used]])
    if not (reached > 0.0).all():
        return None
    psi = np.empty(len(t))
    dispatch.call(states, law, psi0, t, starts, V, rate, Dc, V0, psi)
    v = np.log((V[k] + rate[k] * (t - starts[k])) / V0)
    inertia = M * rate / (a * sigma)
    numbers = {
        "t": t_end,
        "steps": 0.0,
        "energy_residual": 0.0,  # the load point's work is friction's, by V = V_lp
        "amplitude": 0.0,
        "cycles": 0.0,
        "returns": 0.0,
        "v_max": np.log(reached.max() / V0),
        "v_min": np.log(reached.min() / V0),
        "g_max": np.abs(inertia[used]).max(),
    }
    begin = starts[used]
    lowest = _lowest_friction(law, psi0, begin, ends[used], (V, rate), Dc, V0, b / a)
    numbers["f_min"] = lowest.min()
    numbers["xf_min"] = (2.0 * lowest + inertia[used]).min()
    return np.stack([v + b / a * psi + inertia[k], v, psi], axis=-1), numbers


def _lowest_friction(law, psi0, begin, end, segments, Dc, V0, beta):
    """(n,) smallest v + beta psi in each segment of the loading, which is from begin to end.

    At one of its ends, or where it has a minimum between them.
    """
    V, rate = (values[: begin.size] for values in segments)
    state_rate = slip_rate if law == SLIP else aging_rate

    def state(psi, t, starts, V, rate):
        """psi at times t, from psi at the first segment's start on."""
        out = np.empty(len(t))
        dispatch.call(states, law, psi, t, starts, V, rate, Dc, V0, out)
        return out

    def slope(speed, psi, rate):
        w = speed / V0
        return rate / speed + beta * V0 / Dc * state_rate(w, np.log(w), psi, np.exp(-psi))

    def friction(speed, psi):
        return np.log(speed / V0) + beta * psi

    psi = state(psi0, np.append(begin, end[-1]), begin, V, rate)
    last = V + rate * (end - begin)
    lowest = np.minimum(friction(V, psi[:-1]), friction(last, psi[1:]))
    dips = (slope(V, psi[:-1], rate) < 0.0) & (slope(last, psi[1:], rate) > 0.0)
    for k in np.flatnonzero(dips):
        segment = (np.zeros(1), V[k : k + 1], rate[k : k + 1])

        def at(t, k=k, segment=segment):
            return V[k] + rate[k] * t, state(psi[k], np.array([t]), *segment)[0]

        def rise(t, k=k, at=at):
            speed, now = at(t)
            return slope(speed, now, rate[k])

        lowest[k] = friction(*at(brentq(rise, 0.0, end[k] - begin[k])))
    return lowest


def grid(starts, V, t_end, Dc):
    """Times [s] at which a run is shown by default: dense over 10 Dc of slip after breakpoints."""
    breaks = np.append(starts[starts < t_end], t_end)
    if len(breaks) > 100:  # a sampled record: its own rows
        return breaks
    pieces = [np.zeros(1)]
    for k, (begin, end) in enumerate(itertools.pairwise(breaks)):
        near = begin + np.linspace(0.0, 10.0 * Dc / max(V[k], 1e-300), 201)[1:]
        pieces += [near[near < end], np.linspace(begin, end, 101)[1:]]
    return np.unique(np.concatenate(pieces))
