"""The function `fit`: estimates from records of known truth, and refusals."""

import functools
import json

import hypothesis.strategies as st
import numpy as np
import pytest
import xarray
from hypothesis import given, settings
from synthetic_records import FREE, SLIDER, assert_finds, record

import ratestate as rs
from ratestate.dynamics.recipe import recorded_loading

T = np.concatenate([np.linspace(60.0, 99.0, 150), np.linspace(99.1, 130.0, 450)]) - 60.0
EARLY_STEP = rs.Loading.steps("1 um/s", (40.0, "10 um/s"))
START = SLIDER.replace(a=0.005, b=0.005, Dc=5e-5, K=1e10)
LAWS = ("slip", "aging")


@pytest.fixture(scope="module")
def clean():
    return record(SLIDER, EARLY_STEP, T)


@pytest.fixture(scope="module")
def noisy():
    return record(SLIDER, EARLY_STEP, T, noise=2e-4, seed=4)


@pytest.fixture(scope="module")
def fitted(noisy):
    return rs.fit(noisy, START)


@given(
    a=st.floats(0.003, 0.02),
    ratio=st.floats(0.4, 1.8),
    stiffness=st.floats(0.4, 6.0),
    down=st.booleans(),
    law=st.sampled_from(LAWS),
    eta=st.sampled_from([0.0, 0.0, 0.3, 3.0]),
)
@settings(max_examples=4)
@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")  # of a trend at 1e-11
def test_fit_without_noise_recovers_the_slider(a, ratio, stiffness, down, law, eta):
    b, Dc, sigma = ratio * a, 1e-5, 2e7
    V1, V2 = (1e-5, 1e-6) if down else (1e-6, 1e-5)
    K = (max(ratio - 1.0, 0.0) * (1.0 + eta) + stiffness) * a * sigma / Dc
    M = eta * a * sigma * Dc / 1e-10
    truth = rs.SpringSlider(a=a, b=b, Dc=Dc, sigma=sigma, K=K, M=M, law=law)
    step = 20e-5 / V1
    loading = rs.Loading.steps(V1, (step, V2))
    t = np.concatenate([np.linspace(0, step, 100, False), step + np.linspace(0, 20e-5 / V2, 400)])
    start = truth.replace(a=0.6 * a, b=1.5 * b, Dc=3e-5, K=0.4 * K)
    result = rs.fit(record(truth, loading, t), start, errors="covariance")
    for name in FREE:
        assert float(result[name]) == pytest.approx(getattr(truth, name), rel=2e-5), name
    assert float(result.rms) < 1e-7 * a
    assert float(result.mu0) == pytest.approx(0.6, abs=1e-7)


@pytest.mark.parametrize("law", LAWS)
def test_several_steps_are_fitted_together(law):
    loading = EARLY_STEP.step(70.0, "1 um/s").step(120.0, "30 um/s")
    t = np.concatenate([T, np.linspace(70.1, 140.0, 900)])
    data = record(SLIDER, loading, t, noise=2e-4, law=law)
    result = rs.fit(data, START, law=law)
    assert_finds(result, SLIDER)
    first = rs.fit(data.sel(time=slice(None, 69.9)), START, law=law)
    assert (result.standard_error < first.standard_error).all()
    loading = recorded_loading(result)
    np.testing.assert_allclose(loading.V, [1e-6, 1e-5, 1e-6, 3e-5], rtol=1e-6)
    np.testing.assert_allclose(loading.t, [0.0, 40.0, 70.0, 120.0], atol=1e-4)


def test_mass_is_estimated_from_an_oscillation():
    truth = SLIDER.replace(M=2e11)
    t = np.concatenate([T[:150], np.linspace(39.1, 70.0, 1500)])
    data = record(truth, EARLY_STEP, t, noise=2e-4)
    result = rs.fit(data, START.replace(M=1e10), free=(*FREE, "M"))
    assert_finds(result, truth, (*FREE, "M"))


