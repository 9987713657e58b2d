"""The function `continue_cycle`: a branch of limit cycles along one parameter."""

import numpy as np
import xarray

from ...engine.backend import check_stopped
from ...engine.model import FINISHED
from ...errors import NotConverged
from ...friction.composition import composed_law
from ...model.arrays import Batch
from ...model.names import keywords_checked
from ...model.parameters import parameter_to_si
from ...model.quantities import QUANTITIES, attrs
from ...model.slider import check_slider
from ...model.units import is_array, to_si
from ..cycles.variables import VARIABLES, cycle_variables
from ..progress import bar
from ..recipe import record_scenario
from ..refusals import refusal, sentence
from ..simulation.settings import checked_rtol
from .branch_start import beginning, hopf_measures, hopf_near
from .family import PARAMETERS, Family
from .newton import NO_CONVERGENCE, NO_RETURN

# Amplitude of ln V below which a branch ends at a Hopf point.
END_AMPLITUDE = 0.02
MAX_POINTS = 1000
#: ends of a branch that is not whole
PREMATURE = (NO_RETURN, NO_CONVERGENCE, "max_points")


@keywords_checked
def continue_cycle(slider, parameter, start, stop, *, V_lp=None, rtol=1e-8):
    """Follow a limit cycle, stable or not, while one parameter goes from start to stop.

    Begins with the cycle that `limit_cycle` finds at `start`; where that is steady sliding, at
    the Hopf point between start and stop.  Goes by pseudo-arclength in the parameter's logarithm
    (Keller 1977), so it passes the folds where the parameter turns back.  Ends at `stop`, at a Hopf
    point, or on coming back to `start`.

    Parameters
    ----------
    slider : SpringSlider
        One slider, no sweep; M > 0.
    parameter : {"V_lp", "K", "M", "sigma", "a", "b", "Dc"} or a parameter of the law alone
        What changes along the branch.
    start, stop : float, str or pint.Quantity
        Its first and last value, > 0.
    V_lp : float, str or pint.Quantity
        Load-point velocity [m/s], unless it is the parameter.
    rtol : float
        Relative accuracy of amplitude and period, from 1e-10 to 1e-4.

    Returns
    -------
    xarray.Dataset
        In the dimension ``point``, in order along the branch: the parameter under its own name,
        the variables of `limit_cycle`, and ``special``: "hopf" (amplitude 0), "fold" (two cycles
        meet), "period_doubling", "torus", "start" or "stop" at an end that is none of these, and
        "" everywhere else.  The attribute ``parameter`` names the parameter.  Under laws of one
        length there is no torus: the product of the multipliers is below
        exp(-(1 + 1/eta) V_lp period/Dc).
        ``error`` bounds the difference from this branch's own cycle at exactly the parameter
        returned; at a fold, from the cycle there.  Where amplitudes change much faster than the
        parameter, as on a canard or near a Hopf point of all but no curvature, it grows in
        proportion, and may exceed `rtol`: the parameter's last digit then matters.

    Raises
    ------
    ParameterError
        An input that cannot be used; a law of one length with b <= a, where there is no
        instability; M = 0, K = inf; a law without second derivatives; steady sliding reached at
        `start` and no Hopf point between.
    NotConverged
        The motion at `start` is neither steady sliding nor a cycle that closes after one return, or
        the Hopf point is all but degenerate (``best`` is None); or the branch could not be followed
        to its end, and ``best`` holds it as far as it was found.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3000)
    >>> branch = rs.continue_cycle(slider, "V_lp", "1 mm/s", "5 mm/s", rtol=1e-6)
    >>> str(branch.special.values[0]), round(float(branch.V_lp[0]), 6)
    ('hopf', 0.003162)
    """
    family, ends = checked_family(slider, parameter, start, stop, V_lp, rtol)
    p_start, p_stop = np.log([*ends.values()])
    with bar("continue_cycle") as progress:
        begin = beginning(family, p_start, p_stop)

        def advance(point):
            check_stopped()  # kernels of one orbit at a time are too short to look
            if progress:
                progress(float(np.clip((point.p - p_start) / (p_stop - p_start), 0.0, 1.0)))

        branch = family.branch(
            begin.U,
            begin.p,
            stop=p_stop,
            start=p_start,
            along=None if begin.hopf is None else np.append(begin.U, 0.0),
            amplitude=lambda point: family.amplitude(point.u, point.p) - END_AMPLITUDE,
            max_points=MAX_POINTS,
            progress=advance,
        )
    result = _dataset(family, branch, begin.hopf, ends)
    V_lp = None if parameter == "V_lp" else family.values["V_lp"]
    settings = {"parameter": parameter, **ends, "V_lp": V_lp, "rtol": rtol}
    record_scenario(result, "continue_cycle", slider, **settings)
    if branch.end in PREMATURE:
        last = np.exp(branch.points[-1].p if branch.points else begin.p)
        reason = sentence(f"branch_ends.{branch.end}", max_points=MAX_POINTS)
        values = {"last": last, "stop": ends["stop"], "end": branch.end, "reason": reason}
        raise NotConverged(sentence("branch_ends.early", parameter=parameter, **values), result)
    return result


