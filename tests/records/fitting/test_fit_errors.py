"""Errors of fits: profiles, posterior, comparison of laws, notes and warnings."""

import pickle
import re
from types import SimpleNamespace

import numpy as np
import pytest
import xarray
from scipy.stats import norm
from synthetic_records import SLIDER, correlated, power_law, record

import ratestate as rs
from ratestate import ParameterError
from ratestate.records.fitting import posterior as sampling
from ratestate.records.fitting import settings
from ratestate.records.fitting.fit_dataset import with_comparison
from ratestate.records.fitting.identifiability import (
    correlated_groups,
    identifiability,
    product,
    tradeoff_text,
)
from ratestate.records.fitting.inference import infer
from ratestate.records.fitting.posterior import LogLikelihood, sample_posterior
from ratestate.records.fitting.problem import Samples, samples_of
from ratestate.records.fitting.profile import (
    BetterPoint,
    Profile,
    are_gaussian,
    compute_profile,
    compute_profiles,
)
from ratestate.records.fitting.quantities import (
    GAUSSIAN,
    ROOTS,
    ReportedQuantity,
    estimates_from,
    reported_quantities,
)
from ratestate.records.fitting.solutions import (
    Solution,
    least_squares_fit,
    root_of_covariance,
)
from ratestate.records.fitting.unknowns import Unknowns, unknowns_of
from ratestate.records.kit.noise import Noise

T = np.concatenate([np.linspace(60.0, 99.0, 80), np.linspace(99.1, 130.0, 220)]) - 60.0
STEP = rs.Loading.steps("1 um/s", (40.0, "10 um/s"))
FREE = ("a", "b", "Dc", "K")
STIFF = SLIDER.replace(K=5e12)
LONG_T, LONG_STEP = np.arange(0.0, 140.0, 0.2), rs.Loading.steps("1 um/s", (100.0, "10 um/s"))


def solution_of(data, slider, free=FREE, noise=None):
    checked = samples_of(data, slider, loading=None, trend="slip", against="time")
    return least_squares_fit(checked, slider, free, noise, "steady")


@pytest.fixture(scope="module")
def good():
    return record(SLIDER, STEP, T, noise=2e-4, seed=4)


@pytest.fixture(scope="module")
def stiff():
    return record(STIFF, STEP, T, noise=5e-4, seed=4)


@pytest.fixture(scope="module")
def solution(good):
    return solution_of(good, SLIDER)


@pytest.fixture(scope="module")
def sampled(good):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sampling, "LIVE", 60)
        patch.setattr(sampling, "FEWEST", 100)
        return rs.fit(good, SLIDER, ("a",), errors="posterior")


def test_the_profile_of_a_gaussian_likelihood_is_the_covariance(solution):
    numbers = reported_quantities(solution.problem)
    assert all(are_gaussian(solution, numbers))
    assert compute_profiles(solution, numbers, False, [GAUSSIAN] * len(numbers)) == {}
    for number in (numbers[2], numbers[5], numbers[6]):
        one = compute_profile(solution, number)
        gradient = number.gradient(solution.point)
        error = np.sqrt(gradient @ solution.covariance @ gradient)
        ends = (one.interval() - number.value(solution.point)) / error
        np.testing.assert_allclose(ends, ROOTS[:, None] * [-1.0, 1.0], rtol=0.05)
        assert one.ends == ("closed", "closed")


def test_a_profile_is_the_least_of_all_fits_with_that_value(solution):
    """Compare with fits of a, b, Dc in which the slider has that K."""
    number = reported_quantities(solution.problem)[3]
    one = compute_profile(solution, number)
    for value, deviance in zip(one.values[[0, -1]], one.deviance[[0, -1]], strict=True):
        slider = SLIDER.replace(K=float(np.exp(value)))
        other = least_squares_fit(
            solution.problem.record,
            slider,
            ("a", "b", "Dc"),
            solution.noise,
            "steady",
        )
        assert other.chi2 - solution.chi2 == pytest.approx(deviance, abs=2e-3)
        assert deviance > ROOTS[-1] ** 2


