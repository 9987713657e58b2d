"""(b) CPU time to reach an error, one slider alone, against other solvers."""

import functools
from typing import NamedTuple

import numpy as np
from problems import lone
from report import Part, power
from timing import cpu, interleaved, one_core

OURS = "ratestate"
TARGETS = (1e-3, 1e-5, 1e-7, 1e-9)
FINE = 10.0 ** np.arange(-2, -12.1, -0.5)
#: problems that are not stiff, of which smaller errors are asked for
QUASI_HARMONIC = ("P1", "P4a")
COARSE = 10.0 ** np.arange(-3, -10.1, -1.0)  # for SciPy, which takes seconds
SLOW = 1.0  # CPU seconds beyond which one run is enough


class Tried(NamedTuple):
    """One run of a solver; error is inf where it failed, and `fault` says how."""

    tol: float
    error: float
    seconds: float
    fault: str | None


@functools.cache
def prepared(problem, tol):
    """The engine's job, made once: what the other solvers are given is made once too."""
    return problem.job(tol)


def ours(problem, tol):
    """The engine, as a solver in the sense of rivals.py."""
    found = prepared(problem, tol)()
    return found.final, "stops" if found.status[0] else None


def scan(solver, problem, tolerances, smallest):
    """Runs from loose to tight until an error is met."""
    tried = []
    for tol in tolerances:
        found = []
        seconds = cpu(lambda t=tol, f=found: f.append(solver(problem, t)))
        final, fault = found[-1]
        error = np.inf if fault else problem.errors(final)[0]
        tried.append(Tried(tol, error, seconds, fault))
        if error <= smallest:
            break
    return tried


def faults(tried):
    """What went wrong at which tolerances, in words."""
    kinds = dict.fromkeys(run.fault for run in tried if run.fault)
    words = []
    for kind in kinds:
        at = [run.tol for run in tried if run.fault == kind]
        span = power(at[0]) + (f" to {power(at[-1])}" if len(at) > 1 else "")
        words.append(f"{kind} at {len(at)} of {len(tried)} ({span})")
    return "; ".join(words) or "-"


def run(rivals):
    """The Part."""
    part = Part(
        "(b) CPU time to reach an error at the end, alone, one core",
        ["problem", "asked", "solver", "x ratestate", "ms", "tolerance", "error", "failures"],
        text=3,
        notes=[
            "error: the largest in tau/(a sigma), ln V and psi at the end, against rtol 1e-12;"
            " each solver at the tolerance, of those tried, that gets there most cheaply",
            "tolerances tried (rtol = atol): half decades from 1e-2, SciPy decades from 1e-3, down"
            " to 1e-12 or until the smallest error is met",
            "failures: at how many of the tolerances tried, and between which; runs of more than"
            " 1 s are timed once",
        ],
    )
    solvers = {OURS: ours} | rivals
    with one_core():
        for name, problem in lone().items():
            _one_problem(part, name, problem, solvers)
    return part


def _one_problem(part, name, problem, solvers):
    for solver in solvers.values():
        solver(problem, 1e-3)  # warm
    targets = TARGETS if name in QUASI_HARMONIC else TARGETS[:2]
    tried = {
        key: scan(solver, problem, COARSE if key.startswith("SciPy") else FINE, min(targets))
        for key, solver in solvers.items()
    }
    best = {}
    for key, runs in tried.items():
        for target in targets:
            enough = [run for run in runs if run.error <= target]
            if enough:
                best[key, target] = min(enough, key=lambda run: run.seconds)
    jobs = {
        key: lambda s=solvers[key[0]], t=found.tol: s(problem, t)
        for key, found in best.items()
        if found.seconds < SLOW
    }
    seconds = {key: found.seconds for key, found in best.items()} | interleaved(jobs, most=1.5)
    for target in targets:
        label = f"{name}, {power(target)}"
        base = seconds[OURS, target]
        for key in solvers:
            if (key, target) not in best:
                part.add(name, power(target), key, "never", "-", "-", "-", faults(tried[key]))
                continue
            found, spent = best[key, target], seconds[key, target]
            row = [f"{spent / base:.2f}", f"{1e3 * spent:.2f}", power(found.tol)]
            part.add(name, power(target), key, *row, power(found.error), faults(tried[key]))
        _goals(part, name, label, base, seconds, target)


def _goals(part, name, label, base, seconds, target):
    lsoda = seconds.get(("numbalsoda LSODA", target))
    dop853 = seconds.get(("numbalsoda dop853", target))
    if name == "P1" and dop853 and target >= 1e-5:
        ratio = base / dop853
        asked = f"{label}: at most 1.5 times the time of numbalsoda's dop853"
        part.goal(asked, f"{ratio:.2f} times", ratio <= 1.5)
    if name in QUASI_HARMONIC and (heyoka := seconds.get(("heyoka", target))):
        ratio = base / heyoka
        part.goal(f"{label}: faster than heyoka", f"{ratio:.2f} times its time", ratio < 1.0)
    if name not in QUASI_HARMONIC and lsoda:
        ratio = lsoda / base
        asked = f"{label}: at least 4 times faster than numbalsoda's LSODA"
        part.goal(asked, f"{ratio:.1f} times", ratio >= 4.0)
