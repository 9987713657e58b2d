"""Fits under any law: additional parameters, several states, user's laws, comparison."""

from types import MappingProxyType

import numpy as np
import pytest
from synthetic_records import SLIDER, assert_finds, record
from textbook import Textbook

import ratestate as rs
from ratestate.friction.forms import FORMS, parameters_of
from ratestate.friction.laws import LAWS
from ratestate.laws import FrictionLaw, Parameter, log
from ratestate.records.fitting.by_law import results_by_law, stiffness_over_critical
from ratestate.records.fitting.forward import Forward
from ratestate.records.fitting.problem import SamplesProblem, samples_of
from ratestate.records.fitting.quantities import reported_quantities
from ratestate.records.fitting.solutions import least_squares_fit
from ratestate.records.fitting.unknowns import (
    unknowns_of,
)

STEP = rs.Loading.steps("1 um/s", (60.0, "10 um/s"))
T = np.concatenate([np.linspace(0.0, 59.0, 60), np.linspace(60.1, 160.0, 600)])
COMMON = {s: getattr(SLIDER, s) for s in ("a", "b", "Dc", "sigma", "K", "V0")}
TWO = rs.SpringSlider(**COMMON | {"b": 0.008}, law="two-state-slip", b2=0.004, Dc2=1.2e-4)
NAGATA = rs.SpringSlider(**COMMON, law="nagata", c=1.0)
KATO = rs.SpringSlider(**COMMON, law="kato-tullis", V_cut=3e-8)
FAST = KATO.replace(V_cut=1e-6)  # whose steady state is not that of other laws
FREE = ("a", "b", "Dc", "b2", "Dc2", "K")
START = TWO.replace(a=0.006, b=0.005, Dc="20 um", b2=0.002, Dc2="80 um", K=4e10)


class Stronger(FrictionLaw):
    """The slip law with a state that evolves faster and is exp(shift) Dc/V if steady."""

    name = "stronger"
    parameters = MappingProxyType(
        {
            "h_n": Parameter("1", "shift of the steady state", example="0.5"),
            "r_n": Parameter("1", "rate of the state", "> 0", example="1.0"),
        }
    )

    def evolution(self, V, theta, p):
        return -p.r_n * V * theta / p.Dc * (log(V * theta / p.Dc) - p.h_n)


@pytest.fixture(scope="module")
def noisy():
    return record(TWO, STEP, T, noise=1e-4, seed=3)


@pytest.fixture(scope="module")
def compared(noisy):
    with pytest.warns(rs.FitWarning, match=r"^slip law: "):
        return rs.fit(noisy, START, FREE, law=("slip", "two-state-slip"))


def test_fit_recovers_two_states_of_a_scipy_solution():
    """The record has no noise, and the initial guess has b2 of another sign."""
    law = "two-state-aging"
    truth = TWO.replace(law=law, b2=-0.003)
    delta_lp = 1e-6 * np.minimum(T, 60.0) + 1e-5 * np.maximum(T - 60.0, 0.0)
    twin, late = Textbook(law, truth.values), T > 60.0
    start = twin.steady(1e-6)
    friction = np.full(T.size, start[0])
    friction[late] = twin.solve(start, 1e-5, T[late], start=60.0)[:, 0]
    columns = {"friction": ("time", friction), "delta_lp": ("time", delta_lp)}
    data = rs.simulate(truth, STEP, T[-1], times=T)[["delta_lp"]].assign(columns)
    result = rs.fit(data, START.replace(law=law), FREE)
    for name in FREE:
        assert float(result[name]) == pytest.approx(getattr(truth, name), rel=1e-4), name
    assert float(result.a_minus_b) == pytest.approx(0.01 - 0.008 + 0.003, rel=1e-4)
    assert float(result.rms) < 1e-8


