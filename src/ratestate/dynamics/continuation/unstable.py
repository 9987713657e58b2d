"""The unstable cycle between stable steady sliding and a limit cycle that coexists with it."""

import numpy as np

from ..cycles.attractor import settle
from ..cycles.measure import refine
from ..cycles.shooting import state
from .family import Family

#: what `cycles_around` finds
CYCLES = (
    *("amplitude", "period"),
    *("unstable_amplitude", "unstable_period", "unstable_multiplier"),
)
RTOL = 1e-8
# Stiffness, as a multiple of the slider's, by which the two cycles must have met.
FARTHEST = 100.0


def cycles_around(system, which, u):
    """Measures of stable cycles and of the unstable ones inside them, name -> (n,).

    On raising the stiffness the two meet in a fold: the branch that leaves the stable cycle comes
    back to the slider's own stiffness as the unstable one.

    system : n sliders; which : numbers of those that have a cycle; u : (n, 2) about where
    """
    found = {name: np.full(len(u), np.nan) for name in CYCLES}
    part = system.at(which)
    settled = settle(part, state(part, u[which]), RTOL, False, None)
    stable = refine(part, settled, RTOL, False)
    found["amplitude"][which], found["period"][which] = stable["amplitude"], stable["period"]
    single = settled.returns == 1  # the unstable cycle's, which this one meets
    for i, u_i in zip(which[single], settled.u[single], strict=True):
        numbers = (float(values[i]) for values in (system.kappa, system.beta, system.eta))
        kappa, beta, eta = numbers
        # With V_lp = Dc = sigma = a = 1 the slider is its own dimensionless form.
        values = {"a": 1.0, "b": beta, "Dc": 1.0, "sigma": 1.0, "K": kappa, "M": eta, "V_lp": 1.0}
        family, p = Family(system.law, values, "K", RTOL), np.log(kappa)
        branch = family.follow(family.chart(u_i[None], p)[0], p, stop=p + np.log(FARTHEST))
        # Close to the Hopf point p hardly changes along the branch, and no solution at exactly
        # the first p stands out of the noise.
        if len(branch.points) > 2 and abs(branch.points[-1].p - p) <= RTOL:
            measured = family.measures(branch.points[-1:], {"start": kappa})
            found["unstable_amplitude"][i] = measured["amplitude"][0]
            found["unstable_period"][i] = measured["period"][0]
            found["unstable_multiplier"][i] = measured["multipliers"][0, 0].real
    return found
