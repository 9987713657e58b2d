"""(h) Fits of a velocity step: `fit`, beside lmfit on SciPy's solvers."""

from functools import partial
from typing import NamedTuple

import numpy as np
from fit_problems import FREE, NOISE, OFF, SAMPLES, Fitted, fit_problems
from fit_rivals import Model, fit_rivals
from report import Part, power
from timing import cpu, interleaved, one_core

import ratestate as rs
from ratestate.records.fitting.problem import search, with_best_level
from ratestate.records.fitting.unknowns import to_coordinate
from ratestate.records.kit.least_squares import single_blas

OURS, CALL = "least squares alone", "fit"
ENOUGH = 0.05  # standard errors: estimates as near as this to the exact ones will do
SLOW = 1.0  # CPU seconds beyond which one run is enough
LANES = 256  # sliders in a batch of evaluations
LEAST, MOST = 50, 100.0  # the goals: times lmfit, and CPU ms


def run(_rivals):
    """The Part."""
    start = ", ".join(f"{factor:g} {name}" for name, factor in OFF.items())
    part = Part(
        f"(h) CPU time of a fit: a velocity step in {SAMPLES:,} samples, slip law, one core",
        ["record", "how", "x alone", "CPU ms", "motions", "estimates off", "curve off"],
        text=2,
        notes=[
            f"sought are a, b, Dc, K and the level of friction; all begin at {start} of the truth;"
            f" white noise of {power(NOISE.white)}, known to all but fit itself",
            "least squares alone: what fit does from there on with that noise; fit itself also"
            " looks for starts, estimates the noise, checks how the record begins, and reports",
            "lmfit: leastsq with its own differences, the same residuals and coordinates; SciPy at"
            " this rtol = atol; equations compiled, with their Jacobian, unless in Python",
            "motions: how many were computed; estimates off: from those at rtol 1e-12, the largest"
            " in standard errors; curve off: largest error of friction where the search ends",
            f"medians of jobs that take turns; what takes more than {SLOW:g} s is timed once",
        ],
    )
    with one_core(), single_blas():
        for name, problem in fit_problems().items():
            _one_problem(part, name, problem)
            _evaluations(part, name, problem)
            _posterior(part, name, problem)
    return part


def least_squares(problem):
    """The package's own, with nothing around it."""
    forward = problem.search.forward
    before = forward.evaluations
    point = search(problem.search, problem.start, NOISE).x
    motions = forward.evaluations - before
    return Fitted(point, motions, forward.friction(point[None])[0])


def called(problem, noise, errors="covariance"):
    """The Dataset of the public call."""
    keys = {"loading": problem.loading, "trend": None, "noise": noise, "errors": errors}
    return rs.fit(problem.data, problem.begin, FREE, **keys)


def whole(problem, noise):
    """The public call."""
    found = called(problem, noise)
    friction = found.friction_fit.values
    point = [*(to_coordinate(name, float(found[name])) for name in FREE), friction[0]]
    return Fitted(np.array(point), "-", friction)


#: how -> function of a FitProblem
OWN = {
    OURS: least_squares,
    f"{CALL}, noise given": partial(whole, noise=NOISE.white),
    CALL: partial(whole, noise=None),
}


class Tried(NamedTuple):
    """One fit: CPU seconds, motions computed, how far off estimates and curve are."""

    seconds: float
    motions: object
    off: float  # standard errors
    curve: float  # of friction


def tried(problem, fit):
    """A first run."""
    exact, errors = problem.best
    kept = []
    seconds = cpu(lambda: kept.append(fit(problem)))
    point, motions, friction = kept[0]
    off = np.abs((point - exact) / errors).max()
    return Tried(seconds, motions, off, np.abs(friction - problem.exact(point)).max())


def _one_problem(part, name, problem):
    """The rows of one record, and its goals."""
    rivals = fit_rivals()
    for fit in OWN.values():  # warm
        fit(problem)
    for rival in rivals.values():
        Model(problem, rival).friction(problem.start)
    fits = OWN | {how: rival.fitted for how, rival in rivals.items()}
    found = {how: tried(problem, fit) for how, fit in fits.items()}
    jobs = {how: lambda f=fit: f(problem) for how, fit in fits.items() if found[how].seconds < SLOW}
    seconds = {how: one.seconds for how, one in found.items()} | interleaved(jobs)
    base = seconds[OURS]
    for how, (_, motions, off, curve) in found.items():
        row = [f"{seconds[how] / base:.3g}", f"{1e3 * seconds[how]:.3g}", motions]
        part.add(name, how, *row, f"{off:.2g}", power(curve))
    for how in (OURS, CALL):
        ms = 1e3 * seconds[how]
        part.goal(f"{name}, {how}: under {MOST:g} ms", f"{ms:.0f} ms", ms < MOST)
    near = {
        how: seconds[how] / base
        for how in rivals
        if "solve_ivp" in how and found[how].off <= ENOUGH
    }
    fastest = min(near, key=near.get)
    asked = f"{name}: at least {LEAST} times lmfit on solve_ivp, its fastest within {ENOUGH:g}"
    part.goal(asked, f"{near[fastest]:.0f} times ({fastest})", near[fastest] >= LEAST)


def _evaluations(part, name, problem):
    """What a search and a sampler are made of, as a note."""
    point = problem.best[0]
    many = np.repeat(point[None], LANES, axis=0)
    jobs = {
        "jacobian": lambda: problem.search.whitened(point, NOISE),
        "alone": lambda: problem.search.difference(point[None]),
        "lanes": lambda: with_best_level(problem.search, many),
    }
    seconds = interleaved(jobs)
    part.notes.append(
        f"{name}: residual and Jacobian {1e3 * seconds['jacobian']:.2f} ms; evaluations of the"
        f" likelihood per CPU second: {1 / seconds['alone']:,.0f} alone,"
        f" {LANES / seconds['lanes']:,.0f} in batches of {LANES}"
    )


def _posterior(part, name, problem):
    """What a posterior takes."""
    kept = []
    seconds = cpu(lambda: kept.append(called(problem, None, "posterior")))
    evaluations = int(kept[0].posterior_evaluations)
    each = seconds / evaluations
    part.notes.append(
        f"{name}: a posterior of {evaluations:,} evaluations took {seconds:.1f} CPU s"
    )
    asked = f"{name}: 10,000 evaluations of a posterior under 30 s"
    part.goal(asked, f"{1e4 * each:.1f} s", 1e4 * each < 30.0)
