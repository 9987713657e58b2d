"""Parameters of the whole contact, K as friction per length, and mistyped names."""

import numpy as np
import pytest
import xarray as xr

from ratestate import ParameterError, SpringSlider, logspace
from ratestate.scenario import loads, template

FRICTION = {"a": 0.003, "b": 0.006, "Dc": "10 um"}
WHOLE = {"area": "20 cm^2", "mass": "6 kg", "stiffness": "1.8 MN/m", "normal_force": "4 kN"}
PER_AREA = {"M": 3000.0, "K": 9e8, "sigma": 2e6}


def test_of_contact_divides_by_the_area():
    slider = SpringSlider.of_contact(**WHOLE, **FRICTION, law="aging")
    assert slider.values | PER_AREA == slider.values
    assert slider.area == 2e-3
    assert slider.law == "aging"
    assert slider == SpringSlider(**FRICTION, **PER_AREA, area=2e-3, law="aging")
    assert slider != SpringSlider(**FRICTION, **PER_AREA, law="aging")
    assert SpringSlider(**FRICTION, **PER_AREA, law="aging") != slider
    without_mass = {name: value for name, value in WHOLE.items() if name != "mass"}
    damped = SpringSlider.of_contact(**without_mass, **FRICTION, dashpot="4 N s/m")
    assert (damped.M, damped.damping) == (0.0, 2e3)


def test_values_of_the_whole_contact_are_divided_by_the_area():
    whole = {"M": "6 kg", "K": "1.8 kN/mm", "sigma": "4 kN"}
    slider = SpringSlider(**FRICTION, **whole, area="20 cm^2")
    assert slider == SpringSlider.of_contact(**WHOLE, **FRICTION)
    assert slider.replace(M="3 kg").M == 1500.0
    assert slider.replace(area="10 cm^2").values == slider.values | {"area": 1e-3}
    assert SpringSlider(**FRICTION, **PER_AREA).area is None


def test_area_as_an_array_at_a_fixed_force():
    area = xr.DataArray([1e-3, 2e-3], dims="area")
    slider = SpringSlider.of_contact(**{**WHOLE, "area": area}, **FRICTION)
    np.testing.assert_array_equal(slider.sigma, [4e6, 2e6])
    assert slider.sigma.dims == ("area",)
    np.testing.assert_array_equal(slider.sigma.area, [1e-3, 2e-3])


def test_stiffness_as_friction_per_length():
    slider = SpringSlider(**FRICTION, sigma="2 MPa", K="1e-3/um")
    assert slider.K == 2e9
    assert SpringSlider(**FRICTION, sigma="2 MPa", K="1e-3 1/um") == slider
    K = xr.DataArray([1e-3, 2e-3], dims="K", attrs={"units": "1/um"})
    swept = slider.replace(K=K).K
    np.testing.assert_allclose(swept, [2e9, 4e9], rtol=1e-15)
    np.testing.assert_array_equal(swept.coords["K"], swept)
    assert slider.replace(sigma="4 MPa").K == 2e9


@pytest.mark.parametrize(
    ("make", "keyword", "message"),
    [
        (SpringSlider, "k", r"no parameter k\..* Did you mean K\?"),
        (SpringSlider, "dc", r"Did you mean Dc\?"),
        (SpringSlider, "b2", "law = 'slip' has no parameter b2, which belongs to 'two-state-ag"),
        (SpringSlider(**FRICTION, **PER_AREA).replace, "sigm", r"Did you mean sigma\?"),
        (SpringSlider.of_contact, "stifness", r"of_contact has no .* Did you mean stiffness\?"),
        (SpringSlider.of_contact, "K", "of_contact has no parameter K"),
        (SpringSlider.of_contact, "damping", "of_contact has no parameter damping. .* dashpot"),
    ],
)
def test_mistyped_keywords(make, keyword, message):
    given = dict(WHOLE) if make == SpringSlider.of_contact else {}
    with pytest.raises(ParameterError, match=message):
        make(**given, **{keyword: 1.0})


@pytest.mark.parametrize(
    ("given", "name"),
    [("Dieterich", "aging"), ("AGEING", "aging"), ("slowness", "aging"), ("Ruina", "slip")],
)
def test_synonyms_of_laws(given, name):
    assert SpringSlider(**FRICTION, **PER_AREA, law=given).law == name
    lab = template("lab").replace('law = "aging"', f'law = "{given}"')
    assert loads(lab).slider.law == name  # the synonyms are valid in files too


def test_table_for_notebooks():
    html = SpringSlider.of_contact(**WHOLE, **FRICTION)._repr_html_()
    for cell in ("K", "stiffness per area", "900 MPa/m", "20 cm^2", "slip"):
        assert f"<td>{cell}</td>" in html
    third = SpringSlider(**FRICTION | PER_AREA | {"K": 2e10 / 3})
    assert "<td>6.66667 GPa/m</td>" in third._repr_html_()
    assert "K='6.666666666666667 GPa/m'" in repr(third)
    swept = SpringSlider(**FRICTION | PER_AREA | {"M": logspace("M", 1, 10, 3)})._repr_html_()
    assert "&lt;M: 3; 1 to 10 kg/m^2&gt;" in swept
