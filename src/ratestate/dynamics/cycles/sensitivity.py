"""How a limit cycle, its amplitude and its period change with a parameter, and their errors.

On a canard they change, relatively, ten million times as much as the stiffness does.  There the
last digit of a parameter, or the rounding of a return, limits how well an amplitude is known.
"""

import dataclasses
from typing import Any, NamedTuple

import numpy as np

from .iterates import iterated_map
from .shooting import Returns, change_along, effective_tolerance, newton_step
from .system import System

# Relative change of a parameter in difference quotients: the smallest, and divided by the tolerance
# of a return.
# A canard may be all over within 1e-7, and multiplies the errors of a return by as much.
LEAST_CHANGE, CHANGE = 1e-9, 1e3
# Errors as equivalent relative changes of K: those of a step, over its tolerance, and rounding,
# of the parameters and in a return.
STEP_ERROR, ROUNDING_ERROR = 0.3, 5.0 * 2.0**-52
# Ratio of the tolerances of two orbits whose difference shows the errors that their steps
# accumulate.
COARSER = 2.0


class Orbits(NamedTuple):
    """Orbits of n sliders from points near their cycles, for one period, with extremes recorded.

    Where an orbit did not come back, only `returns` says so.
    """

    system: System
    cycles: Any  # `attractor.CycleEstimates`, whose u the orbits begin at
    tol: np.ndarray  # (n,)
    returns: Returns
    measures: np.ndarray  # (n, 4) logarithms of amplitude (of x), period, V_max and V_min
    by_u: np.ndarray  # (n, 4, k) their derivatives with respect to u at the beginning


class Difference(NamedTuple):
    """By how much orbits that begin at the same u differ, or that over the cause's size."""

    image: np.ndarray  # (n, k) of the next u; NaN where one of them did not come back
    measures: np.ndarray  # (n, 4) of `Orbits.measures`; means nothing where `image` is NaN


def orbits_of_one_period(system, cycles, tol, *, waveform=False):
    """`Orbits` of one period from the `attractor.CycleEstimates` cycles, at the tolerance tol.

    waveform : whether it is recorded too
    """
    period = cycles.period if waveform else None
    returns = iterated_map(system, cycles.u, tol, cycles.n_returns, observe=True, period=period)
    numbers, gradients = returns.numbers, returns.gradients
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        amplitude, period = numbers["x_high"] - numbers["x_low"], numbers["period"]
        by_u = [
            (gradients["x_high"] - gradients["x_low"]) / amplitude[:, None],
            gradients["period"] / period[:, None],
            gradients["v_max"],
            gradients["v_min"],
        ]
        values = [np.log(amplitude), np.log(period), numbers["v_max"], numbers["v_min"]]
    return Orbits(system, cycles, tol, returns, np.stack(values, axis=1), np.stack(by_u, axis=1))


def difference(orbits, reference):
    """`Difference` of orbits from those of reference."""
    images = orbits.returns.image - reference.returns.image
    return Difference(images, orbits.measures - reference.measures)


def coarser_orbits(orbits, tol):
    """The same orbits by larger steps, of the tolerance tol (n,) or more; and a factor (n,) <= 1/2.

    By this factor the errors that the first ones accumulate are smaller than how much the two
    differ.
    """
    fine = effective_tolerance(orbits.returns, orbits.tol)
    coarse = np.maximum(tol, COARSER * fine)
    return orbits_of_one_period(orbits.system, orbits.cycles, coarse), fine / coarse


def parameter_derivatives(orbits, changed):
    """`Difference` over the change of a parameter's logarithm at constant u, which takes one orbit.

    changed : factor (n,) -> `System` of the sliders with the parameter larger by it
    """
    h = np.maximum(LEAST_CHANGE, CHANGE * orbits.tol)
    others = orbits_of_one_period(changed(1.0 + h), orbits.cycles, orbits.tol)
    return Difference(*(values / h[:, None] for values in difference(others, orbits)))


def stiffness_derivatives(orbits):
    """`parameter_derivatives` with respect to ln K."""
    system = orbits.system
    return parameter_derivatives(
        orbits, lambda by: dataclasses.replace(system, kappa=system.kappa * by)
    )


def backward_error(system, tol):
    """(n,) relative change of K that is equivalent to the errors of a return at this tolerance.

    The rounding of b/a counts the more, the smaller b - a is than b; inf at b = a.
    """
    return STEP_ERROR * tol + ROUNDING_ERROR * system.cancellation


def stiffness_sensitivity(orbits):
    """(n, 4) sizes of the relative changes of amplitude, period, V_max and V_min over that of K.

    Not finite where the cycle is at a fold, or its orbit did not come back.
    """
    u, by_K = orbits.cycles.u, stiffness_derivatives(orbits)
    du = newton_step(orbits.returns._replace(image=u + by_K.image), u)
    with np.errstate(invalid="ignore", over="ignore"):
        return np.abs(change_along(orbits.by_u, du) + by_K.measures)
