"""A batch of runs: converted to the engine's units, run, and converted back."""

from functools import partial
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pandas
import xarray

from ...engine.model import FINISHED, NO_CONVERGENCE, NUMBERS, RIGID_REST, RUNAWAY
from ...friction.expressions import LIMIT
from ...model.initial_state import initial_state
from ...model.quantities import attrs
from ...model.units import is_array
from ..results import columns, domain_variables, status_variable
from .engine_cases import comes_to_rest, engine_cases, engine_loads, run_cases, run_path

# A double below this has lost digits.
SMALLEST = np.finfo(float).tiny


class BatchMotion(NamedTuple):
    """The motion of a batch of n cases, at m times each."""

    t: np.ndarray  # (m,) or, if each case has its own, (n, m) [s]
    #: (n, m, len(y)) x, v, psi; NaN if a case failed, except for a path of own steps
    states: np.ndarray
    numbers: dict  # name (engine.model.NUMBERS, "energy_residual") -> (n,)
    status: np.ndarray  # (n,) int, engine.model


def move(call, progress):
    """Return the `BatchMotion` of all cases of a `SimulateCall`; a case that fails raises no error.

    It is saved at the call's times, or without them at the own steps of a single case, and at the
    end of a sweep.  Raises ParameterError if initial values contradict each other.
    """
    batch, loading, times, law = call.batch, call.loading, call.times, call.law
    loads, rows = engine_loads(batch, loading)
    y0 = initial_state(call.slider.friction_law, batch, loads.V[rows, 0])
    t_end = batch.flat("t_end")
    save_times, time_rows = batch.rows(np.empty(0) if times is None else times)
    settings = {"loading": rows, "times": time_rows, "rtol": call.rtol}
    cases = engine_cases(law, batch, y0, t_end=t_end, **settings)
    rests = np.isinf(cases.kappa) & comes_to_rest(loads, rows, t_end)
    if batch.is_single and times is None and not rests[0]:
        t, states, results = run_path(call.method, law, cases, loads, progress)
    else:
        which = np.flatnonzero(~rests)
        results = run_cases(call.method, law, cases, loads, save_times, which, progress)
        results.status[rests] = RIGID_REST
        t = _saved_at(batch, times)
        states = results.final[:, None] if times is None else results.saved
    numbers = dict(zip(NUMBERS, results.numbers.T.copy(), strict=True))
    numbers["energy_residual"] = _energy_residual(law, batch, loading, cases, y0, results)
    return BatchMotion(t, states, numbers, results.status)


def _saved_at(batch, times):
    """Return the saved times [s]: (m,) or, if each case has its own, (n, m)."""
    if times is None:
        t_end = batch.flat("t_end")
        return t_end[:, None] if is_array(batch.values["t_end"]) else t_end[:1]
    table, rows = batch.rows(times)
    return table[rows] if is_array(times) else table[0]


def blank_motion(law, batch, times):
    """Return the `BatchMotion` of a batch that has not been run: NaN, status NO_CONVERGENCE."""
    t = _saved_at(batch, times)
    missing = np.full(batch.n, np.nan)
    numbers = dict.fromkeys((*NUMBERS, "energy_residual"), missing)
    states = np.full((batch.n, t.shape[-1], 2 + len(law.states)), np.nan)
    return BatchMotion(t, states, numbers, np.full(batch.n, NO_CONVERGENCE))


def _energy_residual(law, batch, loading, cases, y0, results):
    """Return (load work - dissipation - change of stored energy)/(sum of their sizes) [1].

    The unit of all is a sigma Dc per area.  The parts that mu_ref contributes to work, dissipation
    and spring energy cancel exactly, since slip is delta_lp - tau/K.  It is 0 if K = inf: the work
    of the load point is not integrated then.
    """
    x0, v0, *psi0 = y0.T
    x1, v1, *psi1 = results.final.T
    p = tuple(cases.p.T)
    w0, w1 = law.speed(v0, psi0, p), law.speed(v1, psi1, p)

    def number(name):
        return results.numbers[:, NUMBERS.index(name)]

    load, friction = number("load_work"), number("dissipation")
    with np.errstate(over="ignore", invalid="ignore"):  # for V0 beyond 1e-150 of the speeds
        kinetic = 0.5 * cases.eta0 * (w1 * w1 - w0 * w0)
    kinetic = np.where(cases.eta0 > 0.0, kinetic, 0.0)
    spring = (x1 - x0) * (x1 + x0) / (2.0 * cases.kappa)
    base = batch.at_reference(law)[0] / batch.flat("a")
    ends = np.where(results.status == RUNAWAY, number("t"), batch.flat("t_end"))
    advance = batch.evaluate(loading.delta_lp, ends[:, None])[:, 0] / batch.flat("Dc")
    slip = advance - (x1 - x0) / cases.kappa
    turnover = (
        np.abs(base * advance + load)
        + np.abs(base * slip + friction)
        + np.abs(spring + base * (x1 - x0) / cases.kappa + kinetic)
    )
    solved = np.isinf(cases.kappa) & (results.status == FINISHED)
    residual = np.where(solved, 0.0, load - friction - spring - kinetic)
    return residual / np.where(turnover > 0.0, turnover, 1.0)


