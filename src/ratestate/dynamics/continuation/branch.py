"""The function `continue_cycle`: a branch of limit cycles along one parameter."""

import numpy as np
import xarray

from ...engine.backend import check_stopped
from ...engine.model import FINISHED, STATUSES, STEADY_SLIDING
from ...errors import NotConverged
from ...friction import linear_stability
from ...friction.composition import composed_law
from ...model.arrays import Batch
from ...model.names import keywords_checked
from ...model.parameters import parameter_to_si
from ...model.quantities import QUANTITIES, attrs
from ...model.slider import check_slider
from ...model.units import is_array, to_si
from ..cycles.attractor import find_attractors, steady_start
from ..cycles.limit_cycle import VARIABLES, cycle_variables
from ..cycles.small_cycles import hopf_curvature, small_cycle
from ..cycles.system import linear_section
from ..progress import bar
from ..recipe import record_scenario
from ..refusals import refusal, sentence
from ..simulation.settings import checked_rtol
from .bifurcations import NO_CONVERGENCE, NO_RETURN
from .family import PARAMETERS, CycleFamily

# Amplitudes of ln V at which a branch leaves its Hopf point, and below which it ends at one.
START_AMPLITUDE, END_AMPLITUDE = 0.03, 0.02
MAX_POINTS = 1000
#: ends of a branch that is not whole
PREMATURE = (NO_RETURN, NO_CONVERGENCE, "max_points")


