"""The unstable cycle between stable steady sliding and a limit cycle that coexists with it."""

import numpy as np

from ..cycles.attractor import find_attractors
from ..cycles.measure import refine
from ..cycles.shooting import state
from .family import Family

#: results of `cycles_around`
CYCLES = (
    *("amplitude", "period"),
    *("unstable_amplitude", "unstable_period", "unstable_multiplier"),
)
RTOL = 1e-8
# Stiffness, as a multiple of the slider's, by which the two cycles must have met.
FARTHEST = 100.0


def cycles_around(system, which, u):
    """Measures of stable cycles and of the unstable ones inside them, name -> (n,).

    As the stiffness increases the two meet in a fold: the branch from the stable cycle comes back
    to the slider's own stiffness as the unstable one.

    system : n sliders; which : numbers of those with a cycle; u : (n, 2) estimates of its point
    """
    result = {name: np.full(len(u), np.nan) for name in CYCLES}
    part = system.at(which)
    attractors = find_attractors(part, state(part, u[which]), RTOL, False, None)
    stable = refine(part, attractors, RTOL, False)
    result["amplitude"][which], result["period"][which] = stable["amplitude"], stable["period"]
    single = attractors.n_returns == 1  # as many as of the unstable cycle that meets it
    for i, u_i in zip(which[single], attractors.u[single], strict=True):
        kappa, beta, eta = (float(values[i]) for values in (system.kappa, system.beta, system.eta))
        # With V_lp = Dc = sigma = a = 1 the slider is its own dimensionless form.
        values = {"a": 1.0, "b": beta, "Dc": 1.0, "sigma": 1.0, "K": kappa, "M": eta, "V_lp": 1.0}
        family, p = Family(system.law, values, "K", RTOL), np.log(kappa)
        branch = family.follow(family.chart(u_i[None], p)[0], p, stop=p + np.log(FARTHEST))
        # Close to the Hopf point p hardly changes along the branch, and noise hides the solution at
        # exactly the first p.
        if len(branch.points) > 2 and abs(branch.points[-1].p - p) <= RTOL:
            measures = family.measures(branch.points[-1:], {"start": kappa})
            result["unstable_amplitude"][i] = measures["amplitude"][0]
            result["unstable_period"][i] = measures["period"][0]
            result["unstable_multiplier"][i] = measures["multipliers"][0, 0].real
    return result
