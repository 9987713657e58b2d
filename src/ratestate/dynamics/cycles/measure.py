"""What a limit cycle is like: one turn of it, observed, and what its derivative says."""

import numpy as np

from ...engine.model import FINISHED
from ...friction.eigenvalues import steady_modes
from .attraction import FINER
from .iterates import iterate
from .sensitivity import COARSER, defect, measured, stiffness_sensitivity
from .shooting import distance, kept_tolerance, multipliers, newton_step, small_amplitude, tightest

# Of the error estimate: its safety, and what rounding makes of a turn.
SAFETY, ROUNDING = 3.0, 60.0 * 2.0**-52
# Turns, each finer than the last, to which a cycle that is not yet known well enough is put.
MOST_TURNS = 8


def refine(system, settled, rtol, alone):
    """`measure`, repeated with finer turns where the error is larger than rtol."""
    found = measure(system, settled, alone)
    for _ in range(MOST_TURNS):
        floor = tightest(system, settled.u)
        worse = (found["error"] > rtol) & (settled.tol > floor) & (settled.error == 0.0)
        if not worse.any():
            break
        part = settled.at(worse)
        finer = part.tol * np.clip(rtol / found["error"][worse], 0.01, 0.3)
        tol = np.maximum(finer, floor[worse])
        settled.tol[worse], settled.u[worse] = tol, found["u"][worse]
        settled.period[worse] = found["period"][worse]
        for name, value in measure(system.at(worse), settled.at(worse), alone).items():
            found[name][worse] = value
    soft = settled.error > 0.0
    first = _soft_multiplier(system.at(soft), found["period"][soft])
    with np.errstate(divide="ignore", invalid="ignore"):
        second = np.prod(found["multipliers"][soft], axis=1) / first
    found["multipliers"][soft] = np.stack([first, second], axis=1)
    return found


def _soft_multiplier(system, period):
    """(n,) larger multiplier of soft cycles, which a turn would round to 1.

    With dr/dT = g r + l r^3, g the growth rate of steady sliding, a distance from r^2 = -g/l
    grows at the rate -2 g.
    """
    modes = steady_modes(system.eta, system.kappa, system.beta, system.margin)
    return np.exp(-2.0 * modes[:, 0].real * period)


def measure(system, settled, alone):
    """Measures of the cycles in `settled`, name -> (n,) or (n, 2); NaN where a turn did not close.

    In units of a (stress), Dc/V_lp (time) and ln V_lp (speeds).  The turn is finer than the one
    that found the cycle.  The step of Newton's method that it still asks for is taken, to first
    order, in the period and the amplitude; as errors go with the tolerance, the error left is
    smaller than what it changes by as much as the turn is finer, and so it is smaller than what
    another turn, no finer than the one that found the cycle, makes of them.  Cycles that come with
    an error are known better, or under another condition, and left as they are.
    """
    tol = np.maximum(FINER * settled.tol, tightest(system, settled.u))
    u = settled.u
    turns = iterate(system, u, tol, settled.returns, alone=alone, period=settled.period)
    found = turns.numbers
    fixed = settled.error > 0.0
    step = np.where(fixed[:, None], 0.0, newton_step(turns, u))
    floquet = multipliers(turns)
    attraction = np.where(fixed, 1.0, np.minimum(1.0, np.abs(1.0 - floquet[:, 0])))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        high, low, shift, v_max, v_min = (
            found[f"{name}_a"] * step[:, 0] + found[f"{name}_b"] * step[:, 1]
            for name in ("x_high", "x_low", "period", "v_max", "v_min")
        )
        before = found["x_high"] - found["x_low"]
        amplitude = before + (high - low)
        period = found["period"] + shift
        scale = np.minimum(1.0, np.abs(small_amplitude(system, u)))
        # Where the stress is large and the cycle hardly attracts, rounding can feign one.
        drowned = ROUNDING * distance(system, u) > 1e-4 * attraction
        kept = kept_tolerance(turns, tol)
        finer = kept / np.maximum(kept, settled.tol)
        gathered = np.where(fixed[:, None], 0.0, _gathered(system, settled, turns, kept, alone))
        least = kept / scale + np.where(drowned & ~fixed, np.inf, ROUNDING / attraction)
        sensitivity = stiffness_sensitivity(system, settled, turns, tol)
        doubt = np.where(fixed[:, None], 0.0, defect(system, kept)[:, None] * sensitivity)
        # A cycle that is corrected away was none.
        whole = np.where((amplitude > 0.0) & (period > 0.0), [amplitude, period], 0.0)
        changes = np.abs([high - low, shift]) / whole
        mean = found["mean"] / found["period"]
        variance = found["square"] / found["period"] - mean**2
        wave = (found["cosine"] ** 2 + found["sine"] ** 2) / found["period"] ** 2
        closes = turns.image - u

        def error(change, gathered, doubt):
            return settled.error + SAFETY * (finer * change + gathered + least + doubt)

        values = {
            "period": period,
            "amplitude": amplitude,
            "v_max": found["v_max"] + v_max,
            "v_min": found["v_min"] + v_min,
            "g_max": found["g_max"],
            "f_min": found["f_min"],
            "xf_min": found["xf_min"],
            "slow_fraction": found["slow"] / found["period"],
            "fundamental": 2.0 * wave / variance,
            "multipliers": floquet,
            "u": u + step,
            "residual": distance(system, closes) / distance(system, u),
            "returns": settled.returns.astype(float),
            "error": error(changes.max(axis=0), *(w[:, :2].max(axis=1) for w in (gathered, doubt))),
            "v_max_error": error(np.abs(v_max), gathered[:, 2], doubt[:, 2]),
            "v_min_error": error(np.abs(v_min), gathered[:, 3], doubt[:, 3]),
        }
    closed = turns.status == FINISHED
    return {
        name: np.where(closed[:, None] if value.ndim == 2 else closed, value, np.nan)
        for name, value in values.items()
    }


def _gathered(system, settled, turns, kept, alone):
    """(n, 4) errors of amplitude, period, V_max and V_min that the steps of turns add up to.

    Told by another turn, no finer than the one that found the cycle: what a step may have, steps
    gather to many times, as V falls over decades, or in the stress of b/a near 1, which changes
    little while ln V and psi change much.  Errors go with the tolerance.  Those of extreme speeds,
    which fall into a few steps, do so less evenly, and may cancel in one turn but not in another:
    of them the root of the ratio is counted on, and each part by itself.

    kept : (n,) tolerance of the turns
    """
    tol = np.maximum(settled.tol, COARSER * kept)
    u, count = settled.u, settled.returns
    rough = iterate(system, u, tol, count, alone=alone, period=settled.period)
    fine, step = measured(turns), newton_step(rough, u) - newton_step(turns, u)
    at_u, by_u = measured(rough).values - fine.values, fine.by_u * step[:, None, :]
    together = np.abs(at_u + by_u.sum(axis=2))[:, :2]
    apart = (np.abs(at_u) + np.abs(by_u).sum(axis=2))[:, 2:]
    finer = (kept / tol)[:, None]
    return np.concatenate([finer * together, np.sqrt(finer) * apart], axis=1)
