"""Iterates of the return map: several returns of a slider as one map.

A limit cycle that closes after m returns is a fixed point of the m-th iterate.
"""

import numpy as np

from .shooting import state, turn

#: what adds up over several returns
SUMS = ("period", "trace", "slow", "mean", "square", "steps")


def iterate(system, u, rtol, count, *, alone, steady_tol=0.0, period=None):
    """`turn` from the section's points u (n, 2), count (n,) times over, as one map.

    The numbers are those of all returns: sums, extremes, Fourier integrals of a phase that runs
    on, the times' derivatives by u; and x_high, the largest stress maximum from u on, the last
    return's own left out (on a cycle it is the first again).

    period : (n,) of all returns together
    """
    each = np.ones(len(u)) if period is None else period / count

    def single(part, y, rtol, steady_tol, each):
        assumed = None if period is None else each
        return turn(part, y, rtol, alone=alone, steady_tol=steady_tol, period=assumed)

    turns = single(system, state(system, u), rtol, steady_tol, each)
    high = np.stack([system.beta, system.eta], axis=1)  # d x/d u at a stress maximum
    turns.numbers["x_high"] = state(system, u)[:, 0]
    turns.numbers["x_high_a"], turns.numbers["x_high_b"] = high.T.copy()
    steady_tol, rtol = np.broadcast_to(steady_tol, len(u)), np.broadcast_to(rtol, len(u))
    for number in range(1, int(count.max(initial=1))):
        which = np.flatnonzero((count > number) & turns.came_back)
        part, begin = system.at(which), state(system.at(which), turns.image[which])
        more = single(part, begin, rtol[which], steady_tol[which], each[which])
        more.numbers["x_high"] = begin[:, 0]
        more.numbers["x_high_a"], more.numbers["x_high_b"] = high[which].T
        _append(turns, which, more, 2.0 * np.pi / each[which])
    return turns


def _append(turns, which, more, pace):
    """Let the turns with these numbers go on by one more.

    pace : angular frequency of the waveform
    """
    had = {name: values[which] for name, values in turns.numbers.items()}
    before, new = turns.jacobian[which], more.numbers

    def by_start(name):
        """Derivatives, with respect to where the turns begin, of what the last one says."""
        row = np.stack([new[f"{name}_a"], new[f"{name}_b"]], axis=1)
        return np.einsum("ni,nij->jn", row, before)

    joined = dict(new)
    for name in SUMS:
        joined[name] = had[name] + new[name]
    joined["g_max"] = np.maximum(had["g_max"], new["g_max"])
    for name in ("f_min", "xf_min"):
        joined[name] = np.minimum(had[name], new[name])
    for suffix, slope in zip("ab", by_start("period"), strict=True):
        joined[f"period_{suffix}"] = had[f"period_{suffix}"] + slope
    for name, further in (
        ("x_low", new["x_low"] < had["x_low"]),
        ("x_high", new["x_high"] > had["x_high"]),
        ("v_min", new["v_min"] < had["v_min"]),
        ("v_max", new["v_max"] > had["v_max"]),
    ):
        joined[name] = np.where(further, new[name], had[name])
        for suffix, slope in zip("ab", by_start(name), strict=True):
            joined[f"{name}_{suffix}"] = np.where(further, slope, had[f"{name}_{suffix}"])
    turned = np.exp(1j * pace * had["period"]) * (new["cosine"] + 1j * new["sine"])
    joined["cosine"], joined["sine"] = had["cosine"] + turned.real, had["sine"] + turned.imag
    for name, values in joined.items():
        turns.numbers[name][which] = values
    turns.status[which], turns.image[which] = more.status, more.image
    turns.jacobian[which] = more.jacobian @ before