@functools.cache
def without_mass(faster):
    """Return a slider with mass, a record at higher speeds, and a fit with M = 0."""
    truth = SLIDER.replace(M=1.5e11 / faster**2)
    loading = rs.Loading.steps(faster * 1e-6, (EARLY_STEP.t[1] / faster, faster * 1e-5))
    data = record(truth, loading, T / faster, noise=2e-4)
    return truth, data, rs.fit(data, START, errors="covariance")


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
@pytest.mark.parametrize("faster", [1.0, 1e4])
def test_inertia_is_suggested_if_a_machine_can_have_the_mass(faster):
    """At low speeds the mass is impossible; at high speeds it is 1500 kg/m^2."""
    _, _, result = without_mass(faster)
    assert ("inertia would lower chi-square" in result.warnings.item()) == (faster > 1.0)


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
@pytest.mark.parametrize("trend", ["slip", "time"])
def test_a_trend_is_separated_from_the_step(clean, trend):
    along = clean.delta_lp / 1e-3 if trend == "slip" else clean.time / 100.0
    drifting = clean.assign(friction=clean.friction + 0.01 * along)
    result = rs.fit(drifting, START, trend=trend)
    # the trend is along the slider's slip, which is a little behind the load point
    assert float(result.Dc) == pytest.approx(1e-5, rel=5e-3)
    expected = 10.0 if trend == "slip" else 1e-4
    assert float(result[f"trend_{trend}"]) == pytest.approx(expected, rel=5e-3)
    without = rs.fit(drifting, START, trend=None)
    assert float(without.rms) > 10 * float(result.rms)


def test_a_lag_of_the_record_is_found(clean):
    late = clean.assign_coords(time=clean.time).copy()
    late["friction"] = ("time", np.interp(T - 0.15, T, clean.friction))
    noise = 1e-4 * np.random.default_rng(1).normal(size=T.size)
    result = rs.fit(late.assign(friction=late.friction + noise), START, free=(*FREE, "lag"))
    assert float(result.lag) == pytest.approx(0.15, abs=0.03)
    assert float(result.lag) > 5 * float(result.standard_error.sel(parameter="lag"))


def test_against_displacement_needs_no_clock(noisy):
    """The fit is the same as by time, and works with noise of displacement."""
    how = {"errors": "covariance", "against": "displacement"}
    result = rs.fit(noisy, START, **how)
    by_time = rs.fit(noisy, START, errors="covariance")
    for name in FREE:
        assert float(result[name]) == pytest.approx(float(by_time[name]), rel=1e-6)
    noise = 2e-8 * np.random.default_rng(0).normal(size=T.size)
    rough = noisy.assign(delta_lp=noisy.delta_lp + noise)
    assert_finds(rs.fit(rough, START, **how), SLIDER, within=5.0)


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
def test_given_noise_is_used(noisy, fitted):
    assert float(fitted.noise_white) == pytest.approx(2e-4, rel=0.1)
    given, doubled = (rs.fit(noisy, START, noise=k * float(fitted.noise_white)) for k in (1.0, 2.0))
    np.testing.assert_allclose(doubled.standard_error / given.standard_error, 2.0, rtol=1e-3)
    # estimated noise is uncertain: it may be correlated, which affects the level most
    wider = (fitted.standard_error / given.standard_error).values
    assert (wider > 1.0).all()
    assert wider[:4].max() < 1.2
    assert wider.max() < 2.2
    with pytest.warns(rs.FitWarning, match="times as large as the noise that was given"):
        red = rs.fit(noisy, START, noise={"white": 1e-5, "red": 2e-4, "time": "3 s"})
    assert float(red.noise_time) == 3.0
    assert float(red.standard_error.sel(parameter="mu0")) > 2 * float(
        fitted.standard_error.sel(parameter="mu0")
    )


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
def test_equivalent_records_give_the_same_fit(noisy, fitted):
    """Another origin of time, tau, load-point speed, or the loading may be given."""
    tau = noisy.drop_vars("friction").assign(tau=noisy.friction * SLIDER.sigma)
    speed = xarray.DataArray(np.where(T < 40.0, 1e-6, 1e-5), dims="time")
    others = {
        "origin": (noisy.assign_coords(time=noisy.time + 1e4), {}),
        "tau": (tau, {}),
        "loading": (noisy.drop_vars("delta_lp"), {"loading": EARLY_STEP}),
        "units": (noisy, {"law": "slip"}),
    }
    for label, (data, options) in others.items():
        result = rs.fit(data, START, errors="covariance", **options)
        for name in FREE:
            assert float(result[name]) == pytest.approx(float(fitted[name]), rel=1e-4), label
    # between two samples of the speed the step may be anywhere, which widens the errors
    by_speed = rs.fit(noisy.drop_vars("delta_lp").assign(V_load=speed), START)
    assert by_speed.warnings.item() == ""
    for name in FREE:
        error = float(by_speed.standard_error.sel(parameter=name))
        assert abs(float(by_speed[name] - fitted[name])) < 3.0 * error, name
        assert error < 0.2 * float(by_speed[name]), name


