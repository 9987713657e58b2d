"""Synthetic laboratory records, of which the truth is known."""

from typing import NamedTuple

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


class Drawn(NamedTuple):
    """A record drawn from a realistic range, its truth, and from where a search may begin."""

    truth: rs.SpringSlider
    start: rs.SpringSlider
    data: xarray.Dataset
    is_red: bool


def drawn(seed):
    """A velocity step up or down, either law, with inertia in every second, noise of either kind.

    Ranges: a 0.003 to 0.016, b/a 0.5 to 1.6, Dc 1 to 100 um, sigma 2 to 50 MPa, K 1.8 to 16 K_c
    (of what is unstable), V 0.1 to 200 um/s, steps by 2.5 to 20, noise 1 to 6 % of the direct
    effect.  eta at the larger speed is 0.1 to 10 where there is mass.
    """
    rng = np.random.default_rng(1000 + seed)
    a, sigma, Dc = 10 ** rng.uniform((-2.5, 6.3, -6), (-1.8, 7.7, -4))
    b = a * rng.uniform(0.5, 1.6)
    V1 = 10 ** rng.uniform(-7, -5)
    V2 = V1 * 10 ** (rng.choice([-1, 1]) * rng.uniform(0.4, 1.3))
    K_c = max(b - a, 0.15 * a) * sigma / Dc
    eta = 10 ** rng.uniform(-1, 1) if seed % 4 > 1 else 0.0
    K = K_c * (1 + eta) * 10 ** rng.uniform(0.25, 1.2 if eta == 0.0 else 0.6)
    M = eta * a * sigma * Dc / max(V1, V2) ** 2
    law = ("slip", "aging")[seed % 2]
    truth = rs.SpringSlider(a=a, b=b, Dc=Dc, sigma=sigma, K=K, M=M, V0=V1, law=law)
    distance = Dc * rng.uniform(15, 40)
    step, end = 0.5 * distance / V1, 0.5 * distance / V1 + distance / V2
    before, after = rng.integers(150, 500), rng.integers(600, 2000)
    early = np.linspace(0, step, before, endpoint=False)
    t = np.concatenate([early, np.linspace(step, end, after)])
    level = a * abs(np.log(V2 / V1)) * 10 ** rng.uniform(-2.0, -1.2)
    is_red = bool(rng.random() < 0.5)
    share = rng.uniform(0.3, 1.0) if is_red else 0.0
    time = (end - step) / after * 10 ** rng.uniform(0.3, 1.5)
    noise = {"noise": level * np.sqrt(1 - share), "red": level * np.sqrt(share), "time": time}
    data = record(truth, rs.Loading.steps(V1, (step, V2)), t, seed=seed, **noise)
    factors = 2.0 ** rng.normal(size=4)
    start = {s: f * getattr(truth, s) for s, f in zip(("a", "b", "Dc", "K"), factors, strict=True)}
    return Drawn(truth, truth.replace(**start), data, is_red)
