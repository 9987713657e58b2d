"""Scenario files with values of the whole contact, friction per length, and laws by other names."""

import numpy as np
import pytest
from scenario_problems import problems_of

from ratestate import ParameterError, SpringSlider
from ratestate.scenario import loads, python, toml

FILE = """
[slider]
a = 0.003
b = 0.006
Dc = "10 um"
{slider}
[loading]
V_lp = "3.2 mm/s"
[sweep]
function = "{function}"
{sweep}
"""
WHOLE = """area = "20 cm^2"
sigma = "4 kN"
K = "1.8 MN/m"
M = "6 kg"
"""


def scenario(slider, sweep="b = [0.006]", function="stability"):
    return loads(FILE.format(slider=slider, sweep=sweep, function=function))


def test_axes_of_the_whole_contact_and_of_the_area():
    slider = scenario(WHOLE, 'M = { from = "2 kg", to = "6 kg", n = 3 }').slider
    np.testing.assert_allclose(slider.M, [1000, 2000, 3000], rtol=1e-15)
    np.testing.assert_array_equal(slider.M.coords["M"], slider.M)
    slider = scenario(WHOLE.replace('area = "20 cm^2"', ""), 'area = ["10 cm^2", "20 cm^2"]').slider
    np.testing.assert_array_equal(slider.sigma, [4e6, 2e6])


BY_NAME = """area = "20 cm^2"
normal_force = "4 kN"
stiffness = 1.8e6
mass = 6
"""


def test_names_of_the_whole_contact():
    contact = SpringSlider.of_contact(
        area="20 cm^2", normal_force="4 kN", stiffness=1.8e6, mass=6, a=0.003, b=0.006, Dc="10 um"
    )
    slider = scenario(BY_NAME).slider
    assert slider.replace(b=0.006) == contact
    assert scenario(BY_NAME.replace("mass = 6", "mass = 0")).slider.M == 0.0
    no_normal_force = BY_NAME.replace('normal_force = "4 kN"', "")
    axes = 'mass = { from = 2, to = 6, n = 3 }\nnormal_force = ["4 kN", 5000]'
    swept = scenario(no_normal_force, axes).slider
    same = 'M = { from = "2 kg", to = "6 kg", n = 3 }\nsigma = ["4 kN", "5 kN"]'
    as_parameters = scenario('area = "20 cm^2"\nK = "1.8 MN/m"', same).slider
    assert swept == as_parameters
    np.testing.assert_array_equal(swept.sigma, [2e6, 2.5e6])


@pytest.mark.parametrize(
    "axis", ['["1e-4/um", "2e-4/um"]', '{ from = "1e-4/um", to = "2e-4 1/um", n = 2 }']
)
def test_axis_of_friction_per_length(axis):
    K = scenario('sigma = "2 MPa"', f"K = {axis}").slider.K
    np.testing.assert_allclose(K, [2e8, 4e8], rtol=1e-15)


@pytest.mark.parametrize(
    ("slider", "axis", "parts"),
    [
        ('area = "20 cm^2"', 'sigma = ["2 MPa", "3 MPa"]', "K_over_sigma and sigma"),
        ('sigma = "2 MPa"', 'area = ["10 cm^2", "20 cm^2"]', "stiffness and area"),
    ],
)
def test_a_derived_parameter_is_written_as_python_only(slider, axis, parts):
    K = "1e-4/um" if "K_over" in parts else "1.8 MN/m"
    it = scenario(f'{slider}\nK = "{K}"', axis)
    by = parts.split()[-1]
    with pytest.raises(ParameterError) as caught:
        toml(it)
    assert str(caught.value).startswith(
        f"K lies along {by}, as it does if made of {parts}, but in a scenario file each swept"
    )
    assert "ratestate.scenario.python(scenario)" in caught.value.remedy
    lines = {}
    exec(python(it), lines)
    assert lines["slider"] == it.slider


def test_branch_over_friction_per_length():
    text = 'sigma = "2 MPa"\nM = 3000'
    settings = scenario(text, 'K = { from = "3e-4/um", to = "4e-4/um" }', "continue_cycle").settings
    assert (settings["start"], settings["stop"]) == (6e8, 8e8)