def test_the_initial_guess_does_not_matter(noisy, fitted):
    for far in ({"a": 1e-4, "b": 0.5, "Dc": 1e-2, "K": 1e6}, {"a": 0.5, "b": 0.1, "Dc": 1e-8}):
        result = rs.fit(noisy, SLIDER.replace(**far), errors="covariance")
        for name in FREE:
            assert float(result[name]) == pytest.approx(float(fitted[name]), rel=2e-3)


def test_variables_of_the_result(noisy, fitted):
    assert set(FREE) <= set(fitted.data_vars)
    assert fitted.parameter.values.tolist() == [*FREE, "mu0", "a_minus_b", "trend_slip"]
    for variable in fitted.variables.values():
        assert (
            variable.dtype.kind in "US"
            or {"units", "long_name"} <= set(variable.attrs)
            or (variable.dims in (("level",), ("side",)))
        )
    residual = fitted.friction - fitted.friction_fit
    np.testing.assert_allclose(fitted.residual, residual, atol=1e-15)
    np.testing.assert_array_equal(fitted.time, noisy.time)
    inside = (fitted.band.sel(side="lower") < noisy.friction) & (
        noisy.friction < fitted.band.sel(side="upper")
    )
    assert 0.92 < float(inside.mean()) < 0.98
    low, high = (fitted.interval.sel(side=side) for side in ("lower", "upper"))
    assert (low.sel(level=0.95) < low.sel(level=0.68)).all()
    assert (high.sel(level=0.68) < high.sel(level=0.95)).all()
    np.testing.assert_allclose(np.diag(fitted.correlation), 1.0, atol=1e-9)
    error = fitted.standard_error.sel(parameter="a_minus_b")
    assert float(fitted.a_minus_b) == pytest.approx(float(fitted.a - fitted.b), rel=1e-12)
    assert abs(float(fitted.a_minus_b) + 0.004) < 4 * float(error)
    assert float(error) < 0.5 * float(fitted.standard_error.sel(parameter="a"))
    assert fitted.warnings.item() == ""
    assert fitted.identifiability.item().startswith("All free parameters are determined")
    assert json.loads(fitted.attrs["slider"])["sigma"] == 2e7


