"""Measures of a limit cycle and their errors, from one period of it and its derivatives."""

import numpy as np

from ...engine.model import FINISHED
from ...friction.stability import steady_modes
from .search_step import FINER
from .sensitivity import (
    backward_error,
    coarser_orbits,
    difference,
    orbits_of_one_period,
    stiffness_sensitivity,
)
from .shooting import change_along, effective_tolerance, multipliers, newton_step
from .system import distance, frequency, small_amplitude, tightest

# Safety factor of the error estimate; relative errors, due to rounding, of a return and a number.
SAFETY, ROUNDING_OF_RETURN, EPS = 3.0, 60.0 * 2.0**-52, 2.0**-52
# The error of a multiplier, which is absolute, over the relative one that is asked for.
OF_MULTIPLIER = 3.0
# Measurements, each with finer returns than the last, of a cycle that is not accurate enough yet.
MAX_REFINEMENTS = 8
# A share of the fundamental may exceed 1 by this much, by the errors of integrals.
UNRESOLVED = 1e-2


def refine(system, cycles, rtol):
    """`measure`, repeated with finer returns where errors are too large.

    They are too large if `error` exceeds rtol or `multipliers_error` three times rtol.  At most
    `MAX_REFINEMENTS` times and down to rounding: the error may stay larger.

    cycles : `CycleEstimates`, refined in place
    """
    measures = measure(system, cycles)
    for _ in range(MAX_REFINEMENTS):
        floor = tightest(system, cycles.u)
        of_multipliers = measures["multipliers_error"].max(axis=1) / OF_MULTIPLIER
        errors = np.fmax(measures["error"], of_multipliers)
        worse = (errors > rtol) & (cycles.tol > floor) & (cycles.error == 0.0)
        if not worse.any():
            break
        finer = cycles.tol[worse] * np.clip(rtol / errors[worse], 0.01, 0.3)
        cycles.tol[worse] = np.maximum(finer, floor[worse])
        # (where there is no cycle Newton's step may lead to where V falls)
        known = worse & (measures["u"][:, -1] > 0.0)
        cycles.u[known] = measures["u"][known]
        cycles.period[known] = measures["period"][known]
        for name, value in measure(system.at(worse), cycles.at(worse)).items():
            measures[name][worse] = value
    small = np.flatnonzero(cycles.error > 0.0)
    if not len(small):
        return measures
    found, of_found = measures["multipliers"][small], measures["multipliers_error"][small]
    first = _small_cycle_multiplier(system.at(small), measures["period"][small])
    off = SAFETY * np.abs(first - found[:, 0])
    better = off < of_found[:, 0]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        second = np.prod(found, axis=1) / first
    measures["multipliers"][small[better]] = np.stack([first, second], axis=1)[better]
    measures["multipliers_error"][small[better], 0] = off[better]
    return measures


def _small_cycle_multiplier(system, period):
    """(n,) larger multiplier of the smallest cycles, which a return would round to 1.

    With dr/dT = g r + l r^3, g the growth rate of steady sliding, a distance from r^2 = -g/l grows
    at the rate -2 g.  The relative error of the multiplier's distance from 1 is some r^2.
    """
    modes = steady_modes(system.eta, system.kappa, system.beta, system.margin)
    return np.exp(-2.0 * modes[:, 0].real * period)