def test_a_stiff_machine_gives_a_lower_bound_of_K(stiff):
    start = STIFF.replace(K=1e12)
    with pytest.warns(rs.FitWarning, match=r"the record only shows that K > .* too stiff"):
        result = rs.fit(stiff, start)
    K = result.interval.sel(parameter="K", level=0.95).values
    assert 2e11 < K[0] < STIFF.K
    assert K[1] == np.inf
    assert str(result.interval_kind.sel(parameter="K").values) == "profile"
    assert "Not determined: K (> " in result.identifiability.item()
    for name in ("a", "b", "Dc"):
        low, high = result.interval.sel(parameter=name, level=0.95).values
        assert low < getattr(STIFF, name) < high
    deviance = result.profile_deviance.sel(parameter="K")
    assert float(deviance[0]) > 3.84
    assert float(deviance.max("profile_point")) == float(deviance[0])
    assert not np.isnan(result.interval).any()
    absent = np.isnan(result.profile_value).all("profile_point")
    np.testing.assert_array_equal(absent, result.interval_kind == "covariance")
    np.testing.assert_array_equal(np.isnan(result.profile_value), np.isnan(result.profile_deviance))


def test_an_interval_of_a_parameter_far_below_its_guess_is_closed():
    """c of Nagata's law has a wide range: values below its guess are not at bounds."""
    truth = SLIDER.replace(law="nagata", c=2.0)
    loading = rs.Loading.steps("1 um/s", (30.0, "10 um/s"), (45.0, "1 um/s"))
    data = record(truth, loading, np.arange(0.0, 100.0, 0.1), noise=1e-3, seed=1)
    result = rs.fit(data, truth.replace(c=5.0), ("a", "b", "Dc", "c"), errors="profile")
    low, high = result.interval.sel(parameter="c", level=0.95).values
    error = float(result.standard_error.sel(parameter="c"))
    assert result.interval_kind.sel(parameter="c") == "profile"
    assert 1.0 * error < float(result.c) - low < 3.0 * error
    assert 1.0 * error < high - float(result.c) < 4.0 * error
    assert low < 2.0 < high


def test_a_better_point_on_a_profile_becomes_the_solution(good, solution):
    point = solution.point.copy()
    point[2] += 0.01
    worse = solution._replace(point=point, chi2=solution.chi2 + 5.0)
    with pytest.raises(BetterPoint):
        compute_profile(worse, reported_quantities(solution.problem)[0])
    again = infer(worse, None, "profile")
    assert again.solution.chi2 == pytest.approx(solution.chi2, rel=1e-3)
    np.testing.assert_allclose(again.solution.point, solution.point, rtol=1e-3)
    assert not again.still_improving


def test_interval_ends_of_a_profile_that_is_not_a_parabola():
    values = np.linspace(-3.0, 4.0, 29)
    wave = np.where(values < 0.0, values**2, np.minimum(values, 1.5) ** 2)
    found = Profile(values, wave, values[:, None], ("closed", "open")).interval()
    np.testing.assert_allclose(found[:, 0], -ROOTS, rtol=1e-6)
    assert found[0, 1] == pytest.approx(ROOTS[0], rel=1e-6)
    assert found[1, 1] == np.inf
    edge = Profile(values, wave, values[:, None], ("closed", "edge")).interval()
    assert edge[1, 1] == 4.0
    # of several crossings the outermost counts
    dips = np.interp(values, [-3, 0, 2, 3, 4], [9, 0, 9, 1, 9])
    several = Profile(values, dips, values[:, None], ("closed", "closed")).interval()
    assert 3.0 < several[1, 1] < 4.0


