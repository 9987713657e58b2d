"""The benchmark: `make bench`, or `python benchmarks/run.py [--out DIR] [part ...]`.

Medians of repetitions in which all contenders take turns; ratios first, times as context.
Prints its tables and writes results.md and results.json.  Compiling is never counted, but for the
cold start in (e).
"""

import argparse
import time
from pathlib import Path

import accuracy
import cycles
import fits
import scheme
import startup
import steps
import sweep
import sweeps
from report import CONSOLE, write
from rivals import heyoka_solver, numbalsoda_solvers, scipy_solvers

PARTS = {
    "a": steps,
    "b": accuracy,
    "c": sweep,
    "d": scheme,
    "e": startup,
    "f": cycles,
    "g": sweeps,
    "h": fits,
}


def main():
    parser = argparse.ArgumentParser(description="Benchmark of ratestate.")
    parser.add_argument("parts", nargs="*", help="a b c d e f g h; all by default")
    parser.add_argument("--out", type=Path, default=Path("build/bench"), help="folder to write to")
    options = parser.parse_args()
    if unknown := set(options.parts) - set(PARTS):
        parser.error(f"no such part: {' '.join(sorted(unknown))}; choose from {' '.join(PARTS)}")
    start = time.perf_counter()
    rivals = numbalsoda_solvers() | heyoka_solver()
    if len(rivals) < 3:
        CONSOLE.print(
            "numbalsoda or heyoka is not installed: left out (CONTRIBUTING.md says how to add them)"
        )
    rivals |= scipy_solvers()
    done = []
    for name in sorted(set(options.parts)) or PARTS:
        began = time.perf_counter()
        part = PARTS[name].run(rivals)
        part.notes.append(f"this part took {time.perf_counter() - began:.0f} s")
        part.show()
        done.append(part)
    write(done, options.out)
    goals = [goal for part in done for goal in part.goals]
    CONSOLE.print(f"{sum(goal.met for goal in goals)} of {len(goals)} goals met.")
    CONSOLE.print(f"{time.perf_counter() - start:.0f} s; written to {options.out}")


if __name__ == "__main__":
    main()
