"""Synthetic experiments of many steps and holds, of which the truth is known."""

import numpy as np
import xarray
from synthetic_records import correlated

import ratestate as rs


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