def test_level_and_trend_are_integrated_out(solution):
    """Compare with quadrature of the likelihood over both."""
    moving = [i for i, name in enumerate(solution.unknowns.names) if name in FREE]
    marginal = LogLikelihood(solution.problem, Noise(3e-4, 2e-4, 2.0))
    coordinates = solution.point[moving] + [0.02, 1e-4, -0.03, 0.01]
    value, blob = marginal.at(coordinates)
    t, friction = solution.problem.record.t, solution.problem.record.friction
    root = blob[2:].reshape(2, 2)
    spread = np.sqrt(np.diag(root @ root.T))

    def log_likelihood(level, trend):
        point = np.zeros(solution.point.size)
        point[moving], point[-2:] = coordinates, (level, trend)
        residual = friction - solution.problem.forward.friction(point[None])[0]
        white, log_determinant = marginal.noise.whiten(t, residual)
        constant = t.size * np.log(2 * np.pi)
        return -0.5 * (white[:, 0] @ white[:, 0] + log_determinant + constant)

    top = log_likelihood(*blob[:2])
    nodes, weights = np.polynomial.hermite.hermgauss(12)
    inner = [
        sum(
            v
            * np.exp(log_likelihood(*(blob[:2] + np.sqrt(2.0) * root @ [x, y])) - top + x**2 + y**2)
            for y, v in zip(nodes, weights, strict=True)
        )
        for x in nodes
    ]
    integral = 2.0 * abs(np.linalg.det(root)) * (weights @ inner)
    assert value == pytest.approx(top + np.log(integral), abs=1e-6)
    assert (spread > 0.0).all()


def test_the_likelihood_is_a_function_of_values_in_the_order_of_free(good, solution):
    """It falls by 1/2 if a is a standard error off, with the best K for that a."""
    function = rs.log_likelihood(good, SLIDER, ("K", "mu0", "a"), noise=2e-4)
    assert function.names == ("K", "a")
    fitted = rs.fit(good, SLIDER, ("a", "K"), noise=2e-4, errors="covariance", start="steady")
    best = np.array([float(fitted.K), float(fitted.a)])
    errors = fitted.standard_error.sel(parameter=["K", "a"]).values / best
    correlation = float(fitted.correlation.sel(parameter="K", other="a"))
    top, moved = function(best), best * np.exp(errors * [correlation, 1.0])
    assert function(moved) - top == pytest.approx(-0.5, abs=0.1)
    again = pickle.loads(pickle.dumps(function))
    assert again(best) == top
    for impossible in ([1e9, 0.01], [-1e10, 0.01], [np.nan, 0.01]):
        assert function(impossible) == -np.inf
    for wrong in (best[:1], 0.01, [best, best], ["5 GPa/m", 0.01]):
        with pytest.raises(rs.ParameterError, match="Give 2 numbers: K, a"):
            function(wrong)
    assert rs.log_likelihood(good, SLIDER, iter(["a"]), noise=2e-4).names == ("a",)
    with pytest.raises(rs.ParameterError, match="alpha is free, but normal stress is constant"):
        rs.log_likelihood(good, SLIDER, ("a", "alpha"))


def test_the_posterior_of_a_gaussian_is_the_gaussian(sampled, good):
    profiled = rs.fit(good, SLIDER, ("a",), errors="profile")
    assert (sampled.interval_kind == "posterior").all()
    assert (profiled.interval_kind == "profile").all()
    width = sampled.interval.diff("side") / profiled.interval.diff("side")
    assert np.abs(width - 1.0).max() < 0.15
    shift = (sampled.interval - profiled.interval).sel(level=0.95) / profiled.standard_error
    assert np.abs(shift).max() < 0.35
    spread = sampled.posterior.std("sample") / profiled.standard_error
    assert np.abs(spread - 1.0).max() < 0.12
    assert 100 < float(sampled.effective_samples) < float(sampled.posterior_evaluations)
    assert "flat in ln a from" in sampled.attrs["prior"]
    assert sampled.warnings.item() == ""


