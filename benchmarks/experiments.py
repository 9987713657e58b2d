"""Coverage of the fits of whole experiments: `python benchmarks/experiments.py [NUMBER]`.

Of 100 experiments of 10 steps, half of them of two states, with drift and with correlated noise
slower than the transient or faster, under the law of the truth and its rival.
"""

import argparse
import sys
import warnings
from pathlib import Path

import numpy as np
from report import CONSOLE, Table
from rich.progress import track

import ratestate as rs

sys.path.insert(0, str(Path(__file__).parents[1] / "tests/helpers"))
from synthetic_experiments import RIVALS, drawn_experiment

#: difference of AIC in a whole experiment from which the law counts as told
TOLD = 10.0


def main():
    parser = argparse.ArgumentParser(description="Coverage of the fits of experiments.")
    parser.add_argument("number", nargs="?", type=int, default=100, help="experiments")
    number = parser.parse_args().number
    warnings.simplefilter("ignore")
    holds: dict = {}
    told, wrong, failed, p_values = 0, 0, 0, []
    for seed in track(range(number), "experiments"):
        case = drawn_experiment(seed)
        law = case.truth.law
        result = rs.fit(case.data, case.start, case.free, law=RIVALS[law], per_step=True)
        aic = result.aic.sum("step")
        difference = float(aic.drop_sel(law=law).squeeze() - aic.sel(law=law))
        told += difference > TOLD
        wrong += difference < -TOLD
        right = result.sel(law=law)
        failed += int((right.status != 0).sum())
        p_values.append(float(right.shared_p_value))
        for name in case.free:
            truth = getattr(case.truth, name)
            interval = right.interval.sel(parameter=name).dropna("step", how="all")
            inside = (interval[..., 0] <= truth) & (truth <= interval[..., 1])
            states = "two states" if law.startswith("two") else "one state"
            for key in ("all", states, name):
                holds.setdefault(key, []).append(inside.values)
    table = Table(
        "", "68 %", "95 %", "intervals", title=f"Truth in the intervals of {number} experiments"
    )
    for what, each in holds.items():
        inside = np.concatenate(each)
        table.add_row(what, *(f"{100 * x:.1f} %" for x in inside.mean(axis=0)), str(len(inside)))
    CONSOLE.print(table)
    CONSOLE.print(
        f"law told rightly in {told} experiments, wrongly in {wrong}, undecided in "
        f"{number - told - wrong}; {failed} steps failed; p below 0.05 that one set serves: "
        f"{int(np.sum(np.array(p_values) < 0.05))} of {number}"
    )


if __name__ == "__main__":
    main()
