"""Synthetic records of machines, of which stiffness, mass and damping are known."""

import functools

import numpy as np
import xarray
from synthetic_records import correlated

import ratestate as rs

#: a slider that rings at high speed, and loads its spring slowly after a hold
SLIDER = rs.SpringSlider(
    a=0.008, b=0.006, Dc="10 um", sigma="10 MPa", K="20 GPa/m", M=1e4, V0="10 um/s", law="aging"
)
SLOW = rs.Loading.steps("10 um/s", (10, 0), (60, "10 um/s"), (75, 0), (175, "10 um/s"))
FAST = rs.Loading.steps("3 cm/s", (0.05, "5 cm/s"))
#: as stiff as a biaxial machine: a step is over within some 15 samples
STIFF = rs.SpringSlider(
    a=0.0092, b=0.0097, Dc="9 um", sigma="20 MPa", K="145 GPa/m", mu0=0.61, V0="3 um/s"
)
STICK_SLIP = SLIDER.replace(b=0.014, K="3 GPa/m", M=1e3, law="slip")


@functools.cache
def clean(slider=SLIDER):
    """The record without noise: holds at low speed, then a step at high speed."""
    slow, fast = np.arange(0.0, 190.0, 0.02), np.arange(0.0, 0.35, 1e-4)
    parts = [(slow, SLOW), (fast, FAST)]
    runs = [rs.simulate(slider, how, float(t[-1]), times=t, rtol=1e-9) for t, how in parts]
    t = np.concatenate([slow, 190.0 + fast])
    friction = np.concatenate([run.tau.values / slider.sigma for run in runs])
    last = float(runs[0].delta_lp[-1]) + 2e-7
    delta_lp = np.concatenate([runs[0].delta_lp.values, last + runs[1].delta_lp.values])
    starts = np.concatenate([SLOW.t, 190.0 + FAST.t])
    columns = {"friction": ("time", friction), "delta_lp": ("time", delta_lp)}
    columns |= {"segment_t": ("segment", starts)}
    columns |= {"segment_V": ("segment", np.concatenate([SLOW.V, FAST.V]))}
    return xarray.Dataset(columns, {"time": t})


@functools.cache
def stick_slip(slider=STICK_SLIP, t_end=60.0):
    """A record of stick-slip without noise."""
    t = np.arange(0.0, t_end, 0.02)
    run = rs.simulate(
        slider, rs.Loading.constant("50 um/s"), t_end, V_start="20 um/s", times=t, rtol=1e-8
    )
    columns = {"friction": ("time", run.tau.values / slider.sigma)}
    columns |= {"delta_lp": ("time", run.delta_lp.values)}
    columns |= {"segment_t": ("segment", [0.0]), "segment_V": ("segment", [5e-5])}
    return xarray.Dataset(columns, {"time": t})


@functools.cache
def one_step():
    """A record of one step up in a stiff machine, without noise."""
    t = np.arange(0.0, 30.0, 0.01)
    how = rs.Loading.steps("3 um/s", (15.003, "10 um/s"))
    run = rs.simulate(STIFF, how, float(t[-1]), times=t, rtol=1e-8)
    columns = {"friction": ("time", run.tau.values / STIFF.sigma)}
    columns |= {"delta_lp": ("time", run.delta_lp.values)}
    columns |= {"segment_t": ("segment", how.t), "segment_V": ("segment", how.V)}
    return xarray.Dataset(columns, {"time": t})


def wandering(seed):
    """A record of steady sliding whose noise wanders."""
    rng, t = np.random.default_rng(seed), np.arange(0.0, 60.0, 0.05)
    noise = 1e-4 * rng.normal(size=t.size) + 3e-4 * correlated(t, 2.0, rng)
    columns = {"friction": ("time", 0.6 + noise), "delta_lp": ("time", 1e-5 * t)}
    columns |= {"segment_t": ("segment", [0.0]), "segment_V": ("segment", [1e-5])}
    return xarray.Dataset(columns, {"time": t})


def noisy(seed, data, *, white=1e-4, red=0.0):
    """A record with noise; the correlated part over 20 samples."""
    rng, n = np.random.default_rng(seed), data.sizes["time"]
    noise = white * rng.normal(size=n)
    # (sampling differs along the record, and the noise is that of an amplifier and a filter)
    noise += red * correlated(np.arange(n, dtype=float), 5.0, rng) if red else 0.0
    return data.assign(friction=data.friction + noise)
