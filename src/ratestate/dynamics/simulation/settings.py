"""Checks of arguments: rtol of all functions; times, method and start of `simulate`."""

import numpy as np

from ...engine.model import METHODS
from ...friction.closed_forms import EDGE_WIDTH
from ...friction.linear_stability import K_c, is_stable
from ...model.arrays import column_to_si
from ...model.initial_state import initial_state, steady_sliding_state
from ...model.names import one_of
from ...model.parameters import of_contact
from ...model.units import is_array, to_si
from ..refusals import refusal, sentence
from ..results import columns

# Differences of x, v and psi from steady sliding that are due to rounding.
ROUNDING = 1e-12
# Relative difference up to which two speeds count as equal.
SAME_SPEED = 1e-6
# Suggested V_start, divided by the load-point speed.
OTHER_START = 0.1


def checked_rtol(rtol, least, most, example):
    """Return a relative tolerance as a float, between the texts least and most, such as "1e-12"."""
    rtol = to_si("rtol", rtol)
    if is_array(rtol) or not float(least) <= rtol <= float(most):
        raise refusal("settings.rtol", rtol=rtol, least=least, most=most, example=example)
    return rtol


def solver_settings(rtol, method):
    """Return rtol as a float; check that it is from 1e-13 to 0.1, and that the method is known."""
    rtol = checked_rtol(rtol, "1e-13", "0.1", "1e-6")
    if not isinstance(method, str) or method not in METHODS:
        raise refusal("settings.method", method=method, wanted=one_of(METHODS, method))
    return rtol


def check_normal_stress(loading, slider, t_end):
    """Check that the loading's normal stress begins at the slider's, and is > 0 up to t_end [s]."""
    if loading.normal_stress is None:
        return
    if "sigma" in getattr(slider.sigma, "dims", ()):
        raise refusal("settings.sigma_axis")
    loading.normal_stress.check_stress(slider.sigma, t_end)


def saved_times(times, t_end):
    """Return saved times [s]: an array (m,), or a DataArray with ``time`` last; None for None."""
    if times is None:
        return None
    if not is_array(times) or times.ndim == 1:
        times = column_to_si("times", times)
        if is_array(times):
            raise refusal("times.list_of_arrays")
    else:
        times = to_si("times", times)
        if "time" not in times.dims:
            raise refusal("times.dimensions", dims=times.dims)
        times = times.drop_vars("time", errors="ignore").transpose(..., "time")
    values = np.asarray(times)
    if not (np.diff(values, axis=-1) > 0).all():
        raise refusal("times.order")
    latest = times.max("time") if is_array(times) else values.max()
    if np.any(latest > t_end * (1.0 + 1e-12)):
        raise refusal("times.late", latest=float(np.max(latest)), t_end=float(np.max(t_end)))
    return np.minimum(times, t_end if is_array(times) else float(np.min(t_end)))  # rounding


def undisturbed_warning(calls):
    """Return a warning if cases start exactly on unstable steady sliding; "" if none does.

    calls : iterable of `simulate.SimulateCall`, the parts of one
    """
    cases, count = 0, 0
    first: dict = {}
    for call in calls:
        V_lp = _constant_speeds(call)
        p, law = columns(call.batch), call.slider.friction_law
        cases += V_lp.size
        is_undisturbed = _starts_steady(call, V_lp, p)
        if not is_undisturbed.any():
            continue
        of_law = {symbol: call.batch.flat(symbol) for symbol in law.symbols}
        critical = K_c(law, V_lp, sigma=p.sigma, M=p.M, **of_law)
        stiffer = (1.0 + EDGE_WIDTH) * p.K
        is_undisturbed &= ~is_stable(law, V_lp, sigma=p.sigma, K=stiffer, M=p.M, **of_law)
        is_undisturbed &= critical > stiffer
        count += int(is_undisturbed.sum())
        if is_undisturbed.any() and not first:
            i = int(np.argmax(is_undisturbed))
            area = p.area[i] if call.slider.has_area else None
            stiffnesses = {"K": p.K[i], "K_c": critical[i]}
            first = {symbol: of_contact("K", K, area) for symbol, K in stiffnesses.items()}
            first["V_lp"] = V_lp[i]
    if not count:
        return ""
    name = "undisturbed" if cases == 1 else "undisturbed_sweep"
    start = OTHER_START * first["V_lp"]
    return sentence(f"simulate.{name}", **first, V_start=start, count=count, cases=cases)


def _constant_speeds(call):
    """Return the load-point speeds (n,); NaN if one is 0 or changes, or normal stress changes."""
    table, rows = call.batch.rows(call.loading.V)
    rates, _ = call.batch.rows(call.loading.rate)
    changes = (table != table[:, :1]) | (rates != 0.0)
    first = np.where(changes, call.loading.t, np.inf).min(axis=1)[rows]
    V = table[rows, 0]
    if call.loading.normal_stress is not None:
        first = np.minimum(first, call.loading.normal_stress.first_change)
    return np.where((first >= call.batch.flat("t_end")) & (V > 0.0), V, np.nan)


def _starts_steady(call, V_lp, p):
    """Return whether cases (n,) start in steady sliding at these speeds; False for NaN."""
    law, constant = call.slider.friction_law, np.isfinite(V_lp)
    given = any(name.endswith("_initial") for name in call.batch.values)
    same_speed = np.abs(call.batch.flat("V_start") / V_lp - 1.0) < SAME_SPEED
    if not (constant & (given | same_speed)).any():
        return np.zeros(V_lp.shape, bool)
    steady = steady_sliding_state(law, call.batch, np.where(constant, V_lp, p.V0))
    start = initial_state(law, call.batch, V_lp)
    return constant & (np.abs(start - steady).max(axis=1) < ROUNDING)
