"""Brief speeds about a step of the load point: a motor that overshoots and settles."""

import numpy as np

#: longest overshoot, over the shorter of the times at the speeds before and after it
BRIEF = 0.05
#: largest deviation from the speed after, over the change of speed
BEYOND = 0.5
#: largest deviation of the displacement, over that at either speed.  A laboratory slides 10 Dc or
#: more at each speed: friction does not notice so small a part of Dc.
EXCESS = 0.005


def without_overshoots(t, V, end):
    """Return starts [s] and speeds [m/s] of the segments without overshoots, and their numbers.

    t, V : (n,) of all segments; end : of the last one [s]

    A step with an overshoot begins where the overshoot begins.
    """
    lasts = np.diff(np.append(t, end))
    starts, kept = [0], [0]
    while kept[-1] < V.size - 1:
        before = kept[-1]
        after = next(
            (k for k in range(V.size - 1, before + 1, -1) if _overshoots(V, lasts, before, k)),
            before + 1,
        )
        starts.append(before + 1)
        kept.append(after)
    return t[starts], V[kept], np.array(kept)


def _overshoots(V, lasts, before, after):
    """Whether all segments between two are overshoots of a step from the one to the other."""
    brief, ends = slice(before + 1, after), [before, after]
    off = np.abs(V[brief] - V[after])
    moved = (V * lasts)[ends]
    return bool(
        lasts[brief].sum() <= BRIEF * lasts[ends].min()
        and off.max() <= BEYOND * abs(V[after] - V[before])
        and off @ lasts[brief] <= EXCESS * moved[moved > 0.0].min(initial=np.inf)
    )
