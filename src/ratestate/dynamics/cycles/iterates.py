"""Iterates of the return map: several returns of a slider as one map.

A limit cycle that closes after m returns is a fixed point of the m-th iterate.
"""

import numpy as np

from .shooting import return_map
from .system import state

#: what adds up over several returns
SUMS = ("period", "trace", "slow", "mean", "square", "steps")


def iterated_map(system, u, atol, count, *, steady_tol=0.0, observe=False, period=None):
    """`return_map` from the section's points u (n, k), count (n,) >= 1 times over; `Returns`.

    The numbers are those of all returns together: sums, extremes, Fourier integrals of a phase
    that runs on, and derivatives of times by the first u; x_high is the largest stress maximum
    from u on, without that at the end (on a cycle it is the first again).  A slider that does not
    come back keeps the status of that return, and its image is NaN.

    observe : whether extremes are recorded, which else mean nothing
    period : (n,) of all returns together, for the waveform; without it that means nothing
    """
    n = len(u)
    atol, steady_tol = np.broadcast_to(atol, n), np.broadcast_to(steady_tol, n)
    each = np.ones(n) if period is None else period / count

    def once(which, u):
        """One return of the sliders with these numbers."""
        part = system.at(which)
        y, assumed = state(part, u), None if period is None else each[which]
        options = {"steady_tol": steady_tol[which], "observe": observe, "period": assumed}
        return return_map(part, y, atol[which], **options)

    returns = once(np.arange(n), u)
    for number in range(1, int(count.max(initial=1))):
        which = np.flatnonzero((count > number) & returns.came_back)
        _append(returns, which, once(which, returns.image[which]), 2.0 * np.pi / each[which])
    return returns


def _append(returns, which, more, omega):
    """Extend the returns of the sliders with these numbers by one more return, in place.

    omega : (n,) angular frequency of the waveform
    """
    old = {name: values[which] for name, values in returns.numbers.items()}
    before, new = returns.jacobian[which], more.numbers
    joined = dict(new)
    for name in SUMS:
        joined[name] = old[name] + new[name]
    joined["g_max"] = np.maximum(old["g_max"], new["g_max"])
    for name in ("f_min", "xf_min"):
        joined[name] = np.minimum(old[name], new[name])
    slopes = {name: np.einsum("ni,nij->nj", d, before) for name, d in more.gradients.items()}
    slopes["period"] = returns.gradients["period"][which] + slopes["period"]
    for name, is_new in (
        ("x_low", new["x_low"] < old["x_low"]),
        ("x_high", new["x_high"] > old["x_high"]),
        ("v_min", new["v_min"] < old["v_min"]),
        ("v_max", new["v_max"] > old["v_max"]),
    ):
        joined[name] = np.where(is_new, new[name], old[name])
        slopes[name] = np.where(is_new[:, None], slopes[name], returns.gradients[name][which])
    shifted = np.exp(1j * omega * old["period"]) * (new["cosine"] + 1j * new["sine"])
    joined["cosine"], joined["sine"] = old["cosine"] + shifted.real, old["sine"] + shifted.imag
    for found, values in ((returns.numbers, joined), (returns.gradients, slopes)):
        for name, value in values.items():
            found[name][which] = value
    returns.status[which], returns.image[which] = more.status, more.image
    returns.jacobian[which] = more.jacobian @ before