def measure(system, cycles):
    """Measures of the `CycleEstimates`, name -> (n,) or (n, 2); NaN where an orbit did not return.

    In units of a (stress), Dc/V_lp (time) and ln V_lp (speeds).  One more period is followed, with
    finer steps than those that led to the estimate.  The step of Newton's method that is left is
    taken to first order, for period, amplitude and speeds.  Estimates that come with an error are
    known better, or under another condition than constant parameters, and are not corrected.
    The time below V_lp/10, for ``slow_fraction``, is summed in `engine.waveform`.
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
        high, low, longer, v_max, v_min = change_along(gradients, step).T
        larger = high - low
        values["amplitude"] = numbers["x_high"] - numbers["x_low"] + larger
        values["period"] = numbers["period"] + longer
        values |= {"v_max": numbers["v_max"] + v_max, "v_min": numbers["v_min"] + v_min}
        values["slow_fraction"] = numbers["slow"] / numbers["period"]
        values["fundamental"] = _fundamental_share(numbers)
        values["residual"] = distance(system, returns.image - u) / distance(system, u)
        values["returns"] = cycles.n_returns.astype(float)
        # A cycle whose amplitude or period the correction removes was none.
        whole = np.array([values["amplitude"], values["period"]])
        whole = np.where((whole > 0.0).all(axis=0), whole, 0.0)
        changes = np.stack([*np.abs([larger, longer]) / whole, *np.abs([v_max, v_min])], axis=1)
        errors, values["multipliers_error"] = _errors(orbits, values["multipliers"], changes)
        # By Parseval's theorem the share is at most 1.  Where it is not, steps were too long for
        # the waveform, whose speeds differ by seventy decades and more, and nothing is known of it.
        excess = values["fundamental"] - 1.0
        errors = np.maximum(errors, np.where(excess > UNRESOLVED, excess, 0.0))
    values |= dict(zip(("error", "v_max_error", "v_min_error"), errors, strict=True))
    closed = returns.status == FINISHED
    return {
        name: np.where(closed[:, None] if value.ndim == 2 else closed, value, np.nan)
        for name, value in values.items()
    }


def _fundamental_share(numbers):
    """(n,) share of the fundamental in the variance of the stress."""
    mean = numbers["mean"] / numbers["period"]
    variance = numbers["square"] / numbers["period"] - mean**2
    wave = (numbers["cosine"] ** 2 + numbers["sine"] ** 2) / numbers["period"] ** 2
    return 2.0 * wave / variance


def _errors(orbits, floquet, changes):
    """(3, n) relative errors: the larger one of amplitude and period, of V_max, and of V_min.

    Also the errors (n, k) of the multipliers, which are those of the orbit that was followed.

    Each relative error is the sum of four parts.  Errors go with the tolerance, so what Newton's
    step leaves is smaller than its change by the ratio of this orbit's tolerance to the estimate's.
    The others are the errors that steps accumulate, the smallest error of a return, and that of the
    parameters.

    changes : (n, 4) relative changes of amplitude, period, V_max and V_min by Newton's step
    """
    system, cycles = orbits.system, orbits.cycles
    fixed = cycles.error > 0.0
    tol = effective_tolerance(orbits.returns, orbits.tol)
    finer = tol / np.maximum(tol, cycles.tol)
    attraction = np.where(fixed, 1.0, np.minimum(1.0, np.abs(1.0 - floquet[:, 0])))
    scale = np.minimum(1.0, np.abs(small_amplitude(system, cycles.u)))
    # Where the stress is large and the cycle hardly attracts, rounding can feign a cycle.
    feigned = ROUNDING_OF_RETURN * distance(system, cycles.u) > 1e-4 * attraction
    absolute = _rounding_of_state(system, orbits.returns.numbers["steps"])
    rounding = ROUNDING_OF_RETURN + np.where(fixed, 0.0, absolute / scale)
    least = tol / scale + np.where(feigned & ~fixed, np.inf, rounding / attraction)
    accumulated, of_multipliers = _accumulated_errors(orbits, floquet)
    accumulated = np.where(fixed[:, None], 0.0, accumulated)
    by_stiffness = backward_error(system, tol)[:, None] * stiffness_sensitivity(orbits)
    by_stiffness = np.where(fixed[:, None], 0.0, by_stiffness)

    def column(values):
        return np.array([values[:, :2].max(axis=1), values[:, 2], values[:, 3]])

    parts = finer * column(changes) + column(accumulated) + least + column(by_stiffness)
    errors = cycles.error + SAFETY * parts
    moved = errors[0] + SAFETY * changes[:, :2].max(axis=1)
    return errors, SAFETY * of_multipliers + np.abs(floquet) * moved[:, None]


def _rounding_of_state(system, steps):
    """Return the error of ln V (n,) that rounding in the steps (n,) of a return adds up to.

    Each step rounds V/V_lp relative to 1, and x, v and psi relative to their steady values, such as
    mu/a under regularized friction, however small the cycle is.  Independent errors add up like
    the root of their number.  An error of stress changes the amplitude of ln V by omega/kappa.
    """
    x, v, psi = system.rest[:, :1], system.rest[:, 1:2], system.rest[:, 2:]
    per_stress = (frequency(system) / system.kappa)[:, None]
    sizes = np.concatenate([v, per_stress * x, per_stress * system.weights[:, :-1] * psi], axis=1)
    return EPS * np.sqrt(steps) * np.maximum(1.0, np.abs(sizes).max(axis=1))


def _accumulated_errors(orbits, floquet):
    """(n, 4) errors of amplitude, period, V_max and V_min that the steps of an orbit add up to.

    Also those (n, k) of its multipliers `floquet`, which the steps' tolerance does not bound.

    Estimated from a coarser orbit, no finer than the one that led to the estimate: steps may
    accumulate many times the error of one, as V falls over decades, or in the stress of b/a near
    1, which changes little while ln V and psi change much.  Errors go with the tolerance.  Those
    of extreme speeds, which arise in a few steps, do so less evenly, and may cancel in one orbit
    but not in another: they are scaled by the root of the ratio of tolerances, and their parts are
    added without their signs.
    """
    coarse, finer = coarser_orbits(orbits, orbits.cycles.tol)
    u, finer = orbits.cycles.u, finer[:, None]
    step = newton_step(coarse.returns, u) - newton_step(orbits.returns, u)
    at_u, gradients = difference(coarse, orbits).measures, orbits.by_u
    together = np.abs(at_u + change_along(gradients, step))[:, :2]
    apart = (np.abs(at_u) + change_along(np.abs(gradients), np.abs(step)))[:, 2:]
    of_multipliers = np.abs(multipliers(coarse.returns) - floquet)
    return np.concatenate([finer * together, np.sqrt(finer) * apart], axis=1), of_multipliers