@pytest.mark.parametrize(
    ("truth", "name", "off"), [(NAGATA, "c", 3.0), (NAGATA, "c", 0.0), (KATO, "V_cut", 10.0)]
)
def test_a_law_s_own_parameter_is_found(truth, name, off):
    """The record has a hold; the guess is wrong, right, or at the bound 0."""
    loading = rs.Loading.steps("1 um/s", (40.0, 0.0), (340.0, "1 um/s"), (400.0, "10 um/s"))
    t = np.concatenate([np.linspace(0.0, 339.0, 200), np.linspace(340.5, 440.0, 500)])
    data = record(truth, loading, t, noise=2e-5, seed=1)
    start = truth.replace(a=0.006, Dc="20 um", **{name: off * getattr(truth, name)})
    free = ("a", "b", "Dc", "K", name)
    result = rs.fit(data, start, free)
    assert_finds(result, truth, free, within=3.5, widest=0.6 / 3.5)


def test_a_user_s_law_is_fitted():
    """Its steady state is found numerically."""
    own = rs.SpringSlider(**COMMON, law=Stronger, h_n=0.7, r_n=2.0)
    data = record(own, STEP, T, noise=1e-4, seed=2)
    result = rs.fit(data, own.replace(a=0.006, r_n=0.5), ("a", "b", "r_n", "K"), law=Stronger)
    assert_finds(result, own, ("a", "b", "r_n", "K"), within=3.5, widest=0.1)
    # mu0 is not that of steady sliding at V0, which the shift raises by b h_n
    assert float(result.mu0) == pytest.approx(0.6, abs=2e-4)
    assert float(result.friction_fit[0]) == pytest.approx(0.6 + 0.014 * 0.7, abs=2e-4)
    found = rs.fitted_slider(result)
    assert (found.law, found.h_n, found.r_n) == (own.law, 0.7, float(result.r_n))


def test_bounds_of_a_law_s_own_parameters(noisy):
    """Sizes: Dc2 as Dc; b2 as b or its value; c its value; V_cut the slowest V."""

    def ends(slider, name):
        data = samples_of(noisy, slider, loading=None, trend=None, against="time")
        _, low, high = unknowns_of(data, slider, (name,), start=False)
        return np.array([low[0], high[0]])

    np.testing.assert_array_equal(ends(TWO, "Dc2"), ends(TWO, "Dc"))
    np.testing.assert_array_equal(ends(TWO, "b2"), ends(TWO, "b"))
    np.testing.assert_allclose(ends(TWO.replace(b2=-0.5), "b2"), [-50.0, 50.0])
    np.testing.assert_allclose(ends(NAGATA, "c"), [0.0, 1e3])
    np.testing.assert_allclose(ends(NAGATA.replace(c=0.0), "c"), [0.0, 1e3])
    np.testing.assert_allclose(ends(NAGATA.replace(c=4.0), "c"), [0.0, 4e3])
    np.testing.assert_allclose(ends(KATO, "V_cut"), np.log([1e-12, 1.0]), rtol=1e-4)


@pytest.mark.parametrize("slider", [TWO, NAGATA, FAST], ids=lambda slider: slider.law)
@pytest.mark.parametrize(("kind", "M"), [("friction", 0.0), ("friction", 2e11), ("mu", 2e11)])
def test_friction_agrees_with_simulate(slider, kind, M, noisy):
    """With mass it starts in steady sliding, without mass also from other states."""
    slider = slider.replace(M=M)
    data = samples_of(noisy.rename(friction=kind), slider, loading=STEP, trend=None, against="time")
    names = ("V_start", *(f"{state}_start" for state in slider.friction_law.states))
    ratios = (0.5, 0.3, -0.4)[: len(names)] if M == 0.0 else (0.0,) * len(names)
    steady = rs.simulate(slider, STEP, 1.0, times=[0.0]).isel(time=0)
    begin = {
        symbol.removesuffix("_start"): float(steady[symbol.removesuffix("_start")]) * np.exp(ratio)
        for symbol, ratio in zip(names, ratios, strict=True)
    }
    initial = None if M else begin
    run = rs.simulate(slider, STEP, T[-1], times=T, rtol=1e-10, initial=initial)
    expected = run.mu if kind == "mu" else run.tau / slider.sigma
    point = np.array([[*ratios, float(steady.mu)]])
    found = Forward(data, slider, (*names, "level")).friction(point)[0]
    np.testing.assert_allclose(found, expected, rtol=0, atol=2e-8)
    assert abs(float(expected[0]) - float(steady.mu)) > (1e-3 if M == 0.0 else -1.0)


