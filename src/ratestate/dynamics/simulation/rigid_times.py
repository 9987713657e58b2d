"""Times at which the motion of a rigid slider is shown, and searched for its extremes."""

import itertools

import numpy as np

from ...errors import ParameterError

# Times in a period of the normal stress, and most periods.
PER_PERIOD, MOST = 32, 5000


def stress_jumps(loads, row):
    """(segments,) whether normal stress jumps where each begins."""
    jumps = np.zeros(loads.t.size, bool)
    if loads.sigma.size:
        before, after = loads.sigma_end[row, :-1], loads.sigma[row, 1:]
        jumps[1:] = ~np.isclose(after, before, rtol=1e-12, atol=0.0)
    return jumps


def jumps(loads, row):
    """(segments,) whether speed or normal stress jumps where each begins; not at t = 0."""
    V, rate = loads.V[row], loads.rate[row]
    found = stress_jumps(loads, row)
    before = V[:-1] + rate[:-1] * np.diff(loads.t)
    found[1:] |= ~np.isclose(V[1:], before, rtol=1e-9, atol=0.0)
    return found


def grid(loads, row, p):
    """Times [s] at which a run is shown by default: dense over 10 Dc of slip after breakpoints.

    And `PER_PERIOD` in each period of the normal stress; ParameterError for more than `MOST`.

    loads, row : `Loads`, and the row of this slider in its tables
    p : the slider's parameters, t_end and, if any, sigma_period [SI] as attributes

    (n,) distinct, from 0 to t_end: each segment in 100 parts, and in 200 its first 10 Dc at the
    speed of its start.  More than 100 breakpoints, 0 and t_end among them: these alone.  A segment
    that starts at rest: the 100 parts alone.  Before each jump of V also the last time that is
    still before it, so that the motion has both of its sides.
    """
    starts, V = loads.t, loads.V[row]
    t_end, period = p.t_end, getattr(p, "sigma_period", np.inf)
    breaks = np.append(starts[starts < t_end], t_end)
    before_jumps = np.nextafter(starts[jumps(loads, row) & (starts < t_end)], 0.0)
    pieces = [np.zeros(1), before_jumps]
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
        near = begin + np.linspace(0.0, 10.0 * p.Dc / max(V[k], 1e-300), 201)[1:]
        pieces += [near[near < end], np.linspace(begin, end, 101)[1:]]
    return np.unique(np.concatenate(pieces))
