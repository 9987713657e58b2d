"""A dashpot beside friction: its motion, stability and cycles under every law."""

import math

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar
from synthetic_records import record
from textbook import drawn

import ratestate as rs
from ratestate.dynamics.basin import escape
from ratestate.dynamics.cycles.regimes import classify
from ratestate.dynamics.refusals import check_one_length
from ratestate.dynamics.results import whole_contact
from ratestate.friction.composition import composed_law
from ratestate.friction.laws import LAWS, one_length_laws

FIG2 = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=3e3, K=4e8)
DAMPED = FIG2.replace(damping=5e4)


def heavy(law, rng):
    """Parameters of a slider with about as much damping as direct effect; its speed."""
    parameters, V = drawn(law, rng)
    zeta = 10 ** rng.uniform(-2, 0.5)
    return parameters | {"damping": zeta * parameters["a"] * parameters["sigma"] / V}, V


def K_c(V, *, a, b, Dc, sigma, M, damping, **_):
    """In closed form, for laws of one length."""
    return (sigma * (b - a) - damping * V) / Dc * (1 + M * V**2 / (Dc * (a * sigma + damping * V)))


@settings(max_examples=25)
@given(seed=st.integers(0, 10**6))
def test_critical_stiffness_in_closed_form(seed):
    rng = np.random.default_rng(seed)
    law = rng.choice(sorted(one_length_laws()))
    parameters, V = heavy(law, rng)
    case = rs.SpringSlider(**parameters, law=law)
    exact = K_c(V, **parameters)
    size = parameters["sigma"] * parameters["b"] / parameters["Dc"]
    for slider in (case, case.replace(M=0.0)):
        exact = K_c(V, **slider.values)
        if exact > 1e-6 * size:
            assert slider.K_c(V) == pytest.approx(exact, rel=1e-9)
            K = xr.DataArray([exact * (1.0 + 1e-9), exact * (1.0 - 1e-9)], dims="K")
            both = rs.stability(slider.replace(K=K), V)
            assert both.stable.values.tolist() == [True, False]
            assert (both.eigenvalues[:, 0].real < 0.0).values.tolist() == [True, False]
        elif exact < -1e-6 * size:
            assert slider.K_c(V) <= 0.0
            assert rs.stability(slider, V).stable


@settings(max_examples=10)
@given(seed=st.integers(0, 10**6))
def test_critical_speeds_solve_a_cubic(seed):
    """Of K = K_c(V): by np.roots; sliding may be stable again above V_c_upper."""
    rng = np.random.default_rng(seed)
    many = [heavy("slip", rng)[0] for _ in range(10)]
    arrays = {name: xr.DataArray([p[name] for p in many], dims="case") for name in many[0]}
    together = rs.SpringSlider(**arrays)
    for parameters, *found in zip(many, together.V_c, together.V_c_upper, strict=True):
        expected = critical_speeds(rs.SpringSlider(**parameters))
        assert [float(V) for V in found] == pytest.approx(expected, rel=1e-9)


def critical_speeds(s):
    """V_c and V_c_upper of a slider with damping, under a law of one length."""
    A, B, d, m = s.a * s.sigma, (s.b - s.a) * s.sigma, s.damping, s.M / s.Dc
    # (B - d V)(A + d V + m V^2) = K Dc (A + d V)
    k = s.K * s.Dc
    roots = np.roots([-d * m, B * m - d**2, (B - A - k) * d, (B - k) * A])
    edges = sorted(x.real for x in roots if abs(x.imag) < 1e-7 * abs(x) and x.real > 0)
    falls = [V for V in edges if K_c(V * 0.999, **s.values) > s.K > K_c(V * 1.001, **s.values)]
    rises = [V for V in edges if K_c(V * 0.999, **s.values) < s.K < K_c(V * 1.001, **s.values)]
    lower = 0.0 if k < B else rises[0] if rises else math.inf
    return lower, next((V for V in falls if lower < V), math.inf)


