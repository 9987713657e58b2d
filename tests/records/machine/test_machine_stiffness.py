"""`machine_stiffness` for known K, M and damping: values, errors, remarks and refusals."""

import json

import numpy as np
import pytest
import xarray
from machine_records import SLIDER, STICK_SLIP, STIFF, clean, noisy, one_step, stick_slip, wandering

import ratestate as rs
from ratestate import ParameterError, plot, summary
from ratestate.records.machine.machine_stiffness import stiffness_remarks, stress_drops
from ratestate.records.machine.ring_down import RingDown, mass_and_damping, ring_down
from ratestate.records.machine.slopes import curve, fitted_slope
from ratestate.records.raw_record import raw_record, segments_of
from ratestate.records.stick_slip import catalogue


@pytest.fixture(scope="module")
def one():
    return rs.machine_stiffness(noisy(1, clean()), sigma="10 MPa", slider=SLIDER)


def test_constant_or_falling_friction_has_no_slope():
    x = np.linspace(-1e-5, 1e-5, 200)
    assert fitted_slope(x, x, np.full(200, 0.6), 0.3) is None
    assert fitted_slope(x, x, 0.6 - 100.0 * x, 0.3) is None


@pytest.mark.parametrize("h", [0.0, 60.0])
def test_the_loading_curve_solves_its_equation(h):
    """d mu/dx = k (1 - r exp((mu - mu_0 - h x)/a)): a fault that heals creeps less."""
    x, k, a, r = np.linspace(0.0, 2e-5, 2001), 2e3, 0.01, 0.2
    mu = curve(x, 0.6, k, a, r, h)
    slope = np.gradient(mu, x, edge_order=2)
    np.testing.assert_allclose(slope, k * (1 - r * np.exp((mu - 0.6 - h * x) / a)), rtol=1e-4)
    np.testing.assert_array_equal(curve(-x, 0.6, k, a, r, h), 0.6)  # the level before
    np.testing.assert_allclose(curve(x, 0.6, k, a, 0.0), 0.6 + k * x, rtol=1e-14)
    assert (mu[-1] > curve(x, 0.6, k, a, r)[-1] + 1e-4) == (h > 0.0)


def test_the_slip_rate_at_the_end_of_a_hold_is_not_a_mean():
    """It agrees with the last samples without noise, which give -dmu/dx = k r."""
    t, mu = clean().time.values, clean().friction.values
    pair = [rs.machine_stiffness(noisy(7, clean(), white=w), sigma="10 MPa") for w in (1e-4, -1e-4)]
    for i, end in enumerate((60.0, 175.0)):
        last = np.flatnonzero(t < end)[-3:]
        rate = -np.polyfit(t[last], mu[last], 1)[0]
        creep = np.mean([one.slope_creep.values[i] for one in pair])
        assert creep == pytest.approx(rate / (2e3 * 1e-5), rel=0.012)
    # noise has opposite effects on the pair, to first order
    K = np.mean([float(one.K) for one in pair])
    assert pytest.approx(SLIDER.K, rel=2e-4) == K


def test_stress_drops_agree_with_events(monkeypatch):
    """They agree to the sample, and are found without measuring the falls."""
    record = noisy(2, stick_slip())
    expected = rs.events(record, sigma="10 MPa")
    whole = np.isfinite(expected.stress_drop.values)
    monkeypatch.setattr(catalogue, "measured_falls", None)
    raw = raw_record(record, None)
    (drops,) = stress_drops(raw, 1e7, segments_of(raw))
    assert len(drops) == whole.sum() == 7
    for i, name in enumerate(("event_start", "event_end")):
        np.testing.assert_allclose(drops[:, i], expected[name].values[whole], atol=0.1)


def test_one_step_of_a_stiff_machine_is_not_biased():
    """The rise takes about 14 samples; K of 8 records is as often too high as too low."""
    z, relative = [], []
    for seed in range(8):
        result = rs.machine_stiffness(noisy(seed, one_step(), white=7.5e-4), sigma=STIFF.sigma)
        assert result.slope_kind.values.tolist() == ["step_up"]
        error = float(result.K_error / result.K)
        relative.append(error)
        z.append(np.log(float(result.K) / STIFF.K) / error)
        remark = f"K rests on 1 slope, with an error of {100.0 * error:.2g} %"
        assert remark in result.attrs["remarks"]
    assert abs(np.mean(z)) < 0.8
    assert 2 <= np.sum(np.array(z) > 0.0) <= 6
    assert 0.6 < np.std(z) < 1.4
    assert 0.05 < np.median(relative) < 0.3


def test_a_large_error_of_K_is_remarked(one):
    """Several slopes cause a warning only if the error of K exceeds 20 %."""
    for error, expected in ((0.199, 0), (0.201, 1)):
        texts = [*stiffness_remarks(one.assign(K_error=error * one.K))]
        assert len(texts) == expected
    assert "K rests on 2 slopes, with an error of 20 %" in texts[0]
    assert "Do not fix K in a fit" in texts[0]


