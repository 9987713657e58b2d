"""How often errors of `machine_stiffness` hold the truth: `python benchmarks/machine.py [NUMBER]`.

Of 200 records with two holds and a ring-down, in every second of them with correlated noise; some
minutes.  The faults have other a than is assumed, from half to twice of it, under both laws.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from report import CONSOLE, Table

import ratestate as rs

sys.path.insert(0, str(Path(__file__).parents[1] / "tests/helpers"))
from machine_records import SLIDER, clean, noisy

TRUTH = {"K": SLIDER.K, "M": SLIDER.M, "damping": 0.0}
#: the first seed: those below it have served to choose what is assumed, and in tests
FIRST = 7000
#: all with the same a - b
SLIDERS = [
    SLIDER.replace(a=float(a), b=float(a) - 0.002, law=("aging", "slip")[i % 2])
    for i, a in enumerate(np.geomspace(0.004, 0.016, 16))
]


def deviations(number):
    """(number, 3) of K, M and damping from the truth, in standard errors."""
    rows = []
    for seed in range(FIRST, FIRST + number):
        slider = SLIDERS[seed // 2 % len(SLIDERS)]
        data = noisy(seed, clean(slider), red=5e-5 * (seed % 2))
        result = rs.machine_stiffness(data, sigma="10 MPa", slider=slider)
        rows.append([float((result[k] - x) / result[f"{k}_error"]) for k, x in TRUTH.items()])
    return np.array(rows)


def main():
    parser = argparse.ArgumentParser(description="Coverage of the errors of machine_stiffness.")
    parser.add_argument("number", nargs="?", type=int, default=200, help="records")
    number = parser.parse_args().number
    table = Table("", "68 %", "95 %", "mean", title=f"Truth in {number} records")
    for name, z in zip(TRUTH, deviations(number).T, strict=True):
        within = [f"{100 * (np.abs(z) < reach).mean():.1f} %" for reach in (0.994, 1.96)]
        table.add_row(name, *within, f"{z.mean():+.2f}")
    CONSOLE.print(table)


if __name__ == "__main__":
    main()
