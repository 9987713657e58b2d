"""`machine_stiffness`: K, M and damping that are known, their errors, and what is refused."""

import json

import numpy as np
import pytest
from machine_records import SLIDER, STICK_SLIP, clean, noisy, stick_slip

import ratestate as rs
from ratestate import ParameterError, plot
from ratestate.records.machine import summary
from ratestate.records.machine.inertia import mass_and_damping
from ratestate.records.machine.loading_curve import curve
from ratestate.records.machine.ring_down import RingDown, ring_down


@pytest.fixture(scope="module")
def one():
    return rs.machine_stiffness(noisy(1, clean()), "10 MPa", slider=SLIDER)


def test_the_loading_curve_solves_its_equation():
    """d mu/dx = k (1 - r exp((mu - mu_0)/a))."""
    x, k, a, r = np.linspace(0.0, 2e-5, 2001), 2e3, 0.01, 0.2
    mu = curve(x, 0.6, k, a, r)
    slope = np.gradient(mu, x, edge_order=2)
    np.testing.assert_allclose(slope, k * (1.0 - r * np.exp((mu - 0.6) / a)), rtol=1e-4)
    assert mu[0] == pytest.approx(0.6)


def test_eigenvalues_give_mass_and_damping_back():
    """The least stable mode of steady sliding, by `stability`, is a ring-down."""
    for damping in (0.0, 3e5):
        slider = SLIDER.replace(damping=damping) if damping else SLIDER
        rate = complex(rs.stability(slider, "5 cm/s").eigenvalues.values[0])
        mode = RingDown(0.0, 0.05, abs(rate.imag), -rate.real, np.eye(2), None, None)
        (M, found), by, by_K = mass_and_damping(SLIDER.K, mode, SLIDER.sigma, SLIDER)
        assert pytest.approx(SLIDER.M, rel=1e-8) == M
        assert found == pytest.approx(damping, abs=2.0)
        (more, _), *_ = mass_and_damping(1.01 * SLIDER.K, mode, SLIDER.sigma, SLIDER)
        assert more - M == pytest.approx(0.01 * SLIDER.K * by_K[0], rel=1e-6)
        assert by.shape == (2, 2)
        (alone, _), *_ = mass_and_damping(SLIDER.K, mode, SLIDER.sigma, None)
        assert alone == pytest.approx(SLIDER.K / abs(rate) ** 2)
        assert 0.01 < alone / SLIDER.M - 1.0 < 0.05


def test_a_damped_sinusoid():
    t, rng = np.arange(0.0, 1.0, 1e-3), np.random.default_rng(3)
    z = []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        y = 0.6 + 1e-3 * t + 1e-2 * np.exp(-5.0 * t) * np.sin(100.0 * t + seed)
        found = ring_down(t, y + 3e-4 * rng.normal(size=t.size), np.arange(t.size), 0.0, 1e-2)
        errors = np.sqrt(np.diag(found.covariance))
        z.append([(found.omega - 100.0) / errors[0], (found.decay - 5.0) / errors[1]])
    z = np.array(z)
    assert np.abs(z.mean(axis=0)).max() < 0.8
    assert 0.6 < z.std() < 1.35
    noise = 0.6 + 3e-4 * rng.normal(size=t.size)
    assert ring_down(t, noise, np.arange(t.size), 0.0, 1e-2) is None


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


def test_errors_hold_the_truth():
    """Of 16 records, in every second of which the noise is correlated."""
    z = []
    for seed in range(16):
        data = noisy(seed, clean(), red=5e-5 * (seed % 2))
        result = rs.machine_stiffness(data, "10 MPa", slider=SLIDER)
        truth = {"K": SLIDER.K, "M": SLIDER.M, "damping": 0.0}
        z.append([float((result[k] - x) / result[f"{k}_error"]) for k, x in truth.items()])
    z = np.array(z)
    assert np.abs(z.mean(axis=0)).max() < 1.0
    assert 0.55 < (np.abs(z) < 1.0).mean() < 0.88
    assert (np.abs(z) < 1.96).mean() > 0.85


def test_without_a_slider_friction_is_in_the_damping(one):
    result = rs.machine_stiffness(noisy(1, clean()), "10 MPa")
    assert "friction together" in result.attrs["remarks"]
    friction = SLIDER.a * SLIDER.sigma / 0.05
    assert 0.2 * friction < float(result.damping) < 1.1 * friction
    assert 1.01 < float(result.M / one.M) < 1.05
    assert float(result.K) == float(one.K)


def test_stick_slip_gives_a_lower_bound():
    result = rs.machine_stiffness(noisy(2, stick_slip()), "10 MPa")
    assert set(result.slope_kind.values.tolist()) == {"stick"}
    assert "lower bound" in result.attrs["remarks"]
    assert 0.94 < float(result.K) / STICK_SLIP.K < 1.0
    assert np.isnan(result.M)


def test_normal_stress_scales_stiffness(one):
    doubled = rs.machine_stiffness(noisy(1, clean()), "20 MPa")
    assert float(doubled.K) == pytest.approx(2.0 * float(one.K))
    recorded = noisy(1, clean())
    recorded = recorded.assign(sigma=("time", np.full(recorded.sizes["time"], 1e7)))
    assert float(rs.machine_stiffness(recorded).K) == pytest.approx(float(one.K))


def test_the_summary_the_page_and_a_file(one, tmp_path):
    text = summary(one)
    assert text.startswith("K = ")
    assert "GPa/m" in text
    assert text.count("reload") == 2
    assert summary(rs.files.read(rs.files.write(one, tmp_path / "machine.nc"))) == text
    fig = plot.page(one)
    fig.draw_without_rendering()
    assert [ax.get_title("left").split("$ ")[1][:9] for ax in fig.axes] == [
        "reload: 2",
        "reload: 2",
        "ring-down",
    ]
    with pytest.raises(ParameterError, match="summary wants"):
        summary(one.drop_attrs())


@pytest.mark.parametrize(
    ("sigma", "settings", "text"),
    [
        (None, {}, "no normal stress"),
        ("10 um", {}, "sigma"),
        ("10 MPa", {"slider": 3}, "slider is of the type int"),
        ("10 MPa", {"slider": SLIDER.replace(a=rs.logspace("a", 1e-3, 1e-2, 2))}, "a of the"),
        ("10 MPa", {"slider": SLIDER.replace(friction="regularized")}, "one state"),
    ],
)
def test_bad_input(sigma, settings, text):
    with pytest.raises(ParameterError, match=text):
        rs.machine_stiffness(noisy(1, clean()), sigma, **settings)


def test_a_record_that_tells_nothing():
    quiet = noisy(1, clean()).sel(time=slice(0.0, 9.0))
    with pytest.raises(ParameterError, match="no slope of loading"):
        rs.machine_stiffness(quiet, "10 MPa")
