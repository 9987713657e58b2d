"""(a) Time of an accepted step, step control, events and refill included."""

from problems import fig3, lone
from report import Part
from timing import interleaved, one_core

from ratestate.engine.model import NUMBERS
from ratestate.friction.laws import LAWS

STEPS, REJECTED = NUMBERS.index("steps"), NUMBERS.index("rejected")


def run(_rivals):
    """The Part."""
    part = Part(
        "(a) CPU time of an accepted step per slider, rtol 1e-6, one core",
        ["what", "ns", "ns with extremes", "steps", "of them rejected"],
    )
    problems = {f"in lanes, Fig. 3, {law} law": fig3(law) for law in LAWS}
    problems |= {f"alone, {name}": problem for name, problem in lone().items()}
    jobs = {
        (name, observe): problem.job(observe=observe)
        for name, problem in problems.items()
        for observe in (0.0, 1.0)
    }
    with one_core():
        counts = {key: job().numbers.sum(axis=0) for key, job in jobs.items()}  # and warm
        seconds = interleaved(jobs, repetitions=5)
    ns = {key: 1e9 * seconds[key] / counts[key][STEPS] for key in jobs}
    for name in problems:
        steps, rejected = counts[name, 0.0][[STEPS, REJECTED]]
        plain, observed = ns[name, 0.0], ns[name, 1.0]
        share = f"{rejected / (steps + rejected):.1%}"
        part.add(name, f"{plain:.0f}", f"{observed:.0f}", f"{int(steps):,}", share)
    part.notes.append(
        "the time of rejected steps is counted; extremes: those of V and of |tau - mu|"
    )
    for where, most in (("in lanes", 55), ("alone", 200)):
        for name in problems:
            if name.startswith(where):
                found = f"{ns[name, 0.0]:.0f} ns"
                part.goal(f"{name}: at most {most} ns", found, ns[name, 0.0] <= most)
    return part
