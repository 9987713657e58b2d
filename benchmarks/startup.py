"""(e) Start: importing, the first run with an empty cache, a warm process, a second call."""

import os
import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from problems import own_parameters
from report import Part
from timing import wall

from ratestate.friction.laws import LAWS

README = Path(__file__).parent.parent / "README.md"
REPETITIONS = 3
SLIDER = {"a": 0.003, "b": 0.006, "Dc": 1e-5, "sigma": 2e6, "K": 9e8, "M": 3e3}

IMPORT = """
import time
start = time.perf_counter()
import ratestate
print(time.perf_counter() - start)
"""
FIRST = """
import time
import ratestate as rs
slider = rs.SpringSlider(**{slider})
start = time.perf_counter()
rs.simulate(slider, rs.Loading.constant(3e-3), 0.1, V_start=3e-4)
print(time.perf_counter() - start)
"""
SECOND = """
import time
start = time.perf_counter()
{run}
print(time.perf_counter() - start)
"""


def quick_start():
    """The README's first block of Python, whole, and what precedes its limit cycle, and that."""
    block = re.search(r"```python\n(.*?)```", README.read_text(), re.DOTALL).group(1)
    before, cycle = re.match(r"(.*?)^(cycle\s*=[^\n]*)$", block, re.DOTALL | re.MULTILINE).groups()
    return block, before, cycle


def python(code, **environment):
    """What a new Python prints."""
    kept = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
    command = [sys.executable, "-c", code]
    done = subprocess.run(
        command, env=kept | environment, capture_output=True, text=True, check=True
    )
    return done.stdout


def median(job):
    return statistics.median(job() for _ in range(REPETITIONS))


def first_call(law):
    """Seconds of the first `simulate` under a law, by name, with an empty cache."""
    code = FIRST.format(slider=SLIDER | own_parameters(law) | {"law": law})
    with tempfile.TemporaryDirectory() as folder:
        return float(python(code, XDG_CACHE_HOME=folder))


def run(_rivals):
    """The Part."""
    block, before, first = quick_start()
    python(before + first)  # warm: kernels of these sources are in the cache
    with tempfile.TemporaryDirectory() as folder:
        cold = wall(lambda: python(before + first, XDG_CACHE_HOME=folder))
    second = before + first + SECOND.format(run=first)
    found = {
        "import ratestate": (median(lambda: float(python(IMPORT))), 0.3),
        "first cycle, empty cache (whole process)": (cold, 20.0),
        "warm process, quick start up to its cycle": (
            median(lambda: wall(lambda: python(before + first))),
            1.2,
        ),
        "second limit_cycle in one process": (
            median(lambda: float(python(second).splitlines()[-1])),
            0.02,
        ),
        "warm process, the whole quick start": (wall(lambda: python(block)), None),
    }
    found |= {f"first simulate, empty cache, {law} law": (first_call(law), None) for law in LAWS}
    part = Part("(e) Start-up, seconds on the clock", ["what", "s"])
    for name, (seconds, most) in found.items():
        part.add(name, f"{seconds:.3f}")
        if most:
            part.goal(f"{name}: under {most:g} s", f"{seconds:.3f} s", seconds < most)
    part.notes.append("the quick start is the README's: a verdict, then a limit cycle")
    return part
