"""Forms of friction other than eq. 1: their formulas, and the laws that take them."""

import math
import pickle

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from load_step import load_step
from textbook import OF_LAW, Textbook, drawn

import ratestate as rs
from ratestate import files
from ratestate.dynamics.results import law_of_result, parameter
from ratestate.friction.composition import composed, composed_law, forms_of, takes_forms
from ratestate.friction.forms import FORMS
from ratestate.friction.laws import LAWS
from ratestate.interfaces import scenario

LAWS_WITH_FORMS = [name for name, law in LAWS.items() if takes_forms(law) and law.form == "log"]
NAMES = pytest.mark.parametrize("law", LAWS_WITH_FORMS)
EACH_FORM = pytest.mark.parametrize("form", FORMS)
RTOL = 1e-6
CUT = rs.SpringSlider(
    a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=3e3, K=4e8, friction="cut-off", V1=1e-2, V2=1.0
)


def cut_off_parameters(law, rng):
    """Return parameters of a slider near its edge of stability, cut-offs near its speed."""
    parameters, V = drawn(law, rng)
    parameters |= {"V1": V * 10 ** rng.uniform(-0.5, 3), "V2": V * 10 ** rng.uniform(0, 4)}
    return parameters, V


def regularized_parameters(law, rng):
    """Return parameters of a slider near its edge of stability, with mu0 of a few a."""
    parameters, V = drawn(law, rng)
    parameters |= {"mu0": parameters["a"] * rng.uniform(0.5, 20.0), "V0": V}
    return parameters | {"friction": "regularized"}, V


RANDOM_PARAMETERS = {"cut-off": cut_off_parameters, "regularized": regularized_parameters}


@pytest.mark.parametrize(
    ("law", "form"), [(name, form) for name, law in LAWS.items() for form in forms_of(law)]
)
@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_derivatives_have_the_order_of_the_variables(law, form, damping):
    """Slopes equal finite differences."""
    rng = np.random.default_rng(5)
    parameters, V = RANDOM_PARAMETERS.get(form, drawn)(law, rng)
    parameters.pop("friction", None)
    parameters["damping"] = damping * parameters["a"] * parameters["sigma"] / V
    values = {symbol: np.array([x]) for symbol, x in parameters.items()}
    law = composed(LAWS[law], form, damped=damping > 0.0)
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


@NAMES
@EACH_FORM
@given(seed=st.integers(0, 10**6))
def test_friction_matches_the_textbook(law, form, seed):
    rng = np.random.default_rng(seed)
    parameters, V = RANDOM_PARAMETERS[form](law, rng)
    twin, friction = Textbook(law, parameters), composed(LAWS[law], form)
    values = {k: np.array([x]) for k, x in parameters.items() if k != "friction"}
    p = tuple(float(x[0]) for x in friction.coefficient_arrays(V, values))
    v, theta = rng.normal(), [D / V * math.exp(rng.normal()) for D in twin.D]
    psi = tuple(math.log(V * th / D) for th, D in zip(theta, twin.D, strict=True))
    reference = friction.reference_friction(np.array([V]), values)[0]
    mu = reference + parameters["a"] * friction.at_speed(v, psi, p).R
    assert mu == pytest.approx(twin.mu(V * math.exp(v), theta), abs=1e-12)
    steady = twin.mu(V, twin.steady_theta(V))
    assert friction.steady_friction(np.array([V]), values)[0] == pytest.approx(steady, abs=1e-12)


@pytest.mark.parametrize(
    ("law", "mass", "damping"),
    [
        ("slip", True, 0.0),
        ("slip", False, 0.3),
    ],
)
def test_a_velocity_step_matches_the_textbook(law, mass, damping):
    parameters, V = cut_off_parameters(law, np.random.default_rng(8))
    parameters["damping"] = damping * parameters["a"] * parameters["sigma"] / V
    parameters |= {"friction": "cut-off"} | ({} if mass else {"M": 0.0})
    simulate, times, twin, exact = load_step(law, parameters, V)
    run = simulate(times=times, rtol=RTOL)
    assert twin.differs(run, exact) < 100 * RTOL
    assert abs(float(run.energy_residual)) < 10 * RTOL
    whole = simulate(rtol=RTOL)
    rounding = 1e-2 * RTOL * parameters["a"]  # of the place in a step where friction is smallest
    assert float(run.mu_min) == float(whole.mu_min) <= float(whole.mu.min()) + rounding
    assert float(run.mu_min) == pytest.approx(float(whole.mu.min()), abs=0.02 * parameters["a"])


