"""Whether errors that the package states are at least those that its answers have.

The truth comes from the same equations, solved by another method in 80-bit floating point
(precise.py, truth.c): it takes nothing from the package but where to begin.  Each cycle is found
with steps of two tolerances; an error below what these differ by is not seen, and passes.
"""

import argparse
import csv
import itertools
import time
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import numpy as np
from attractors import DC, SIGMA, V_LP, A, draw, slider_at
from precise import FINER, TOL, NoCycle, Real, Slider, Solver

import ratestate as rs
from ratestate.dynamics.continuation import family
from ratestate.dynamics.continuation.coexistence import folds
from ratestate.dynamics.cycles.limit_cycle import limit_cycle_call
from ratestate.friction.expressions import LIMIT

MEASURES = ("amplitude", "period", "V_max", "V_min")
ERRORS = ("error", "error", "V_max_error", "V_min_error")
# Limit cycles: rtol -> its share of them.
RTOLS = {1e-8: 0.6, 1e-6: 0.2, 1e-10: 0.2}
LOWEST = 5
BRANCHES = 16
FOLD_ERROR = 1e-4  # of K_fold/K_c - 1, as `folds` states it
# Slip law: canards, on which amplitudes change by 1e7 times what the stiffness does.
STEEP = Slider("slip", 0.01, 0.2388660833, 1e-5, 1e7, 0.0, 11757.21134, 1e-5)
# Sliders of docs/accuracy.md; period and amplitude of their cycles to the digits known otherwise.
QUASI_HARMONIC = (0.003, 0.006, 1e-5, 2e6, 900e6, 3000.0, 3.2e-3)
STICK_SLIP = (0.005, 0.008, 1e-5, 4e6, 0.96e9, 100.0)
REFERENCES = {
    "P1": (Slider("slip", *QUASI_HARMONIC), 0.019764896443215, 0.00123469636703),
    "P4a": (Slider("aging", *QUASI_HARMONIC), 0.019835727664857, 0.00229919602080),
    "P2": (Slider("slip", *STICK_SLIP, 1e-5), 29.97526508532, 0.061396405204),
    "P3": (Slider("slip", *STICK_SLIP, 1e-7), 4205.987027919, 0.089865449566),
    "P4b": (Slider("aging", *STICK_SLIP, 1e-5), 32.676591512, 0.07356797895),
}


class Compared(NamedTuple):
    """One answer of the package against the truth; arrays (4,) in the order of MEASURES."""

    group: str
    slider: Slider
    note: str
    stated: np.ndarray
    off: np.ndarray
    doubt: np.ndarray

    @property
    def ratios(self):
        """(4,) errors stated over true ones; inf where the truth cannot tell."""
        with np.errstate(divide="ignore"):
            return np.where(self.off > self.doubt, self.stated / self.off, np.inf)


class Missed(NamedTuple):
    """An answer for which no truth was found."""

    group: str
    slider: Slider
    note: str
    why: str


class Located(NamedTuple):
    """How far off the parameter of a special point is, relatively, and what is stated of it."""

    group: str
    slider: Slider
    note: str
    stated: float
    off: float


def in_SI(slider, measures):
    """(4,) MEASURES of what `Cycle.measures` has, SI but for V: ln(V/V_lp)."""
    a, Dc, V = Real(slider.a), Real(slider.Dc), Real(slider.V_lp)
    told = np.maximum(measures, [-np.inf, -np.inf, -LIMIT, -LIMIT])  # at rest
    return told + np.log(np.array([a, Dc / V, V, V]))


def compare(solver, group, slider, u, returns, answer, note=""):
    """`Compared` of an answer, name -> number, that begins at u = (psi, G); or `Missed`."""
    numbers = slider.numbers
    psi, G = map(Real, u)
    start = np.array([numbers[1] * psi + numbers[2] * G, psi])
    try:
        cycle = solver.cycle(slider.law, numbers, start, returns)
        finer = solver.cycle(slider.law, numbers, cycle.u, returns, FINER)
    except NoCycle as why:
        return Missed(group, slider, note, str(why))
    return against(group, slider, note, answer, finer.measures, cycle.measures)


