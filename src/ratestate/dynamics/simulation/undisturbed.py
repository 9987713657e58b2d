"""Runs in which nothing visible happens: they start on unstable steady sliding, undisturbed."""

import numpy as np

from ...friction.linear_stability import K_c, is_stable
from ...friction.stability import EDGE_WIDTH
from ...model.initial_state import initial_state, steady_sliding_state
from ..refusals import sentence
from ..results import columns

# Differences of x, v and psi from those of steady sliding that are due to rounding.
ROUNDING = 1e-12
# Speeds that differ by more are not the same, as a part of them.
SAME_SPEED = 1e-6
# The speed at which the remedy starts, over that of the load point.
OTHER_START = 0.1


def undisturbed_warning(calls):
    """What is wrong with the start of cases that stay on unstable steady sliding (str).

    "" where there are none.  ParameterError where initial values contradict each other.

    calls : iterable of `simulate.SimulateCall`, the parts of one
    """
    cases, count = 0, 0
    first: dict[str, float] = {}
    for call in calls:
        V_lp = _constant_speeds(call)
        p, law = columns(call.batch), call.slider.friction_law
        cases += V_lp.size
        stays = _starts_steady(call, V_lp, p)
        if not stays.any():
            continue
        of_law = {symbol: call.batch.flat(symbol) for symbol in law.symbols}
        critical = K_c(law, V_lp, sigma=p.sigma, M=p.M, **of_law)
        stiffer = (1.0 + EDGE_WIDTH) * p.K
        stays &= ~is_stable(law, V_lp, sigma=p.sigma, K=stiffer, M=p.M, **of_law)
        stays &= critical > stiffer
        count += int(stays.sum())
        if stays.any() and not first:
            i = int(np.argmax(stays))
            first = {"V_lp": V_lp[i], "K": p.K[i], "K_c": critical[i]}
    if not count:
        return ""
    name = "undisturbed" if cases == 1 else "undisturbed_sweep"
    start = OTHER_START * first["V_lp"]
    return sentence(f"simulate.{name}", **first, V_start=start, count=count, cases=cases)


def _constant_speeds(call):
    """(n,) speed of the load point [m/s]; NaN where it is 0 or changes, or normal stress does."""
    table, rows = call.batch.rows(call.loading.V)
    rates, _ = call.batch.rows(call.loading.rate)
    changes = (table != table[:, :1]) | (rates != 0.0)
    first = np.where(changes, call.loading.t, np.inf).min(axis=1)[rows]
    V = table[rows, 0]
    if call.loading.normal_stress is not None:
        first = np.minimum(first, call.loading.normal_stress.first_change)
    return np.where((first >= call.batch.flat("t_end")) & (V > 0.0), V, np.nan)


def _starts_steady(call, V_lp, p):
    """Whether cases (n,) start in steady sliding at these speeds; not where one is NaN."""
    law, constant = call.slider.friction_law, np.isfinite(V_lp)
    if not (constant & _may_start_there(call.batch, V_lp)).any():
        return np.zeros(V_lp.shape, bool)
    steady = steady_sliding_state(law, call.batch, np.where(constant, V_lp, p.V0))
    start = initial_state(law, call.batch, V_lp)
    return constant & (np.abs(start - steady).max(axis=1) < ROUNDING)


def _may_start_there(batch, V):
    """Whether cases (n,) may start at these speeds: at V_start, unless `initial` gives values."""
    given = any(name.endswith("_initial") for name in batch.values)
    return given | (np.abs(batch.flat("V_start") / V - 1.0) < SAME_SPEED)
