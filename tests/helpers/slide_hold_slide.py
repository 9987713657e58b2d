"""Synthetic slide-hold-slide records, of which healing and relaxation are known."""

import functools

import numpy as np
import xarray
from synthetic_records import correlated

import ratestate as rs

SLIDER = rs.SpringSlider(a=0.008, b=0.01, Dc="10 um", sigma="10 MPa", K="20 GPa/m", V0="10 um/s")
HOLDS = (3.0, 10.0, 30.0, 100.0)
V, SLIDE, DT = 1e-5, 30.0, 0.1


def loading_of(holds=HOLDS, slide=SLIDE, V_after=V):
    """Holds of these times [s] after slides; V_after : speed of reloading after each."""
    steps, t = [], slide
    for hold in holds:
        steps += [(t, 0.0), (t + hold, V_after)]
        t += hold + slide
    return rs.Loading.steps(V, *steps), t


@functools.cache
def clean(slider=SLIDER, holds=HOLDS, slide=SLIDE, V_after=V, dt=DT):
    """The record without noise, as a Dataset."""
    loading, end = loading_of(holds, slide, V_after)
    t = np.arange(0.0, end, dt)
    run = rs.simulate(slider, loading, float(t[-1]), times=t, rtol=1e-9)
    friction = (run.tau / slider.sigma).values
    columns = {"friction": ("time", friction), "delta_lp": ("time", run.delta_lp.values)}
    columns["slip"] = "time", (run.delta_lp - run.tau / slider.K).values
    columns |= {"segment_t": ("segment", loading.t), "segment_V": ("segment", loading.V)}
    return xarray.Dataset(columns, {"time": t})


@functools.cache
def truth(slider=SLIDER, holds=HOLDS, V_after=V, last=12.0):
    """(n, 2) healing and relaxation of the holds, each after steady sliding, by many samples.

    last : how long the slide after a hold is [s]
    """
    found = []
    for hold in holds:
        loading = rs.Loading.steps(V, (1.0, 0.0), (1.0 + hold, V_after))
        t = np.concatenate([[0.0, 1.0 + hold], 1.0 + hold + np.linspace(0.0, last, 24001)[1:]])
        run = rs.simulate(slider, loading, float(t[-1]), times=t, rtol=1e-10)
        friction = (run.tau / slider.sigma).values
        found.append([friction[1:].max() - friction[0], friction[0] - friction[1]])
    return np.array(found)


def noisy(seed, *, white=3e-4, red=0.0, time=0.5, trend=0.0, **record):
    """A record with noise and a drift of friction with fault slip [1/m]."""
    data, rng = clean(**record), np.random.default_rng(seed)
    noise = white * rng.normal(size=data.sizes["time"])
    noise += red * correlated(data.time.values, time, rng) if red else 0.0
    return data.assign(friction=data.friction + noise + trend * data.slip)