def motion_variables(call, motion):
    """Return the variables of the result of a `SimulateCall`, name -> Variable [SI].

    They include ``time``, or ``t`` if each case has its own times.  A failed case has NaN, but not
    for ``steps``, ``returns`` (0), ``outside_domain`` (-1), ``delta_lp`` and ``V_load``.
    """
    variables = _series(call.slider, call.batch, call.loading, motion)
    variables["status"] = status_variable(call.batch, motion.status)
    variables |= _observables(call.slider.friction_law, call.batch, motion, call.rtol)
    if motion.t.ndim == 1:
        # (to make an index of an array, xarray would import pint)
        variables["time"] = xarray.IndexVariable("time", pandas.Index(motion.t), attrs("time"))
    else:  # times of its own for each case
        variables["t"] = call.batch.variable(motion.t, "t", "time")
    return variables


def _series(slider, batch, loading, motion):
    """Return the variables along time, name -> Variable in the sweep's dimensions and ``time``."""
    law, sigma = slider.friction_law, slider.sigma
    p = SimpleNamespace(**{symbol: values[:, None] for symbol, values in batch.columns.items()})
    x, v, *states = np.moveaxis(motion.states, -1, 0)
    psi = tuple(states)
    mu_ref, coefficients = batch.at_reference(law)
    mu_ref, coefficients = mu_ref[:, None], tuple(x[:, None] for x in coefficients)
    t = np.broadcast_to(motion.t, x.shape)
    tau = p.sigma * (mu_ref + p.a * x)
    delta_lp = batch.evaluate(loading.delta_lp, t)
    V = p.V0 * law.speed(v, psi, coefficients)
    logs = law.log_states(v, psi, coefficients)
    with np.errstate(over="ignore"):
        ages = {
            name: getattr(p, D) / p.V0 * np.exp(state)
            for name, D, state in zip(law.states, law.lengths, logs, strict=True)
        }
        friction = law.at(v, psi, coefficients).R
    # Beyond double precision V and theta differ from those that friction was computed from.
    in_range = law.reverses | ((v >= -LIMIT) & (V >= SMALLEST) & (np.inf > V))
    for theta in ages.values():
        in_range &= (theta >= SMALLEST) & (theta < np.inf)
    values = {
        "V": V,
        **ages,
        "delta": delta_lp - tau / p.K,
        "delta_lp": delta_lp,
        "V_load": batch.evaluate(loading.V_load, t),
        "tau": tau,
        "mu": np.where(in_range, mu_ref + p.a * friction, np.nan),
    }
    if loading.normal_stress is not None:
        # (a jump at the very end has not happened)
        end = np.nextafter(batch.flat("t_end"), 0.0)[:, None]
        values["sigma"] = batch.evaluate(partial(loading.sigma, sigma=sigma), np.minimum(t, end))
    variables = {name: batch.variable(value, name, "time") for name, value in values.items()}
    variables["mu"].attrs["comment"] = "NaN where V or theta is beyond double precision"
    return variables


def _observables(law, batch, motion, rtol):
    """Return the variables that have one value a case, name -> Variable."""
    p, numbers = columns(batch), motion.numbers
    mu_ref, coefficients = batch.at_reference(law)
    # rtol bounds the error of a step in x = tau/(a sigma): a smaller oscillation is not a cycle.
    counts = (numbers["amplitude"] > 10.0 * rtol) & (numbers["cycles"] > 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        frequency = p.V0 / p.Dc / numbers["period"]
    amplitude = np.where(counts, p.a * numbers["amplitude"], 0.0)
    values = {
        "cycles": numbers["cycles"],
        "amplitude": amplitude,
        "stress_drop": p.sigma * amplitude,
        "frequency": np.where(counts, frequency, 0.0),
        "V_max": p.V0 * law.speed(numbers["v_max"], law.reference_state, coefficients),
        "V_min": p.V0 * law.speed(numbers["v_min"], law.reference_state, coefficients),
        "inertial_force": p.a * numbers["g_max"],
        "mu_min": mu_ref + p.a * numbers["f_min"],
        "reversal_margin": 2.0 * mu_ref + p.a * numbers["xf_min"],
    }
    failed = np.isnan(motion.states[:, -1]).any(axis=-1)
    values = {name: np.where(failed, np.nan, value) for name, value in values.items()}
    domain = domain_variables(law, batch, values.pop("mu_min"), values.pop("reversal_margin"))
    values["steps"] = np.nan_to_num(numbers["steps"]).astype(np.int64)
    values["returns"] = np.where(counts & ~failed, numbers["returns"], 0.0).astype(np.int16)
    values["energy_residual"] = numbers["energy_residual"]
    return {name: batch.variable(value, name) for name, value in values.items()} | domain
