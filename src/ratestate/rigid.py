"""The rigid limit K = inf: V = V_lp at all times, and only the state evolves."""

import itertools

import numpy as np

from .engine import drive
from .engine.rigid import states


def follow(law, psi0, t, t_end, segments, *, a, b, Dc, sigma, M, V0):
    """States (m, 3) x, v, psi at times t, and the numbers of a run as the engine reports them.

    None where the load point rests.  tau includes the force M dV_lp/dt that a ramp takes; the
    impulse of a jump is not shown.
    """
    starts, V, rate = segments
    k = np.searchsorted(starts, t, side="right") - 1
    ends = np.minimum(np.append(starts[1:], np.inf), t_end)
    used = starts < t_end
    reached = np.concatenate([V[used], (V + rate * (ends - starts))[used]])
    if not (reached > 0.0).all():
        return None
    psi = np.empty(len(t))
    drive.call(states, law, psi0, t, starts, V, rate, Dc, V0, psi)
    v = np.log((V[k] + rate[k] * (t - starts[k])) / V0)
    inertia = M * rate / (a * sigma)
    found = {
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
    return np.stack([v + b / a * psi + inertia[k], v, psi], axis=-1), found


def grid(starts, V, t_end, Dc):
    """Times [s] that show a run of its own accord: dense over 10 Dc of slip after each break."""
    breaks = np.append(starts[starts < t_end], t_end)
    if len(breaks) > 100:  # a sampled record: its own rows
        return breaks
    pieces = [np.zeros(1)]
    for k, (begin, end) in enumerate(itertools.pairwise(breaks)):
        near = begin + np.linspace(0.0, 10.0 * Dc / max(V[k], 1e-300), 201)[1:]
        pieces += [near[near < end], np.linspace(begin, end, 101)[1:]]
    return np.unique(np.concatenate(pieces))
