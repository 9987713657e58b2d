"""Steady sliding, stability and cycles under users' formulas, beside closed forms."""

from types import MappingProxyType

import numpy as np
import pytest
import xarray as xr
from scipy.special import lambertw
from user_laws import MINE

import ratestate as rs
from ratestate.laws import Parameter, exp, log, where

COMMON = {"a": 0.003, "b": 0.006, "Dc": 1e-5, "sigma": 2e6, "M": 0.0, "K": 9e8}


class Ratio(rs.FrictionLaw):
    """With b/a as the exponent, which is 2 in the examples of parameters, as under prz."""

    name = "ratio"

    def evolution(self, V, theta, p):
        n = p.b / p.a
        return (1 - (V * theta / p.Dc) ** n) / n


class Fast(rs.FrictionLaw):
    """Of one length at all speeds but those near 0.1 m/s and above."""

    name = "fast"

    def evolution(self, V, theta, p):
        x = V * theta / p.Dc
        return -x * log(x * (1 + (V / 0.1) ** 4))


class HealingEnds(rs.FrictionLaw):
    """Healing ends within a time: at low speeds steady states are far from Dc/V."""

    name = "healing-ends"
    parameters = MappingProxyType({"tc": Parameter("s", "time of healing", "> 0", "'1 s'")})

    def evolution(self, V, theta, p):
        return exp(-theta / p.tc) - V * theta / p.Dc


class Two(rs.FrictionLaw):
    """Two states, of which one has two sides."""

    name = "two-sides"
    states = MappingProxyType({"theta": ("b", "Dc"), "theta2": ("b2", "Dc2")})
    parameters = MappingProxyType(
        {
            "b2": Parameter("1", "evolution effect of the second state"),
            "Dc2": Parameter("m", "critical slip distance of the second state", "> 0"),
        }
    )

    def evolution(self, V, theta, p):
        x, y = V * theta[0] / p.Dc, V * theta[1] / p.Dc2
        return where(x < 1, 1 - x, -x * log(x)), 1 - y


def slider(law, **changes):
    return rs.SpringSlider(**COMMON | changes, law=rs.register(law))


@pytest.mark.parametrize("b", [0.0045, 0.006, 0.012])
def test_an_exponent_made_of_parameters(b, law_file):
    """Not of one length, though it seems so where b/a is that of the examples."""
    ratio = rs.hopf(slider(Ratio, b=b, M=3e3), "1 mm/s")
    exponent = rs.hopf(slider(law_file(MINE), b=b, M=3e3, m=b / COMMON["a"]), "1 mm/s")
    for name in ("K_c", "omega_c", "lyapunov_1"):
        np.testing.assert_allclose(ratio[name], exponent[name], rtol=1e-9, err_msg=name)


@pytest.mark.parametrize("V", [1e-6, 1e-3, 0.05, 1.0])
def test_speeds_that_stand_in_a_formula(V):
    """d ln theta/d ln V = -1 - s, and theta goes to it over Dc: K_c = sigma (b (1 + s) - a)/Dc."""
    s = 4 * (V / 0.1) ** 4 / (1 + (V / 0.1) ** 4)
    K_c = COMMON["sigma"] * (COMMON["b"] * (1 + s) - COMMON["a"]) / COMMON["Dc"]
    np.testing.assert_allclose(rs.stability(slider(Fast), V).K_c, K_c, rtol=1e-9)


def test_steady_states_far_from_Dc_over_V():
    """theta/tc = W(Dc/(V tc)), Lambert's W: K_c = sigma (b - a (1 + W))/Dc, alone or not."""
    V = np.array([1e-9, 1e-6, 1e-3, 1.0])
    W = lambertw(COMMON["Dc"] / V).real
    K_c = COMMON["sigma"] * (COMMON["b"] - COMMON["a"] * (1 + W)) / COMMON["Dc"]
    own = slider(HealingEnds, tc=1.0)
    together = rs.stability(own, xr.DataArray(V, dims="V_lp")).K_c
    np.testing.assert_allclose(together, K_c, rtol=1e-9)
    np.testing.assert_allclose(rs.stability(own, V[1]).K_c, K_c[1], rtol=1e-9)


def test_two_states_one_of_which_has_two_sides():
    """Both sides fall by V/Dc where they meet: K_c is that of two states under the slip law."""
    own = slider(Two, b2=0.001, Dc2=5e-5)
    like = rs.SpringSlider(**COMMON, law="two-state-slip", b2=0.001, Dc2=5e-5)
    V = 1e-3
    np.testing.assert_allclose(rs.stability(own, V).K_c, rs.stability(like, V).K_c, rtol=1e-12)