STRESS = 'sigma = "2 MPa"'
BAD = [
    (STRESS + '\nK = 9e8\nM = "6 kg"', "", "[slider] M: '6 kg' is of the whole contact"),
    (STRESS + "\nK = 9e8\nmass = 6", "", "[slider] M: '6.0 kg' is of the whole contact"),
    (WHOLE + "mass = 6", "", "[slider] mass: is given in addition to M"),
    (WHOLE, 'mass = ["3000 kg/m^2"]', "[sweep] mass[0]: '3000 kg/m^2' is a mass per area"),
    (WHOLE, 'M = ["6 kg"]\nmass = [6]', "[sweep] mass: is given in addition to M"),
    (STRESS, 'K = ["1e-4/um", 9e8]', "[sweep] K: mixes a rate per length and a stiffness"),
    (
        STRESS,
        'K = { from = "1e-4/um", to = "1e20/um", n = 3 }',
        "[sweep] K.to: '1e20/um' is far outside the usual range, 1e-15 to 1e+15 1/m",
    ),
]


@pytest.mark.parametrize(("slider", "sweep", "line"), BAD)
def test_wrong_units_of_a_contact_are_refused(slider, sweep, line):
    (found,) = problems_of(scenario, slider, sweep or "b = [0.006]")
    assert found.startswith(line)


HISTORY = """[slider]
a = 0.003
b = 0.006
Dc = "10 um"
{slider}
[loading]
{loading}
[run]
t_end = 2
[sweep]
function = "simulate"
{sweep}
"""
STRESSED = {
    "steps": "V_lp = 1e-3\n"
    "sigma_steps = [{{ t = 1, sigma = {} }}, {{ t = 1.5, sigma = 3e6, ramp = 0.5 }}]",
    "sinusoid": "V_lp = 1e-3\nsigma_sinusoid = {{ amplitude = {}, period = 1 }}",
    "rows": "t = [0, 1, 2]\nV_lp = [1e-3, 1e-3, 1e-3]\nsigma = [{0}, {0}, {1}]",
    "record": 'file = "{}.csv"\ncolumns = [1, 2, 3]',
}


def history(folder, kind, values, slider=WHOLE, sweep="b = [0.006]"):
    """The normal stress of a loading of this kind."""
    (folder / "kN.csv").write_text("t [s],V [mm/s],F [kN]\n0,1,4\n1,1,4\n2,1,5\n")
    (folder / "MPa.csv").write_text("t [s],V [mm/s],F [MPa]\n0,1,2\n1,1,2\n2,1,2.5\n")
    loading = STRESSED[kind].format(*values)
    text = HISTORY.format(slider=slider, loading=loading, sweep=sweep)
    return loads(text, folder=folder).settings["loading"].normal_stress


@pytest.mark.parametrize(
    ("kind", "forces", "stresses"),
    [
        ("steps", ['"5 kN"'], [2.5e6]),
        ("sinusoid", ['"400 N"'], [2e5]),
        ("rows", ['"4 kN"', '"5 kN"'], [2e6, 2.5e6]),
        ("record", ["kN"], ["MPa"]),
    ],
)
def test_normal_forces_in_time(tmp_path, kind, forces, stresses):
    """They are divided by the area, and so by each of a sweep."""
    found, known = (history(tmp_path, kind, values) for values in (forces, stresses))
    for name in ("t", "start", "end", "amplitude", "period"):
        np.testing.assert_array_equal(getattr(found, name), getattr(known, name))
    no_area = WHOLE.replace('area = "20 cm^2"', "")
    swept = history(tmp_path, kind, forces, no_area, 'area = ["20 cm^2", "10 cm^2"]')
    name = "amplitude" if kind == "sinusoid" else "end"
    given, one = getattr(swept, name), np.asarray(getattr(known, name))
    assert given.dims[0] == "area"
    np.testing.assert_allclose(given.isel(area=0), one, rtol=1e-15)
    half = np.array([2, 2, 1, 1]) if kind == "steps" else 2  # (the ramp's end is no force)
    np.testing.assert_allclose(given.isel(area=1), half * one, rtol=1e-15)


@pytest.mark.parametrize(
    ("kind", "forces", "where"),
    [
        ("steps", ['"5 kN"'], "sigma_steps[0].sigma: '5 kN'"),
        ("sinusoid", ['"400 N"'], "sigma_sinusoid.amplitude: '400 N'"),
        ("rows", ['"4 kN"', '"5 kN"'], "sigma: '4000 N'"),
        ("record", ["kN"], "columns[2]: 'kN'"),
    ],
)
def test_normal_forces_in_time_need_an_area(tmp_path, kind, forces, where):
    (line,) = problems_of(history, tmp_path, kind, forces, 'sigma = "2 MPa"\nK = 9e8')
    assert line.startswith(f"[loading] {where} is of the whole contact")
    assert line.endswith("Or give the area too, such as area = '20 cm^2'.")
    (line,) = problems_of(history, tmp_path, kind, forces, 'area = 0\nsigma = "2 MPa"\nK = 9e8')
    assert line.startswith("[slider] area: 0 m^2 must be > 0")
