"""`healing` of known holds: values, errors, rates, statuses and predictions."""

import warnings

import numpy as np
import pytest
import xarray
from slide_hold_slide import HOLDS, SLIDE, SLIDER, V, clean, loading_of, noisy, truth

import ratestate as rs
from ratestate import ParameterError, summary
from ratestate.records.healing.measured import STATUSES

#: statuses of holds whose relaxation is unknown, too
UNMEASURED = ("short_hold", "no_slide_before", "not_steady_before")


def statuses(result):
    return [STATUSES[code] for code in result.hold_status.values]


@pytest.fixture(scope="module")
def one():
    """Evaluate a record with correlated noise and a drift, with the true slider."""
    return rs.healing(noisy(1, white=2e-4, red=2e-4, trend=3.0), slider=SLIDER)


def test_holds_are_found_from_the_load_point(one):
    np.testing.assert_allclose(one.t_hold, HOLDS)
    starts = SLIDE + np.concatenate([[0.0], np.cumsum(np.array(HOLDS) + SLIDE)[:-1]])
    np.testing.assert_allclose(one.hold_start, starts)
    np.testing.assert_allclose(one.V_before, V)
    assert statuses(one) == ["evaluated"] * 4
    assert not any(one.hold_message.values)


def test_healing_without_noise_is_exact():
    result = rs.healing(clean(dt=0.02), noise=1e-6)
    np.testing.assert_allclose(result.delta_mu, truth()[:, 0], rtol=0, atol=3e-6)
    np.testing.assert_allclose(result.delta_mu_c, truth()[:, 1], rtol=0, atol=2e-5)
    np.testing.assert_allclose(result.friction_peak - result.friction_before, result.delta_mu)


@pytest.mark.statistics
def test_estimates_are_unbiased_and_errors_calibrated():
    """There are 60 records; every second one has correlated noise."""
    z = []
    for seed in range(60):
        result = rs.healing(noisy(seed, red=2e-4 * (seed % 2), trend=2.0))
        assert statuses(result) == ["evaluated"] * 4
        found = np.stack([result.delta_mu, result.delta_mu_c], axis=-1)
        errors = np.stack([result.delta_mu_error, result.delta_mu_c_error], axis=-1)
        z.append((found - truth()) / errors)
    z = np.array(z)  # (60, holds, 2)
    assert np.abs(z.mean(axis=0)).max() < 0.5
    assert np.abs(z.mean(axis=(0, 1))).max() < 0.25
    for k in range(2):
        assert 0.60 < (np.abs(z[..., k]) < 1.0).mean() < 0.76
        assert 0.90 < (np.abs(z[..., k]) < 1.96).mean() < 0.985


def test_errors_grow_with_correlated_noise():
    data = noisy(5, holds=(3.0, 30.0))
    white = rs.healing(data, noise={"white": 3e-4})
    red = rs.healing(data, noise={"white": 2e-4, "red": 2.2e-4, "time": "1 s"})
    ratio = red.delta_mu_error / white.delta_mu_error
    assert 1.1 < float(ratio.min()) < float(ratio.max()) < 4.0
    assert float(red.noise_time) == 1.0


@pytest.mark.parametrize(
    ("K", "white", "low", "high"),
    [("500 GPa/m", 1e-4, 1e-4, 1e-3), ("300 GPa/m", 1e-3, 2e-4, 4e-3)],
)
def test_a_peak_to_which_friction_rises_within_few_samples_has_a_larger_error(K, white, low, high):
    """The machine is stiff: friction rises by 0.03 and more from one sample to the next."""
    slider = SLIDER.replace(K=K, Dc="20 um", law="aging")
    z, errors = [], []
    for seed in range(5):
        result = rs.healing(noisy(seed, slider=slider, slide=60.0, white=white))
        assert statuses(result)[1:] == ["evaluated"] * 3
        z.append((result.delta_mu - truth(slider)[:, 0])[1:] / result.delta_mu_error[1:])
        errors.append(result.delta_mu_error[1:])
    assert 0.4 < np.sqrt(np.mean(np.square(z))) < 1.6
    assert np.abs(z).max() < 3.5
    assert low < np.min(errors) < np.max(errors) < high


