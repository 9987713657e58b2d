"""Synthetic experiments of many steps and holds, of which the truth is known."""

from typing import NamedTuple

import numpy as np
import xarray
from synthetic_records import FREE, FREE_OF_TWO_STATES, correlated

import ratestate as rs

#: law of the truth -> the laws between which its experiment is to decide
RIVALS = {
    "slip": ("slip", "aging"),
    "aging": ("slip", "aging"),
    "two-state-slip": ("two-state-slip", "two-state-aging"),
    "two-state-aging": ("two-state-slip", "two-state-aging"),
}


def experiment(slider, speeds, distance, rows, *, drift=0.0, noise=0.0, red=0.0, time=1.0, seed=0):
    """What a laboratory would record of a slider, as a Dataset.

    speeds : of the load point [m/s], one after the other, each over `distance` [m]; a pair
        (0.0, t) is a hold of t [s]
    rows : samples at each of them
    drift : of friction with slip [1/m]
    noise, red, time : standard deviations of white and correlated noise, correlation time [s]
    """
    starts, times, begin = [], [], 0.0
    for speed in speeds:
        V, lasts = speed if isinstance(speed, tuple) else (speed, distance / speed)
        starts.append((begin, V))
        times.append(begin + np.arange(rows) * lasts / rows)
        begin += lasts
    t = np.concatenate(times)
    loading = rs.Loading.steps(starts[0][1], *starts[1:])
    run = rs.simulate(slider, loading, float(t[-1]), times=t, rtol=1e-9)
    rng = np.random.default_rng(seed)
    delta_lp = run.delta_lp.values
    friction = (run.tau / slider.sigma).values + drift * run.delta.values
    friction = friction + noise * rng.normal(size=t.size) + red * correlated(t, time, rng)
    variables = {"friction": ("time", friction), "delta_lp": ("time", delta_lp)}
    return xarray.Dataset(variables, {"time": t})


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