@keywords_checked
def continue_cycle(slider, parameter, start, stop, *, V_lp=None, rtol=1e-8):
    """Follow a limit cycle, stable or not, while one parameter goes from start to stop.

    The branch begins with the cycle that `limit_cycle` finds at `start`.  If this is steady
    sliding, the branch begins at the Hopf point between start and stop.  Pseudo-arclength
    continuation in the parameter's logarithm (Keller 1977) follows it through folds, where the
    parameter turns back.  The branch ends at `stop`, at a Hopf point, or when it
    comes back to `start`.

    Parameters
    ----------
    slider : SpringSlider
        One slider, not a sweep; M > 0.
    parameter : {"V_lp", "K", "M", "sigma", "a", "b", "Dc"} or a parameter of the law alone
        Parameter that changes along the branch.  The slider's own value of it is not used.
    start, stop : float, str or pint.Quantity
        Its first and last value, > 0.
    V_lp : float, str or pint.Quantity
        Load-point velocity [m/s], unless it is the parameter.
    rtol : float
        Relative accuracy of amplitude and period, from 1e-10 to 1e-4.

    Returns
    -------
    xarray.Dataset
        In the dimension ``point``, in order along the branch: the parameter under its own name, as
        a coordinate, the variables of `limit_cycle`, and ``special``.

        ``special`` is "hopf", "fold" (two cycles meet), "period_doubling", "torus", "start" or
        "stop" at another end, and "" everywhere else.  At a Hopf point amplitude is 0, the largest
        multiplier 1 and ``stable`` False.

    Raises
    ------
    ParameterError
        If an input cannot be used, M = 0 or K = inf, or the law has no second derivatives.  Also if
        the law has one length and b <= a, because sliding is then always stable.  Also if sliding
        at `start` is steady, and there is no Hopf point between start and stop.
    NotConverged
        If the motion at `start` is neither steady sliding nor a cycle with one stress maximum, or
        if the Hopf point is almost degenerate.  Then ``best`` is None.  Also if the branch could
        not be followed to its end.  Then ``best`` holds the part that was found.

    Notes
    -----
    Laws of one length have no torus: the product of the multipliers is below
    exp(-(1 + 1/eta) V_lp period/Dc).

    ``error`` bounds the difference from the exact cycle at the same parameter, or at a fold from
    the exact cycle at the fold.  It may exceed `rtol` if the amplitude changes so much faster than
    the parameter that the parameter's last digit matters.  This happens if a branch is almost
    vertical, for example near some Hopf points.

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
        U, p, hopf = _beginning(family, p_start, p_stop)

        def advance(point):
            check_stopped()  # kernels of one orbit at a time are too short to look
            if progress:
                progress(float(np.clip((point.p - p_start) / (p_stop - p_start), 0.0, 1.0)))

        branch = family.branch(
            U,
            p,
            stop=p_stop,
            start=p_start,
            along=None if hopf is None else np.append(U, 0.0),
            amplitude=lambda point: family.amplitude(point.u, point.p) - END_AMPLITUDE,
            max_points=MAX_POINTS,
            progress=advance,
        )
    result = _dataset(family, branch, hopf, ends)
    V_lp = None if parameter == "V_lp" else family.values["V_lp"]
    settings = {"parameter": parameter, **ends, "V_lp": V_lp, "rtol": rtol}
    record_scenario(result, "continue_cycle", slider, **settings)
    if branch.end in PREMATURE:
        last = np.exp(branch.points[-1].p if branch.points else p)
        reason = sentence(f"branch_ends.{branch.end}", max_points=MAX_POINTS)
        values = {"last": last, "stop": ends["stop"], "end": branch.end, "reason": reason}
        raise NotConverged(sentence("branch_ends.early", parameter=parameter, **values), result)
    return result


def _dataset(family, branch, hopf, ends):
    """Return the measures of a branch's points, with the Hopf points at its ends, as a Dataset.

    ends : the parameter's values at "start" and "stop", of which p is the rounded logarithm
    """
    points = branch.points
    if hopf is None and points:
        points = [points[0]._replace(special="start"), *points[1:]]
    special = [point.special for point in points]
    measures = family.measures(points, ends)
    p_values = measures.pop("parameter")
    hopf_points = [] if hopf is None else [(0, hopf)]
    if branch.end == "hopf":
        hopf_points.append((len(points), _hopf_near(family, points[-1].p)))
    for index, p in reversed(hopf_points):
        special.insert(index, "hopf")
        p_values = np.insert(p_values, index, np.exp(p))
        vanishing = _hopf_measures(family, p)
        for name, value in measures.items():
            measures[name] = np.insert(value, index, vanishing.get(name, 0.0), axis=0)
    values = family.values | {
        family.parameter: xarray.DataArray(p_values, dims="point", attrs=attrs(family.parameter))
    }
    batch = Batch(values, reserved=VARIABLES)
    status = np.full(len(p_values), FINISHED)
    stable = np.abs(measures["multipliers"][:, 0]) < 1.0
    variables = cycle_variables(composed_law(family.law), batch, status, measures, stable)
    variables["special"] = batch.variable(np.array(special, dtype=str), "special")
    result = xarray.Dataset(variables, batch.coordinates([*VARIABLES, "special"]))
    at_hopf = result.special == "hopf"
    system = family.sliders(p_values[at_hopf])
    result["inertia"][at_hopf] = 0.5 * system.eta * system.critical.omega**2 / system.critical.kappa
    return result


def check_rtol(rtol):
    """Check that rtol is a number from 1e-10 to 1e-4."""
    checked_rtol(rtol, "1e-10", "1e-4", "1e-8")


def checked_family(slider, parameter, start, stop, V_lp, rtol):
    """Return the `CycleFamily` and {"start": ..., "stop": ...} [SI], from checked arguments."""
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
            is_parameter = symbol in ("K", "M") or parameter in ("K", "M")
            reason = sentence(f"branch_range.{'needed' if is_parameter else 'followed'}")
            raise refusal("branch.range", symbol=symbol, value=value, unit=unit, reason=reason)
    if ends["start"] == ends["stop"]:
        raise refusal("branch.no_length", start=ends["start"])
    family = CycleFamily(law.name, values, parameter, rtol)
    system = family.system(np.log([*ends.values()]))
    if not system.may_cycle.any():
        raise refusal("branch.strengthening", beta=system.beta[0])
    return family, ends


# Where a branch begins and ends


def _beginning(family, p_start, p_stop):
    """Return U (k,) and p of the first cycle, and p of the Hopf point before it, or None.

    It is the cycle reached from steady sliding at V_lp/10 for p_start; or, if this ends in steady
    sliding, a small cycle beside a Hopf point between p_start and p_stop.
    """
    system = family.system(p_start)
    if system.may_cycle[0]:
        attractor = find_attractors(system, steady_start(system), family.rtol, None)
        status, returns = int(attractor.status[0]), int(attractor.n_returns[0])
        if status == FINISHED and returns > 1:
            raise NotConverged(sentence("branch_begins.doubled", returns=returns), None)
        if status == FINISHED:
            return family.chart(attractor.u, [p_start])[0], p_start, None
        if status != STEADY_SLIDING:
            name, text = STATUSES[status]
            raise NotConverged(sentence("branch_begins.no_cycle", name=name, text=text), None)
    if (family.margin(p_start) > 0.0) == (family.margin(p_stop) > 0.0):
        start, stop = np.exp([p_start, p_stop])
        values = {"parameter": family.parameter, "start": start, "stop": stop}
        raise refusal("branch_begins.no_hopf_between", **values)
    return _beginning_at_hopf(family, _sign_change(family.margin, p_start, p_stop))


def _hopf_near(family, p):
    """Return p of a Hopf point near this one; raise NotConverged if none is within 82.

    Under a law of one length there is at most one: the margin of eq. 6 is monotone in every
    parameter.
    """
    for reach in 0.01 * 2.0 ** np.arange(14):
        low, high = p - reach, p + reach
        if (family.margin(low) > 0.0) != (family.margin(high) > 0.0):
            return _sign_change(family.margin, low, high)
    values = {"parameter": family.parameter, "value": np.exp(p)}
    raise NotConverged(sentence("branch_begins.no_hopf_near", **values), None)


def _beginning_at_hopf(family, hopf):
    """Return U and p of a small cycle beside the Hopf point, and p of this.

    Harmonic balance gives the cycle if it knows the law, else the linear equations give one from
    which Newton's method goes on.
    """
    at = family.system(hopf)
    margin = START_AMPLITUDE**2 * float(hopf_curvature(at)[0])
    step = 1e-3
    while (family.margin(hopf - step) > margin) == (family.margin(hopf + step) > margin):
        step *= 2.0
    p = _sign_change(lambda q: family.margin(q) - margin, hopf - step, hopf + step)
    system = family.system(p)
    if system.friction_law.one_length:
        cycle = small_cycle(system.law, system.kappa, system.beta, system.eta)
        u = np.stack([cycle.psi, cycle.G], axis=1)
    else:
        u = START_AMPLITUDE * linear_section(system)
    if not np.isfinite(u).all():
        values = {"parameter": family.parameter, "value": np.exp(hopf), "eta": at.eta[0]}
        raise NotConverged(sentence("branch_begins.degenerate_hopf", **values), None)
    return family.chart(u, [p])[0], p, hopf


def _hopf_measures(family, p):
    """Return those measures of the vanishing cycle at a Hopf point that are not 0."""
    at = family.system(p)
    omega = at.critical.omega
    period = 2.0 * np.pi / omega[0]
    modes = linear_stability.modes(at.friction_law, at.coefficients, at.kappa, at.eta)
    # The two modes that oscillate become the trivial multiplier and another 1.
    others = linear_stability.other_modes(modes, omega)[0]
    multipliers = np.append(1.0, np.exp(others * period))
    return {"period": period, "multipliers": multipliers, "fundamental": 1.0, "returns": 1.0}


def _sign_change(function, low, high):
    """Return where a function changes its sign between low and high, by bisection to rounding."""
    rising = function(high) > 0.0
    while low != (middle := 0.5 * (low + high)) != high:
        low, high = (low, middle) if (function(middle) > 0.0) == rising else (middle, high)
    return middle
