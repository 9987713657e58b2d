"""Measures of a limit cycle and their errors, from one period of it and its derivatives.

On a canard amplitude and period change, relatively, ten million times as much as the stiffness
does.  There the last digit of a parameter, or the rounding of a return, limits how accurate an
amplitude is.
"""

import dataclasses
from typing import Any, NamedTuple

import numpy as np

from ...engine.model import FINISHED
from ...friction.closed_forms import steady_modes
from .attractor import FINER
from .shooting import (
    Returns,
    change_along,
    effective_tolerance,
    iterated_map,
    multipliers,
    newton_step,
)
from .system import System, distance, small_amplitude, tightest

# Safety factor of the error estimate; relative errors, due to rounding, of a return and a number.
SAFETY, ROUNDING_OF_RETURN, EPS = 3.0, 60.0 * 2.0**-52, 2.0**-52
# Allowed error of a multiplier, which is absolute, divided by the relative accuracy requested.
OF_MULTIPLIER = 3.0
# Measurements, each with finer returns than the last, of a cycle that is not accurate enough yet.
MAX_REFINEMENTS = 8
# A share of the fundamental may exceed 1 by this much, by the errors of integrals.
UNRESOLVED = 1e-2
# Relative change of a parameter in difference quotients: the smallest, and divided by the tolerance
# of a return.  A canard may be all over within 1e-7, and multiplies the errors of a return by as
# much.
LEAST_CHANGE, CHANGE = 1e-9, 1e3
# Errors as equivalent relative changes of K: of a step, divided by its tolerance, and of rounding,
# in the parameters and in a return.
STEP_ERROR, ROUNDING_ERROR = 0.3, 5.0 * 2.0**-52
# Ratio of the tolerances of two orbits whose difference shows the errors that steps accumulate.
COARSER = 2.0


def refine(system, cycles, rtol):
    """Return `measure`, repeated with finer returns while errors are too large.

    They are too large if `error` exceeds rtol or `multipliers_error` three times rtol.  After
    `MAX_REFINEMENTS` repetitions, or at the limit of rounding, the error may stay larger.

    cycles : `CycleEstimates`, refined in place
    """
    measures = measure(system, cycles)
    for _ in range(MAX_REFINEMENTS):
        floor = tightest(system, cycles.u)
        of_multipliers = measures["multipliers_error"].max(axis=1) / OF_MULTIPLIER
        errors = np.fmax(measures["error"], of_multipliers)
        refined = (errors > rtol) & (cycles.tol > floor) & (cycles.error == 0.0)
        if not refined.any():
            break
        finer = cycles.tol[refined] * np.clip(rtol / errors[refined], 0.01, 0.3)
        cycles.tol[refined] = np.maximum(finer, floor[refined])
        # (if there is no cycle, Newton's step may lead to where V falls)
        known = refined & (measures["u"][:, -1] > 0.0)
        cycles.u[known] = measures["u"][known]
        cycles.period[known] = measures["period"][known]
        for name, value in measure(system.at(refined), cycles.at(refined)).items():
            measures[name][refined] = value
    small = np.flatnonzero(cycles.error > 0.0)
    if len(small):
        _improve_multipliers(system.at(small), measures, small)
    return measures


def _improve_multipliers(system, measures, small):
    """Replace the larger multiplier of the smallest cycles, which a return would round to 1.

    With dr/dT = g r + l r^3, g the growth rate of steady sliding, a distance from r^2 = -g/l grows
    at the rate -2 g.  The relative error of the multiplier's distance from 1 is some r^2.

    small : numbers of the cycles of this system
    """
    found, of_found = measures["multipliers"][small], measures["multipliers_error"][small]
    modes = steady_modes(system.eta, system.kappa, system.beta, system.margin)
    first = np.exp(-2.0 * modes[:, 0].real * measures["period"][small])
    error = SAFETY * np.abs(first - found[:, 0])
    improved = error < of_found[:, 0]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        second = np.prod(found, axis=1) / first
    measures["multipliers"][small[improved]] = np.stack([first, second], axis=1)[improved]
    measures["multipliers_error"][small[improved], 0] = error[improved]


