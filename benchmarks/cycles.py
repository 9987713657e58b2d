"""(f) Limit cycles over the atlas: `limit_cycle`, beside marching, SciPy and a branch.

Everything is for b/a = 2; a slider is its K/K_c_qs and eta, and a cycle exists below K_c (but for
a strip beside it, which the samples leave out).
"""

import time

import numpy as np
from cycle_problems import (
    BASE,
    ETA,
    EXACT,
    SIDE,
    STIFFNESS,
    V_LP,
    atlas,
    cycle,
    listed,
    many,
    sample,
    sliders,
    truth,
)
from cycle_rivals import MOST_PERIODS, case_of, collocation, marched, shooting
from report import Part, power
from timing import cpu, interleaved, one_core

import ratestate as rs
from ratestate.dynamics.cycles.attractor import find_attractors, steady_start
from ratestate.dynamics.cycles.system import one_length_system
from ratestate.paper.parameters import FIG2

LAWS = ("slip", "aging")
ETA_SCIPY = 1e-6, ETA[1]  # below, (tau/sigma - mu)/eta drowns in rounding
SOFT = (0.03, 0.003)  # 1 - K/K_c of the soft cycles


def run(_rivals):
    """The Part."""
    part = Part(
        "(f) CPU time of a limit cycle, over the atlas: b/a = 2,"
        f" K/K_c_qs {STIFFNESS[0]:g} to {STIFFNESS[1]:g}, eta {power(ETA[0])} to {ETA[1]:g}",
        ["cycles", "law", "how", "found", "CPU ms", "x limit_cycle", "median error", "worst"],
        text=3,
        notes=[
            "CPU ms: per cycle found; x limit_cycle: in lanes, on the same cycles; error: of"
            " period and amplitude, the larger, against rtol 1e-10",
            "marching: simulate from V_lp/10, rtol 1e-7, in stretches of 3, 3, 6, 12, ... true"
            " periods, until the last cycles of two stretches agree to 1e-6; near K_c that leaves"
            f" larger errors, and some do not get there in {MOST_PERIODS:,} periods",
            "SciPy starts 10 % off the answer, solve_bvp from all of its waveform, with compiled"
            " rates and Jacobians; what it does not find costs it nothing",
            "jobs take turns, medians of 3 (grid: 5); what takes seconds is timed once",
        ],
    )
    for law in LAWS:
        cycle(listed(law, *sample(20, 0)))  # warm
    for law in LAWS:
        _atlas(part, law)
    with one_core():
        for law in LAWS:
            _marching(part, law)
        ratios = [_scipy(part, law) for law in LAWS]
    for name in list(SOLVED)[1:]:
        least = min(ratio[name] for ratio in ratios)
        part.goal(f"at least 100 times {name}, both laws", f"{least:.0f} times", least >= 100)
    _branches(part)
    return part


def _row(part, cycles, law, how, seconds, base, found, exact):
    """A row for CPU seconds spent on cycles whose period and amplitude are found (2, n)."""
    errors = np.abs(found / exact - 1.0).max(axis=0)
    got = np.isfinite(errors)
    ms = 1e3 * seconds / got.sum()
    numbers = [f"{ms:.3g}", f"{ms / base:.3g}"]
    part.add(cycles, law, how, f"{got.sum()} of {got.size}", *numbers, *_errors(errors[got]))


def _errors(errors):
    return power(np.median(errors)), power(errors.max())


def _atlas(part, law):
    """Speed and true error of `limit_cycle` on the grid."""
    slider, times = atlas(law), []
    for _ in range(5):
        clock, start = time.perf_counter(), time.process_time()
        found = cycle(slider)
        times.append((time.perf_counter() - clock, time.process_time() - start))
    clock, spent = np.median(times, axis=0)
    cycles = int((found.status == 0).sum())
    some = listed(law, *sample(400, 1))
    quick = cycle(some)
    errors = np.abs(np.stack([quick.period, quick.amplitude]) / truth(some) - 1.0).max(axis=0)
    part.add(
        f"atlas, {SIDE} x {SIDE}",
        law,
        "limit_cycle, lanes",
        f"{cycles:,}",
        f"{1e3 * spent / cycles:.3g}",
        "1",
        *_errors(errors),
    )
    rate = cycles / clock
    part.notes.append(
        f"{law}: {found.status.size / clock:,.0f} cases, {rate:,.0f} cycles per second on the"
        f" clock, {spent / clock:.1f} cores busy; repetitions {times_of(times)} s;"
        f" per CPU-second {cycles / spent:,.0f} cycles"
    )
    part.goal(f"{law}: at least 2,000 cycles per second", f"{rate:,.0f}", rate >= 2000)
    part.goal(f"{law}: a million cycles in under 240 s", f"{1e6 / rate:.0f} s", 1e6 / rate < 240)
    worst = errors.max()
    part.goal(f"{law}: every error at most 1e-6", power(worst), worst <= 1e-6)


