"""The edge of runaway without inertia (M = 0) under the slip law, exactly.

In the variables of `quasi_static`, with y = v + psi = ln(V theta/Dc), e(v) = kappa (exp(-v) - 1)
and slip D instead of time,

    dv/dD = (b/a) y + e(v),   dy/dD = c y + e(v)

The distance Q = y - K/K_c_qs obeys dQ/dD = c Q + kappa exp(-v): once it is not negative it grows
for ever, and V without bound.  Where V >> V_lp the equations are linear, and while Q < 0 the motion
turns back, however fast it has become.  So one path, along which Q rises to 0 as V grows, parts
what runs away from what comes back, for K >= K_c_qs: there v rises all along it, no path comes back
and then runs away, and it meets each line of disturbances once.  Seen from its fast end it
attracts what lies beside it, so that it is followed from there, as y(v).
"""

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from ..errors import SolverError

# ln(V/V_lp) from which on exp(-v) is lost in rounding.
FAST = 40.0
RTOL = 1e-12


class Thresholds(NamedTuple):
    """Smallest disturbances that run away, dimensionless, > 0; inf where none is up to `largest`.

    step_up: ln(V_lp/V before); kick_up, kick_down: rise and size of fall of tau/(a sigma).
    """

    step_up: float
    kick_up: float
    kick_down: float


def runaway_edge(kappa, beta, largest):
    """`Thresholds` of one slider.

    A step up starts at y = 0, v = -step; a kick, without a change of the state, at y = v.
    SolverError where the path cannot be followed; kappa > beta - 1 > 0 is not checked.

    kappa, beta : float, K Dc/(a sigma) and b/a
    largest : float, size up to which to look
    """
    c = beta - 1.0

    def slope(v, y):
        load = kappa * np.expm1(-v)
        return (c * y + load) / (beta * y + load)

    def step(v, y):
        return y[0]

    def kick(v, y):
        return y[0] - v

    kick.terminal = 2  # type: ignore[attr-defined]  # the second is the kick down, beyond the step
    fast = kappa / c - kappa * np.exp(-FAST) / (c + kappa / c)
    path = solve_ivp(
        slope,
        (max(FAST, largest), -largest),
        [fast],
        method="LSODA",
        events=(step, kick),
        rtol=RTOL,
        atol=RTOL / beta,
    )
    if not path.success:
        raise SolverError(
            f"the edge of runaway (M = 0) could not be followed: K Dc/(a sigma) = {kappa:.6g}, "
            f"b/a = {beta:.6g}: {path.message}"
        )
    steps, kicks = path.t_events
    found = -steps, kicks[(kicks > 0.0) & (kicks <= largest)], -kicks[kicks < 0.0]
    return Thresholds(*(float(at[0]) if at.size else np.inf for at in found))
