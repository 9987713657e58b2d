"""Forms of friction other than eq. 1: their formulas, and the laws that take them."""

import math
import pickle

import numpy as np
import pytest
import xarray as xr
from textbook import OF_LAW, drawn_of_form

import ratestate as rs
from ratestate import files, scenario
from ratestate.dynamics.results import law_of_result, parameter
from ratestate.friction.composition import composed, composed_law, forms_of, takes_forms
from ratestate.friction.forms import FORMS
from ratestate.friction.laws import LAWS

LAWS_WITH_FORMS = [name for name, law in LAWS.items() if takes_forms(law) and law.form == "log"]
CUT = rs.SpringSlider(
    a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=3e3, K=4e8, friction_form="cut-off", V1=1e-2, V2=1.0
)


@pytest.mark.parametrize(
    ("law", "form"), [(name, form) for name, law in LAWS.items() for form in forms_of(law)]
)
@pytest.mark.parametrize("damped", [False, True])
def test_derivatives_have_the_order_of_the_variables(law, form, damped):
    """Slopes equal finite differences."""
    rng = np.random.default_rng(5)
    parameters, V = drawn_of_form(law, rng, form, damped)
    values = {
        symbol: np.array([x]) for symbol, x in parameters.items() if symbol != "friction_form"
    }
    law = composed(LAWS[law], form, damped)
    p = tuple(float(x[0]) for x in law.coefficient_arrays(V, values))
    y, n = rng.normal(size=1 + len(law.states)), len(law.states)

    def at(y):
        return law.at_speed(y[0], tuple(y[1:]), p)

    def slopes(function):
        h, steps = 1e-3, np.eye(1 + n)
        each = [[function(y + k * h * step) for step in steps] for k in (2, 1, -1, -2)]
        each = [np.array(one) for one in each]
        return (8 * (each[1] - each[2]) - (each[0] - each[3])) / (12 * h)

    of_rates, (by_v, by_psi) = slopes(lambda y: np.array(at(y).f)), at(y).f_slopes
    pairs = [
        (at(y).S_slopes, slopes(lambda y: at(y).S)),
        (at(y).R_slopes, slopes(lambda y: at(y).R)),
        (at(y).slaved_slopes, slopes(lambda y: at(y).slaved)[1:]),
        (by_v, of_rates[0]),
        (by_psi, np.diag(of_rates[1:])),
    ]
    for found, true in pairs:
        np.testing.assert_allclose(found, true, rtol=0, atol=1e-7 * np.abs(found).max() + 1e-9)


def test_a_cycle_begins_at_the_hopf_point():
    V, slider = 1e-3, CUT.replace(K=2e8)
    hopf = rs.hopf(slider, V)
    K = float(hopf.K_c)
    for below, rtol in ((1e-6, 2e-2), (1e-7, 2e-3)):  # (the type changes nearby)
        small = rs.limit_cycle(slider.replace(K=K * (1 - below)), V, rtol=1e-8)
        expected = float(hopf.amplitude_coefficient) * math.sqrt(below)
        assert float(small.amplitude) == pytest.approx(expected, rel=rtol)


def test_far_from_the_cut_offs_friction_is_eq_1_with_another_mu0():
    V1, V2 = 1e6, 1e9
    slider = CUT.replace(V1=V1, V2=V2)
    offset = -0.003 * math.log(V1 / 1e-6) + 0.006 * math.log(V2 / 1e-6)
    plain = slider.replace(friction_form="log", mu0=0.6 + offset)
    assert plain.friction_law is LAWS["slip"]
    loading = rs.Loading.steps(1e-3, (0.05, 3e-3))
    runs = [rs.simulate(s, loading, 0.5, times=[0.2, 0.5], rtol=1e-10) for s in (slider, plain)]
    for name in ("tau", "V", "mu"):
        np.testing.assert_allclose(runs[0][name], runs[1][name], rtol=1e-6, err_msg=name)