def _dataset(family, branch, hopf, ends):
    """The result: measures of a branch's points, with the Hopf points at its ends.

    ends : the parameter's values at "start" and "stop", of which p is the rounded logarithm
    """
    points = branch.points
    if hopf is None and points:
        points = [points[0]._replace(special="start"), *points[1:]]
    special = [point.special for point in points]
    measures = family.measures(points, ends)
    along = measures.pop("parameter")
    hopf_points = [] if hopf is None else [(0, hopf)]
    if branch.end == "hopf":
        hopf_points.append((len(points), hopf_near(family, points[-1].p)))
    for index, p in reversed(hopf_points):
        special.insert(index, "hopf")
        along = np.insert(along, index, np.exp(p))
        for name, value in hopf_measures(family, p).items():
            measures[name] = np.insert(measures[name], index, value[0], axis=0)
    values = family.values | {
        family.parameter: xarray.DataArray(along, dims="point", attrs=attrs(family.parameter))
    }
    batch = Batch(values, reserved=VARIABLES)
    status = np.full(len(along), FINISHED)
    stable = np.abs(measures["multipliers"][:, 0]) < 1.0
    variables = cycle_variables(composed_law(family.law), batch, status, measures, stable)
    variables["special"] = batch.variable(np.array(special, dtype=str), "special")
    result = xarray.Dataset(variables, batch.coordinates([*VARIABLES, "special"]))
    at_hopf = result.special == "hopf"
    there = family.sliders(along[at_hopf])
    result["inertia"][at_hopf] = 0.5 * there.eta * there.critical.omega**2 / there.critical.kappa
    return result


def check_rtol(rtol):
    """Raise ParameterError for an rtol that is no number from 1e-10 to 1e-4."""
    checked_rtol(rtol, "1e-10", "1e-4", "1e-8")


def checked_family(slider, parameter, start, stop, V_lp, rtol):
    """`Family` and {"start": ..., "stop": ...} [SI], from the arguments of `continue_cycle`.

    ParameterError for any that it refuses before it looks for a cycle.
    """
    law = check_slider(slider).friction_law
    parameters = (*PARAMETERS, *law.parameters)
    if not isinstance(parameter, str) or parameter not in parameters:
        raise refusal("branch.parameter", parameter=parameter, names=", ".join(parameters))
    if (parameter == "V_lp") != (V_lp is None):
        name = "V_lp_twice" if parameter == "V_lp" else "V_lp_missing"
        raise refusal(f"branch.{name}", parameter=parameter)
    rtol = to_si("rtol", rtol)
    ends = {"start": start, "stop": stop}
    given = slider.values
    ends = {k: parameter_to_si(parameter, value, given, label=k) for k, value in ends.items()}
    values = {**given, **ends}
    if V_lp is not None:
        values["V_lp"] = to_si("V_lp", V_lp)
    if arrays := [symbol for symbol, value in {**values, "rtol": rtol}.items() if is_array(value)]:
        raise refusal("branch.array", symbol=arrays[0])
    check_rtol(rtol)
    values |= {parameter: ends["start"]}
    for symbol, value in {**values, **ends}.items():
        if symbol in (*PARAMETERS, "start", "stop") and symbol != "b" and not 0 < value < np.inf:
            unit = QUANTITIES[symbol if symbol in QUANTITIES else parameter].unit
            needed = symbol in ("K", "M") or parameter in ("K", "M")
            reason = sentence(f"branch_range.{'needed' if needed else 'followed'}")
            raise refusal("branch.range", symbol=symbol, value=value, unit=unit, reason=reason)
    if ends["start"] == ends["stop"]:
        raise refusal("branch.no_length", start=ends["start"])
    family = Family(law.name, values, parameter, rtol)
    system = family.system(np.log([*ends.values()]))
    if not system.may_cycle.any():
        raise refusal("branch.strengthening", beta=system.beta[0])
    return family, ends
