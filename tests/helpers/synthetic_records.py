"""Synthetic laboratory records, of which the truth is known."""

import numpy as np
import xarray

import ratestate as rs

FREE = ("a", "b", "Dc", "K")  # what is fitted to a record that is drawn
# A laboratory's velocity step: soft enough to show its stiffness, stiff enough to be stable.
SLIDER = rs.SpringSlider(a=0.01, b=0.014, Dc=1e-5, sigma=2e7, K=6.4e10, V0=1e-6)
STEP = rs.Loading.steps("1 um/s", (100.0, "10 um/s"))


def record(slider, loading, t, *, noise=0.0, red=0.0, time=1.0, seed=0, law=None):
    """What a laboratory would record of this slider at times t [s].

    noise, red, time : standard deviations of white and correlated noise, correlation time [s]
    """
    slider = slider if law is None else slider.replace(law=law)
    run = rs.simulate(slider, loading, float(t[-1]), times=t, rtol=1e-9)
    rng = np.random.default_rng(seed)
    friction = (run.tau / slider.sigma).values + noise * rng.normal(size=t.size)
    friction = friction + red * correlated(t, time, rng)
    variables = {"friction": ("time", friction), "delta_lp": ("time", run.delta_lp.values)}
    return xarray.Dataset(variables, {"time": t})


def assert_finds(result, truth, names=FREE, within=4.0, widest=0.2):
    """Each estimate within so many errors of the truth, and no error above this part of it."""
    for name in names:
        error, value = float(result.standard_error.sel(parameter=name)), getattr(truth, name)
        assert 0.0 < error < widest * abs(value), name
        assert abs(float(result[name]) - value) < within * error, name


def correlated(t, time, rng):
    """An Ornstein-Uhlenbeck process of unit variance at times t."""
    z = rng.normal(size=t.size)
    keep = np.exp(-np.diff(t) / time)
    for i, (part, rest) in enumerate(zip(keep, np.sqrt(1.0 - keep**2), strict=True)):
        z[i + 1] = part * z[i] + rest * z[i + 1]
    return z


def power_law(n, exponent, rng):
    """Noise of unit variance, of n even samples, with a spectrum of 1/f^exponent."""
    f = np.fft.rfftfreq(8 * n)
    f[0] = f[1]
    filtered = np.fft.irfft(np.fft.rfft(rng.normal(size=8 * n)) * f ** (-0.5 * exponent))[:n]
    return filtered / filtered.std()