REFUSED = {
    "no Dataset": (lambda d: d.friction, {}, "data is of type DataArray"),
    "no friction": (lambda d: d.drop_vars("friction"), {}, "has no friction"),
    "no load point": (lambda d: d.drop_vars("delta_lp"), {}, "neither delta_lp nor V_load"),
    "empty": (lambda d: d.isel(time=slice(0, 0)), {}, "0 samples, but at least 30"),
    "too short": (lambda d: d.isel(time=slice(0, 20)), {}, "20 samples, but at least 30"),
    "no step": (lambda d: d.sel(time=slice(0, 35)), {}, "without a velocity step"),
    "step at the end": (
        lambda d: d.sel(time=slice(0, 40.2)),
        {"loading": EARLY_STEP},
        "samples after the last step",
    ),
    "constant": (lambda d: d.assign(friction=0.0 * d.friction + 0.6), {}, "friction is constant"),
    "NaN": (lambda d: d.assign(friction=d.friction.where(d.time != T[7])), {}, "in row 7"),
    "backwards": (lambda d: d.isel(time=slice(None, None, -1)), {}, "times must increase"),
    "rest": (lambda d: d, {"loading": rs.Loading.steps(0.0, (40.0, 1e-5))}, "begins at rest"),
    "tau and mu": (
        lambda d: d.assign(tau=d.friction, mu=d.friction).drop_vars("friction"),
        {},
        "both tau and mu",
    ),
    "unknown": (lambda d: d, {"free": ("a", "D_c")}, "free has 'D_c'"),
    "nothing": (lambda d: d, {"free": ()}, r"free = \(\) does not name parameters"),
    "twice": (lambda d: d, {"free": ("a", "a")}, "twice"),
    "law": (lambda d: d, {"law": "nope"}, "law = 'nope' is unknown"),
    "start": (lambda d: d, {"start": True}, "start = True is unknown"),
    "against": (lambda d: d, {"against": "phase"}, "against = 'phase' is unknown"),
    "noise": (lambda d: d, {"noise": -1.0}, "noise = -1 must be > 0"),
    "parts": (lambda d: d, {"noise": {"red": 1e-4}}, "no time"),
    "per cent": (lambda d: d.assign(friction=100.0 * d.friction), {}, "in per cent"),
    "sign": (lambda d: d.assign(friction=-d.friction), {}, "Change its sign"),
    "unit": (lambda d: d.assign(delta_lp=1e6 * d.delta_lp), {}, "If it is in um, divide it by 1e6"),
    "speeds": (
        lambda d: d,
        {"loading": rs.Loading.steps("1 mm/s", (40.0, "10 mm/s"))},
        "Check units and times",
    ),
    "times": (
        lambda d: d,
        {"loading": rs.Loading.steps("1 um/s", (20.0, "10 um/s"))},
        "Check units and times",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_records_and_settings_that_cannot_be_fitted_are_refused(noisy, case):
    change, options, message = REFUSED[case]
    with pytest.raises(rs.ParameterError, match=message):
        rs.fit(change(noisy), START, **options)


def test_sliders_that_cannot_be_fitted_are_refused(clean):
    with pytest.raises(rs.ParameterError, match="K = inf, a rigid machine"):
        rs.fit(clean, SLIDER.replace(K=np.inf))
    with pytest.raises(rs.ParameterError, match="M is free but starts at M = 0"):
        rs.fit(clean, SLIDER, free=("a", "M"))
    with pytest.raises(rs.ParameterError, match="a of the slider is a DataArray"):
        rs.fit(clean, SLIDER.replace(a=xarray.DataArray([0.01, 0.02], dims="a")))
    with pytest.raises(rs.ParameterError, match="not a SpringSlider"):
        rs.fit(clean, 3)
    with pytest.raises(rs.ParameterError, match="becomes unstable before the end"):
        rs.fit(clean, SLIDER.replace(K=5e9), free=("lag",))


def test_a_fit_is_the_same_each_time(noisy, fitted):
    xarray.testing.assert_identical(rs.fit(noisy, START), fitted)


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
def test_an_unsteady_start_is_not_taken_for_noise():
    """Windows begin soon after an earlier step; the law fits all of them."""
    loading = rs.Loading.steps("10 um/s", (10.0, "1 um/s"), (50.0, "10 um/s"))
    t = np.concatenate([np.linspace(0.0, 49.9, 500), np.linspace(50.0, 80.0, 900)])
    for begin in (10.5, 20.0):
        data = record(SLIDER, loading, t, noise=1e-4, seed=3).sel(time=slice(begin, None))
        result = rs.fit(data, START)
        assert_finds(result, SLIDER)
        assert float(result.noise_white) == pytest.approx(1e-4, rel=0.15)
        assert "V_start" in result


def test_a_wrong_given_value_is_not_taken_for_noise(noisy):
    with pytest.warns(rs.FitWarning) as emitted:
        rs.fit(noisy, SLIDER.replace(b=0.03), free=("a",))
    assert any(
        "a value that was given does not suit it (b = 0.03" in str(w.message) for w in emitted
    )
