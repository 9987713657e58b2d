"""Coverage of the fits of whole experiments: `python benchmarks/experiments.py [NUMBER]`.

Of 100 experiments of 10 steps, half of them of two states, with drift and with correlated noise
slower than the transient or faster, under the law of the truth and its rival.
"""

import argparse
import sys
import warnings
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray
from report import CONSOLE, Table
from rich.progress import track

import ratestate as rs

sys.path.insert(0, str(Path(__file__).parents[1] / "tests/helpers"))
from synthetic_experiments import experiment
from synthetic_records import FREE

FREE_OF_TWO_STATES = ("a", "b", "Dc", "b2", "Dc2", "K")
#: law of the truth -> the laws between which its experiment is to decide
RIVALS = {
    "slip": ("slip", "aging"),
    "aging": ("slip", "aging"),
    "two-state-slip": ("two-state-slip", "two-state-aging"),
    "two-state-aging": ("two-state-slip", "two-state-aging"),
}


class DrawnExperiment(NamedTuple):
    """An experiment drawn from a realistic range, its truth, and from where searches may begin."""

    truth: rs.SpringSlider
    start: rs.SpringSlider
    data: xarray.Dataset
    free: tuple


def drawn_experiment(seed, steps=10):
    """An experiment of so many steps up and down, with drift and correlated noise.

    Every second seed under one of the laws with two states.  Ranges: a 0.003 to 0.016, b/a 0.5 to
    1.6, Dc 2 to 50 um (with two states 1 to 20 um, and Dc2 8 to 15 times as long), sigma 2 to 50
    MPa, K 2 to 16 times what is unstable; speeds around 0.1 to 10 um/s, steps by 2.5 to 12; noise
    of 1 to 5 % of the direct effect, half to all of it correlated, over times from a few samples to
    several times the transient.  A slider that a step makes unstable is drawn again.
    """
    rng = np.random.default_rng(70_000 + seed)
    law = list(RIVALS)[seed % 4]
    two = law.startswith("two")
    while True:
        a, sigma, Dc, V = 10 ** rng.uniform((-2.5, 6.3, -5.7, -7), (-1.8, 7.7, -4.3, -5))
        values = {"a": a, "b": a * rng.uniform(0.5, 1.6), "Dc": Dc, "sigma": sigma, "V0": V}
        if two:
            values |= {"b": a * rng.uniform(0.4, 1.2), "Dc": 0.4 * Dc}
            values |= {"b2": a * rng.uniform(0.15, 0.6), "Dc2": 0.4 * Dc * rng.uniform(8, 15)}
        soft = rs.SpringSlider(**values, K=1.0, law=law)
        K = max(soft.K_c_qs, 0.15 * a * sigma / values["Dc"]) * 10 ** rng.uniform(0.3, 1.2)
        factor = 10 ** rng.uniform(0.4, 1.1)
        speeds = [
            V * (factor if i % 2 else 1.0) * 10 ** rng.uniform(-0.1, 0.1) for i in range(steps + 1)
        ]
        longest = values.get("Dc2", Dc)
        size = a * np.log(factor) * 10 ** rng.uniform(-2.0, -1.3)
        share = rng.uniform(0.5, 1.0)
        noise = {"noise": size * np.sqrt(1 - share), "red": size * np.sqrt(share)}
        noise["time"] = longest / V * 10 ** rng.uniform(-2.0, 0.7)
        drift = size / longest * rng.uniform(-0.3, 0.3)
        distance, rows = longest * rng.uniform(12, 25), int(rng.integers(700, 1400))
        truth = soft.replace(K=K)
        try:
            data = experiment(truth, speeds, distance, rows, drift=drift, seed=seed, **noise)
        except rs.QuasiStaticInstability:
            continue
        free = FREE_OF_TWO_STATES if two else FREE
        start = {name: getattr(truth, name) * 2.0 ** rng.normal(scale=0.7) for name in free}
        if two:
            start["Dc"], start["Dc2"] = sorted((start["Dc"], start["Dc2"]))
        return DrawnExperiment(truth, truth.replace(**start), data, free)


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