def test_a_known_posterior_is_found(good, monkeypatch):
    """The likelihood is Student's t, with known quantiles and evidence."""
    from scipy.stats import t as student

    def known(self, coordinates):
        self.evaluations += 1
        value = student.logpdf(coordinates, 4).sum()
        return float(value), np.zeros(6)

    monkeypatch.setattr(LogLikelihood, "at", known)
    monkeypatch.setattr(sampling, "LIVE", 100)
    box = dict.fromkeys(("a", "Dc"), (-20.0, 20.0))
    solution = solution_of(good, SLIDER, ("a", "Dc"))
    found = sample_posterior(solution, box, "test")
    inside = student.cdf(20.0, 4) - student.cdf(-20.0, 4)
    assert abs(found.log_evidence - 2.0 * np.log(inside / 40.0)) < 3.5 * found.log_evidence_error
    number = reported_quantities(solution.problem)[1]
    expected = student.ppf(norm.cdf(ROOTS), 4)
    np.testing.assert_allclose(found.interval(number)[:, 1], expected, rtol=0.25)
    np.testing.assert_allclose(found.interval(number)[:, 0], -expected, rtol=0.25)
    assert found.complete


def test_warnings_on_a_truncated_or_unreliable_posterior(stiff, good, monkeypatch):
    monkeypatch.setattr(sampling, "LIVE", 20)
    with pytest.warns(rs.FitWarning) as emitted:
        result = rs.fit(stiff, STIFF.replace(K=1e12), ("K", "Dc"), errors="posterior")
    texts = " ".join(str(one.message) for one in emitted)
    assert "the posterior of K reaches the upper end of its prior" in texts
    assert "effective samples: the intervals are not its quantiles" in texts
    assert not (result.interval_kind == "posterior").any()
    monkeypatch.setattr(sampling, "MOST", 100)
    with pytest.warns(rs.FitWarning) as emitted:
        rs.fit(good, SLIDER, ("a",), errors="posterior")
    assert "the posterior was not complete after" in str(emitted[0].message)


@pytest.mark.parametrize("per_step", [False, True])
def test_a_posterior_needs_dynesty(good, monkeypatch, per_step):
    """Before anything is fitted: a step whose posterior fails has the errors "auto"."""
    monkeypatch.setattr(settings, "find_spec", lambda _: None)
    with pytest.raises(ParameterError, match=r"needs dynesty.*ratestate\[posterior\]"):
        rs.fit(good, SLIDER, ("a",), errors="posterior", per_step=per_step)


def test_a_fit_without_a_slider_is_refused(good):
    with pytest.raises(ParameterError, match=r"fit needs slider too\. Call fit\(data, slider\)\. "):
        rs.fit(good, law="slip")


def test_an_unknown_kind_of_errors_is_refused(good):
    with pytest.raises(ParameterError, match="errors = 'bayes' is unknown"):
        rs.fit(good, SLIDER, errors="bayes")


@pytest.mark.parametrize(
    ("apart", "by_likelihood", "by_evidence"),
    [
        (1.4, "does not decide between the laws", "which does not decide between the laws"),
        (1.6, "The slip law fits somewhat better", "under equal priors"),
        (4.9, "The slip law fits somewhat better", "under equal priors"),
        (5.1, "The slip law fits clearly better", "under equal priors"),
    ],
)
def test_text_on_a_difference_of_likelihoods(apart, by_likelihood, by_evidence):
    """AIC differs by twice the difference of ln(likelihood), which is the evidence's."""
    values = {"log_evidence": [0.0, -apart], "log_evidence_error": [0.0, 0.0]}
    result = xarray.Dataset({k: ("law", v) for k, v in values.items()}, {"law": ["slip", "aging"]})
    aic = xarray.DataArray([10.0, 10.0 + 2.0 * apart], {"law": result.law})
    table = with_comparison(result, aic, True)
    text = table.comparison
    assert by_likelihood in text
    assert by_evidence in text
    assert float(table.aic_difference.sel(law="aging")) == pytest.approx(2.0 * apart)
    assert float(table.log_bayes_factor.sel(law="aging")) == pytest.approx(-apart)


