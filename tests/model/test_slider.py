"""Sliders: values in SI, checks, derived quantities, equality."""

import copy
import dataclasses
import re

import numpy as np
import pytest
import xarray as xr

from ratestate import ParameterError, SpringSlider, logspace, stability
from ratestate.friction.laws import LAWS

FIG_2 = {
    "a": 0.003,
    "b": 0.006,
    "Dc": "10 um",
    "mu0": 0.6,
    "V0": 1e-9,
    "sigma": "2 MPa",
    "M": 3000,
    "K": "900 MPa/m",
    "law": "slip",
}


def test_values_are_si_floats():
    slider = SpringSlider(**FIG_2)
    si = {**FIG_2, "Dc": 1e-5, "sigma": 2e6, "M": 3000.0, "K": 9e8}
    assert slider.parameters == si
    assert slider == SpringSlider(**si) == SpringSlider(**slider.parameters)
    assert slider == eval(repr(slider))
    assert len(repr(slider)) < 200


def test_derived_quantities():
    slider = SpringSlider(**FIG_2)
    assert slider.K_c_qs == pytest.approx(600e6, rel=1e-15, abs=0)
    assert slider.V_c == pytest.approx(1e-5**0.5, rel=1e-15, abs=0)
    assert slider.f_n == pytest.approx(np.sqrt(9e8 / 3000) / (2 * np.pi), rel=1e-15, abs=0)
    assert slider.eta("3.2 mm/s") == pytest.approx(0.512, rel=1e-14, abs=0)
    assert slider.K_c("3.2 mm/s") == pytest.approx(1.512 * 600e6, rel=1e-14, abs=0)
    assert {type(x) for x in (slider.K_c_qs, slider.V_c, slider.f_n, slider.eta(1e-3))} == {float}


def test_derived_quantities_broadcast_by_name_and_have_units():
    slider = SpringSlider(**FIG_2).replace(M=logspace("M", 1e2, 1e5, 4))
    V = logspace("V_lp", 1e-4, 1e-2, 3)
    assert slider.eta(V).dims == ("M", "V_lp")
    assert slider.V_c.attrs == {"units": "m/s", "long_name": "critical velocity"}
    assert slider.V_c.name == "V_c"
    for M in slider.M.values:
        one = slider.replace(M=M)
        assert slider.V_c.sel(M=M) == one.V_c
        assert slider.f_n.sel(M=M) == one.f_n
        np.testing.assert_allclose(
            slider.K_c(V).sel(M=M), [one.K_c(v) for v in V.values], rtol=1e-15
        )
    assert type(slider.K_c_qs) is float


def test_sliders_are_frozen():
    slider = SpringSlider(**FIG_2)
    with pytest.raises(dataclasses.FrozenInstanceError):
        slider.K = 1.0
    with pytest.raises(TypeError):
        SpringSlider(0.003, 0.006)
    with pytest.raises(ParameterError, match=r"^SpringSlider needs b, Dc, sigma, K too\. Call"):
        SpringSlider(a=0.003)
    with pytest.raises(ParameterError, match="viscosity"):
        slider.replace(viscosity=1.0)


def test_equality_and_hash():
    slider = SpringSlider(**FIG_2)
    swept = slider.replace(M=logspace("M", 1, 10, 3))
    assert swept == slider.replace(M=logspace("M", 1, 10, 3))
    assert swept != slider.replace(M=logspace("M", 1, 11, 3))
    assert swept != slider
    assert slider != slider.replace(law="aging")
    assert slider != "slider"
    same = slider.replace(M="3000 kg/m^2")
    assert hash(slider) == hash(same)
    assert len({slider, same, swept}) == 2
    assert "M=<M: 3; 1 to 10 kg/m^2>" in repr(swept)