def test_mass_and_damping_agree_with_eigenvalues():
    """The least stable mode of steady sliding from `stability` is a ring-down."""
    for damping in (0.0, 3e5):
        slider = SLIDER.replace(damping=damping) if damping else SLIDER
        rate = complex(rs.stability(slider, "5 cm/s").eigenvalues.values[0])
        point = np.array([abs(rate.imag), -rate.real])
        mode = RingDown(point, np.eye(2), None, None, 0.0, start=0.0, V=0.05)
        (M, result), jacobian = mass_and_damping(SLIDER.K, mode, SLIDER.sigma, SLIDER)
        assert pytest.approx(SLIDER.M, rel=1e-8) == M
        assert result == pytest.approx(damping, abs=2.0)
        (more, _), _ = mass_and_damping(1.01 * SLIDER.K, mode, SLIDER.sigma, SLIDER)
        assert more - M == pytest.approx(0.01 * SLIDER.K * jacobian[0, 2], rel=1e-6)
        (alone, _), _ = mass_and_damping(SLIDER.K, mode, SLIDER.sigma, None)
        assert alone == pytest.approx(SLIDER.K / abs(rate) ** 2)
        assert 0.01 < alone / SLIDER.M - 1.0 < 0.05


def test_a_damped_sinusoid():
    t, rng = np.arange(0.0, 1.0, 1e-3), np.random.default_rng(3)
    z = []
    for seed in range(8):
        rng = np.random.default_rng(seed)
        y = 0.6 + 1e-3 * t + 1e-2 * np.exp(-5.0 * t) * np.sin(100.0 * t + seed)
        found = ring_down(t, y + 3e-4 * rng.normal(size=t.size), np.arange(t.size), 1e-2)
        errors = np.sqrt(np.diag(found.covariance))
        z.append((found.point - [100.0, 5.0]) / errors)
    z = np.array(z)
    assert np.abs(z.mean(axis=0)).max() < 1.0
    assert 0.6 < z.std() < 1.35
    noise = 0.6 + 3e-4 * rng.normal(size=t.size)
    assert ring_down(t, noise, np.arange(t.size), 1e-2) is None


def test_stiffness_mass_and_damping(one):
    assert one.slope_kind.values.tolist() == ["reload", "reload"]
    for symbol in ("K", "M"):
        value, error = float(one[symbol]), float(one[f"{symbol}_error"])
        assert abs(value - getattr(SLIDER, symbol)) < 3.5 * error
        assert 1e-3 < error / value < 2e-2
    assert abs(float(one.damping)) < 4.0 * float(one.damping_error) < 1e5
    assert (one.slope_straight < one.slope_K).all()  # the fault creeps
    assert json.loads(one.attrs["remarks"]) == []
    replaced = SLIDER.replace(K=float(one.K), M=float(one.M))
    assert pytest.approx(float(one.M)) == replaced.M


@pytest.mark.statistics
def test_errors_are_calibrated():
    """There are 16 records; every second one has correlated noise."""
    z = []
    for seed in range(16):
        data = noisy(seed, clean(), red=5e-5 * (seed % 2))
        result = rs.machine_stiffness(data, sigma="10 MPa", slider=SLIDER)
        truth = {"K": SLIDER.K, "M": SLIDER.M, "damping": 0.0}
        z.append([float((result[k] - x) / result[f"{k}_error"]) for k, x in truth.items()])
    z = np.array(z)
    assert np.abs(z.mean(axis=0)).max() < 1.0
    assert 0.55 < (np.abs(z) < 1.0).mean() < 0.88
    assert (np.abs(z) < 1.96).mean() > 0.85


def test_without_a_slider_the_damping_includes_friction(one):
    result = rs.machine_stiffness(noisy(1, clean()), sigma="10 MPa")
    assert "friction together" in result.attrs["remarks"]
    friction = SLIDER.a * SLIDER.sigma / 0.05
    assert 0.2 * friction < float(result.damping) < 1.1 * friction
    assert 1.01 < float(result.M / one.M) < 1.05
    assert float(result.K) == float(one.K)


def test_stick_slip_gives_a_lower_bound():
    result = rs.machine_stiffness(noisy(2, stick_slip()), sigma="10 MPa")
    assert set(result.slope_kind.values.tolist()) == {"stick"}
    assert "lower bound" in result.attrs["remarks"]
    # the fraction by which creep reduces K, which the remark gives
    lost = STICK_SLIP.K * STICK_SLIP.Dc / (5.0 * STICK_SLIP.b * STICK_SLIP.sigma)
    assert 0.7 * lost < 1.0 - float(result.K) / STICK_SLIP.K < 1.1 * lost
    assert np.isnan(result.M)


def test_stick_slip_that_does_not_creep():
    """Under the aging law the fault heals and sticks, so K is unbiased."""
    slider = STICK_SLIP.replace(law="aging")
    z = []
    for seed in range(3):
        result = rs.machine_stiffness(noisy(seed, stick_slip(slider)), sigma="10 MPa")
        assert set(result.slope_kind.values.tolist()) == {"stick"}
        z.append(float((result.K - slider.K) / result.K_error))
        np.testing.assert_allclose(result.slope_straight, result.slope_K, rtol=1e-9)
    assert abs(np.mean(z)) < 1.0
    assert np.abs(z).max() < 3.5