@pytest.mark.parametrize(
    ("laws", "none", "apart", "words"),
    [
        (("slip", "aging"), "Neither law", 1.4, "does not decide between"),
        (("slip", "aging", "prz"), "None of the", 9.0, "is nearer to the record than"),
    ],
)
def test_text_on_laws_that_do_not_fit(laws, none, apart, words):
    aic = xarray.DataArray(2.0 * apart * np.arange(len(laws)), {"law": list(laws)}, "law")
    text = with_comparison(xarray.Dataset(coords=aic.coords), aic, False).comparison
    assert text.startswith(none)
    assert words in text
    assert "better" not in text


@pytest.mark.parametrize(("red", "of_all"), [([0.0, 1e-3], False), ([1e-3, 0.0], True)])
def test_correlated_residuals_are_of_the_law_that_has_them(red, of_all):
    """The criterion has no names of laws, as in a fit."""
    result = xarray.Dataset({"noise_red": ("law", red)}, {"law": ["slip", "aging"]})
    text = with_comparison(result, xarray.DataArray([0.0, 30.0], dims="law"), True).comparison
    assert ("perhaps none of the laws fits" in text) == of_all
    assert ("Residuals under the aging law are correlated" in text) != of_all


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
@pytest.mark.parametrize(("noise", "fits"), [(2e-4, True), (5e-5, False)])
def test_laws_with_residuals_above_the_noise_do_not_fit(good, noise, fits):
    """The record is of the slip law, and its noise is 2e-4."""
    both = rs.fit(good, SLIDER, law=("slip", "aging"), noise=noise, errors="covariance")
    assert ("Neither law fits" in both.comparison) != fits
    assert ("slip law fits clearly better" in both.comparison) == fits


def test_each_problem_has_its_warning(good):
    """A record with the problem has the warning; the good record has none."""
    assert rs.fit(good, SLIDER).warnings.item() == ""
    rng = np.random.default_rng(1)
    silent = good.assign(friction=0.6 + 2e-4 * xarray.zeros_like(good.friction))
    silent = silent.assign(friction=silent.friction + 2e-4 * rng.normal(size=T.size))
    pressed = good.assign(sigma=("time", np.linspace(2.05e7, 2.25e7, T.size)))
    patchy = good.assign(sigma=pressed.sigma.where(np.arange(T.size) != 100))
    cases = {
        "does not respond to the steps by more than the noise": (silent, {"errors": "covariance"}),
        "normal stress is 20.5 MPa at the start": (pressed, {}),
        "normal stress varies by 9.3 % about 21.5 MPa in this window": (patchy, {}),
        "before friction is steady": (good.isel(time=T < 42.0), {"free": ("a", "K")}),
        "Try another law, such as two-state-aging or two-state-slip": (good, {"law": "aging"}),
        "times as large as the noise that was given": (good, {"noise": 5e-5}),
    }
    for words, (data, options) in cases.items():
        with pytest.warns(rs.FitWarning) as emitted:
            rs.fit(data, SLIDER, **{"errors": "covariance"} | options)
        texts = [str(one.message) for one in emitted]
        assert any(words in text for text in texts), (words, texts)
        assert {one.filename for one in emitted} == {__file__}  # the line that asked


def test_the_end_of_a_ramp_of_normal_stress_is_not_a_step(good):
    """The ramp lasts as long as the record, which shows steady friction after its step."""
    pressed = good.assign(sigma=("time", np.linspace(2.05e7, 2.25e7, T.size)))
    with pytest.warns(rs.FitWarning) as emitted:
        rs.fit(pressed, SLIDER, errors="covariance")
    assert not [one for one in emitted if "after its last step" in str(one.message)]


