"""The GPU against two cores: `python benchmarks/gpu.py [--out DIR]`, where there is an NVIDIA GPU.

Fig. 3's ranges of M and V_lp in 316 x 316 = 99,856 cases, through `ratestate.sweep`.  Compiling is
not counted.  Prints its table; results.md and results.json are written again after each row,
because time on a GPU may be short.
"""

import argparse
import contextlib
import itertools
import os
import sys
from pathlib import Path

import numpy as np
from report import CONSOLE, Part, power, write
from timing import wall

import ratestate as rs
from ratestate.engine import cuda
from ratestate.paper.parameters import FIG2, FIG2_START, FIG3_M, FIG3_V_LP

SIDE, SIDE_CPU, SIDE_EXACT = 316, 32, 20  # of the grids that are timed, and of that compared
T_END = 10.0  # s, as in Fig. 3
EXACT = 1e-10
CLOSE = 1e-9  # what was asked for
REPETITIONS = 3
#: function -> what is compared: all that does not pass through 0
COMPARED = {
    "simulate": ["V", "theta", "V_max", "V_min"],
    "limit_cycle": ["period", "amplitude", "V_max", "V_min"],
}
METHODS = {"simulate": ["auto", "rodas5p"], "limit_cycle": ["auto"]}


def sweep(function, law, side, device, method, rtol=1e-6):
    """The sweep over a grid of this side."""
    slider = FIG2.replace(law=law, M=rs.logspace("M", *FIG3_M[:2], side))
    V_lp = rs.logspace("V_lp", *FIG3_V_LP[:2], side)
    settings = {"rtol": rtol, "device": device, "progress": False}
    if function == "limit_cycle":
        return rs.sweep(function, slider, V_lp=V_lp, **settings)
    loading = rs.Loading.constant(V_lp)
    settings |= {"loading": loading, "t_end": T_END, "V_start": FIG2_START, "method": method}
    return rs.sweep(function, slider, **settings)


@contextlib.contextmanager
def two_cores():
    """Keep this process on two cores, where the system can."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, sorted(before)[:2])
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


def rate(function, law, side, device, method):
    """Cases per second on the clock, the best of some: others' work only ever slows it."""
    times = [wall(lambda: sweep(function, law, side, device, method)) for _ in range(REPETITIONS)]
    return side**2 / min(times)


def difference(function, law, method):
    """Largest relative difference between the GPU and the CPU; cases with different fates."""
    gpu, cpu = (sweep(function, law, SIDE_EXACT, one, method, EXACT) for one in ("cuda", "cpu"))
    largest = 0.0
    for name in COMPARED[function]:
        off = np.abs(gpu[name] / cpu[name] - 1.0)
        largest = max(largest, float(off.max()))  # without the NaN of those that failed
    return largest, int((gpu.status != cpu.status).sum())


def run():
    """Yield the Part after each row."""
    part = Part(
        f"The GPU against 2 cores: Fig. 3's M and V_lp, {SIDE**2:,} cases, rtol 1e-6",
        ["function", "law", "method", "cases/s, GPU", "cases/s, 2 cores", "ratio", "difference"],
        text=3,
        notes=[
            f"best of {REPETITIONS}; 2 cores: on {SIDE_CPU**2:,} cases of the same ranges",
            f"difference: relative, at rtol {power(EXACT)}, of {SIDE_EXACT**2} cases;"
            f" {'; '.join(f'{name}: ' + ', '.join(x) for name, x in COMPARED.items())}",
        ],
    )
    for function, law in itertools.product(COMPARED, ("slip", "aging")):
        for method in METHODS[function]:
            off, fates = difference(function, law, method)  # and so all kernels are compiled
            on_gpu = rate(function, law, SIDE, "cuda", method)
            with two_cores():
                on_cpu = rate(function, law, SIDE_CPU, "cpu", method)
            rates = [f"{on_gpu:,.0f}", f"{on_cpu:,.0f}", f"{on_gpu / on_cpu:.1f}"]
            part.add(function, law, method, *rates, power(off))
            found = f"{power(off)}, {fates} other fates"
            goal = f"{function}, {law}, {method}: within {power(CLOSE)}"
            part.goal(goal, found, off <= CLOSE and not fates)
            yield part


def main():
    parser = argparse.ArgumentParser(description="Benchmark of ratestate on an NVIDIA GPU.")
    parser.add_argument("--out", type=Path, default=Path("build/bench-gpu"), help="where to write")
    options = parser.parse_args()
    try:
        cuda.check()
    except rs.ParameterError as error:
        sys.exit(f"error: {error}")
    for part in run():
        CONSOLE.print("  ".join(part.rows[-1]))
        write([part], options.out)
    part.show()
    CONSOLE.print(f"written to {options.out}")


if __name__ == "__main__":
    main()
