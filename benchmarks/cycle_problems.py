"""Sliders of b/a = 2 all over the atlas, each given by K/K_c_qs and eta, and their cycles."""

import numpy as np
import xarray

import ratestate as rs
from ratestate.dynamics.atlas import ETA, STIFFNESS

SIDE = 100  # of the grid
RTOL, EXACT = 1e-6, 1e-10
V_LP = 1e-5  # m/s; V_lp/Dc = 1 1/s, so that times are what they are in units of Dc/V_lp
BASE = rs.SpringSlider(a=0.01, b=0.02, Dc=1e-5, sigma=1e6, K=1e9, M=1.0)


def sliders(law, K, eta):
    """Sliders of these K/K_c_qs and eta, DataArrays."""
    M = eta * BASE.a * BASE.sigma * BASE.Dc / V_LP**2
    return BASE.replace(law=law, K=K * BASE.K_c_qs, M=M)


def atlas(law):
    """The grid."""
    return sliders(law, rs.logspace("K", *STIFFNESS, SIDE), rs.logspace("eta", *ETA, SIDE))


def sample(n, seed, eta=ETA):
    """K/K_c_qs and eta (n,) of random places of the atlas where steady sliding is unstable."""
    draw = np.random.default_rng(seed).uniform
    K, eta = (np.exp(draw(*np.log(limits), 20 * n)) for limits in (STIFFNESS, eta))
    unstable = 1.0 + eta > K
    return K[unstable][:n], eta[unstable][:n]


def listed(law, K, eta):
    """Sliders one after another."""
    return sliders(law, *(xarray.DataArray(values, dims="case") for values in (K, eta)))


def cycle(slider, rtol=RTOL):
    """The public call."""
    return rs.limit_cycle(slider, V_LP, rtol=rtol)


def truth(slider):
    """Period and amplitude (2, n), to all digits asked for here."""
    exact = cycle(slider, EXACT)
    return np.stack([exact.period.values, exact.amplitude.values])


def many(law, K, eta):
    """Sliders, repeated until they fill lanes."""
    times = -(-256 // len(K))
    return listed(law, np.tile(K, times), np.tile(eta, times))