@NAMES
@EACH_FORM
def test_eigenvalues_match_the_textbooks_jacobian(law, form):
    rng = np.random.default_rng(9)
    for _ in range(3):
        parameters, V = RANDOM_PARAMETERS[form](law, rng)
        twin = Textbook(law, parameters)
        case = rs.SpringSlider(**(parameters | {"friction": form}), law=law)
        exact = np.linalg.eigvals(twin.jacobian(twin.steady(V), V))
        for value in rs.stability(case, V).eigenvalues.values:
            near = exact[np.argmin(np.abs(exact - value))]
            assert abs(near - value) < 1e-6 * abs(value) + 1e-9 * np.abs(exact).max()
        K_c = case.K_c(V)
        if K_c > 0:
            both = case.replace(K=xr.DataArray([K_c * (1.0 + 1e-9), K_c * (1.0 - 1e-9)], dims="K"))
            assert rs.stability(both, V).stable.values.tolist() == [True, False]


def test_a_cycle_matches_a_long_run_and_begins_at_the_hopf_point():
    V, slider = 1e-3, CUT.replace(K=2e8)
    cycle = rs.limit_cycle(slider, V, rtol=1e-8)
    run = rs.simulate(
        slider, rs.Loading.constant(V), 40 * float(cycle.period), rtol=1e-10, V_start=V / 2
    )
    for name in ("amplitude", "frequency"):
        assert float(run[name]) == pytest.approx(float(cycle[name]), rel=1e-6)
    assert float(cycle.mu_min) == pytest.approx(
        float(run.mu[run.time > 0.5 * run.time[-1]].min()), abs=1e-5
    )
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
    plain = slider.replace(friction="log", mu0=0.6 + offset)
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
    assert "friction='cut-off', V1='10 mm/s', V2='1 m/s'" in repr(CUT)
    assert "cut-off" in CUT._repr_html_()
    assert CUT.replace(friction="LOG").values.keys() == {*"a b Dc sigma K M mu0 V0".split()}
    swept = CUT.replace(V1=xr.DataArray([1e-3, 1e-2], dims="V1"))
    cycles = rs.sweep(rs.limit_cycle, swept, V_lp=1e-4, store=tmp_path / "x.zarr", chunk=1)
    assert float(cycles.amplitude[1]) == float(rs.limit_cycle(CUT, 1e-4).amplitude)
    run = rs.simulate(CUT, rs.Loading.constant(1e-3), 0.05, V_start=5e-4)
    text = scenario.toml(scenario.from_result(run))
    assert 'friction = "cut-off"' in text
    assert scenario.loads(text).slider == CUT
    lines: dict = {}
    exec(scenario.python(scenario.loads(text)), lines)
    np.testing.assert_array_equal(lines["result"].tau, run.tau)
    again = files.read(files.write(run, tmp_path / "run.nc"))
    assert parameter(again, "friction") == "cut-off"
    assert law_of_result(again) is CUT.friction_law
    assert parameter(rs.stability(CUT.replace(friction="log"), 1.0), "friction") == "log"


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        (
            {"friction": "asinh"},
            r"^friction = 'asinh' is unknown. Choose 'log' or 'cut-off' or 'regularized'",
        ),
        ({"friction": 3}, r"^friction = 3 is unknown"),
        (
            {"friction": "cut-off", "V1": 1.0},
            r"^friction = 'cut-off' needs V2, cut-off speed of the state",
        ),
        ({"V1": 1.0}, r"^friction = 'log' has no parameter V1, which belongs to 'cut-off'"),
        ({"friction": "cut-off", "V1": 0.0, "V2": 1.0}, r"^V1 = 0 m/s must be > 0"),
        (
            {"friction": "cut-off", "V1": 1.0, "V2": 1.0, "law": "nagata", "c": 1.0},
            r"^friction = 'cut-off' does not go with law = 'nagata'",
        ),
        (
            {"friction": "log", "law": "flash-heating", "V_w": 0.1, "mu_w": 0.2},
            r"^friction = 'log' does not go with law = 'flash-heating', which needs",
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
