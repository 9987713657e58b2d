"""A batch of runs: converted for the engine, run, and converted back to units."""

from typing import NamedTuple

import numpy as np

from ...engine.exp import LIMIT
from ...engine.model import FINISHED, NO_CONVERGENCE, NUMBERS, RIGID_REST, Loads
from ...model.initial_state import initial_state
from ...model.units import is_array
from . import rigid
from .cases import engine_cases, run_cases, run_path, speed
from .domain import domain_variables

# A double below this has lost digits.
SMALLEST = np.finfo(float).tiny


class Motion(NamedTuple):
    """The motion of a batch of n cases, at m times each."""

    t: np.ndarray  # (m,) or, where each case has its own, (n, m) [s]
    states: np.ndarray  # (n, m, 3) x, v, psi
    numbers: dict  # name (engine.model.NUMBERS, "energy_residual") -> (n,)
    status: np.ndarray  # (n,)


def move(batch, law, loading, times, method, dt, rtol, progress):
    """Run all cases of a batch that holds the slider, V_start, t_end and any initial values.

    times : None (own steps of a single case, final state of several), (m,) or DataArray
    """
    table, rows = batch.rows(loading.V)
    rates, _ = batch.rows(loading.rate)
    y0 = initial_state(batch, table[rows, 0])
    t_end = batch.flat("t_end")
    save_times, time_rows = batch.rows(np.empty(0) if times is None else times)
    cases = engine_cases(batch, y0, t_end=t_end, loading=rows, times=time_rows, dt=dt, rtol=rtol)
    loads = Loads(loading.t, table, rates)
    is_rigid = np.isinf(batch.flat("K"))
    if own_steps := batch.alone and times is None:
        if is_rigid[0]:
            t = rigid.grid(loading.t, table[0], t_end[0], batch.flat("Dc")[0])
            states = np.full((1, t.size, 3), np.nan)
        else:
            t, states, results = run_path(method, law, cases, loads, progress)
    else:
        t = saved_at(batch, times)
    if not own_steps or is_rigid[0]:
        which = np.flatnonzero(~is_rigid)
        results = run_cases(method, law, cases, loads, save_times, which, batch.alone, progress)
        if not own_steps:
            states = results.final[:, None] if times is None else results.saved
    numbers = dict(zip(NUMBERS, results.numbers.T.copy(), strict=True))
    numbers["energy_residual"] = energy_residual(batch, loading, cases, y0, results)
    scales = {symbol: batch.flat(symbol) for symbol in ("a", "b", "Dc", "sigma", "M", "V0")}
    for i in np.flatnonzero(is_rigid):
        segments = (loading.t, table[rows[i]], rates[rows[i]])
        at = t if t.ndim == 1 else t[i]
        own = {symbol: values[i] for symbol, values in scales.items()}
        motion = rigid.follow(law, y0[i, 2], at, t_end[i], segments, **own)
        results.status[i] = RIGID_REST if motion is None else FINISHED
        if motion is not None:
            states[i], rigid_numbers = motion
            for name, value in rigid_numbers.items():
                numbers[name][i] = value
    return Motion(t, states, numbers, results.status)


def saved_at(batch, times):
    """Times at which the cases are saved [s]: (m,) or, where each has its own, (n, m).

    times : as for `move`; None saves the end
    """
    if times is None:
        t_end = batch.flat("t_end")
        return t_end[:, None] if is_array(batch.values["t_end"]) else t_end[:1]
    table, rows = batch.rows(times)
    return table[rows] if is_array(times) else table[0]


def blank_motion(batch, times):
    """The `Motion` of a batch that has not been run: NaN."""
    t = saved_at(batch, times)
    nothing = np.full(batch.n, np.nan)
    numbers = dict.fromkeys((*NUMBERS, "energy_residual"), nothing)
    states = np.full((batch.n, t.shape[-1], 3), np.nan)
    return Motion(t, states, numbers, np.full(batch.n, NO_CONVERGENCE))