@pytest.mark.parametrize("given", [5e-5, 8e-4])
@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
def test_misfit_does_not_depend_on_the_given_noise(good, given):
    right, wrong = (
        rs.fit(good, SLIDER, law=law, noise=given, errors="covariance") for law in ("slip", "aging")
    )
    assert 0.05 < float(right.misfit_p_value) < 1.0
    assert float(wrong.misfit_p_value) < 1e-6
    assert "the law does not describe the record after its steps" in wrong.warnings.item()
    assert "does not describe" not in right.warnings.item()


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
@pytest.mark.parametrize("exponent", [None, 1.0])
def test_a_second_state_is_not_taken_for_correlated_noise(exponent):
    """Red noise is as large as the misfit by one state; the right law has no misfit."""
    two = SLIDER.replace(law="two-state-slip", b=0.010, b2=0.004, Dc2="60 um")
    data = record(two, LONG_STEP, LONG_T, noise=1e-4)
    rng = np.random.default_rng(3)
    red = correlated(LONG_T, 1.0, rng) if exponent is None else power_law(LONG_T.size, 1.0, rng)
    data = data.assign(friction=data.friction + 1e-4 * red)
    one = rs.fit(data, SLIDER, errors="covariance")
    assert float(one.noise_red) > 5e-5
    assert float(one.misfit_p_value) < 1e-4
    free = (*FREE, "b2", "Dc2")
    both = rs.fit(data, two, free, errors="covariance")
    assert float(both.misfit_p_value) > 0.03


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
def test_a_load_point_that_accelerates_from_the_start_is_fitted():
    """Without steps no samples are too few, and the law is not tested."""
    t = np.arange(0.0, 60.0, 0.1)
    loading = rs.Loading.series([0.0, 60.0], ["1 um/s", "30 um/s"])
    z = []
    for seed in range(2):
        data = record(SLIDER, loading, t, noise=1e-4, seed=seed)
        result = rs.fit(data, SLIDER.replace(a=0.008, Dc="20 um"), loading=loading)
        for name in ("a", "b", "Dc"):
            error = result.standard_error.sel(parameter=name)
            z.append(float((result[name] - getattr(SLIDER, name)) / error))
        assert np.isnan(result.misfit_p_value)
    assert 0.1 < np.sqrt(np.mean(np.square(z))) < 2.0
    steady = rs.Loading.series([0.0, 60.0], ["1 um/s", "1 um/s"])
    with pytest.raises(ParameterError, match=r"moves at 1e-06 m/s all the time"):
        rs.fit(record(SLIDER, steady, t, noise=1e-4), SLIDER, loading=steady)
    with pytest.raises(ParameterError, match="the loading accelerates between steps"):
        rs.fit(data, SLIDER, ("a", "b"), loading=loading, against="cycles")


def drifting(slope, begins):
    """Return the good record with a drift [1/m] along slip that begins at a time."""
    data = record(SLIDER, LONG_STEP, LONG_T, noise=1e-4, seed=1)
    slip = data.delta_lp - data.delta_lp.sel(time=begins, method="nearest")
    return data.assign(friction=data.friction + slope * slip.where(data.time >= begins, 0.0))


def test_a_trend_before_the_step_has_no_warning():
    result = rs.fit(drifting(20.0, 0.0), SLIDER)
    assert abs(float(result.trend_slip)) > 5.0 * result.standard_error.values[-1]
    assert result.warnings.item() == ""


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
def test_a_trend_only_after_the_step_has_a_warning():
    """Its first-order effect is compared with a fit without trend, with equal noise."""
    data = drifting(20.0, 100.0)
    result = rs.fit(data, SLIDER)
    noise = {name: float(result[f"noise_{name}"]) for name in ("white", "red", "time")}
    plain = rs.fit(data, SLIDER, trend=None, noise=noise if noise["red"] else noise["white"])
    assert "which friction before the first step does not confirm" in result.warnings.item()
    for name in ("a", "b", "Dc", "a_minus_b"):
        one = result.sel(parameter=name)
        change, moved = (float(x - result[name]) for x in (plain[name], one.without_trend))
        assert moved == pytest.approx(change, rel=0.25, abs=0.3 * float(one.standard_error)), name
    assert abs(change) > 3.0 * float(one.standard_error)
    assert "without_trend" not in plain


