"""(g) `sweep`: how it uses two cores, what it adds to the engine, what a store adds to it."""

import itertools
import tempfile
from pathlib import Path

import numpy as np
from cycle_problems import RTOL, V_LP, atlas, sliders
from problems import fig3
from report import Part, power
from rivals import lsoda_on_all_cores
from sweep import MEDIAN, TOLERANCES, TOLERANCES_LSODA, loosest
from timing import cpu, interleaved, one_core, wall

import ratestate as rs
from ratestate.dynamics.atlas import ETA, STIFFNESS

SIDE = 400  # of the grid of limit cycles
CASES, CHUNK = 40_000, 10_000  # for the store
TURNS = 3


def run(_rivals):
    """The Part."""
    for law in ("slip", "aging"):
        quiet("limit_cycle", atlas(law), V_lp=V_LP, rtol=RTOL)  # warm
    part = Part(
        "(g) sweep: seconds on the clock, medians of jobs that take turns",
        ["sweep", "law", "how", "s", "CPU s"],
        text=3,
        notes=[
            f"limit cycles: {SIDE} x {SIDE} over the atlas, rtol {power(RTOL)}; Fig. 3: simulate,"
            " 156 cases of 10 s, rtol that gives a median error of 1e-5",
            "engine: the march alone, without energy and Dataset, on as many threads",
        ],
    )
    for law in ("slip", "aging"):
        _scaling(part, law)
        _fig3(part, law)
    _store(part)
    return part


def quiet(function, slider, **how):
    """The public call, without its bar."""
    return rs.sweep(function, slider, progress=False, **how)


def _timed(jobs, turns=TURNS):
    """name -> median seconds on the clock and of CPU, of jobs that take turns."""
    found = {name: [] for name in jobs}
    for _ in range(turns):
        for name, job in jobs.items():
            spent = []
            found[name].append((wall(lambda j=job, s=spent: s.append(cpu(j))), spent[0]))
    return {name: np.median(values, axis=0) for name, values in found.items()}


def _add(part, sweep, law, seconds):
    for how, (clock, spent) in seconds.items():
        part.add(sweep, law, how, f"{clock:.3f}", f"{spent:.3f}")


def on_one_core(job):
    """The same job, on one core."""

    def alone():
        with one_core():
            job()

    return alone


def _scaling(part, law):
    """Limit cycles on one core and on all."""
    K, eta = rs.logspace("K", *STIFFNESS, SIDE), rs.logspace("eta", *ETA, SIDE)
    slider = sliders(law, K, eta)

    def job():
        quiet(rs.limit_cycle, slider, V_lp=V_LP, rtol=RTOL)

    seconds = _timed({"one core": on_one_core(job), "all cores": job}, turns=2)
    _add(part, "limit cycles", law, seconds)
    ratio = seconds["one core"][0] / seconds["all cores"][0]
    part.goal(f"{law}: two cores at least 1.85 times one", f"{ratio:.2f}", ratio >= 1.85)


def _fig3(part, law):
    """Fig. 3 through the engine, `simulate` and `sweep`; finer, beside LSODA under prange."""
    problem = fig3(law)
    tol, *_ = loosest(lambda t: problem.job(t)().final, problem, TOLERANCES)
    jobs = {
        "engine": problem.job(tol, observe=1.0),
        "engine, no extremes": problem.job(tol),
        "simulate": lambda: rs.simulate(problem.slider, **asked(problem, tol)),
        "sweep": lambda: quiet("simulate", problem.slider, **asked(problem, tol)),
    }
    with one_core():
        for job in jobs.values():
            job()
        alone = interleaved(jobs, repetitions=7, most=8.0)
    _add(part, "Fig. 3", law, _timed(jobs))
    ratio = alone["sweep"] / alone["engine"]
    part.goal(f"{law}, Fig. 3: at most 1.3 times the bare engine", f"{ratio:.2f}", ratio <= 1.3)
    part.notes.append(
        f"{law}, Fig. 3 on one core, CPU s: "
        + ", ".join(f"{name} {value:.3f}" for name, value in alone.items())
    )
    if rival := lsoda_on_all_cores():
        _beside(part, law, problem, tol, rival)


def _beside(part, law, problem, tol, rival):
    """Fig. 3, and four times as many cases, beside LSODA under prange."""
    lsoda_tol, *_ = loosest(lambda t: rival(problem, t)[0], problem, TOLERANCES_LSODA[law])
    for finer in (1, 2):
        cases = fig3(law, finer)
        jobs = {
            "sweep": lambda p=cases: quiet("simulate", p.slider, **asked(p, tol)),
            "numbalsoda LSODA, prange": lambda p=cases: rival(p, lsoda_tol),
        }
        seconds = _timed(jobs)
        name = f"Fig. 3, {cases.n} cases"
        _add(part, name, law, seconds)
        ratio = seconds["numbalsoda LSODA, prange"][0] / seconds["sweep"][0]
        goal = f"{law}, {name}: at least 6 times LSODA under prange, median error {power(MEDIAN)}"
        part.goal(goal, f"{ratio:.1f}", ratio >= 6.0)


def asked(problem, rtol):
    """The arguments of `simulate` for a problem."""
    loading = rs.Loading.constant(problem.V_lp)
    settings = {"t_end": problem.t_end, "V_start": problem.V_start, "rtol": rtol}
    return {"loading": loading, **settings}


def _store(part):
    """What a store adds to a sweep of limit cycles."""
    side = round(CASES**0.5)
    K, eta = rs.logspace("K", *STIFFNESS, side), rs.logspace("eta", *ETA, side)
    slider = sliders("slip", K, eta)

    def into(store):
        quiet("limit_cycle", slider, V_lp=V_LP, rtol=RTOL, chunk=CHUNK, store=store)

    with tempfile.TemporaryDirectory() as folder:
        paths = (Path(folder) / f"{i}.zarr" for i in itertools.count())
        jobs = {"in memory": lambda: into(None), "in a store": lambda: into(next(paths))}
        seconds = _timed(jobs)
    _add(part, f"{side**2:,} limit cycles, chunks of {CHUNK:,}", "slip", seconds)
    (memory, _), (store, _) = seconds["in memory"], seconds["in a store"]
    ms = 1e3 * (store - memory) / side**2
    part.goal("a store adds less than 1 ms a case", f"{ms:.4f} ms", ms < 1.0)