@pytest.mark.parametrize(
    ("law", "slide", "least", "most"),
    [
        # when the last hold that is evaluated begins, friction is so far from steady:
        ("slip", 25.0, 2e-3, 2e-2),  # 5e-3
        ("slip", 40.0, 1e-3, 3e-3),  # 2e-3
        ("slip", 60.0, 2e-5, 5e-4),  # 5e-5
        ("aging", 20.0, 5e-4, 5e-3),  # 1e-3
    ],
)
def test_a_hold_that_begins_before_friction_is_steady_has_a_larger_error(law, slide, least, most):
    slider = rs.SpringSlider(a=0.007, b=0.008, Dc="17 um", sigma="10 MPa", K="2 GPa/m", law=law)
    holds = (10.0, 100.0, 1000.0)
    result = rs.healing(noisy(1, slider=slider, holds=holds, slide=slide, white=2e-5))
    expected = truth(slider, holds, last=60.0)
    k = np.flatnonzero(np.isfinite(result.delta_mu))[-1]
    for name, value in zip(("delta_mu", "delta_mu_c"), expected[k], strict=True):
        error = float(result[f"{name}_error"][k])
        assert abs(float(result[name][k]) - value) < 3.0 * error
        assert least < error < most


def test_a_hold_that_begins_as_friction_crosses_its_level_has_a_larger_error():
    """The state is then far from steady; 5 s before, friction was 4.5e-3 from steady."""
    slider = rs.SpringSlider(a=0.007, b=0.008, Dc="17 um", sigma="10 MPa", K="2 GPa/m", law="aging")
    loading = rs.Loading.steps(1e-5, (8.0, 0.0), (38.0, 1e-5), (158.0, 0.0), (258.0, 1e-5))
    t = np.arange(0.0, 378.0, 0.05)
    run = rs.simulate(slider, loading, t[-1], times=t, V_start=5e-5)
    noise = 1e-4 * np.random.default_rng(0).normal(size=t.size)
    record = run[["delta_lp"]].assign(friction=run.tau / slider.sigma + noise)
    result = rs.healing(record, loading=loading)
    off = np.stack([result.delta_mu, result.delta_mu_c]).T - truth(slider, (30.0, 100.0), last=60.0)
    errors = np.stack([result.delta_mu_error, result.delta_mu_c_error]).T
    assert (abs(off[0]) > 3e-4).all()
    assert (errors[0] > 2e-4).all()
    assert (abs(off[0]) < 6.0 * errors[0]).all()
    assert (abs(off[1]) < 4.0 * errors[1]).all()
    assert (errors[1] < 1e-4).all()


def test_noise_of_slip_may_exceed_the_shortest_decay_length():
    slider = rs.SpringSlider(a=0.007, b=0.008, Dc="17 um", sigma="10 MPa", K="2 GPa/m", law="aging")
    holds = (100.0, 100.0, 100.0)
    data = noisy(0, slider=slider, holds=holds, slide=25.0, dt=0.002, white=1e-3)
    result = rs.healing(data)
    expected = truth(slider, holds, last=60.0)[:, 0]
    assert (abs(result.delta_mu - expected) < 3.0 * result.delta_mu_error).all()
    # (the first hold begins in steady sliding, the others 25 s after a hold)
    assert (result.delta_mu_error[0] > 5e-5) & (result.delta_mu_error[0] < 7e-5)
    assert ((result.delta_mu_error[1:] > 5e-3) & (result.delta_mu_error[1:] < 2e-2)).all()
    again = rs.healing(data.assign(friction=data.friction * (1.0 + 1e-12)))
    np.testing.assert_allclose(again.delta_mu, result.delta_mu, rtol=1e-9)


def test_a_drift_is_extrapolated():
    level = rs.healing(noisy(7))
    for trend in (5.0, -5.0):
        drifting = rs.healing(noisy(7, trend=trend))
        np.testing.assert_allclose(drifting.delta_mu, level.delta_mu, rtol=0, atol=2e-5)
    flat = rs.healing(noisy(7, trend=5.0), trend=None)
    # holds then seem to begin before friction is steady: larger errors, or none
    assert not (flat.delta_mu_error < 2.0 * level.delta_mu_error).any()
    assert "not_steady_before" in statuses(flat)


def test_the_rate_is_a_weighted_line(one):
    x, y, error = np.log10(one.t_hold), one.delta_mu, one.delta_mu_error
    slope, _ = np.polyfit(x, y, 1, w=1.0 / error)
    residual = np.polyval(np.polyfit(x, y, 1, w=1.0 / error), x) - y
    scatter = np.sqrt(float(((residual / error) ** 2).sum()) / 2)
    assert float(one.beta) == pytest.approx(slope)
    assert float(one.beta_scatter) == pytest.approx(scatter)
    _, covariance = np.polyfit(x, y, 1, w=1.0 / error, cov="unscaled")
    expected = np.sqrt(covariance[0, 0]) * max(scatter, 1.0)
    assert float(one.beta_error) == pytest.approx(expected)
    line = np.interp(10.0, one.line_t_hold, one.line_delta_mu)
    assert line == pytest.approx(np.polyval(np.polyfit(x, y, 1, w=1.0 / error), 1.0), abs=1e-4)