def against(group, slider, note, answer, truth, rougher):
    """`Compared` of an answer with logarithms of the truth, found twice."""
    found = np.log(np.array([answer[name] for name in MEASURES], Real))
    with np.errstate(over="ignore"):
        off = np.abs(np.expm1(found - in_SI(slider, truth)))
    stated = np.array([answer[name] for name in ERRORS])
    doubt = 2.0 * np.abs(truth - rougher) + 1e-18
    return Compared(group, slider, note, stated, off.astype(float), doubt.astype(float))


def references(solver):
    """The reference values again, and how far two tolerances differ there."""
    print("Reference values (period, amplitude): relative differences; of two tolerances")
    for name, (slider, period, amplitude) in REFERENCES.items():
        call = limit_cycle_call(package_slider(slider), slider.V_lp, rtol=1e-10)
        _, found = call.find_cycles()
        answer = dict.fromkeys((*MEASURES, *ERRORS), 1.0)
        answer |= {"period": period, "amplitude": amplitude}
        one = compare(solver, name, slider, found["u"][0], 1, answer)
        print(f"  {name:4s} {one.off[1]:8.1e} {one.off[0]:8.1e}; {one.doubt[:2].max():8.1e}")


def package_slider(slider):
    """The package's own `SpringSlider`."""
    return rs.SpringSlider(**{k: v for k, v in slider._asdict().items() if k != "V_lp"})


def limit_cycles(solver, count, rng):
    """Random sliders that have a cycle: yields `Compared` or `Missed`."""
    for law in ("slip", "aging"):
        for rtol, share in RTOLS.items():
            wanted = round(0.5 * count * share)
            while wanted > 0:
                drawn = draw(3 * wanted + 20, rng, law)
                call = limit_cycle_call(drawn, V_LP, rtol=rtol)
                status, found = call.find_cycles()
                result = call.dataset(call.variables(status, found))
                which = np.flatnonzero(status == 0)[:wanted]
                wanted -= len(which)
                for i in which:
                    one = slider_at(drawn, i)
                    slider = Slider(
                        law, A, float(one.b), DC, SIGMA, float(one.K), float(one.M), V_LP
                    )
                    answer = {name: float(result[name][i]) for name in (*MEASURES, *ERRORS)}
                    returns = int(result.returns[i])
                    note = f"rtol {rtol:g}, {returns} returns"
                    yield compare(solver, law, slider, found["u"][i], returns, answer, note)


@contextmanager
def recorded():
    """A list of what `Family.measures` finds: the points' u, which results leave out."""
    kept, measures = [], family.Family.measures

    def measured(self, points, exact):
        kept.append(measures(self, points, exact))
        return dict(kept[-1])

    family.Family.measures = measured
    try:
        yield kept
    finally:
        family.Family.measures = measures


class Asked(NamedTuple):
    """A branch."""

    slider: Slider
    parameter: str
    start: float
    stop: float
    rtol: float


