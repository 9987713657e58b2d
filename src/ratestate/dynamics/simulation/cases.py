"""A batch in the engine's terms: dimensionless cases, an order that fills lanes, failures."""

import numpy as np

from ...engine import dispatch
from ...engine.model import (
    FINISHED,
    METHODS,
    NO_CONVERGENCE,
    RIGID_REST,
    RUNAWAY,
    STATUSES,
    Cases,
)
from ...errors import NotConverged, ParameterError, QuasiStaticInstability, SolverError
from ..refusals import sentence
from ..results import columns

# [m/s] Beyond this a quasi-static run that does not slow down (`laws`) has met its instability.
V_LIMIT = 3e8
# Some 10 s of a case alone, and 10,000 cycles or more: beyond it a run counts as stuck.
MAX_STEPS = 1e7


def engine_cases(law, batch, y0, *, t_end, loading, times, rtol, observe=1.0):
    """`Cases` of a batch that holds the slider's parameters; nothing is checked here.

    law : of `LAWS`; y0 : (n, len(y)) x, v, psi at t = 0; t_end : (n,) [s]
    loading, times : (n,) rows of the tables of load histories and of saved times
    observe : 1 where extremes of V, friction and the inertial force are wanted
    """
    p = columns(batch)
    settings = {"observe": observe, "max_steps": MAX_STEPS, "rtol": rtol}
    with np.errstate(over="ignore"):  # overflow ends as not finite
        eta0 = p.M * p.V0**2 / (p.a * p.sigma * p.Dc)
        unlimited = (p.M > 0.0) | (getattr(p, "damping", 0.0) > 0.0)
        v_limit = np.where(unlimited, np.inf, np.log(V_LIMIT / p.V0))
    return Cases(
        kappa=p.K * p.Dc / (p.a * p.sigma),
        p=np.stack(law.coefficient_arrays(p.V0, batch.columns), axis=-1),
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


def run_cases(method, law, cases, loads, save_times, which, progress=None):
    """March the cases with these numbers; `Results` of all n cases.

    Of the others they are NaN, with the status RUNNING.  method : a name in `METHODS`
    law : of `LAWS`
    """
    order = which[np.argsort(-cost(cases, loads)[which], kind="stable")]
    return dispatch.run_march(METHODS[method], law, cases, loads, save_times, order, progress)


def run_path(method, law, cases, loads, progress=None):
    """March the one case, keeping each step: times (m,) [s], states (1, m, 3), `Results`.

    From t = 0 on; if the run fails, up to there, where its final state then is.
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
    before = np.append(t[1:] == t[:-1], False)  # where the state jumps, the last time before it
    return np.where(before, np.nextafter(t, 0.0), t), path[None, :, 1:], results


def cost(cases, loads):
    """(n,) estimated duration of each case, in slips of Dc at the load point's fastest speed.

    Or in radians at the natural frequency if these are fewer.  It serves only to put long cases
    first.
    """
    fastest = loads.V.max(axis=1)[cases.loading] / cases.V0
    with np.errstate(divide="ignore", invalid="ignore"):
        natural = np.sqrt(cases.kappa / cases.eta0)
    rate = np.minimum(fastest, natural)
    return np.nan_to_num(rate, nan=0.0) * cases.scale * np.minimum(cases.t_end, 1e300)


def failure(function, slider, status, t=None, best=None, loading=None):
    """The exception, to be raised, for a single case that ended with this status without an answer.

    RIGID_REST: ParameterError; RUNAWAY: QuasiStaticInstability; NO_CONVERGENCE: NotConverged; any
    other: SolverError.

    function : its name; t : when it ended [s], or None; best : what the exception carries
    loading : of a run, the `Loading`, whose normal stress at t counts
    """
    name, text = STATUSES[int(status)]
    if status == RIGID_REST:
        return ParameterError(f"{text}.\n{slider!r}")
    when = "" if t is None else f" at t = {t:.9g} s"
    if status == RUNAWAY and not slider.friction_law.has_speed_scale and slider.K_c_qs > 0.0:
        varies = loading is not None and loading.normal_stress is not None
        then = loading.slider_at(t, slider) if varies else slider
        at = sentence("failure.stress", sigma=then.sigma) if varies else ""
        ratio = then.K / then.K_c_qs
        text = sentence("failure.runaway", slider=then, ratio=ratio, at=at, text=text)
    message = f"{function} stopped{when} ({name}): {text}.\n{slider!r}"
    kinds = {RUNAWAY: QuasiStaticInstability, NO_CONVERGENCE: NotConverged}
    return kinds.get(int(status), SolverError)(message, best)
