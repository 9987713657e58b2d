"""Where a branch of limit cycles begins, and the Hopf points where its amplitude is zero."""

from typing import NamedTuple

import numpy as np

from ...engine.model import FINISHED, STATUSES, STEADY_SLIDING
from ...errors import NotConverged
from ...friction.linear_stability import other_modes
from ..cycles.attractor import find_attractors, steady_start
from ..cycles.small_cycles import hopf_curvature, small_cycle
from ..cycles.system import linear_section
from ..refusals import refusal, sentence

# Amplitude of ln V at which a branch leaves its Hopf point.
START_AMPLITUDE = 0.03


class Beginning(NamedTuple):
    """The first cycle of a branch, and the Hopf point before it, if there is one."""

    U: np.ndarray  # (k,) of the cycle, in the chart of `Family`
    p: float  # of the cycle: logarithm of the parameter
    hopf: float | None  # p of the Hopf point


def beginning(family, p_start, p_stop):
    """The `Beginning` of a branch from p_start to p_stop.

    That is the cycle reached from steady sliding at V_lp/10 for p_start; or, where this ends in
    steady sliding, a small cycle beside a Hopf point between the two.  ParameterError where no
    Hopf point lies between; NotConverged, with `best` None, where what is reached is no cycle, or
    closes after several returns, or the Hopf point is all but degenerate.
    """
    system = family.system(p_start)
    if system.may_cycle[0]:
        attractor = find_attractors(system, steady_start(system), family.rtol, None)
        status, returns = int(attractor.status[0]), int(attractor.n_returns[0])
        if status == FINISHED and returns > 1:
            raise NotConverged(sentence("branch_begins.doubled", returns=returns), None)
        if status == FINISHED:
            return Beginning(family.chart(attractor.u, [p_start])[0], p_start, None)
        if status != STEADY_SLIDING:
            name, text = STATUSES[status]
            raise NotConverged(sentence("branch_begins.no_cycle", name=name, text=text), None)
    if (family.margin(p_start) > 0.0) == (family.margin(p_stop) > 0.0):
        start, stop = np.exp([p_start, p_stop])
        values = {"parameter": family.parameter, "start": start, "stop": stop}
        raise refusal("branch_begins.no_hopf_between", **values)
    return _beginning_at_hopf(family, _sign_change(family.margin, p_start, p_stop))


def hopf_near(family, p):
    """p of a Hopf point near this one, a float; NotConverged (`best` None) if none is within 82.

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
    """`Beginning` with a small cycle beside the Hopf point, on the side where cycles exist."""
    at = family.system(hopf)
    margin = START_AMPLITUDE**2 * float(hopf_curvature(at)[0])
    step = 1e-3
    while (family.margin(hopf - step) > margin) == (family.margin(hopf + step) > margin):
        step *= 2.0
    p = _sign_change(lambda q: family.margin(q) - margin, hopf - step, hopf + step)
    u = _small_cycle(family.system(p))
    if not np.isfinite(u).all():
        values = {"parameter": family.parameter, "value": np.exp(hopf), "eta": at.eta[0]}
        raise NotConverged(sentence("branch_begins.degenerate_hopf", **values), None)
    return Beginning(family.chart(u, [p])[0], p, hopf)


def _small_cycle(system):
    """(1, k) section of a cycle of about `START_AMPLITUDE`; NaN beside a degenerate Hopf point.

    By harmonic balance where that knows the law, else by the linear equations: from there Newton's
    method goes on.
    """
    if system.friction_law.one_length:
        cycle = small_cycle(system.law, system.kappa, system.beta, system.eta)
        return np.stack([cycle.psi, cycle.G], axis=1)
    return START_AMPLITUDE * linear_section(system)


def hopf_measures(family, p):
    """Measures of the vanishing cycle at a Hopf point, as by `measure`: name -> (1,) or (1, k).

    All but "u"; amplitude and speeds are 0.  That p is a Hopf point is not checked.
    """
    system = family.system(p)
    omega, zero = system.critical.omega, np.zeros(1)
    period = 2.0 * np.pi / omega
    # The two modes that oscillate become the trivial multiplier and another 1.
    multipliers = np.append(1.0, np.exp(other_modes(system.modes, omega)[0] * period))
    vanishing = (
        "amplitude v_max v_min v_max_error v_min_error g_max f_min xf_min slow_fraction".split()
    )
    values = dict.fromkeys(vanishing, zero)
    return values | {
        "period": period,
        "fundamental": zero + 1.0,
        "multipliers": multipliers[None],
        "multipliers_error": np.zeros((1, len(multipliers))),
        "residual": zero,
        "returns": zero + 1.0,
        "error": zero,
    }


def _sign_change(function, low, high):
    """Where the sign of a function changes between low and high, by bisection to rounding."""
    rising = function(high) > 0.0
    while low != (middle := 0.5 * (low + high)) != high:
        low, high = (low, middle) if (function(middle) > 0.0) == rising else (middle, high)
    return middle
