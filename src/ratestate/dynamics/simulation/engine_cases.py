"""A batch for the engine: dimensionless cases, tables of the loading, runs, failures."""

import numpy as np
import xarray

from ...engine import dispatch
from ...engine.model import (
    FINISHED,
    METHODS,
    NO_CONVERGENCE,
    RIGID_REST,
    RUNAWAY,
    STATUSES,
    Cases,
    Loads,
)
from ...errors import NotConverged, ParameterError, QuasiStaticInstability, SolverError
from ...model.arrays import as_column
from ...model.parameters import of_contact
from ...model.units import is_array
from ..refusals import sentence
from ..results import columns

# Speed [m/s] beyond which a quasi-static run that does not slow down has met its instability.
V_LIMIT = 3e8
# Steps after which a run counts as stuck: some 10 s of a case alone, and 10,000 cycles or more.
MAX_STEPS = 1e7


def engine_cases(law, batch, y0, *, t_end, loading, times, rtol, observe=1.0):
    """Return the `Cases` of a batch of sliders; nothing is checked here.

    y0, t_end : (n, len(y)) x, v, psi at t = 0, and (n,) [s]
    loading, times : (n,) rows of the tables of load histories and of saved times
    observe : 1 to record extremes of V, friction and the inertial force
    """
    p = columns(batch)
    settings = {"observe": observe, "max_steps": MAX_STEPS, "rtol": rtol}
    with np.errstate(over="ignore"):  # overflow ends as not finite
        eta0 = p.M * p.V0**2 / (p.a * p.sigma * p.Dc)
        unlimited = (p.M > 0.0) | (getattr(p, "damping", 0.0) > 0.0)
        v_limit = np.where(unlimited, np.inf, np.log(V_LIMIT / p.V0))
    return Cases(
        kappa=p.K * p.Dc / (p.a * p.sigma),
        p=np.stack(batch.at_reference(law)[1], axis=-1),
        eta0=eta0,
        scale=p.V0 / p.Dc,
        V0=p.V0,
        sigma=p.sigma,
        y=np.ascontiguousarray(y0),
        t_end=np.asarray(t_end, float),
        loading=loading,
        times=times,
        v_limit=v_limit,
        **{name: np.broadcast_to(value, batch.n).astype(float) for name, value in settings.items()},
    )


def engine_loads(batch, loading):
    """Return the `Loads` of a loading, and the row (n,) of each case in its tables."""
    if (stress := loading.normal_stress) is None:
        table, rows = batch.rows(loading.V)
        return Loads(loading.t, table, batch.rows(loading.rate)[0]), rows
    t = np.union1d(loading.t, stress.t)
    speed, known = loading.speed.refined(t), stress.with_sigma(batch.values["sigma"]).refined(t)
    rate = loading.rate[..., loading.speed.segments_at(t)]
    series = [np.maximum(speed.start, 0.0), rate, known.start, known.end]  # (rounding)
    if any(map(is_array, series)):  # then all get the same dimensions
        arrays = [as_column(column).drop_vars("segment", errors="ignore") for column in series]
        series = [array.transpose(..., "segment") for array in xarray.broadcast(*arrays)]
    (V, rows), *others = (batch.rows(column) for column in series)
    return Loads(t, V, *(table for table, _ in others)), rows


def comes_to_rest(loads, rows, t_end):
    """Return whether the load point (n,) rests at any time before t_end, (n,) [s].

    loads, rows : `Loads`, and the row of each case in its tables
    """
    ends, V, rate = np.append(loads.t[1:], np.inf), loads.V, loads.rate
    slows = rate < 0.0
    stop = (loads.t - V / np.where(slows, rate, 1.0)) * (1.0 - 1e-15)  # (rounding)
    rest = np.where(slows & (stop < ends), stop, np.inf)
    return np.where(V > 0.0, rest, loads.t).min(axis=1)[rows] < t_end


def run_cases(method, law, cases, loads, save_times, rows, progress=None):
    """March the cases with these numbers; return the `Results` of all n cases.

    Those of the others are NaN, with the status RUNNING.  method : a name in `METHODS`
    """
    order = rows[np.argsort(-cost(cases, loads)[rows], kind="stable")]
    return dispatch.run_march(METHODS[method], law, cases, loads, save_times, order, progress)


def run_path(method, law, cases, loads, progress=None):
    """March one case; return the times (m,) [s] and states (1, m, len(y)) of each step, `Results`.

    A run that fails ends with its last step, which is also its final state.
    """
    path, results = dispatch.run_path(METHODS[method], law, cases, loads, progress)
    if results.status[0] != FINISHED:
        results.final[0] = path[-1, 1:]
    t = path[:, 0] / cases.scale[0]
    # Scaling to seconds rounds; a step to a breakpoint, or to the end, gets its exact time.
    for breaks in (loads.t, cases.t_end):
        at = np.clip(np.searchsorted(breaks, t), 1, len(breaks)) - 1
        for k in (at, np.minimum(at + 1, len(breaks) - 1)):
            t = np.where(np.abs(t - breaks[k]) <= 1e-15 * breaks[k], breaks[k], t)
    t = np.minimum(t, cases.t_end[0])
    jumps = np.append(t[1:] == t[:-1], False)  # the state before a jump: the last time before it
    return np.where(jumps, np.nextafter(t, 0.0), t), path[None, :, 1:], results


def cost(cases, loads):
    """Return the estimated cost (n,) of each case, by which long cases are put first.

    It is a number of slips of Dc at the load point's fastest speed, or of radians at the natural
    frequency if these are fewer.
    """
    fastest = loads.V.max(axis=1)[cases.loading] / cases.V0
    with np.errstate(divide="ignore", invalid="ignore"):
        natural = np.sqrt(cases.kappa / cases.eta0)
    rate = np.minimum(fastest, natural)
    return np.nan_to_num(rate, nan=0.0) * cases.scale * np.minimum(cases.t_end, 1e300)


def failure(function, slider, status, t=None, best=None, loading=None):
    """Return the exception, to be raised, for a single case that ended with this status.

    function : its name
    t : when it ended [s], or None
    best : what the exception carries
    loading : of a run, the `Loading`, whose normal stress at t counts
    """
    name, text = STATUSES[int(status)]
    if status == RIGID_REST:
        return ParameterError(f"{text}.\n{slider!r}")
    time_text = "" if t is None else f" at t = {t:.9g} s"
    if status == RUNAWAY and not slider.friction_law.has_speed_scale and slider.K_c_qs > 0.0:
        varies = loading is not None and loading.normal_stress is not None
        slider_at_t = loading.slider_at(t, slider) if varies else slider
        sigma, K, K_c_qs = (
            of_contact(symbol, getattr(slider_at_t, symbol), slider_at_t.area)
            for symbol in ("sigma", "K", "K_c_qs")
        )
        at = sentence("failure.stress", sigma=sigma) if varies else ""
        values = {"K": K, "K_c_qs": K_c_qs, "ratio": slider_at_t.K / slider_at_t.K_c_qs}
        text = sentence("failure.runaway", at=at, text=text, **values)
    message = f"{function} stopped{time_text} ({name}): {text}.\n{slider!r}"
    kinds = {RUNAWAY: QuasiStaticInstability, NO_CONVERGENCE: NotConverged}
    return kinds.get(int(status), SolverError)(message, best)