def test_friction_at_a_point_does_not_depend_on_the_other_points(noisy):
    """Newton's method for mu0 needs more steps at some points than at others."""
    own = {"law": "flash-heating", "V_w": 1e-5, "mu_w": 0.2, "mu0": 0.6}
    slider = rs.SpringSlider(**COMMON, **own)
    data = samples_of(noisy, slider, loading=STEP, trend=None, against="time")
    forward = Forward(data, slider, ("a", "V_w"))
    points = np.array([[0.01, np.log(V_w)] for V_w in (1e-7, 1e-6, 1e-5, 1e-3, 1.0)])
    together = forward.friction(points)
    alone = np.concatenate([forward.friction(points[k : k + 1]) for k in range(len(points))])
    np.testing.assert_array_equal(together, alone)
    assert np.ptp(together, axis=0).max() > 1e-3


def test_states_keep_the_order_of_their_distances(noisy):
    """The distances in the slider tell which of two states is the first."""
    other = START.replace(b=0.002, Dc="80 um", b2=0.005, Dc2="20 um")
    one, two = (rs.fit(noisy, start, FREE, errors="covariance") for start in (START, other))
    assert float(one.Dc) < float(one.Dc2)
    for first, second in (("b", "b2"), ("Dc", "Dc2"), ("b2", "b"), ("Dc2", "Dc"), ("K", "K")):
        assert float(two[first]) == pytest.approx(float(one[second]), rel=1e-3), first


def test_each_compared_law_has_its_own_parameters(noisy, compared):
    """The first law lacks b2 and Dc2; each law's result equals its separate fit."""
    slip, two = (compared.sel(law=law) for law in ("slip", "two-state-slip"))
    order = [*FREE[:5], "K", "mu0", "a_minus_b", "trend_slip"]
    assert compared.parameter.values.tolist() == order
    for name in ("b2", "Dc2"):
        assert np.isnan(slip[name])
        assert np.isnan(slip.standard_error.sel(parameter=name))
    assert_finds(two, TWO, ("b2", "Dc2"), widest=np.inf)
    alone = rs.fit(noisy, START.replace(law="two-state-slip"), FREE)
    assert float(two.log_likelihood) == float(alone.log_likelihood)
    counted = (compared.aic + 2.0 * compared.log_likelihood).values / 2.0
    white = [2 if red > 0.0 else 0 for red in compared.noise_red.values]
    # a, b, Dc, K, level, trend and the noise's one or three; and b2, Dc2
    np.testing.assert_allclose(counted, [7 + white[0], 9 + white[1]])
    assert float(compared.aic_difference.sel(law="slip")) > 100.0
    assert "The two-state-slip law fits clearly better than the slip law" in compared.comparison


def test_stiffness_over_critical_with_two_states(compared):
    """Compare its error with samples of the Gaussian of the fit."""
    part = results_by_law(compared)["two-state-slip"]
    ratio, error = stiffness_over_critical(part)
    slider = rs.fitted_slider(compared, "two-state-slip")
    assert ratio == pytest.approx(slider.K / slider.K_c_qs, rel=1e-10)
    names, rng = list(FREE), np.random.default_rng(1)
    correlation = part.correlation.sel(parameter=names, other=names).values
    errors = part.standard_error.sel(parameter=names).values
    drawn = rng.multivariate_normal(np.zeros(6), correlation, size=400) * errors
    sampled = []
    for row in drawn:
        values = {name: getattr(slider, name) + x for name, x in zip(names, row, strict=True)}
        moved = slider.replace(**values)
        sampled.append(moved.K / moved.K_c_qs)
    assert error == pytest.approx(np.std(sampled), rel=0.15)