def test_one_hold_time_has_no_rate():
    result = rs.healing(noisy(2, holds=(10.0, 10.0)), slider=SLIDER)
    assert statuses(result) == ["evaluated"] * 2
    assert np.isnan(result.beta)
    assert np.isnan(result.beta_predicted).all()
    assert "two holds of different duration" in str(summary(result))


def test_the_slider_predicts_each_hold(one):
    np.testing.assert_allclose(one.delta_mu_predicted.sel(law="slip"), truth()[:, 0], atol=2e-7)
    np.testing.assert_allclose(one.delta_mu_c_predicted.sel(law="slip"), truth()[:, 1], atol=2e-7)
    assert float(one.delta_mu_predicted_error.max()) == 0.0
    x, w = np.log10(one.t_hold), 1.0 / one.delta_mu_error
    assert float(one.beta_predicted[0]) == pytest.approx(np.polyfit(x, truth()[:, 0], 1, w=w)[0])


def test_a_fit_under_two_laws_predicts_with_errors():
    data = noisy(11, holds=(3.0, 30.0), white=1e-4)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rs.FitWarning)
        fitted = rs.fit(data, SLIDER, law=("slip", "aging"), errors="covariance")
    result = rs.healing(data, slider=fitted)
    assert result.law.values.tolist() == ["slip", "aging"]
    slip = result.sel(law="slip")
    off = np.abs(slip.delta_mu_predicted - truth(holds=(3.0, 30.0))[:, 0])
    assert (off < 4.0 * slip.delta_mu_predicted_error).all()
    assert (slip.delta_mu_predicted_error > 1e-6).all()
    assert (slip.delta_mu_predicted_error < 1e-3).all()
    assert "aging law predicts" in str(summary(result))


def test_another_speed_of_reloading_is_mentioned():
    data = noisy(4, holds=(30.0,), V_after=3e-5, dt=0.05)
    result = rs.healing(data, slider=SLIDER)
    assert statuses(result) == ["evaluated"]
    assert "reloaded at 30 um/s after sliding at 10 um/s" in result.hold_message.item()
    error = float(result.delta_mu_error[0])
    assert abs(float(result.delta_mu[0]) - truth(holds=(30.0,), V_after=3e-5)[0, 0]) < 3.5 * error
    step = (SLIDER.a - SLIDER.b) * np.log(3.0)
    change = float((result.friction_after - result.friction_before)[0])
    both = np.hypot(result.friction_after_error, result.friction_before_error)
    assert abs(change - step) < 3.5 * float(both[0])


def test_normal_stress_that_varies_is_mentioned():
    data = noisy(1)
    t = data.time.values
    noise = 1.0 + 1e-3 * np.random.default_rng(1).normal(size=t.size)
    drift = 0.02 * np.interp(t, [130.0, 250.0], [0.0, 1.0])  # from the slide before the last hold
    for change, numbers in ((0.0 * t, []), (drift, [3])):
        result = rs.healing(data.assign(sigma=("time", 1e7 * (1.0 + change) * noise)))
        found = ["normal stress varies by" in text for text in result.hold_message.values]
        assert np.flatnonzero(found).tolist() == numbers


def test_a_record_that_ends_too_soon():
    data = noisy(6, holds=(3.0, 30.0))
    last = float(data.time[-1]) - SLIDE + 1.0
    result = rs.healing(data.sel(time=slice(None, last)))
    assert statuses(result) == ["evaluated", "record_ends"]
    assert np.isnan(result.delta_mu[1])
    off = abs(float(result.delta_mu_c[1]) - truth()[2, 1])
    assert off < 4.0 * float(result.delta_mu_c_error[1])
    np.testing.assert_allclose(result.delta_mu[0], rs.healing(data).delta_mu[0], atol=2e-5)