def measure(system, cycles):
    """Return measures of the `CycleEstimates`, name -> (n,) or (n, k); NaN if an orbit got lost.

    The units are a (stress), Dc/V_lp (time) and ln V_lp (speeds).  One more period is followed,
    with finer steps than those that led to the estimate, and period, amplitude and speeds are
    corrected by the remaining step of Newton's method, to first order.  Estimates with an error > 0
    are not corrected: they are more accurate, or hold for another condition than constant
    parameters.  `engine.waveform` sums the time below V_lp/10, for ``slow_fraction``.
    """
    u, fixed = cycles.u, cycles.error > 0.0
    tol = np.maximum(FINER * cycles.tol, tightest(system, u))
    orbits = orbits_of_one_period(system, cycles, tol, waveform=True)
    returns, numbers = orbits.returns, orbits.returns.numbers
    step = np.where(fixed[:, None], 0.0, newton_step(returns, u))
    corrected = ("x_high", "x_low", "period", "v_max", "v_min")
    gradients = np.stack([returns.gradients[name] for name in corrected], axis=1)
    values = {name: numbers[name] for name in ("g_max", "f_min", "xf_min")}
    values |= {"multipliers": multipliers(returns), "u": u + step}
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        high, low, d_period, v_max, v_min = change_along(gradients, step).T
        d_amplitude = high - low
        values["amplitude"] = numbers["x_high"] - numbers["x_low"] + d_amplitude
        values["period"] = numbers["period"] + d_period
        values |= {"v_max": numbers["v_max"] + v_max, "v_min": numbers["v_min"] + v_min}
        values["slow_fraction"] = numbers["slow"] / numbers["period"]
        values["fundamental"] = _fundamental_share(numbers)
        values["residual"] = distance(system, returns.image - u) / distance(system, u)
        values["returns"] = cycles.n_returns.astype(float)
        # If the correction removes amplitude or period, there was no cycle.
        scales = np.array([values["amplitude"], values["period"]])
        scales = np.where((scales > 0.0).all(axis=0), scales, 0.0)
        relative = np.abs([d_amplitude, d_period]) / scales
        changes = np.stack([*relative, *np.abs([v_max, v_min])], axis=1)
        errors, values["multipliers_error"] = _errors(orbits, values["multipliers"], changes)
        # By Parseval's theorem the share is at most 1.  If it is larger, steps were too long for
        # the waveform, whose speeds differ by seventy decades and more.
        excess = values["fundamental"] - 1.0
        errors = np.maximum(errors, np.where(excess > UNRESOLVED, excess, 0.0))
    values |= dict(zip(("error", "v_max_error", "v_min_error"), errors, strict=True))
    closed = returns.status == FINISHED
    return {
        name: np.where(closed[:, None] if value.ndim == 2 else closed, value, np.nan)
        for name, value in values.items()
    }


def _fundamental_share(numbers):
    """Return the share of the fundamental in the variance of the stress."""
    mean = numbers["mean"] / numbers["period"]
    variance = numbers["square"] / numbers["period"] - mean**2
    wave = (numbers["cosine"] ** 2 + numbers["sine"] ** 2) / numbers["period"] ** 2
    return 2.0 * wave / variance


def _errors(orbits, floquet, changes):
    """Return relative errors (3, n) and the absolute errors (n, k) of the multipliers `floquet`.

    The first three are the larger one of amplitude and period, V_max, and V_min.  Each is the sum
    of four parts: what Newton's step leaves, the errors that steps accumulate, the smallest error
    of a return, and the error of the parameters.  Errors go with the tolerance, so Newton's step
    leaves its own change times the ratio of the tolerances of this orbit and the estimate.

    changes : (n, 4) relative changes of amplitude, period, V_max and V_min by Newton's step
    """
    system, cycles = orbits.system, orbits.cycles
    fixed = cycles.error > 0.0
    tol = effective_tolerance(orbits.returns, orbits.tol)
    finer = tol / np.maximum(tol, cycles.tol)
    attraction = np.where(fixed, 1.0, np.minimum(1.0, np.abs(1.0 - floquet[:, 0])))
    scale = np.minimum(1.0, np.abs(small_amplitude(system, cycles.u)))
    # If the stress is large and the cycle hardly attracts, rounding can make a false cycle.
    false = ROUNDING_OF_RETURN * distance(system, cycles.u) > 1e-4 * attraction
    absolute = _rounding_of_state(system, orbits.returns.numbers["steps"])
    rounding = ROUNDING_OF_RETURN + np.where(fixed, 0.0, absolute / scale)
    least = tol / scale + np.where(false & ~fixed, np.inf, rounding / attraction)
    accumulated, of_multipliers = _accumulated_errors(orbits, floquet)
    accumulated = np.where(fixed[:, None], 0.0, accumulated)
    by_stiffness = backward_error(system, tol)[:, None] * _stiffness_sensitivity(orbits)
    by_stiffness = np.where(fixed[:, None], 0.0, by_stiffness)

    def column(values):
        return np.array([values[:, :2].max(axis=1), values[:, 2], values[:, 3]])

    parts = finer * column(changes) + column(accumulated) + least + column(by_stiffness)
    errors = cycles.error + SAFETY * parts
    relative_error = errors[0] + SAFETY * changes[:, :2].max(axis=1)
    return errors, SAFETY * of_multipliers + np.abs(floquet) * relative_error[:, None]