def test_tradeoffs_are_named():
    """In this covariance K Dc is known to 1 %, Dc/K to 80 %, and a and b likewise."""
    best, worst = 0.01**2, 0.8**2
    block = 0.5 * np.array([[best + worst, best - worst], [best - worst, best + worst]])
    pair = 0.5 * np.array([[1.0, 1.0], [1.0, 1.0]]) * 0.1**2 + 1e-6 * np.eye(2)
    scale = np.diag([1.0, 0.01])  # b = 0.01 is no logarithm
    covariance = np.block([[scale @ pair @ scale, np.zeros((2, 2))], [np.zeros((2, 2)), block]])
    coordinates = np.array([np.log(0.01), 0.01, np.log(1e-5), np.log(1e10)])
    gradients = np.vstack([np.eye(4), [0.01, -1.0, 0.0, 0.0]])
    table = estimates_from(
        (*FREE, "a_minus_b"),
        np.append(coordinates, 0.0),
        gradients @ covariance @ gradients.T,
        np.array([True, False, True, True, False]),
    )
    assert correlated_groups(table, FREE) == [("Dc", "K"), ("a", "b")]
    text, loose = tradeoff_text(table, ("Dc", "K"))
    assert loose
    assert text.startswith("Dc and K trade off (correlation -1.000): the record fixes Dc K to 1 %")
    assert text.endswith(("but Dc/K only to a factor of 2.2", "K/Dc only to a factor of 2.2"))
    text, loose = tradeoff_text(table, ("a", "b"))
    assert not loose
    assert re.fullmatch(r"(a/b|b/a) to 0.1 %, and a - b = 0\.0+ \+- 0\.000014", text)
    assert product(("Dc", "K"), np.array([0.7, 0.69])) == "Dc K"
    assert product(("a", "b"), np.array([-0.6, 0.8])) == "b/a^0.75"


@pytest.mark.parametrize(("error", "is_constrained"), [(7.0, True), (7.1, False), (4e5, False)])
def test_text_on_an_unconstrained_parameter(solution, error, is_constrained):
    """An interval is open from 1.96 errors of ln 1e6, so K from an error of 7.05."""
    inference = infer(solution, None, "covariance")
    quantities = inference.quantities
    spread = np.diag([0.01, 1e-4, 0.01, error, 1e-4, 1e-4, 1.0]) ** 2
    values = np.array([q.value(solution.point) for q in quantities])
    names, is_log = [*inference.estimates.by_name], np.array([q.is_log for q in quantities])
    estimates = estimates_from(names, values, spread, is_log)
    note, warnings = identifiability(inference._replace(estimates=estimates))
    (warning,) = warnings
    assert (
        "K is hardly determined: its standard error is a factor of" in warning
    ) == is_constrained
    assert ("the record does not constrain K: its standard error is" in warning) != is_constrained
    assert re.search(r"Not determined: K( \(95 %: .*\))?\.", note)
    assert ("its standard error is more than a factor of 1e+06" in warning) == (error > 14)


@pytest.mark.parametrize(
    ("worst", "text"),
    [(7.04, "but (Dc/K|K/Dc) only to a factor of 1.1e.03"), (7.06, "but does not constrain Dc/K")],
)
def test_text_on_an_unconstrained_combination(worst, text):
    best = 0.01
    block = 0.5 * np.array(
        [[best**2 + worst**2, best**2 - worst**2], [best**2 - worst**2, best**2 + worst**2]]
    )
    coordinates = np.log([1e-5, 1e10])
    table = estimates_from(("Dc", "K"), coordinates, block, np.array([True, True]))
    assert re.search(text, tradeoff_text(table, ("Dc", "K"))[0])


def test_settings_of_samples_are_refused_for_cycles(good):
    with pytest.raises(rs.ParameterError, match="errors, noise cannot be chosen"):
        rs.fit(good, SLIDER, against="cycles", errors="profile", noise=1e-4)
    with pytest.raises(rs.ParameterError, match="does not name different laws"):
        rs.fit(good, SLIDER, law=("slip", "slip"))