def test_the_slider_keeps_its_form(tmp_path):
    assert CUT.friction_law.name == "slip+cut-off"
    assert CUT.friction_law is composed_law("slip+cut-off")
    damped = CUT.replace(damping=1e4)
    assert damped.friction_law is composed_law("slip+cut-off+damping")
    assert rs.SpringSlider(**damped.parameters) == damped
    assert pickle.loads(pickle.dumps(damped)) == damped
    assert "friction_form='cut-off', V1='10 mm/s', V2='1 m/s'" in repr(CUT)
    assert "cut-off" in CUT._repr_html_()
    assert CUT.replace(friction_form="LOG").values.keys() == {*"a b Dc sigma K M mu0 V0".split()}
    swept = CUT.replace(V1=xr.DataArray([1e-3, 1e-2], dims="V1"))
    cycles = rs.sweep(rs.limit_cycle, swept, V_lp=1e-4, store=tmp_path / "x.zarr", chunk=1)
    assert float(cycles.amplitude[1]) == float(rs.limit_cycle(CUT, 1e-4).amplitude)
    run = rs.simulate(CUT, rs.Loading.constant(1e-3), 0.05, V_start=5e-4)
    text = scenario.toml(scenario.from_result(run))
    assert 'friction_form = "cut-off"' in text
    assert scenario.loads(text).slider == CUT
    lines: dict = {}
    exec(scenario.python(scenario.loads(text)), lines)
    np.testing.assert_array_equal(lines["result"].tau, run.tau)
    again = files.read(files.write(run, tmp_path / "run.nc"))
    assert parameter(again, "friction_form") == "cut-off"
    assert law_of_result(again) is CUT.friction_law
    assert parameter(rs.stability(CUT.replace(friction_form="log"), 1.0), "friction_form") == "log"


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        (
            {"friction_form": "asinh"},
            r"^friction_form = 'asinh' is unknown. Choose 'log' or 'cut-off' or 'regularized'",
        ),
        ({"friction_form": 3}, r"^friction_form = 3 is unknown"),
        (
            {"friction_form": "cut-off", "V1": 1.0},
            r"^friction_form = 'cut-off' needs V2, cut-off speed of the state",
        ),
        ({"V1": 1.0}, r"^friction_form = 'log' has no parameter V1, which belongs to 'cut-off'"),
        ({"friction_form": "cut-off", "V1": 0.0, "V2": 1.0}, r"^V1 = 0 m/s must be > 0"),
        (
            {"friction_form": "cut-off", "V1": 1.0, "V2": 1.0, "law": "nagata", "c": 1.0},
            r"^friction_form = 'cut-off' does not go with law = 'nagata'",
        ),
        (
            {"friction_form": "log", "law": "flash-heating", "V_w": 0.1, "mu_w": 0.2},
            r"^friction_form = 'log' does not go with law = 'flash-heating', which needs",
        ),
        (
            {"law": "flash-heating", "V_w": 0.1, "mu_w": 0.2, "mu0": 0.03},
            r"^law = 'flash-heating' gives a steady friction .* of -0.0045",
        ),
        (
            {"law": "flash-heating", "V_w": 0.1, "mu_w": 0.2, "b": 0.0},
            r"^law = 'flash-heating' needs b > 0",
        ),
        (
            {"law": "flash-heating", "V_w": 0.1, "mu_w": 0.61},
            r"^law = 'flash-heating' has mu_w = 0.61 > mu0 = 0.6",
        ),
        (
            {
                "law": "flash-heating",
                "V_w": 0.1,
                "mu0": xr.DataArray([0.6, 0.5], dims="mu0"),
                "mu_w": xr.DataArray([0.2, 0.55, 0.5], dims="mu_w"),
            },
            r"^law = 'flash-heating' has mu_w = 0.55 > mu0 = 0.5",
        ),
    ],
)
def test_incompatible_parameters_are_refused(changes, text):
    plain = {"a": 0.003, "b": 0.006, "Dc": 1e-5, "sigma": 2e6, "K": 1e9}
    with pytest.raises(rs.ParameterError, match=text):
        rs.SpringSlider(**(plain | changes))


def test_mu_w_may_equal_mu0():
    plain = {"a": 0.003, "b": 0.006, "Dc": 1e-5, "sigma": 2e6, "K": 1e9}
    assert rs.SpringSlider(**plain, law="flash-heating", V_w=0.1, mu_w=0.6).mu_w == 0.6


def test_forms_and_their_parameters():
    assert list(FORMS) == ["cut-off", "regularized"]
    assert {*LAWS_WITH_FORMS} == {*OF_LAW} - {"nagata", "flash-heating"}
    assert LAWS["flash-heating"].form == "regularized"
    assert FORMS["regularized"].OWN_PARAMETERS == {}
    assert set(FORMS["cut-off"].OWN_PARAMETERS) == {"V1", "V2"}
