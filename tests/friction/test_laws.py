"""Friction and the evolution laws equal their definitions (eqs 1-3)."""

import math
import pickle

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from ratestate import ParameterError
from ratestate import formulas as rsf
from ratestate.laws import catalogue
from ratestate.paper.figures import LAWS as LAWS_OF_PAPER

LAWS = list(LAWS_OF_PAPER)
FRICTION = {"a": 0.003, "b": 0.006, "mu0": 0.6, "V0": 1e-9, "Dc": 1e-5}
#: eqs 2 and 3 as printed
TEXTBOOK = {
    "aging": lambda V, theta, Dc: 1 - V * theta / Dc,
    "slip": lambda V, theta, Dc: -V * theta / Dc * np.log(V * theta / Dc),
}
logs = st.floats(-9, 1)
spread = st.floats(-8, 8)


@given(logs)
def test_steady_state_is_steady_for_both_laws(log_V):
    V = 10**log_V
    theta = rsf.theta_ss(V, Dc=1e-5)
    for law in LAWS:
        assert abs(rsf.dtheta_dt(V, theta, Dc=1e-5, law=law)) < 1e-15
    steady = rsf.mu_ss(V, a=0.003, b=0.006, mu0=0.6, V0=1e-9)
    assert rsf.friction(V, theta, **FRICTION) == pytest.approx(steady, abs=1e-15)
    assert steady == pytest.approx(0.6 - 0.003 * math.log(V / 1e-9), abs=1e-15)


@pytest.mark.parametrize("law", LAWS)
@given(log_V=logs, log_omega=spread)
def test_evolution_matches_the_textbook(law, log_V, log_omega):
    V, Dc = 10**log_V, 1e-5
    theta = Dc / V * 10**log_omega
    expected = TEXTBOOK[law](V, theta, Dc)
    scale = max(1, 10**log_omega)  # 1 - Omega and ln(Omega) cancel near Omega = 1
    assert abs(rsf.dtheta_dt(V, theta, Dc=Dc, law=law) - expected) < 1e-14 * scale


@pytest.mark.parametrize("law", LAWS)
def test_only_the_aging_law_heals_at_rest(law):
    assert rsf.dtheta_dt(0.0, 5.0, Dc=1e-5, law=law) == {"aging": 1, "slip": 0}[law]


def complex_step(function, x):
    return function(x * (1 + 1e-30j)).imag / (x * 1e-30)


@pytest.mark.parametrize("law", LAWS)
@given(log_V=logs, log_omega=spread)
def test_partials_of_evolution(law, log_V, log_omega):
    V, Dc = 10**log_V, 1e-5
    theta = Dc / V * 10**log_omega
    by_V, by_theta = rsf.dtheta_dt_partials(V, theta, Dc=Dc, law=law)
    book = TEXTBOOK[law]
    # absolute part: the slip law's slope, 1 + ln(Omega), has a zero
    assert by_V == pytest.approx(
        complex_step(lambda x: book(x, theta, Dc), V), rel=1e-12, abs=1e-14 * theta / Dc
    )
    assert by_theta == pytest.approx(
        complex_step(lambda x: book(V, x, Dc), theta), rel=1e-12, abs=1e-14 * V / Dc
    )


@given(log_V=logs, log_omega=spread)
def test_partials_of_friction(log_V, log_omega):
    V = 10**log_V
    theta = 1e-5 / V * 10**log_omega
    by_V, by_theta = rsf.friction_partials(V, theta, a=0.003, b=0.006)
    mu = rsf.friction
    assert by_V == pytest.approx(
        complex_step(lambda x: mu(x, theta, **FRICTION), V), rel=1e-13, abs=0
    )
    assert by_theta == pytest.approx(
        complex_step(lambda x: mu(V, x, **FRICTION), theta), rel=1e-13, abs=0
    )


def test_arrays_and_named_arrays_broadcast():
    V = xr.DataArray([1e-6, 1e-3], dims="V_lp")
    Dc = xr.DataArray([1e-6, 1e-5, 1e-4], dims="Dc")
    for law in LAWS:
        rate = rsf.dtheta_dt(V, 0.1, Dc=Dc, law=law)
        assert dict(rate.sizes) == {"V_lp": 2, "Dc": 3}
        assert float(rate[1, 2]) == rsf.dtheta_dt(1e-3, 0.1, Dc=1e-4, law=law)
        np.testing.assert_array_equal(rsf.dtheta_dt(V.values, 0.1, Dc=1e-5, law=law), rate[:, 1])
    assert rsf.friction(V, rsf.theta_ss(V, Dc=Dc), **{**FRICTION, "Dc": Dc}).sizes["Dc"] == 3


@pytest.mark.parametrize("law", ["ruinae", "Slip law", "law", "", None, 0])
def test_unknown_law(law):
    with pytest.raises(ParameterError, match=r"is unknown"):
        rsf.dtheta_dt(1e-6, 1.0, Dc=1e-5, law=law)


def test_the_catalogue_can_be_copied():
    for entry in catalogue():
        assert pickle.loads(pickle.dumps(entry)).forms.keys() == entry.forms.keys()