@pytest.mark.parametrize(
    ("made", "window", "noise", "hold", "status"),
    [
        ({"holds": (0.4, 30.0)}, (), None, 0, "short_hold"),
        ({"holds": (3.0, 30.0)}, (SLIDE - 0.5, None), None, 0, "no_slide_before"),
        ({"holds": (3.0, 30.0)}, (2.0 * SLIDE + 13.0,), None, 1, "record_ends"),
        # friction is not steady before a hold after a short slide
        (
            {"slide": 3.0, "holds": (100.0, 30.0), "white": 1e-5, "dt": 0.02},
            (),
            1e-5,
            1,
            "not_steady_before",
        ),
        # velocity strengthening without evolution does not heal
        ({"slider": SLIDER.replace(b=0.0), "holds": (10.0, 30.0)}, (), None, 0, "no_peak"),
        # a peak is between two samples
        ({"holds": (100.0, 30.0), "white": 1e-6, "dt": 1.0}, (), None, 0, "peak_not_resolved"),
    ],
)
def test_holds_without_healing_have_a_message(made, window, noise, hold, status):
    data = noisy(9, **made)
    result = rs.healing(data.sel(time=slice(*window)) if window else data, noise=noise)
    assert statuses(result)[hold] == status
    assert np.isnan(result.delta_mu[hold])
    assert np.isfinite(result.delta_mu_c[hold]) == (status not in UNMEASURED)
    assert len(result.hold_message.values[hold]) > 40


@pytest.mark.parametrize(
    ("change", "hold", "noise", "low", "high"),
    [
        # the error of the largest window is 1.4 standard errors of the noise
        ({"a": 0.007, "b": 0.008, "K": "15 GPa/m"}, 10.0, 7e-5, 0.75, 1.0),
        # the error of the largest window is 0.2 standard errors
        ({"a": 0.007, "b": 0.008, "K": "15 GPa/m"}, 10.0, 3e-4, 0.55, 0.65),
        # the error of the smallest window is 2.7 standard errors, and no other window passes
        ({"K": "30 GPa/m"}, 100.0, 2.4e-4, 1.6, 2.3),
        # the error of the smallest window is 0.9 standard errors, which its samples do not show
        ({"K": "30 GPa/m"}, 100.0, 7e-4, 0.65, 0.75),
    ],
)
def test_the_error_of_a_peak_includes_the_misfit(change, hold, noise, low, high):
    """Samples have no noise; low and high bound the error divided by the assumed noise."""
    slider = SLIDER.replace(Dc="5 um", **change)
    result = rs.healing(clean(slider, (hold,)), noise=noise)
    error = float(result.friction_peak_error[0])
    assert low < error / noise < high
    off = float(result.friction_peak[0]) - slider.mu0 - truth(slider, (hold,))[0, 0]
    assert abs(off) < error


def test_healing_accepts_a_loading_or_a_load_point_velocity():
    data = noisy(13, holds=(10.0, 30.0)).drop_vars(["segment_t", "segment_V"])
    loading, _ = loading_of((10.0, 30.0))
    given = rs.healing(data, loading=loading)
    found = rs.healing(data)
    np.testing.assert_allclose(given.delta_mu, found.delta_mu, rtol=0, atol=3e-4)
    V_load = xarray.DataArray(np.gradient(data.delta_lp, data.time), dims="time")
    speeds = rs.healing(data.assign(V_load=V_load).drop_vars("delta_lp"), loading=loading)
    np.testing.assert_allclose(speeds.delta_mu, given.delta_mu, rtol=0, atol=1e-6)


def test_the_summary_has_the_numbers(one):
    text = str(summary(one))
    assert "4 of 4 holds evaluated" in text
    assert "slip law predicts" in text
    assert text.count("10 um/s") == 8
    with pytest.raises(ParameterError, match="title"):
        str(summary(one.drop_attrs()))


@pytest.mark.parametrize(
    ("change", "arguments", "text"),
    [
        ({}, {"trend": "both"}, "trend = 'both' is unknown"),
        ({}, {"noise": -1.0}, "noise"),
        ({}, {"slider": 3}, "healing needs the Dataset that fit returns"),
        ({"friction": "tau"}, {}, "tau .* no normal stress"),
    ],
)
def test_settings_of_healing_that_are_refused(change, arguments, text):
    with pytest.raises(ParameterError, match=text):
        rs.healing(noisy(1).rename(change), **arguments)


def test_records_without_holds():
    step = noisy(1).drop_vars(["segment_t", "segment_V"]).sel(time=slice(0.0, 29.0))
    with pytest.raises(ParameterError, match="has no hold"):
        rs.healing(step)
    swept = SLIDER.replace(K=rs.logspace("K", 1e9, 1e10, 2))
    with pytest.raises(ParameterError, match="K of the slider is a DataArray"):
        rs.healing(noisy(1), slider=swept)
    with pytest.raises(ParameterError, match="no slide of the record has 12 samples"):
        rs.healing(clean(holds=(30.0,), slide=2.0))