def times_of(times):
    """The fastest and the slowest repetition [s on the clock], in words."""
    clocks = [clock for clock, _ in times]
    return f"{min(clocks):.2f} to {max(clocks):.2f}"


def _marching(part, law):
    """Marching until cycles repeat, on a sample of the grid and on soft cycles."""
    eta = np.geomspace(1.0, 100.0, 16)
    places = {"atlas, a sample": sample(128, 2)}
    places |= {f"soft, K = {1 - d:g} K_c": ((1 - d) * (1.0 + eta), eta) for d in SOFT}
    for name, (K, eta) in places.items():
        slider = listed(law, K, eta)
        exact = truth(slider)
        kept = {}
        jobs = {
            "marching": lambda s=slider, T=exact[0], k=kept: k.update(found=marched(s, V_LP, T)),
            "limit_cycle": lambda K=K, eta=eta: cycle(many(law, K, eta)),
        }
        seconds = interleaved(jobs, repetitions=3, most=1.5)
        base = 1e3 * seconds["limit_cycle"] / many(law, K, eta).K.size
        how = "marching, lanes"
        _row(part, name, law, how, seconds["marching"], base, kept["found"], exact)


def _scipy(part, law):
    """SciPy, and `limit_cycle` one at a time; what it takes -> ratio to `limit_cycle` in lanes."""
    n = max(few for few, _ in SOLVED.values())
    K, eta = sample(n, 3, ETA_SCIPY)
    exact = truth(listed(law, K, eta)) / [[1.0], [BASE.a]]
    system = one_length_system(law, K, np.full(n, 2.0), eta, np.full(n, np.inf))
    points = find_attractors(system, steady_start(system), EXACT, None).u
    cases = [
        case_of(sliders(law, K[i], eta[i]), system.at([i]), points[i], T)
        for i, T in enumerate(exact[0])
    ]
    ratios = {}
    for how, (few, way) in SOLVED.items():
        found = np.transpose([way(case) for case in cases[:few]])
        solved = np.flatnonzero(np.isfinite(found[0]))
        same = many(law, K[solved], eta[solved])
        jobs = {
            how: lambda w=way, s=solved: [w(cases[i]) for i in s],
            "lanes": lambda m=same: cycle(m),
        }
        seconds = interleaved(jobs, repetitions=3)
        base = 1e3 * seconds["lanes"] / same.K.size
        where = f"atlas, eta > {power(ETA_SCIPY[0])}"
        _row(part, where, law, how, seconds[how], base, found, exact[:, :few])
        ratios[how] = 1e3 * seconds[how] / solved.size / base
    return ratios


def alone(case):
    """`limit_cycle` for one slider: period and amplitude of x."""
    found = cycle(case.slider)
    return float(found.period), float(found.amplitude) / BASE.a


#: how -> on how many cycles, and the function of a Case
SOLVED = {
    "limit_cycle, alone": (6, alone),
    "SciPy Radau, shooting": (6, shooting),
    "SciPy solve_bvp": (24, collocation),
}


def _branches(part):
    """Seconds that branches take, as notes."""
    for law, slider, start, stop in (
        ("slip", FIG2, 1.0, 1e-3),
        ("aging", FIG2.replace(law="aging", K=1.01 * FIG2.K_c_qs), 1e-2, 1e-4),
    ):
        kept = []

        def job(slider=slider, start=start, stop=stop, kept=kept):
            kept.append(rs.continue_cycle(slider, "V_lp", start, stop))

        seconds = np.median([cpu(job) for _ in range(3)])
        special = [name for name in kept[-1].special.values if name not in ("", "start", "stop")]
        part.notes.append(
            f"continue_cycle, {law}, K = {slider.K / slider.K_c_qs:g} K_c_qs, V_lp {start:g} to"
            f" {stop:g} m/s: {kept[-1].point.size} points, {seconds:.2f} CPU s;"
            f" on it {', '.join(special)}"
        )