def test_a_branch_along_damping_ends_where_it_makes_sliding_stable():
    V = 1e-3
    slider = DAMPED.replace(damping=5e5)
    branch = rs.continue_cycle(slider, "damping", 5e5, 5e6, V_lp=V, rtol=1e-6)
    assert str(branch.special[-1].values) == "hopf"
    end = slider.replace(damping=float(branch.damping[-1]))
    assert end.K_c(V) == pytest.approx(slider.K, rel=1e-9)


def test_no_damping_is_the_law_alone():
    """The same kernel, and so the same bits; the slider says nothing of it."""
    slider = FIG2.replace(damping=0.0)
    assert slider == FIG2
    assert slider.friction_law is LAWS["slip"]
    assert "damping" not in repr(slider)
    assert "damping" not in slider.parameters
    assert DAMPED.replace(damping="0 Pa s/m") == FIG2
    assert DAMPED.friction_law.name == "slip+damping"
    assert DAMPED.replace(law="aging").friction_law is composed_law("aging+damping")
    assert DAMPED.replace(law="aging").damping == 5e4


def test_impossible_damping_is_refused():
    for value, text in (
        (-1.0, r"damping = -1 Pa s/m must be >= 0"),
        ("5 MPa", r"damping = '5 MPa' is a stress"),
        ("10 N s/m", r"damping = '10 N s/m' is of the whole contact"),
    ):
        with pytest.raises(rs.ParameterError, match=text):
            FIG2.replace(damping=value)
    with pytest.raises(rs.ParameterError, match=r"^with damping K_c_qs depends on the speed"):
        _ = DAMPED.K_c_qs
    cut = DAMPED.replace(friction_form="cut-off", V1=1.0, V2=1.0)
    with pytest.raises(rs.ParameterError, match=r"^with cut-off and damping K_c_qs depends"):
        _ = cut.K_c_qs
    with pytest.raises(rs.ParameterError, match=r"no parameter dampng.* Did you mean damping"):
        rs.SpringSlider(**FIG2.parameters, dampng=1.0)


@pytest.mark.parametrize("kind", ["friction", "mu"])
def test_damping_is_fitted(kind):
    """Beside all that friction has: it tells in three speeds, in tau/sigma and through K in mu."""
    truth = rs.SpringSlider(a=0.008, b=0.010, Dc=1e-5, sigma=5e6, K=2e9, damping=1e6)
    loading = rs.Loading.steps(1e-4, (0.2, 3e-3), (0.6, 3e-2))
    data = record(truth, loading, np.linspace(0.0, 1.0, 800), noise=1e-4, seed=2)
    if kind == "mu":
        noise = np.random.default_rng(3).normal(size=data.time.size)
        run = rs.simulate(truth, loading, 1.0, times=data.time.values)
        data = data.drop_vars("friction").assign(mu=run.mu + 1e-4 * noise)
    start = truth.replace(a=0.006, b=0.009, Dc=2e-5, damping=3e5, K=3e9)
    free = ("a", "b", "Dc", "K", "damping")
    result = rs.fit(data, start, free)
    for name in (*free, "mu0"):
        error = float(result.standard_error.sel(parameter=name))
        assert abs(float(result[name]) - getattr(truth, name)) < 3.5 * error, name
        assert error < 0.02 * getattr(truth, name), name
    assert float(result.a_minus_b) == pytest.approx(-0.002, abs=2e-5)
    assert rs.fitted_slider(result).damping == float(result.damping)
    with pytest.raises(rs.ParameterError, match=r"^damping is free but starts at 0 Pa s/m"):
        rs.fit(data, start.replace(damping=0.0), ("a", "damping"))


@pytest.mark.parametrize(("M", "below"), [(100.0, 1e-2), (777.0, 1e-4), (3e3, 1e-6)])
def test_a_narrow_band_of_unstable_speeds_is_found(M, below):
    """Of a slider just softer than the peak of K_c, which lies between speeds of any grid."""
    slider = rs.SpringSlider(a=0.01, b=0.015, Dc=1e-5, sigma=5e6, M=M, damping=1e5, K=1e9)
    peak = minimize_scalar(lambda x: -K_c(math.exp(x), **slider.values), (-4.0, -2.0), tol=1e-14)
    K, V = -float(peak.fun), math.exp(float(peak.x))
    soft = slider.replace(K=K * (1.0 - below))
    assert soft.V_c < V < soft.V_c_upper < 1.3 * soft.V_c
    for speed in (soft.V_c, soft.V_c_upper):
        assert K_c(speed, **soft.values) == pytest.approx(soft.K, rel=1e-9)
    assert str(rs.hopf(soft).type.values) != "none"
    assert slider.replace(K=K * (1.0 + below)).V_c == math.inf


