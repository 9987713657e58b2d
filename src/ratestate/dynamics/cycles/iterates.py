"""Iterates of the return map: several returns of a slider as one map.

A limit cycle that closes after m returns is a fixed point of the m-th iterate.
"""

import numpy as np

from .shooting import gradient, return_map, state

#: what adds up over several returns
SUMS = ("period", "trace", "slow", "mean", "square", "steps")


def iterated_map(system, u, atol, count, *, alone, steady_tol=0.0, period=None):
    """`return_map` from the section's points u (n, 2), count (n,) >= 1 times over; `Returns`.

    The numbers are those of all returns together: sums, extremes, Fourier integrals of a phase
    that runs on, and derivatives of times by the first u.  They also have x_high, the largest
    stress maximum from u on, without that at the end (on a cycle it is the first again).  Extremes
    and Fourier integrals are there only with a `period`.  A slider that does not come back keeps
    the status of that return, and its image is NaN.

    period : (n,) of all returns together
    """
    n = len(u)
    atol, steady_tol = np.broadcast_to(atol, n), np.broadcast_to(steady_tol, n)
    each = np.ones(n) if period is None else period / count

    def once(which, u):
        """One return of the sliders with these numbers."""
        part = system.at(which)
        y, assumed = state(part, u), None if period is None else each[which]
        options = {"alone": alone, "steady_tol": steady_tol[which], "period": assumed}
        returns = return_map(part, y, atol[which], **options)
        # d x/d u at a stress maximum is (beta, eta)
        returns.numbers.update(x_high=y[:, 0], x_high_a=part.beta, x_high_b=part.eta)
        return returns

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

    def by_start(name):
        """Derivatives of one of the last return's numbers by the first u, (2, n)."""
        return np.einsum("ni,nij->jn", gradient(new, name), before)

    joined = dict(new)
    for name in SUMS:
        joined[name] = old[name] + new[name]
    joined["g_max"] = np.maximum(old["g_max"], new["g_max"])
    for name in ("f_min", "xf_min"):
        joined[name] = np.minimum(old[name], new[name])
    for suffix, slope in zip("ab", by_start("period"), strict=True):
        joined[f"period_{suffix}"] = old[f"period_{suffix}"] + slope
    for name, is_new in (
        ("x_low", new["x_low"] < old["x_low"]),
        ("x_high", new["x_high"] > old["x_high"]),
        ("v_min", new["v_min"] < old["v_min"]),
        ("v_max", new["v_max"] > old["v_max"]),
    ):
        joined[name] = np.where(is_new, new[name], old[name])
        for suffix, slope in zip("ab", by_start(name), strict=True):
            joined[f"{name}_{suffix}"] = np.where(is_new, slope, old[f"{name}_{suffix}"])
    shifted = np.exp(1j * omega * old["period"]) * (new["cosine"] + 1j * new["sine"])
    joined["cosine"], joined["sine"] = old["cosine"] + shifted.real, old["sine"] + shifted.imag
    for name, values in joined.items():
        returns.numbers[name][which] = values
    returns.status[which], returns.image[which] = more.status, more.image
    returns.jacobian[which] = more.jacobian @ before
