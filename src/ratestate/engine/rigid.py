"""The state where the slider moves with its load point (K = inf): theta or s along given speeds.

With the velocity given, and constant normal stress, some laws are linear, in theta or in
ln(V theta/Dc).  The initial value decays over the slip distance Dc; the forcing adds an integral
over the slip.
"""

import math

import numpy as np

from .jit import inner, kernel

# What was forced more than 45 Dc of slip ago has decayed below rounding.
MEMORY = 45.0
# Where the speed at the oldest of that is less than this part of the last, it spans decades.
WIDE = 0.7
NODES, WEIGHTS = np.polynomial.legendre.leggauss(16)


@kernel
def states(law, psi0, t, starts, V, rate, Dc, V0, out):
    """Put psi = ln(V0 theta/Dc) at times t into `out`.  Speeds are not checked: see `rigid_motion`.

    Parameters
    ----------
    law : of `friction.laws.LAWS`
    psi0 : float, psi at t = 0
    t : (n,) increasing times [s], >= 0
    starts, V, rate : (segments,) of the loading: [s], [m/s] > 0, [m/s^2]
    Dc, V0 : float [m], [m/s]
    out : (n,)
    """
    psi, k, now = psi0, 0, 0.0
    for i in range(t.size):
        while k + 1 < starts.size and starts[k + 1] <= t[i]:
            speed = V[k] + rate[k] * (now - starts[k])
            psi = _relax(law, psi, speed, rate[k], starts[k + 1] - now, Dc, V0)
            k += 1
            now = starts[k]
        speed = V[k] + rate[k] * (now - starts[k])
        psi = _relax(law, psi, speed, rate[k], t[i] - now, Dc, V0)
        now = t[i]
        out[i] = psi


@inner
def _relax(law, psi, V, rate, dt, Dc, V0):
    """psi after a time dt in which the velocity goes from V at a constant rate."""
    if dt == 0.0:
        return psi
    V_end = V + rate * dt
    slip = dt * 0.5 * (V + V_end) / Dc
    forced = _forced(law, V, V_end, rate, slip, Dc, V0)
    return law.relaxed(psi, math.log(V / V0), math.log(V_end / V0), slip, forced)


@inner
def _forced(law, V, V_end, rate, slip, Dc, V0):
    """Integral of the law's forcing times exp(-y) over y, the slip still to come over Dc.

    Gauss's rule on panels: of at most 1 in y, and 1/2 in ln V.  Where V spans decades it goes over
    z = ln(V_end/V) in place of y, with dy = (2/curvature) (V/V_end)^2 dz.

    ======  =======================================================
    curvature    change of (V/V_end)^2 with y, and so 1 - curvature y is that
    oldest  V/V_end where the integral ends, at y = slip
    end     of y, or of z
    ======  =======================================================
    """
    curvature = 2.0 * rate * Dc / V_end / V_end
    oldest = V / V_end
    if slip > MEMORY:
        slip = MEMORY
        oldest = math.sqrt(max(1.0 - curvature * slip, min(oldest, 1.0) ** 2))
    decades = -math.log(oldest)
    wide = oldest < WIDE
    end = decades if wide else slip
    by_slip, by_speed = int(slip) + 1, int(2.0 * abs(decades)) + 1
    total, here, i, j = 0.0, 0.0, 1, 1
    while here < end:
        y, z = slip * i / by_slip, decades * j / by_speed
        if wide:
            near = -0.5 * math.log1p(-curvature * y) if i < by_slip else end
            far = z if j < by_speed else end
        else:
            near = y if i < by_slip else end
            far = -math.expm1(-2.0 * z) / curvature if j < by_speed else end
        there = min(near, far, end)
        i, j = i + (near <= there), j + (far <= there)
        half = 0.5 * (there - here)
        for node, weight in zip(NODES, WEIGHTS):  # noqa: B905  (strict is unknown to numba)
            at = here + half * (1.0 + node)
            part = math.exp(-2.0 * at) if wide else 1.0 - curvature * at  # (V/V_end)^2
            y = (1.0 - part) / curvature if wide else at
            force = law.forcing(curvature, part, V_end / V0)
            total += (
                half * weight * force * math.exp(-y) * (2.0 * part / curvature if wide else 1.0)
            )
        here = there
    return total