PLAIN = {"a": 0.003, "b": 0.006, "Dc": 1e-5, "sigma": 2e6, "K": 1e9}
HEATED = {"law": "flash-heating", "V_w": 0.1, "mu_w": 0.2}
CUT_OFF = {"friction_form": "cut-off", "V1": 1.0, "V2": 1.0}
TWO = {"law": "two-state-slip", "b2": 0.001, "Dc2": 1e-4}
MANY = {"mu0": xr.DataArray([0.6, 0.5], dims="mu0")}
MANY |= {"mu_w": xr.DataArray([0.2, 0.55, 0.5], dims="mu_w")}
CLASH = {"M": logspace("M", 1, 10, 3), "K": xr.DataArray([1, 2, 3.0], {"M": [1, 2, 3]}, "M")}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"sigma": -2e6}, "sigma = -2e+06 Pa must be > 0"),
        ({"K": "-1/um"}, "K = '-1/um' must be > 0"),
        ({"M": "3 kg"}, "M = '3 kg' is of the whole contact"),
        ({"area": "1 m^2", "sigma": "-4 N"}, "sigma = '-4 N' must be > 0. Give a force"),
        (CLASH, "K and M have different coordinates along the dimension 'M'"),
        ({"law": "nope"}, f"law = 'nope' is unknown. Choose {' or '.join(map(repr, LAWS))} (or "),
        ({"law": "nagata"}, "law = 'nagata' needs c, stress weakening of the state. Give a"),
        ({"law": "nagata", "c": -0.1}, "c = -0.1 must be >= 0"),
        ({"law": "nagata", "c": 1.0, "b": 0.0}, "law = 'nagata' has b = 0 and c > 0"),
        ({"c": 1.0}, "law = 'slip' has no parameter c, which belongs to 'nagata'"),
        (TWO | {"b2": np.nan}, "b2 = nan is not a number"),
        (HEATED | {"mu0": 0.03}, "law = 'flash-heating' gives a steady friction"),
        (HEATED | {"b": 0.0}, "law = 'flash-heating' needs b > 0"),
        (HEATED | {"mu_w": 0.61}, "law = 'flash-heating' has mu_w = 0.61 > mu0 = 0.6"),
        (HEATED | MANY, "law = 'flash-heating' has mu_w = 0.55 > mu0 = 0.5"),
        (
            HEATED | {"friction_form": "log"},
            "friction_form = 'log' does not go with law = 'flash-h",
        ),
        (CUT_OFF | {"law": "nagata", "c": 1.0}, "friction_form = 'cut-off' does not go with law"),
        (CUT_OFF | {"V1": 0.0}, "V1 = 0 m/s must be > 0"),
        ({"friction_form": "cut-off", "V1": 1.0}, "friction_form = 'cut-off' needs V2, cut-off sp"),
        ({"V1": 1.0}, "friction_form = 'log' has no parameter V1, which belongs to 'cut-off'"),
        ({"friction_form": "asinh"}, "friction_form = 'asinh' is unknown. Choose 'log' or 'cut-o"),
        ({"friction_form": 3}, "friction_form = 3 is unknown"),
    ],
)
def test_sliders_that_cannot_be_are_refused(changes, message):
    """Made so, or made so from another."""
    with pytest.raises(ParameterError, match="^" + re.escape(message)):
        SpringSlider(**PLAIN | changes)
    with pytest.raises(ParameterError, match="^" + re.escape(message)):
        SpringSlider(**PLAIN).replace(**changes)


def test_copies_of_a_slider_have_its_class():
    """The slider has a subclass and a law with more parameters."""

    class Rig(SpringSlider):
        pass

    rig = Rig(**PLAIN, **TWO)
    for same in (copy.copy(rig), copy.deepcopy(rig), rig.replace(), rig.__replace__(b2=0.001)):
        assert type(same) is Rig
        assert same == rig
    assert rig.replace(b2=0.002) != rig
    assert SpringSlider.__match_args__ == ()


def test_steady_stress_is_friction_and_damping():
    slider = SpringSlider(
        a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", mu0=0.6, V0=1e-6
    )
    friction = 0.6 - 0.003 * np.log(1e3)
    assert slider.steady_stress("1 mm/s") == pytest.approx(friction, rel=1e-14)
    damped = slider.replace(damping=xr.DataArray([0.0, 1e6], dims="damping"))
    assert damped.steady_stress(1e-3).values == pytest.approx(
        [friction, friction + 5e-4], rel=1e-14
    )


def test_a_plain_array_has_a_dimension_with_the_name_of_the_parameter():
    stiff = SpringSlider(**FIG_2 | {"K": np.array([1e9, 2e9])})
    assert stiff.K.dims == ("K",)
    assert stiff.K.K.values.tolist() == [1e9, 2e9]
    assert stability(stiff, np.array([1e-3, 2e-3, 3e-3])).growth_rate.sizes == {"K": 2, "V_lp": 3}
    with pytest.raises(ParameterError, match=r"K and M are numpy arrays, .* dims='K'\)"):
        stiff.replace(K=np.array([1e9, 2e9]), M=np.array([1.0, 2.0]))
    with pytest.raises(ParameterError, match=r"For many values give .* dims='V_lp'\)"):
        stability(stiff, np.ones((2, 2)))
