"""(g) `sweep`: how it uses two cores, what it adds to the engine, what a store adds to it."""

import itertools
import tempfile
from pathlib import Path

import numpy as np
from cycle_problems import RTOL, V_LP, sliders
from problems import fig3
from report import Part, power
from rivals import lsoda_on_all_cores
from sweep import MEDIAN, TOLERANCES, TOLERANCES_LSODA, loosest
from timing import cpu, interleaved, one_core, wall

import ratestate as rs
from ratestate.atlas import ETA, STIFFNESS

SIDE = 160  # of the grid of limit cycles
CASES, CHUNK = 40_000, 10_000  # for the store
TURNS = 3


def run(_rivals):
    """The Part."""
    part = Part(
        "(g) sweep: seconds on the clock, medians of jobs that take turns",
        ["sweep", "law", "how", "s", "CPU s"],
        text=3,
        notes=[
            f"limit cycles: {SIDE} x {SIDE} over the atlas, rtol {power(RTOL)}; Fig. 3: simulate,"
            " 156 cases of 10 s, rtol that gives a median error of 1e-5",
            "engine: the march without extremes, energy and Dataset, on as many threads",
        ],
    )
    for law in ("slip", "aging"):
        _scaling(part, law)
        _fig3(part, law)
    _store(part)
    return part


def quiet(verb, slider, **how):
    """The public call, without its bar."""
    return rs.sweep(verb, slider, progress=False, **how)


def _timed(jobs):
    """name -> median seconds on the clock and of CPU, of jobs that take turns."""
    for job in jobs.values():
        job()  # warm
    found = {name: [] for name in jobs}
    for _ in range(TURNS):
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

    seconds = _timed({"one core": on_one_core(job), "all cores": job})
    _add(part, "limit cycles", law, seconds)
    ratio = seconds["one core"][0] / seconds["all cores"][0]
    part.goal(f"{law}: two cores at least 1.85 times one", f"{ratio:.2f}", ratio >= 1.85)


def _fig3(part, law):
    """Fig. 3 through the engine, `simulate`, `sweep`, and numbalsoda's LSODA under prange."""
    problem = fig3(law)
    tol, *_ = loosest(lambda t: problem.job(t)().final, problem, TOLERANCES)
    loading = rs.Loading.constant(problem.V_lp)
    how = {"t_end": problem.t_end, "V_start": problem.V_start, "rtol": tol}
    jobs = {
        "engine": problem.job(tol),
        "simulate": lambda: rs.simulate(problem.slider, loading, **how),
        "sweep": lambda: quiet("simulate", problem.slider, loading=loading, **how),
    }
    with one_core():
        for job in jobs.values():
            job()
        alone = interleaved(jobs, repetitions=7, most=8.0)
    ratio = alone["sweep"] / alone["engine"]
    part.goal(f"{law}, Fig. 3: at most 1.3 times the bare engine", f"{ratio:.2f}", ratio <= 1.3)
    if rival := lsoda_on_all_cores():
        chosen = loosest(lambda t: rival(problem, t)[0], problem, TOLERANCES_LSODA[law])
        jobs["numbalsoda LSODA, prange"] = lambda: rival(problem, chosen[0])
    seconds = _timed(jobs)
    _add(part, "Fig. 3", law, seconds)
    part.notes.append(
        f"{law}, Fig. 3 on one core, CPU s: "
        + ", ".join(f"{name} {value:.3f}" for name, value in alone.items())
    )
    if rival:
        ratio = seconds["numbalsoda LSODA, prange"][0] / seconds["sweep"][0]
        asked = f"{law}, Fig. 3: at least 6 times LSODA under prange, median error {power(MEDIAN)}"
        part.goal(asked, f"{ratio:.1f}", ratio >= 6.0)


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