def test_a_push_does_not_run_away_from_a_dashpot():
    """By the slip law, too, of which the edge of runaway without damping is known."""
    slider = rs.SpringSlider(a=0.01, b=0.015, Dc=1e-5, sigma=5e6, K=2.6e9)
    free = escape(slider, 1e-6)
    assert "runaway" in str(free.outcome.values)
    damped = escape(slider.replace(damping=5e6), 1e-6)
    assert "runaway" not in str(damped.outcome.values)
    run = rs.simulate(slider.replace(damping=5e6), rs.Loading.constant(1e-6), 1e4, V_start=1e-7)
    assert float(run.V[-1]) == pytest.approx(1e-6, rel=1e-4)
    assert float(run.V_max) > 1e-3


def test_little_damping_gives_a_cycle_although_V_exceeds_the_speed_of_light():
    """However fast it slips: the speed of light is no limit of a model that has none."""
    slider = rs.SpringSlider(a=0.01, b=0.015, Dc=1e-3, sigma=5e7, K=7.5e7, damping=0.03)
    cycle = rs.limit_cycle(slider, 1e-9)
    assert int(cycle.status) == 0
    assert float(cycle.V_max) > 3e8


def test_an_earthquake_is_not_slow_stick_slip():
    """Without mass it is the dashpot that holds it: by a tenth of the stress drop, or less."""
    fault = rs.SpringSlider(a=0.01, b=0.015, Dc=1e-2, sigma=5e7, K=1e6, damping=5e6)
    cycle = rs.limit_cycle(fault, 1e-9)
    assert str(classify(cycle).regime.values) == "stick-slip"
    edge = 0.1 * cycle.amplitude * fault.sigma / fault.damping
    for part, regime in ((1.01, "stick-slip"), (0.99, "slow stick-slip")):
        V_max = (part * edge).assign_attrs(cycle.V_max.attrs)
        assert str(classify(cycle.assign(V_max=V_max)).regime.values) == regime


def test_acceleration_with_a_dashpot():
    slider = DAMPED.replace(area=2e-3)
    run = rs.simulate(slider, rs.Loading.steps(1e-3, (0.01, 5e-3)), 0.05, rtol=1e-8)
    found = whole_contact(run)
    V, t, acceleration = (x.values for x in (run.V, run.time, found.acceleration))
    largest = np.argmax(np.abs(acceleration))
    slope = (V[largest + 1] - V[largest - 1]) / (t[largest + 1] - t[largest - 1])
    assert acceleration[largest] == pytest.approx(slope, rel=0.05)
    assert float(found.acceleration_max) == pytest.approx(abs(acceleration[largest]), rel=0.05)


def test_functions_without_damping_refuse_a_damped_slider():
    with pytest.raises(rs.ParameterError, match=r"law = 'slip' .*no damping"):
        check_one_length("fit", DAMPED.friction_law.name)
    given = {"V": 1e-2, "theta": 1e-2, "tau": 1e6}
    with pytest.raises(rs.ParameterError, match=r"tau must be sigma mu \+ damping V = "):
        rs.simulate(DAMPED.replace(M=0.0), rs.Loading.constant(1e-3), 1.0, initial=given)


def test_a_search_where_sliding_is_stable_at_any_stiffness_warns_of_nothing():
    """There is no Hopf bifurcation there, nor anything else of it."""
    slider = DAMPED.replace(a=0.01, b=0.005, damping=1e3, K=1e7)
    assert slider.K_c(1.0) < 0.0
    assert int(rs.limit_cycle(slider, 1.0).status) == 1
    assert np.isnan(rs.hopf(slider, 1.0).lyapunov_1)
