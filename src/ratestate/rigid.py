"""The rigid limit K = inf: V = V_lp at all times, and only the state evolves.

With the velocity given, both laws are linear: the aging law in theta, the slip law in
s = ln(V theta/Dc).  What they start from decays over the slip distance Dc, and what forces them
stands under an integral over the slip still to come.
"""

import itertools

import numpy as np

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
    psi = states(law, psi0, t, segments, Dc, V0)
    v = np.log((V[k] + rate[k] * (t - starts[k])) / V0)
    inertia = M * rate / (a * sigma)
    found = {
        "t": t_end,
        "steps": 0.0,
        "energy_residual": 0.0,  # the load point's work is friction's, by V = V_lp
        "amplitude": 0.0,
        "cycles": 0.0,
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


def relax(law, psi, V, rate, dt, Dc, V0):
    """psi after a time dt in which the velocity goes from V at a constant rate."""
    if dt == 0.0:
        return psi
    V_end = V + rate * dt
    decay = np.exp(-dt * 0.5 * (V + V_end) / Dc)
    if law == SLIP:
        forced = _forced(V, V_end, rate, dt, Dc, lambda speed: rate * Dc / speed**2)
        return (psi + np.log(V / V0)) * decay + forced - np.log(V_end / V0)
    return np.log(np.exp(psi) * decay + _forced(V, V_end, rate, dt, Dc, lambda speed: V0 / speed))


def _forced(V, V_end, rate, dt, Dc, f):
    """Integral of f(V) exp(-y) over y, the slip still to come in units of Dc.

    f is the law's forcing for a slip of Dc: of theta in units of Dc/V0, or of s.
    """
    slip = min(dt * 0.5 * (V + V_end) / Dc, MEMORY)
    oldest = np.sqrt(max(V_end**2 - 2.0 * rate * Dc * slip, min(V, V_end) ** 2))
    u, u_end = np.log(oldest), np.log(V_end)
    by_speed = np.linspace(u, u_end, int(2 * abs(u_end - u)) + 2)
    lag = 2.0 * rate * Dc
    if oldest < 0.7 * V_end:  # V spans decades: over u = ln V, with dy = -2 V^2/lag du
        by_slip = V_end**2 - lag * np.arange(1.0, slip)
        knots = np.unique(np.concatenate([by_speed, 0.5 * np.log(by_slip)]))
        u, weights = _gauss(knots)
        speed = np.exp(u)
        y = (V_end**2 - speed**2) / lag
        return float(np.sum(weights * f(speed) * np.exp(-y) * 2.0 * speed**2 / lag))
    knots = np.linspace(0.0, slip, int(slip) + 2)
    if len(by_speed) > 2:
        by_speed = (V_end**2 - np.exp(2.0 * by_speed[1:-1])) / lag
        knots = np.unique(np.concatenate([knots, by_speed]))
    y, weights = _gauss(knots)
    return float(np.sum(weights * f(np.sqrt(V_end**2 - lag * y)) * np.exp(-y)))


def _gauss(knots):
    """Nodes and weights of Gauss's rule on the panels between the knots."""
    half = 0.5 * np.diff(knots)[:, None]
    return knots[:-1, None] + half * (1.0 + NODES), half * WEIGHTS