def _rounding_of_state(system, steps):
    """Return the error of ln V (n,) to which rounding in the steps (n,) of a return adds up.

    Each step rounds V/V_lp relative to 1, and x, v and psi relative to their steady values, such as
    mu/a under regularized friction, however small the cycle is.  Independent errors add up like
    the root of their number.  An error of stress changes the amplitude of ln V by omega/kappa.
    """
    x, v, psi = system.rest[:, :1], system.rest[:, 1:2], system.rest[:, 2:]
    per_stress = (system.omega / system.kappa)[:, None]
    sizes = np.concatenate([v, per_stress * x, per_stress * system.weights[:, :-1] * psi], axis=1)
    return EPS * np.sqrt(steps) * np.maximum(1.0, np.abs(sizes).max(axis=1))


def _accumulated_errors(orbits, floquet):
    """Return the errors of amplitude, period, V_max and V_min (n, 4) that steps add up to.

    Also returns the errors of the multipliers `floquet` (n, k), which the tolerance does not bound.

    The estimate compares with a coarser orbit: steps may accumulate many times the error of one, as
    V falls over decades, or in the stress at b/a near 1, which changes little while ln V and psi
    change much.  Errors go with the tolerance.  Errors of extreme speeds, which arise in a few
    steps, do so less evenly, and may cancel in one orbit but not in another: they are scaled by the
    root of the ratio of tolerances, and their parts are added without their signs.
    """
    coarse, finer = coarser_orbits(orbits, orbits.cycles.tol)
    u, finer = orbits.cycles.u, finer[:, None]
    step = newton_step(coarse.returns, u) - newton_step(orbits.returns, u)
    at_u, gradients = difference(coarse, orbits).measures, orbits.by_u
    systematic = np.abs(at_u + change_along(gradients, step))[:, :2]
    scattered = (np.abs(at_u) + change_along(np.abs(gradients), np.abs(step)))[:, 2:]
    of_multipliers = np.abs(multipliers(coarse.returns) - floquet)
    return np.concatenate([finer * systematic, np.sqrt(finer) * scattered], axis=1), of_multipliers


def _stiffness_sensitivity(orbits):
    """Return |d ln(measure)/d ln K| (n, 4) of amplitude, period, V_max and V_min.

    It is not finite if the cycle is at a fold, or its orbit did not come back.
    """
    u, by_K = orbits.cycles.u, stiffness_derivatives(orbits)
    du = newton_step(orbits.returns._replace(image=u + by_K.image), u)
    with np.errstate(invalid="ignore", over="ignore"):
        return np.abs(change_along(orbits.by_u, du) + by_K.measures)


# Orbits of one period and how they differ, also for points of a branch


class Orbits(NamedTuple):
    """Orbits of n sliders from points near their cycles, for one period, with extremes recorded.

    If an orbit did not come back, only `returns` shows it.
    """

    system: System
    cycles: Any  # `CycleEstimates`, at whose u the orbits begin
    tol: np.ndarray  # (n,)
    returns: Returns
    measures: np.ndarray  # (n, 4) logarithms of amplitude (of x), period, V_max and V_min
    by_u: np.ndarray  # (n, 4, k) their derivatives by the first u


class Difference(NamedTuple):
    """By how much orbits from the same u differ, or this divided by the size of the cause."""

    image: np.ndarray  # (n, k) of the next u; NaN if one of them did not come back
    measures: np.ndarray  # (n, 4) of `Orbits.measures`; means nothing if `image` is NaN


def orbits_of_one_period(system, cycles, tol, *, waveform=False):
    """Return the `Orbits` of the `CycleEstimates` at the tolerance tol, with waveform or not."""
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
    """Return the `Difference` of two sets of orbits."""
    images = orbits.returns.image - reference.returns.image
    return Difference(images, orbits.measures - reference.measures)


def coarser_orbits(orbits, tol):
    """Return the same orbits at the larger tolerance tol (n,) or more, and a factor (n,) <= 1/2.

    The accumulated errors of the first orbits are this factor times the difference between both.
    """
    fine = effective_tolerance(orbits.returns, orbits.tol)
    coarse = np.maximum(tol, COARSER * fine)
    return orbits_of_one_period(orbits.system, orbits.cycles, coarse), fine / coarse


def parameter_derivatives(orbits, changed):
    """Return the `Difference` per change of a parameter's logarithm at constant u.

    changed : factor (n,) -> `System` of the sliders with the parameter multiplied by it
    """
    h = np.maximum(LEAST_CHANGE, CHANGE * orbits.tol)
    others = orbits_of_one_period(changed(1.0 + h), orbits.cycles, orbits.tol)
    return Difference(*(values / h[:, None] for values in difference(others, orbits)))


def stiffness_derivatives(orbits):
    """Return `parameter_derivatives` with respect to ln K."""
    system = orbits.system
    return parameter_derivatives(
        orbits, lambda factor: dataclasses.replace(system, kappa=system.kappa * factor)
    )


def backward_error(system, tol):
    """Return the relative change of K that is equivalent to the errors of a return.

    The rounding of b/a counts the more, the smaller b - a is than b; inf at b = a.
    """
    return STEP_ERROR * tol + ROUNDING_ERROR * system.cancellation
