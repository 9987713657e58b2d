"""What a limit cycle is like: one turn of it, observed, and what its derivative says."""

import numpy as np

from .engine.model import FINISHED
from .settle import FINER, TIGHTEST
from .shooting import distance, multipliers, newton_step, state, turn

#: symbols of what `measure` finds, each of shape (n,) but for the multipliers, (n, 2)
MEASURES = (
    *("period", "amplitude", "v_max", "v_min", "g_max", "slow_fraction", "fundamental"),
    *("multipliers", "residual", "error"),
)


def measure(system, settled, alone):
    """Measures of the cycles in `settled`, by symbol; NaN where a turn did not close.

    In units of a (stress), Dc/V_lp (time) and ln V_lp (speeds).  The turn is finer than the one
    that found the cycle.  The step of Newton's method that it still asks for is taken, to first
    order, in the period and the amplitude, and reported as their error.
    """
    tol = np.maximum(FINER * settled.tol, TIGHTEST)
    u = settled.u
    turns = turn(system, state(system, u), tol, alone=alone, period=settled.period)
    found = turns.numbers
    soft = settled.error > 0.0
    step = np.where(soft[:, None], 0.0, newton_step(turns, u))
    psi, G = (u + step).T
    with np.errstate(divide="ignore", invalid="ignore"):
        low = found["x_low"] + found["x_low_a"] * step[:, 0] + found["x_low_b"] * step[:, 1]
        amplitude = system.beta * psi + system.eta * G - low
        shift = found["period_a"] * step[:, 0] + found["period_b"] * step[:, 1]
        period = found["period"] + shift
        before = state(system, u)[:, 0] - found["x_low"]
        changes = np.abs([amplitude - before, shift]) / [amplitude, period]
        mean = found["mean"] / found["period"]
        variance = found["square"] / found["period"] - mean**2
        wave = (found["cosine"] ** 2 + found["sine"] ** 2) / found["period"] ** 2
        closes = turns.image - u
        values = {
            "period": period,
            "amplitude": amplitude,
            "v_max": found["v_max"],
            "v_min": found["v_min"],
            "g_max": found["g_max"],
            "slow_fraction": found["slow"] / found["period"],
            "fundamental": 2.0 * wave / variance,
            "multipliers": multipliers(turns),
            "residual": distance(system, closes) / distance(system, u),
            "error": np.where(soft, settled.error, 0.0) + changes.max(axis=0) + 10.0 * tol,
        }
    closed = turns.status == FINISHED
    return {
        name: np.where(closed[:, None] if value.ndim == 2 else closed, value, np.nan)
        for name, value in values.items()
    }
