"""The rigid limit K = inf: V = V_lp at all times, and only the state evolves.

With the velocity given, both laws are linear: the aging law in theta, the slip law in
s = ln(V theta/Dc).  At constant V they relax over the slip distance Dc (closed form); on a ramp
the same relaxation stands under an integral over the slip still to come.
"""

import itertools

import numpy as np

from .errors import ParameterError
from .laws import SLIP

# What was forced more than 45 Dc of slip ago has decayed below rounding.
MEMORY = 45.0
NODES, WEIGHTS = np.polynomial.legendre.leggauss(16)


def states(law, psi0, t, segments, Dc, V0):
    """psi = ln(V0 theta/Dc) at times t.

    Parameters
    ----------
    law : int, code
    psi0 : float, psi at t = 0
    t : (n,) increasing times [s], >= 0
    segments : (start [s], V [m/s], rate [m/s^2]) arrays of the loading's segments, V > 0
    Dc, V0 : float [m], [m/s]

    Returns
    -------
    (n,) array
    """
    starts, V, rate = segments
    psi, k, now = psi0, 0, 0.0
    out = np.empty(len(t))

    def advance(until):
        speed = V[k] + rate[k] * (now - starts[k])
        return relax(law, psi, speed, rate[k], until - now, Dc, V0)

    for i, t_i in enumerate(t):
        while k + 1 < len(starts) and starts[k + 1] <= t_i:
            psi = advance(starts[k + 1])
            k, now = k + 1, starts[k + 1]
        psi = advance(t_i)
        now = t_i
        out[i] = psi
    return out


def march(law, psi0, t, t_end, segments, *, a, b, Dc, sigma, M, V0):
    """States (m, 3) x, v, psi at times t, and the numbers of a run as the engine reports them.

    tau includes the force M dV_lp/dt that a ramp takes; the impulse of a jump is not shown.
    """
    starts, V, rate = segments
    k = np.searchsorted(starts, t, side="right") - 1
    speed = V[k] + rate[k] * (t - starts[k])
    ends = np.minimum(np.append(starts[1:], np.inf), t_end)
    used = starts < t_end
    reached = np.concatenate([V[used], (V + rate * (ends - starts))[used]])
    if not (reached > 0.0).all():
        raise ParameterError(
            "V_lp = 0 m/s with K = inf: a rigidly driven slider at rest has no friction defined by"
            " eq. 1; give a finite K, or a small V_lp for the hold"
        )
    psi = states(law, psi0, t, segments, Dc, V0)
    v = np.log(speed / V0)
    inertia = M * rate / (a * sigma)
    x = v + b / a * psi + inertia[k]
    found = {
        "steps": 0.0,
        "energy_residual": 0.0,  # the load point's work is friction's, by V = V_lp
        "amplitude": 0.0,
        "cycles": 0.0,
        "v_max": np.log(reached.max() / V0),
        "v_min": np.log(reached.min() / V0),
        "g_max": np.abs(inertia[used]).max(),
    }
    return np.stack([x, v, psi], axis=-1), found


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


def relax(law, psi, V, rate, dt, Dc, V0):
    """psi after a time dt in which the velocity goes from V at a constant rate."""
    if dt == 0.0:
        return psi
    V_end = V + rate * dt
    decay = np.exp(-dt * 0.5 * (V + V_end) / Dc)
    if law == SLIP:
        s = (psi + np.log(V / V0)) * decay + _forcing(V, V_end, rate, Dc, lambda u: 1.0 + 0.0 * u)
        return s - np.log(V_end / V0)
    # theta in units of Dc/V0; d ln V = rate dt/V turns the integral over time into one over ln V
    if rate == 0.0:
        grown = V0 / V * -np.expm1(-dt * V / Dc)
    else:
        grown = _forcing(V, V_end, rate, Dc, lambda u: np.exp(u) * V0 / (Dc * rate))
    return np.log(np.exp(psi) * decay + grown)


def _forcing(V, V_end, rate, Dc, f):
    """Integral over u = ln V of f(u) exp(-slip still to come/Dc), by Gauss's rule on panels."""
    if rate == 0.0:
        return 0.0
    lag = 2.0 * rate * Dc
    oldest = V_end**2 - MEMORY * lag
    far = np.sqrt(max(V**2, oldest) if rate > 0.0 else min(V**2, oldest))
    begin, end = np.log(far), np.log(V_end)
    distance = (V_end**2 - far**2) / lag
    by_slip = 0.5 * np.log(V_end**2 - lag * np.linspace(distance, 0.0, int(distance) + 2))
    by_speed = np.linspace(begin, end, int(2 * abs(end - begin)) + 2)
    knots = np.unique(np.concatenate([by_slip[1:-1], by_speed]))
    knots = knots if rate > 0 else knots[::-1]
    half = 0.5 * np.diff(knots)[:, None]
    u = knots[:-1, None] + half * (1.0 + NODES)
    ahead = (V_end**2 - np.exp(2.0 * u)) / lag
    return float(np.sum(WEIGHTS * half * f(u) * np.exp(-ahead)))