@pytest.mark.parametrize("seed", [4, 23, 59])
def test_noise_is_not_stick_slip(seed):
    """These seeds of 60 have falls that happen to be regular, or shorter than rises."""
    assert rs.events(wandering(seed), sigma="10 MPa").sizes["event"] == 0
    with pytest.raises(ParameterError, match="no slope of loading"):
        rs.machine_stiffness(wandering(seed), sigma="10 MPa")


def test_the_summary_the_page_and_a_file(one, tmp_path):
    text = str(summary(one))
    assert text.startswith("K = ")
    assert "GPa/m" in text
    assert text.count("reload") == 2
    assert str(summary(rs.files.read(rs.files.write(one, tmp_path / "machine.nc")))) == text
    fig = plot.figure(one)
    fig.draw_without_rendering()
    slope, ring = (ax.get_title("left").split("$ ")[1] for ax in fig.axes[1:])
    assert slope.startswith("reload\n19.98")
    assert slope.endswith(" GPa/m")
    assert "\N{PLUS-MINUS SIGN}" in slope
    assert ring.startswith("ring-down\n222.")
    assert "Drawn" not in fig.get_suptitle()
    with pytest.raises(ParameterError, match="title"):
        summary(one.drop_attrs())


@pytest.mark.parametrize(
    ("sigma", "settings", "text"),
    [
        ("1e300 MPa", {}, r"sigma = 1e\+297 GPa is impossible .* such as '20 MPa'"),
        ("1.01e11 Pa", {}, "sigma = 101 GPa is impossible"),
        (None, {}, "no normal stress"),
        ("10 um", {}, "sigma"),
        ("10 MPa", {"slider": 3}, "slider is of the type int"),
        ("10 MPa", {"slider": SLIDER.replace(a=rs.logspace("a", 1e-3, 1e-2, 2))}, "a of the"),
        ("10 MPa", {"slider": SLIDER.replace(friction_form="regularized")}, "one state"),
    ],
)
def test_bad_input(sigma, settings, text):
    with pytest.raises(ParameterError, match=text):
        rs.machine_stiffness(noisy(1, clean()), sigma=sigma, **settings)


def test_ringing_at_rest_is_distinguished_from_ringing_in_sliding():
    """A block at rest cannot oscillate, so another part of the machine rings."""
    data = noisy(3, clean())
    t = data.time.values
    start = float(t[np.flatnonzero(np.diff(data.delta_lp.values) == 0.0)[0]])
    since = np.where(t > start, t - start, np.inf)
    ringing = 0.01 * np.exp(-since) * np.cos(10.0 * np.pi * np.minimum(since, 1e3))
    result = rs.machine_stiffness(
        data.assign(friction=data.friction + ringing), sigma="10 MPa", slider=SLIDER
    )
    at_rest = result.ring_down_V == 0.0
    assert int(at_rest.sum()) == 1
    omega = float(result.ring_down_omega[at_rest][0])
    assert omega == pytest.approx(10.0 * np.pi, rel=0.02)  # the relaxation has an effect
    (remark,) = (text for text in json.loads(result.attrs["remarks"]) if "at rest" in text)
    assert f"1 of {result.sizes['ring_down']} ring-downs" in remark


@pytest.mark.parametrize(("excess", "lasts"), [(0.06, 0.088), (0.1, 0.05), (0.0, 0.05)])
def test_an_overshoot_does_not_move_the_stiffness(excess, lasts):
    """The spring loads within 50 ms, entirely at the speed of the overshoot."""
    V, values = 1e-4, {"a": 0.009, "b": 0.012, "Dc": "10 um", "sigma": "10 MPa", "K": "12 GPa/m"}
    slider = rs.SpringSlider(law="aging", V0="10 um/s", **values)
    loading = rs.Loading.steps("10 um/s", (60, V * (1.0 + excess)), (60 + lasts, V))
    t = np.concatenate([np.arange(0, 59, 0.05), np.arange(59, 66, 0.005)])
    run = rs.simulate(slider, loading, t[-1], times=t, rtol=1e-9)
    noise = 1e-4 * np.random.default_rng(1).normal(size=t.size)
    segments = {"segment_t": ("segment", loading.t), "segment_V": ("segment", loading.V)}
    record = xarray.Dataset(segments | {"delta_lp": ("time", run.delta_lp.values)}, {"time": t})
    friction = ("time", run.tau.values / 10e6 + noise)
    result = rs.machine_stiffness(record.assign(friction=friction), sigma="10 MPa")
    assert result.slope_kind.values.tolist() == ["step_up"]
    assert result.slope_start.values == pytest.approx([60.0], abs=1e-12)
    assert float(result.K) == pytest.approx(12e9, rel=0.025)
    assert float(result.K_error) < 0.04 * 12e9