def test_bounds_of_the_search():
    """They are multiples of sizes from the range of friction and the displacement."""
    t = np.linspace(0.0, 100.0, 201)
    loading = rs.Loading.steps("1 um/s", (50.0, "10 um/s"))  # 550 um in all
    friction = np.where(t < 50.0, 0.6, 0.6 + 0.01 * np.log(10.0))
    found = Samples(t, friction, t, None, loading, "tau", t, np.zeros(1))
    unknowns = unknowns_of(found, SLIDER, ("a", "b", "Dc", "K", "M", "lag"), start=True)
    K = 2e7 * 0.01 * np.log(10.0) / 55e-6
    ends = {
        "a": np.log([1e-5, 1.0]),
        "b": (-1.0, 1.0),
        "Dc": np.log([27.5e-9, 27.5e-3]),
        "K": np.log([1e-4 * K, 1e6 * K]),
        "M": np.log([4e-8 * K, 4e4 * K]),  # K times the square of a fiftieth of the time
        "lag": (-10.0, 10.0),
        "V_start": (-20.0, 20.0),
        "theta_start": (-20.0, 20.0),
        "level": (-np.inf, np.inf),
    }
    assert set(unknowns.names) == set(ends)
    for name, low, high in zip(*unknowns, strict=True):
        np.testing.assert_allclose([low, high], ends[name], atol=1e-9, err_msg=name)


def test_sides_of_estimates_at_a_bound():
    """Within 1/1000 of the range, if it is finite, and 1/1000 of the standard error."""
    names = ("below", "above", "low", "high", "certain", "open")
    low, high = np.zeros(6), np.array([10.0, 10.0, 10.0, 10.0, 10.0, np.inf])
    point = np.array([0.011, 9.989, 0.009, 9.991, 0.009, 0.0])
    errors = np.array([100.0, 100.0, 100.0, 100.0, 1.0, 100.0])
    solution = SimpleNamespace(unknowns=Unknowns(names, low, high), point=point, errors=errors)
    sides = dict(zip(names, [0, 0, -1, 1, 0, 0], strict=True))
    assert Solution.sides.fget(solution) == sides


class Combination(ReportedQuantity):
    """A linear combination of the coordinates, with the coefficients `function`."""

    def gradient(self, point):
        return self.function


def test_errors_beside_an_undetermined_combination():
    """The covariance itself, of 1 and 1e18, has no digit left for the smaller variance."""
    rng = np.random.default_rng(3)
    left, _ = np.linalg.qr(rng.normal(size=(40, 3)))
    right, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    jacobian = left * [1.0, 0.5, 1e-12] @ right.T
    solution = SimpleNamespace(point=np.zeros(3), root=root_of_covariance(jacobian))
    for column, error in zip(right.T, (1.0, 2.0), strict=False):
        combination = Combination("a_minus_b", None, column)
        assert combination.standard_error(solution) == pytest.approx(error, rel=1e-5)
    undetermined = Combination("a_minus_b", None, right[:, 2])
    assert undetermined.standard_error(solution) > 1e8


def test_a_profile_that_begins_beside_a_bound_is_open_there():
    """The search for M ends beside its lower bound, closer than a step of the profile."""
    slider = rs.SpringSlider(
        a=0.01, b=0.012, Dc="10 um", sigma="5 MPa", K="5 GPa/m", V0="1 um/s", law="aging"
    )
    t = np.arange(0, 130, 0.05)
    run = rs.simulate(slider, rs.Loading.steps("1 um/s", (100, "10 um/s")), t[-1], times=t)
    noise = 2e-4 * np.random.default_rng(1).normal(size=t.size)
    record = run[["delta_lp"]].assign(friction=run.tau / slider.sigma + noise)
    free = ("a", "b", "Dc", "K", "M")
    with pytest.warns(rs.FitWarning, match="only shows that M < .*: no inertia is seen"):
        result = rs.fit(record, slider.replace(M=1000.0), free=free)
    low, high = result.interval.sel(parameter="M", level=0.95).values
    assert low == 0.0
    assert 1e7 < high < 1e8
