"""How often errors of `healing` hold the truth: `python benchmarks/healing.py [NUMBER]`.

Of 200 slide-hold-slide records of four holds each, under both of the paper's laws, with a drift,
and in every second of them with correlated noise; some minutes.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from report import CONSOLE, Table

import ratestate as rs

sys.path.insert(0, str(Path(__file__).parents[1] / "tests/helpers"))
from slide_hold_slide import SLIDER, noisy, truth


def deviations(number):
    """(number, holds, 2) of healing and relaxation from the truth, in standard errors."""
    rows = []
    for seed in range(number):
        slider = SLIDER.replace(law=("slip", "aging")[seed // 2 % 2])
        result = rs.healing(noisy(seed, slider=slider, red=2e-4 * (seed % 2), trend=2.0))
        found = np.stack([result.delta_mu, result.delta_mu_c], axis=-1)
        errors = np.stack([result.delta_mu_error, result.delta_mu_c_error], axis=-1)
        rows.append((found - truth(slider)) / errors)
    return np.array(rows)


def main():
    parser = argparse.ArgumentParser(description="Coverage of the errors of healing.")
    parser.add_argument("number", nargs="?", type=int, default=200, help="records")
    number = parser.parse_args().number
    z = deviations(number)
    table = Table("", "68 %", "95 %", "mean", "evaluated", title=f"Truth in {number} records")
    for k, name in enumerate(("healing", "relaxation")):
        for what, part in (("white", z[::2]), ("correlated", z[1::2]), ("all", z)):
            known = part[..., k][np.isfinite(part[..., k])]
            within = [f"{100 * (np.abs(known) < reach).mean():.1f} %" for reach in (0.994, 1.96)]
            share = f"{100 * known.size / part[..., k].size:.1f} %"
            table.add_row(f"{name}, {what}", *within, f"{known.mean():+.2f}", share)
    CONSOLE.print(table)


if __name__ == "__main__":
    main()
