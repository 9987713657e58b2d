"""(c) Fig. 3's 156 cases: how many seconds of sliding a CPU second buys."""

import numpy as np
from problems import fig3
from report import Part, power
from timing import cpu, interleaved, one_core, wall

import ratestate

MEDIAN = 1e-5  # the median error asked for
FAST = 10.0  # of eta = eta0 w_lp**2: cases of Fig. 3 below it are not stiff near V = V_lp
TOLERANCES = 10.0 ** np.arange(-4.0, -8.1, -0.25)
# Looser ones leave a larger error, and take seconds to say so.
TOLERANCES_LSODA = {
    "slip": 10.0 ** np.arange(-9.0, -10.6, -0.25),
    "aging": 10.0 ** np.arange(-9.25, -10.6, -0.25),
}


def loosest(solve, problem, tolerances):
    """The loosest tolerance whose median error is at most `MEDIAN`; that, all errors, CPU seconds.

    A case without an answer counts as an infinite error.
    """
    for tol in tolerances:
        found = []
        seconds = cpu(lambda t=tol, f=found: f.append(solve(t)))
        errors = np.nan_to_num(problem.errors(found[0]), nan=np.inf)
        if np.median(errors) <= MEDIAN:
            return tol, np.median(errors), errors, seconds
    return None


def run(rivals):
    """The Part."""
    part = Part(
        "(c) Fig. 3, 12 x 13 cases of 10 s: case-seconds per CPU-second at median error 1e-5",
        ["law", "how", "case-s per CPU-s", "CPU s", "tolerance", "median error", "worst", "failed"],
        text=2,
        notes=[
            "simulate: the public call, with extremes, energy and the Dataset; engine: without"
            " these, through the same march",
            "tolerance: the loosest quarter decade with median error at most 1e-5; errors against"
            " rtol 1e-12; a failed case counts as infinite; LSODA is timed once",
        ],
    )
    for law in ("slip", "aging"):
        _one_law(part, law, rivals.get("numbalsoda LSODA"))
        if "heyoka" in rivals:
            _fast_half(part, law, rivals["heyoka"])
    return part


def _fast_half(part, law, heyoka):
    """Cases of which inertia is not small, beside heyoka; for it the others are stiff."""
    whole = fig3(law)
    p, _ = whole.numbers()
    problem = whole.part(np.flatnonzero(p[:, 2] * p[:, 4] ** 2 < FAST))
    total = problem.n * problem.t_end
    with one_core():
        heyoka(problem, 1e-2)  # warm
        found = {
            "engine": loosest(lambda t: problem.job(t)().final[problem.which], problem, TOLERANCES),
            "heyoka": loosest(lambda t: heyoka(problem, t)[0], problem, TOLERANCES),
        }
        jobs = {
            "engine": problem.job(found["engine"][0]),
            "heyoka": lambda: heyoka(problem, found["heyoka"][0]),
        }
        seconds = interleaved(jobs, repetitions=5, most=4.0)
    for name, (tol, median, errors, _) in found.items():
        row = [f"{total / seconds[name]:,.0f}", f"{seconds[name]:.3f}", power(tol), power(median)]
        worst = power(errors[np.isfinite(errors)].max())
        label = f"{name}, {problem.n} cases with eta < {FAST:g}"
        part.add(law, label, *row, worst, np.isinf(errors).sum())
    ratio = seconds["heyoka"] / seconds["engine"]
    part.goal(f"{law}, eta < {FAST:g}: faster than heyoka", f"{ratio:.1f} times", ratio > 1.0)


def _one_law(part, law, lsoda):
    problem = fig3(law)
    total = problem.n * problem.t_end
    tol, median, errors, _ = loosest(lambda t: problem.job(t)().final, problem, TOLERANCES)
    results = {"engine": (tol, median, errors), "simulate": (tol, median, errors)}
    jobs = {"engine": problem.job(tol), "simulate": lambda: simulate(problem, tol)}
    if lsoda:
        with one_core():
            lsoda(problem, 1e-2)  # warm
            chosen = loosest(lambda t: lsoda(problem, t)[0], problem, TOLERANCES_LSODA[law])
        if chosen:
            results["numbalsoda LSODA"] = chosen[:3]
        else:
            part.add(law, "numbalsoda LSODA", "never", *["-"] * 5)
    with one_core():
        cpu(jobs["simulate"])  # warm
        seconds = interleaved(jobs, repetitions=5, most=4.0)
    if "numbalsoda LSODA" in results:
        seconds["numbalsoda LSODA"] = chosen[3]
    for name, spent in seconds.items():
        tol_used, middle, errors = results[name]
        row = [f"{total / spent:,.0f}", f"{spent:.3f}", power(tol_used), power(middle)]
        part.add(law, name, *row, power(errors[np.isfinite(errors)].max()), np.isinf(errors).sum())
    clock = np.median([wall(jobs["simulate"]) for _ in range(3)])
    part.notes.append(
        f"{law}: simulate on all cores: {total / clock:,.0f} case-seconds per second on the clock"
        f" ({clock:.3f} s)"
    )
    for name in ("engine", "simulate"):
        rate = total / seconds[name]
        part.goal(f"{law}, {name}: at least 6,000", f"{rate:,.0f}", rate >= 6000)


def simulate(problem, rtol):
    """The public call."""
    loading = ratestate.Loading.constant(problem.V_lp)
    return ratestate.simulate(
        problem.slider, loading, problem.t_end, V_start=problem.V_start, rtol=rtol
    )