def ordinary(rng):
    """Without end, branches anywhere, the steep one first: yields `Asked`."""
    K_c = float(package_slider(STEEP._replace(K=1.0)).K_c(STEEP.V_lp))
    yield Asked(STEEP._replace(K=K_c), "K", 0.9 * K_c, 1.1 * K_c, 1e-8)
    for n in itertools.count():
        law, parameter = ("slip", "aging")[n % 2], ("K", "V_lp", "M")[n % 3]
        rtol = (1e-8, 1e-6, 1e-8, 1e-10)[n // 2 % 4]
        beta, eta = 1.0 + 10 ** rng.uniform(-1.5, 1.5), 10 ** rng.uniform(-6, 3)
        part = rng.uniform(0.5, 0.98)
        slider = scaled(law, beta, eta, part * (1.0 + eta))
        reach = {"K": 1.1 / part, "V_lp": 10 ** rng.uniform(-1, 1), "M": 10 ** rng.uniform(-2, 2)}
        start = getattr(slider, parameter)
        yield Asked(slider, parameter, start, reach[parameter] * start, rtol)


def peculiar(rng):
    """Without end, branches that fold (aging law) or on which periods double: yields `Asked`."""
    while True:
        beta, eta = 1.0 + 10 ** rng.uniform(-1.5, 1.4), 10 ** rng.uniform(-4, 0)
        slider = scaled("aging", beta, eta, 0.9 * (1.0 + eta))
        yield Asked(slider, "K", slider.K, 1.2 * slider.K, 1e-8)
        slider = scaled("slip", 10 ** rng.uniform(0.9, 1.5), 30.0, rng.uniform(1.0, 1.3))
        yield Asked(slider, "V_lp", slider.V_lp, 0.01 * slider.V_lp, 1e-8)


def scaled(law, beta, eta, of_K_c_qs):
    """The `Slider` with these b/a, eta and K/K_c_qs."""
    K = of_K_c_qs * (beta - 1.0) * A * SIGMA / DC
    return Slider(law, A, A * beta, DC, SIGMA, K, eta * A * SIGMA * DC / V_LP**2, V_LP)


def followed(asked):
    """The branch's dataset without Hopf points, and u (n, 2) of its points; (None, why) if none."""
    slider = package_slider(asked.slider)
    V_lp = {} if asked.parameter == "V_lp" else {"V_lp": asked.slider.V_lp}
    with recorded() as kept:
        try:
            branch = rs.continue_cycle(
                slider, asked.parameter, asked.start, asked.stop, rtol=asked.rtol, **V_lp
            )
        except rs.NotConverged as stopped:
            branch = stopped.best
        except rs.ParameterError as error:
            return None, str(error)
    if branch is None or not kept:
        return None, "no branch"
    return branch.isel(point=branch.special.values != "hopf"), kept[-1]["u"]


def branch_points(solver, branches, each, least):
    """So many points of each of some branches, and special ones: yields `Compared` and the like.

    branches : of `Asked`, of which as many are followed as it takes to get to `least` points
    """
    for asked in branches:
        if least <= 0:
            break
        branch, u = followed(asked)
        if branch is None:
            continue
        special = branch.special.values
        chosen = np.isin(special, list(SPECIAL))
        chosen[np.linspace(0, len(chosen) - 1, min(len(chosen), each)).round().astype(int)] = True
        least -= int(chosen.sum())
        for i in np.flatnonzero(chosen):
            yield from point_of(solver, asked, branch.isel(point=i), u[i])


def point_of(solver, asked, point, u):
    """A point of a branch against the truth, and the place of a special one."""
    special = str(point.special.values)
    slider = asked.slider.at(asked.parameter, float(point[asked.parameter]))
    answer = {name: float(point[name]) for name in (*MEASURES, *ERRORS)}
    multiplier = f"multiplier {float(point.multipliers[0].real):.3g}"
    note = f"{asked.parameter} at rtol {asked.rtol:g}, {special} {multiplier}"
    if special in SPECIAL:
        yield from special_point(solver, special, slider, asked.parameter, u, answer, note)
    if special != "fold":
        yield compare(solver, f"{slider.law}, branch", slider, u, 1, answer, note)


#: special -> what of a `Cycle` vanishes there
SPECIAL = {"fold": lambda cycle: cycle.turning, "period_doubling": lambda cycle: cycle.doubling}


def special_point(solver, special, slider, parameter, u, answer, note):
    """`Located`, and of a fold `Compared` with the cycle there; or `Missed`."""
    numbers, (psi, G) = slider.numbers, map(Real, u)
    start = np.array([numbers[1] * psi + numbers[2] * G, psi])
    given = (slider.law, numbers, start, parameter, SPECIAL[special])
    try:
        rougher, truth = (solver.special(*given, tol) for tol in (TOL, FINER))
    except NoCycle as why:
        yield Missed(special, slider, note, str(why))
        return
    yield Located(f"place of {special}", slider, note, np.nan, float(-np.expm1(truth.shift)))
    if special == "fold":
        there = slider.at(parameter, Real(getattr(slider, parameter)) * np.exp(truth.shift))
        yield against(special, there, note, answer, truth.measures, rougher.measures)


def stiffest(solver, count, rng):
    """Where limit cycles cease to coexist with stable sliding (`folds`): yields `Located`."""
    beta, eta = 1.0 + 10 ** rng.uniform(-2, np.log10(49), count), 10 ** rng.uniform(-5, 2, count)
    found = folds("aging", beta, eta)
    for i in np.flatnonzero(np.isfinite(found.kappa)):
        kappa = float(found.kappa[i])
        slider = Slider("aging", 1.0, float(beta[i]), 1.0, 1.0, kappa, float(eta[i]), 1.0)
        numbers, (psi, G) = slider.numbers, map(Real, found.u[i])
        start = np.array([numbers[1] * psi + numbers[2] * G, psi])
        K_c = (numbers[1] - 1) * (1 + numbers[2])
        try:
            fold = solver.special(slider.law, numbers, start, "K", SPECIAL["fold"])
        except NoCycle as why:
            yield Missed("K_fold/K_c - 1", slider, "", str(why))
            continue
        true = numbers[0] * np.exp(fold.shift) / K_c - 1
        off = float((numbers[0] / K_c - 1) / true - 1)
        yield Located("K_fold/K_c - 1", slider, f"it is {float(true):.3g}", FOLD_ERROR, off)


def gathered(cases, label, log):
    """All of them, told one by one to a log, with progress."""
    found, begin, told = [], time.perf_counter(), 0.0
    for case in cases:
        found.append(case)
        log.writerow(_row(case))
        passed = time.perf_counter() - begin
        if passed > told + 30.0:
            told = passed
            print(f"  {label}: {len(found):,} in {passed:.0f} s", flush=True)
    return found


def _row(case):
    values = [type(case).__name__, case.group, case.note, *case.slider]
    if isinstance(case, Compared):
        return [*values, *case.stated, *case.off, *case.doubt]
    return [*values, *case[3:]]


def summary(found):
    """Print what became of all cases, group by group."""
    for group in dict.fromkeys(case.group for case in found):
        part = [case for case in found if case.group == group]
        compared = [case for case in part if isinstance(case, Compared)]
        located = [case for case in part if isinstance(case, Located)]
        missed = [case for case in part if isinstance(case, Missed)]
        print(f"{group}: {len(compared) + len(located):,} compared, {len(missed)} without truth")
        for case in missed[:LOWEST]:
            print(f"    {case.why}: {case.note}, {tuple(case.slider)}")
        if compared:
            _print_ratios(compared)
        if located:
            _print_places(located)


def _print_ratios(compared):
    ratios = np.array([case.ratios for case in compared])
    both = ratios[:, :2].min(axis=1)
    rows = {"amplitude and period": both} | dict(zip(MEASURES, ratios.T, strict=True))
    for name, values in rows.items():
        seen = np.isfinite(values)
        least, median = values.min(), np.median(values)
        print(
            f"  {name:20s} error stated over true: least {least:.3g}, median {median:.3g}; "
            f"below 1: {(values < 1.0).sum()}; too small to see: {(~seen).sum()}"
        )
    worst = ratios.min(axis=1)
    for i in np.argsort(worst)[:LOWEST]:
        case, k = compared[i], int(ratios[i].argmin())
        print(
            f"    {worst[i]:.3g} ({MEASURES[k]}: stated {case.stated[k]:.3g}, true "
            f"{case.off[k]:.3g}, seen to {case.doubt[k]:.1g}) {case.note}, {tuple(case.slider)}"
        )


def _print_places(located):
    off = np.abs([case.off for case in located])
    print(f"  relative errors: median {np.median(off):.2g}, largest {off.max():.2g}")
    for i in np.argsort(-off)[:LOWEST]:
        case = located[i]
        print(f"    {off[i]:.2g} (stated {case.stated:.1g}) {case.note}, {tuple(case.slider)}")


def main():
    options = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    options.add_argument("--cycles", type=int, default=2000)
    options.add_argument("--points", type=int, default=500, help="of branches")
    options.add_argument("--special", type=int, default=30, help="folds and period doublings")
    options.add_argument("--stiffest", type=int, default=100, help="sliders asked for K_fold")
    options.add_argument("--seed", type=int, default=13)
    options.add_argument("--log", default="build/truth.csv", help="every case, in a file")
    asked = options.parse_args()
    solver = Solver()
    references(solver)
    rngs = [np.random.default_rng([asked.seed, k]) for k in range(3)]
    each = -(-asked.points // BRANCHES)
    parts = {
        "limit cycles": limit_cycles(solver, asked.cycles, np.random.default_rng(asked.seed)),
        "points of branches": branch_points(solver, ordinary(rngs[0]), each, asked.points),
        "special points": branch_points(solver, peculiar(rngs[1]), 0, asked.special),
        "stiffest cycles": stiffest(solver, asked.stiffest, rngs[2]),
    }
    with Path(asked.log).open("w", newline="") as file:
        log = csv.writer(file)
        for label, cases in parts.items():
            print(f"\n{label}", flush=True)
            summary(gathered(cases, label, log))


if __name__ == "__main__":
    main()
