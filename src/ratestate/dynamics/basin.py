"""The basin of stable steady sliding: the disturbances from which the motion returns to it.

Where K > K_c small disturbances decay.  But where a limit cycle coexists, or a runaway without
inertia, large ones need not.  `escape` finds the smallest that do not, of two kinds that a
laboratory can impose.  With inertia it follows the motion itself, and adds the unstable cycle that
lies between; without inertia it uses the path that separates runaways from orbits that come back
(`quasi_static`) under the slip and aging laws, else the motion too.
"""

import numpy as np
import xarray

from ..errors import SolverError
from ..model.arrays import Batch
from ..model.slider import check_slider
from ..model.units import to_si
from .continuation.family import Family
from .cycles.attractor import find_attractors
from .cycles.measure import refine
from .cycles.system import state, system_of
from .disturbances import KINDS, smallest_escapes
from .progress import bar
from .results import columns, provenance

#: measures of the limit cycle beyond, and of the unstable one between
CYCLES = ("amplitude", "period", "unstable_amplitude", "unstable_period", "unstable_multiplier")
VARIABLES = [*KINDS, "outcome", *CYCLES]
# Accuracy of the cycles whose measures are returned; and the stiffness, as a multiple of the
# slider's, by which the two must have met.
CYCLE_RTOL, FARTHEST_FOLD = 1e-8, 100.0


def escape(slider, V_lp):
    """The smallest disturbances of steady sliding at V_lp from which it does not come back.

    A step: sliding steadily at another speed, where that is stable, until the load point's changes
    to V_lp.  A kick: a sudden change of the spring's stress while sliding steadily at V_lp.  Under
    a law whose sliding is unstable between two speeds only, steps come from the side of V_lp.

    Parameters
    ----------
    slider : SpringSlider
        Parameters that are named DataArrays make a sweep.
    V_lp : float, str, pint.Quantity or DataArray
        Load-point velocity [m/s], > 0.

    Returns
    -------
    xarray.Dataset
        ``step_up`` and ``step_down`` [1]: ratio of V_lp to the speed before, > 1 and < 1;
        ``kick_up`` > 0 and ``kick_down`` < 0 [Pa]: change of tau.  Where no disturbance of up to
        12 decades of V, or 27 a sigma, leaves the basin, step_up = kick_up = inf, step_down = 0
        and kick_down = -inf (steps come from no speed beyond V_c, or V_c_upper); where steady
        sliding is unstable (K <= K_c), steps are 1, kicks 0.
        ``outcome``: the motion beyond, "cycle", "irregular cycles" (they do not repeat), "runaway"
        (M = 0), "none", "no steady sliding" where that is unstable, or "unknown" in a sweep where
        an orbit could not be followed or did not settle (the size concerned is NaN); else
        "irregular cycles" where any of the four disturbances leads to them.  Of the limit cycle
        beyond ``amplitude`` and ``period`` [s], and of the unstable cycle between,
        ``unstable_amplitude`` (max - min of tau/sigma), ``unstable_period`` [s] and
        ``unstable_multiplier`` (by which a distance from it grows in a period); NaN where there is
        none.

    Raises
    ------
    ParameterError
        An input that cannot be used; a law without second derivatives.
    SolverError
        An orbit could not be followed to its end, or did not settle; in a sweep such a case is
        "unknown".

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="630 MPa/m", M=0)
    >>> edge = rs.escape(slider, "1 um/s")
    >>> str(edge.outcome.values), round(float(edge.step_up), 2)
    ('runaway', 2.11)
    """
    V_lp = to_si("V_lp", V_lp)
    batch = Batch({**check_slider(slider).values, "V_lp": V_lp}, reserved=VARIABLES)
    batch.check_fits(len(VARIABLES), "ask for fewer at a time")
    system = system_of(slider.friction_law.name, **batch.columns)
    alone = batch.shape == ()
    with bar("escape") as progress:
        sizes, outcome, u = smallest_escapes(system, batch.columns, alone, progress)
    if alone and outcome[0] == "unknown":
        raise SolverError(f"an orbit from disturbed sliding could not be followed\n{slider!r}")
    cycles = _cycles_around(system, batch.columns, np.flatnonzero(outcome == "cycle"), u)
    p = columns(batch)
    units = {"amplitude": p.a, "period": p.Dc / p.V_lp, "multiplier": 1.0}
    with np.errstate(over="ignore"):
        values = {
            "step_up": np.exp(sizes[0]),
            "step_down": np.exp(-sizes[1]),
            "kick_up": p.a * p.sigma * sizes[2],
            "kick_down": 0.0 - p.a * p.sigma * sizes[3],
        }
        for name, value in cycles.items():
            values[name] = units[name.removeprefix("unstable_")] * value
    values["outcome"] = outcome
    variables = {name: batch.variable(value, name) for name, value in values.items()}
    result = xarray.Dataset(variables, batch.coordinates(VARIABLES))
    result.attrs = provenance("escape", slider, V_lp=V_lp)
    return result


def _cycles_around(system, columns, which, u):
    """Measures of the stable cycles of these sliders and of unstable ones inside, name -> (n,).

    As the stiffness increases the two meet in a fold: the branch from the stable cycle comes back
    to the slider's own stiffness as the unstable one.

    columns : parameters of the sliders and V_lp, symbol -> (n,) [SI]
    u : (n, k) near the stable cycles
    """
    result = {name: np.full(len(u), np.nan) for name in CYCLES}
    part = system.at(which)
    attractors = find_attractors(part, state(part, u[which]), CYCLE_RTOL, None)
    stable = refine(part, attractors, CYCLE_RTOL)
    result["amplitude"][which], result["period"][which] = stable["amplitude"], stable["period"]
    single = attractors.n_returns == 1  # as many as of the unstable cycle that meets it
    for i, u_i in zip(which[single], attractors.u[single], strict=True):
        values = {symbol: float(column[i]) for symbol, column in columns.items()}
        family, p = Family(system.law, values, "K", CYCLE_RTOL), np.log(values["K"])
        branch = family.branch(family.chart(u_i[None], p)[0], p, stop=p + np.log(FARTHEST_FOLD))
        # Close to the Hopf point p hardly changes along the branch, and noise hides the solution at
        # exactly the first p.
        if len(branch.points) > 2 and abs(branch.points[-1].p - p) <= CYCLE_RTOL:
            measures = family.measures(branch.points[-1:], {"start": values["K"]})
            result["unstable_amplitude"][i] = measures["amplitude"][0]
            result["unstable_period"][i] = measures["period"][0]
            result["unstable_multiplier"][i] = measures["multipliers"][0, 0].real
    return result
