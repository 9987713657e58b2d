"""The state where the slider moves with its load point (K = inf), where it has no closed form.

Rodas5P (`tableau`) on d psi/dT = f(psi, T) alone: with the speed given, v follows from psi, and no
state is coupled to another.
"""

import math
from typing import NamedTuple

import numpy as np

from ..friction.normal_stress import FREQUENCY, S
from .drift import with_states
from .exp import exp_each_alone
from .jit import inner, kernel, recursive
from .rodas5p import leaves
from .step_control import GROW, SAFETY, SHRINK
from .tableau import GAMMA, NODES, A, C, D
from .tuples import largest, plus, product, read_rows, sum_of_sizes, times, write, zeros

# Error allowed in a step, of psi or, if that is larger than 1, as a part of it.
TOLERANCE = 1e-11
# (arrays, so that stages are a loop: it is compiled in a fraction of the time that eight take)
STAGES = len(NODES)
POINTS = np.array([[*row, *[0.0] * (STAGES - len(row))] for row in A])
COUPLINGS = np.array([[*row, *[0.0] * (STAGES - len(row))] for row in C])
DRIFTS, PARTS = np.array(D), np.array(NODES)


class Lines(NamedTuple):
    """What a loading does to one slider, in segments; a sinusoid of sigma is among p."""

    t: np.ndarray  # starts [s], increasing from 0
    V: np.ndarray  # speed at the start of each [m/s], > 0
    rate: np.ndarray  # and acceleration [m/s^2]
    # sigma/sigma(0) at the start of each, and its rate [1/s]; of no elements: constant
    s: np.ndarray = np.empty(0)
    s_rate: np.ndarray = np.empty(0)


@kernel
def integrated(law, psi, t, lines, order, p, Dc, V0, out):
    """Put psi at times t into `out`; of how many, if not all, before it could not be followed.

    At the start of a segment psi is that after a jump of sigma.

    Parameters
    ----------
    law : of `composition`
    psi : tuple of n_states, at t = 0
    t : (n,) increasing times [s], >= 0
    lines : `Lines`
    order : (0, 1, ...), n_states of them
    p : the law's coefficients
    Dc, V0 : float [m], [m/s]
    out : (n n_states,)
    """
    k, since, h, n, scale = 0, 0.0, math.inf, len(order), V0 / Dc
    increments = np.empty(STAGES * n)
    line = _line(law, lines, 0, p, scale, V0)
    for i in range(t.size):
        while k + 1 < lines.t.size and lines.t[k + 1] <= t[i]:
            end = scale * (lines.t[k + 1] - lines.t[k])
            psi, h = _advanced(law, psi, since, end, h, line, order, increments)
            k, since, before = k + 1, 0.0, law.later(line[2], end)
            line = _line(law, lines, k, p, scale, V0)
            psi = _after_jump(law.history(p), law, psi, before, line)
        end = scale * (t[i] - lines.t[k])
        psi, h = _advanced(law, psi, since, end, h, line, order, increments)
        since = end
        if math.isnan(psi[0]):
            return i
        write(out, i * n, psi)
    return t.size


@inner
def _line(law, lines, k, p, scale, V0):
    """At the start of segment k: w, dw/dT, and the law's coefficients."""
    now = _begun(law.history(p), law, lines, k, p, scale)
    return lines.V[k] / V0, lines.rate[k] / V0 / scale, now


@recursive
def _begun(history, law, lines, k, p, scale):
    if len(history) == 0:
        return p
    return law.at_time(p, lines.s[k], lines.s_rate[k] / scale, p[FREQUENCY] * scale * lines.t[k])


@recursive
def _after_jump(history, law, psi, before, line):
    """psi after what normal stress does where a segment begins; before : p until then."""
    if len(history) == 0:
        return psi
    v, w, _, e, p = _point(law, psi, 0.0, line)
    return law.after_jump(v, w, psi, e, p, math.log(p[S] / before[S]))


@inner
def _point(law, psi, T, line):
    """v, w, psi, e and p at a time T after the start of a segment."""
    w, p = line[0] + line[1] * T, law.later(line[2], T)
    v = law.v_at(w, psi, p)
    jumps = exp_each_alone(law.jump_exponents(v, psi, p))
    _, _, kept = law.net_speed(v, w, w, jumps)
    return v, w, psi, (*kept, *exp_each_alone(law.own_exponents(v, w, psi, p))), p


@inner
def _advanced(law, psi, T, end, h, line, order, increments):
    """psi, once NaN always, from T to `end` after the start of a segment; the step to try next."""
    while T < end and not math.isnan(psi[0]):
        left = end - T
        size = left if h * (1.0 + 1e-9) >= left else h
        new, error = _step(law, psi, T, size, line, order, increments)
        factor = SHRINK
        if error < math.inf:
            factor = min(max(SAFETY * max(error, 1e-20) ** -0.2, SHRINK), GROW)
        if error <= 1.0:
            psi, T = new, end if size == left else T + size
            # (a step that was cut short says nothing against the one planned)
            h = max(h, size * factor) if size < h else size * factor
        else:
            h = size * factor
            psi = psi if T + h > T else times(math.nan, psi)
    return psi, h


@inner
def _step(law, psi, T, h, line, order, increments):
    """psi after a step h from T, and its estimated error over the one allowed."""
    v, w, _, e, p = _point(law, psi, T, line)
    by_omega, by_psi = law.rate_slopes(v, w, psi, e, p)
    d_omega = line[1] / law.speed_slope(w, e)
    drift = with_states(times(d_omega, by_omega), 1.0, law.rate_drift(v, w, psi, p))
    pivots, n = leaves(GAMMA * h, by_psi), len(order)
    for i in range(STAGES):
        u = _summed(psi, POINTS[i], i, order, increments)
        coupling = _summed(zeros(psi), COUPLINGS[i], i, order, increments)
        v, w, _, e, p = _point(law, u, T + PARTS[i] * h, line)
        right = plus(law.rates_in_v(v, w, u, e, p), 1.0 / h, coupling)
        write(increments, i * n, product(pivots, plus(right, h * DRIFTS[i], drift)))
    new = _summed(psi, POINTS[STAGES], STAGES, order, increments)
    error = sum_of_sizes(read_rows(increments, order, (STAGES - 1) * n))
    return new, error / (TOLERANCE * max(1.0, largest(new)))


@inner
def _summed(total, factors, count, order, increments):
    """A tuple and so many increments, each times its factor."""
    for j in range(count):
        total = plus(total, factors[j], read_rows(increments, order, j * len(order)))
    return total