def test_gradients_of_derived_quantities(noisy):
    """a - b - b2 depends on b2 alone, and mu0 on another V0."""
    data = samples_of(noisy, TWO, loading=None, trend="slip", against="time")
    solution = least_squares_fit(data, TWO.replace(V0=1e-8), ("Dc", "b2"), None, "steady")
    by_name = {quantity.name: quantity for quantity in reported_quantities(solution.problem)}
    rate, mu0 = by_name["a_minus_b"], by_name["mu0"]
    at = dict(zip(solution.unknowns.names, solution.point, strict=True))
    expected = 0.01 - 0.008 - at["b2"]
    assert rate.value(solution.point) == pytest.approx(expected, rel=1e-9)
    height = np.log(data.loading.V[0] / 1e-8)
    level = at["level"] - expected * height
    assert mu0.value(solution.point) == pytest.approx(level, rel=1e-12)
    index = solution.unknowns.names.index("b2")
    assert rate.gradient(solution.point)[index] == pytest.approx(-1.0, rel=1e-9)
    assert mu0.gradient(solution.point)[index] == pytest.approx(height, rel=1e-8)
    without = least_squares_fit(data, TWO, ("Dc", "K"), None, "steady")
    assert "a_minus_b" not in [quantity.name for quantity in reported_quantities(without.problem)]


REFUSED = {
    "own": ((SLIDER, ("a", "b2")), {}, r"free has 'b2', which belongs to 'two-state-aging' and"),
    "none": ((TWO, ("a", "b3")), {}, "free has 'b3', which is not a parameter of the fit"),
    "lacks": (
        (SLIDER, ("a",)),
        {"law": ("slip", "two-state-slip")},
        "law = 'two-state-slip' needs b2, Dc2, which the slider of the law 'slip' does not have",
    ),
    "nothing": ((TWO, ("b2",)), {"law": ("slip", "two-state-slip")}, "'slip' only mu0 is free"),
    "cycles": ((TWO, ("a",)), {"against": "cycles"}, r"in fit\(..., against="),
}


@pytest.mark.parametrize("case", REFUSED)
def test_parameters_that_a_law_lacks_are_refused(case, noisy):
    arguments, options, message = REFUSED[case]
    with pytest.raises(rs.ParameterError, match=message):
        rs.fit(noisy, *arguments, **options)


@pytest.mark.parametrize("name", ["level", "trend", "a_minus_b"])
def test_a_law_with_a_reserved_parameter_name_is_refused(name, noisy, monkeypatch):
    own = {**TWO.friction_law.parameters, name: Parameter("1", "any")}
    monkeypatch.setattr(type(TWO.friction_law), "parameters", own)
    monkeypatch.setattr(rs.SpringSlider, name, 1.0, raising=False)
    with pytest.raises(rs.ParameterError, match=f"has a parameter {name}, which is also"):
        rs.fit(noisy, TWO, ("a",))


#: symbol -> value, of parameters that laws and forms of friction have
OWN = {"b2": 0.004, "Dc2": 1.2e-4, "c": 1.0, "V_cut": 3e-8, "V_w": 1e-2, "mu_w": 0.2}
OWN |= {"V1": 1e-2, "V2": 1e-3}


def slider_under(law, form, **changes):
    """Return a slider under any law and form, with V0 unlike the record's speeds."""
    names = (*LAWS[law].parameters, *parameters_of(form))
    own = {name: OWN[name] for name in names} | {"mu0": 0.55, "V0": 3e-6}
    return rs.SpringSlider(**COMMON | own | changes, law=law, friction_form=form)


ALL = [*((law, LAWS[law].form) for law in LAWS), *(("slip", form) for form in FORMS)]


@pytest.mark.parametrize(("law", "form"), ALL)
@pytest.mark.parametrize("kind", ["friction", "mu"])
def test_friction_and_mu0_under_every_law_and_form(law, form, kind):
    """Friction equals that of a run, and mu0 the slider's, for another V0."""
    slider = slider_under(law, form)
    data = record(slider, STEP, T)
    if kind == "mu":
        run = rs.simulate(slider, STEP, float(T[-1]), times=T, rtol=1e-9)
        data = run[["delta_lp", "mu"]]
    checked = samples_of(data, slider, loading=None, trend=None, against="time")
    problem = SamplesProblem(checked, slider, unknowns_of(checked, slider, ("a", "b"), start=False))
    point = np.array([np.log(slider.a), slider.b, checked.friction[0]])
    found = problem.forward.friction(point[None])[0]
    np.testing.assert_allclose(found, checked.friction, rtol=0.0, atol=2e-7)
    (mu0,) = [q for q in reported_quantities(problem) if q.name == "mu0"]
    assert mu0.value(point) == pytest.approx(0.55, abs=2e-7)