def energy_residual(batch, loading, cases, y0, results):
    """(n,) (load work - dissipation - change of stored energy)/(all of them).

    In units of a sigma Dc per area; the parts that mu0 contributes to work, dissipation and
    spring energy cancel exactly, since slip is delta_lp - tau/K.
    """
    x0, v0, _ = y0.T
    x1, v1, _ = results.final.T
    load, friction = (results.numbers[:, NUMBERS.index(n)] for n in ("load_work", "dissipation"))
    with np.errstate(over="ignore", invalid="ignore"):  # for V0 beyond 1e-150 of the speeds
        kinetic = 0.5 * cases.eta0 * (np.exp(2.0 * v1) - np.exp(2.0 * v0))
    kinetic = np.where(cases.eta0 > 0.0, kinetic, 0.0)
    spring = (x1 - x0) * (x1 + x0) / (2.0 * cases.kappa)
    base = batch.flat("mu0") / batch.flat("a")
    advance = batch.of(loading.delta_lp, batch.flat("t_end")[:, None])[:, 0] / batch.flat("Dc")
    slip = advance - (x1 - x0) / cases.kappa
    turnover = (
        np.abs(base * advance + load)
        + np.abs(base * slip + friction)
        + np.abs(spring + base * (x1 - x0) / cases.kappa + kinetic)
    )
    residual = load - friction - spring - kinetic
    return residual / np.where(turnover > 0.0, turnover, 1.0)


def series(batch, loading, motion):
    """The variables along time, as name -> Variable in the sweep's dimensions and ``time``."""
    a, b, mu0, sigma, V0, Dc, K = (
        batch.flat(symbol)[:, None] for symbol in ("a", "b", "mu0", "sigma", "V0", "Dc", "K")
    )
    x, v, psi = np.moveaxis(motion.states, -1, 0)
    t = np.broadcast_to(motion.t, x.shape)
    tau = sigma * (mu0 + a * x)
    delta_lp = batch.of(loading.delta_lp, t)
    V = speed(v, V0)
    with np.errstate(over="ignore"):
        theta = Dc / V0 * np.exp(psi)
    # Beyond double precision V and theta differ from those that friction was computed from.
    in_range = (
        (v >= -LIMIT) & (V >= SMALLEST) & (np.inf > V) & (theta >= SMALLEST) & (theta < np.inf)
    )
    values = {
        "V": V,
        "theta": theta,
        "delta": delta_lp - tau / K,
        "delta_lp": delta_lp,
        "V_load": batch.of(loading.V_load, t),
        "tau": tau,
        "mu": np.where(in_range, mu0 + a * (v + b / a * psi), np.nan),
    }
    variables = {name: batch.variable(value, name, "time") for name, value in values.items()}
    variables["mu"].attrs["comment"] = "NaN where V or theta is beyond double precision"
    return variables


def observables(batch, motion, rtol):
    """The variables that have one value a case, as name -> Variable."""
    a, mu0, V0 = batch.flat("a"), batch.flat("mu0"), batch.flat("V0")
    numbers = motion.numbers
    # rtol bounds the error of a step in x, tau/sigma over a: below it a cycle is no cycle.
    counts = (numbers["amplitude"] > 10.0 * rtol) & (numbers["cycles"] > 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        frequency = V0 / batch.flat("Dc") / numbers["period"]
    values = {
        "cycles": np.where(counts, numbers["cycles"], 0.0),
        "amplitude": np.where(counts, a * numbers["amplitude"], 0.0),
        "frequency": np.where(counts, frequency, 0.0),
        "V_max": speed(numbers["v_max"], V0),
        "V_min": speed(numbers["v_min"], V0),
        "inertial_force": a * numbers["g_max"],
        "mu_min": mu0 + a * numbers["f_min"],
        "reversal_margin": 2.0 * mu0 + a * numbers["xf_min"],
    }
    failed = motion.status != FINISHED
    values = {name: np.where(failed, np.nan, value) for name, value in values.items()}
    domain = domain_variables(batch, values.pop("mu_min"), values.pop("reversal_margin"))
    values["steps"] = np.nan_to_num(numbers["steps"]).astype(np.int64)
    values["returns"] = np.where(counts & ~failed, numbers["returns"], 0.0).astype(np.int16)
    values["energy_residual"] = numbers["energy_residual"]
    return {name: batch.variable(value, name) for name, value in values.items()} | domain
