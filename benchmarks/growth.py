"""How a sweep's cost grows from 100 limit cycles to a million: `python benchmarks/growth.py`.

Each size runs in a process of its own, into a Zarr store, on all cores.  Writes growth.md,
growth.json and growth.png; a million take some minutes.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import matplotlib.pyplot as plt
from cycle_problems import RTOL, V_LP, sliders
from report import CONSOLE, environment

import ratestate as rs
from ratestate.dynamics.atlas import ETA

SIDES = (10, 32, 100, 316, 1000)
LAW = "slip"
STIFFNESS = (0.1, 0.99)  # K/K_c: all have a limit cycle


def one(side, folder):
    """Run a sweep of side x side cycles in this process, and print what it took, as JSON."""
    eta, ratio = rs.logspace("eta", *ETA, side), rs.logspace("K_over_K_c", *STIFFNESS, side)
    slider = sliders(LAW, ratio * (1.0 + eta), eta)
    store = Path(folder) / "x.zarr"
    clock, spent = time.perf_counter(), time.process_time()
    found = rs.sweep(rs.limit_cycle, slider, V_lp=V_LP, rtol=RTOL, store=store)
    clock, spent = time.perf_counter() - clock, time.process_time() - spent
    status = found.status.values
    files = [path for path in store.rglob("*") if path.is_file()]
    numbers = {
        "cases": side**2,
        "cycles": int((status == 0).sum()),
        "steady": int((status == 1).sum()),
        "failed": int((status > 1).sum()),
        "chunk": int(found.period.encoding["chunks"][0]) * side,
        "seconds": clock,
        "cpu_seconds": spent,
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024,
        "store": sum(path.stat().st_size for path in files),
        "files": len(files),
    }
    sys.stdout.write(json.dumps(numbers) + "\n")


def measured(side):
    """What `one` prints, in a fresh process; with the seconds of the whole of it."""
    with tempfile.TemporaryDirectory() as folder:
        begin = time.perf_counter()
        command = [sys.executable, __file__, "--one", str(side), folder]
        done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
        return json.loads(done.stdout) | {"process": time.perf_counter() - begin}


def table(rows):
    """The numbers in Markdown."""
    lines = [
        "| cases | cycles | steady | failed | s | s with start-up | ms a case | memory, MB |"
        " store, MB | files | cases a chunk |",
        "|" + " ---: |" * 11,
    ]
    for row in rows:
        cells = [
            *(f"{row[name]:,}" for name in ("cases", "cycles", "steady", "failed")),
            *(f"{row[name]:.1f}" for name in ("seconds", "process")),
            f"{1e3 * row['seconds'] / row['cases']:.3f}",
            *(f"{row[name] / 1e6:,.1f}" for name in ("memory", "store")),
            *(f"{row[name]:,}" for name in ("files", "chunk")),
        ]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def draw(rows, path):
    """Seconds against cases, with and without the start of the process."""
    cases = [row["cases"] for row in rows]
    fig, ax = plt.subplots(figsize=(4.6, 3.2), layout="constrained")
    for name, label, style in (
        ("process", "whole process, from its start", "s--"),
        ("seconds", "sweep into a store", "o-"),
    ):
        ax.loglog(cases, [row[name] for row in rows], style, color="k", mfc="w", label=label)
    rate = rows[-1]["cases"] / rows[-1]["seconds"]
    ax.loglog(cases, [n / rate for n in cases], color="0.6", lw=1, label=f"{rate:,.0f} cases/s")
    ax.set(xlabel="limit cycles", ylabel="time (s)")
    ax.legend(frameon=False)
    fig.savefig(path, dpi=200)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("build/growth"), help="folder")
    parser.add_argument("--most", type=int, default=SIDES[-1] ** 2, help="cases of the largest")
    parser.add_argument("--one", nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        one(int(options.one[0]), options.one[1])
        return
    options.out.mkdir(parents=True, exist_ok=True)
    rows = []
    for side in SIDES:
        if side**2 <= options.most:
            rows.append(measured(side))
            CONSOLE.print(rows[-1], highlight=False)
    record = {"environment": environment(), "rows": rows}
    (options.out / "growth.json").write_text(json.dumps(record, indent=1) + "\n")
    (options.out / "growth.md").write_text(table(rows))
    draw(rows, options.out / "growth.png")


if __name__ == "__main__":
    main()
