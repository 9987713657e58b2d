"""Steady friction before holds: short slides, hardening, transients, fault slip, digits."""

import numpy as np
import pytest
from slide_hold_slide import clean, loading_of, noisy, truth

import ratestate as rs
from ratestate.records.healing.holds import healing_record
from ratestate.records.healing.steady import Shape, fitted_line, scatter_about_line
from ratestate.records.kit.sample_noise import digit_of, resolution, rounding

#: slider for which slides of 200 um are short: friction oscillates with a decay length of 32 um
SOFT = rs.SpringSlider(
    a=0.007, b=0.008, Dc="17 um", sigma="10 MPa", K="5 GPa/m", V0="10 um/s", law="aging"
)
SHORT = {"slider": SOFT, "holds": (10.0, 100.0, 1000.0), "slide": 20.0, "white": 2e-4}
HEALING = truth(SOFT, SHORT["holds"], last=16.0)[:, 0]


def test_short_slides_have_larger_errors_and_a_message():
    z, beta = [], []
    for seed in range(3):
        result = rs.healing(noisy(seed, **SHORT))
        assert (result.hold_status == 0).all()
        z.append((result.delta_mu - HEALING) / result.delta_mu_error)
        beta.append((result.beta - 0.0170) / result.beta_error)
        assert "friction was still changing" in result.hold_message.values[2]
        assert "friction was still changing" not in result.hold_message.values[0]
        assert 5e-5 < float(result.delta_mu_error[2]) < 3e-3
    assert np.abs(z).max() < 3.0
    assert np.mean(np.abs(z)) > 0.2
    assert np.abs(beta).max() < 3.0


@pytest.mark.parametrize("hardening", [-5.0])
def test_friction_drifts_with_slip_of_the_fault(hardening):
    """Drift with the load point, which moves 150 um more, would change healing by 7e-4."""
    data = noisy(3, **SHORT | {"slide": 80.0, "white": 5e-5}, trend=hardening)
    result = rs.healing(data)
    assert (np.abs(result.delta_mu - HEALING) < 3.0 * result.delta_mu_error).all()
    assert float(result.delta_mu_error.max()) < 2e-4
    assert all("friction drifts by" in text for text in result.hold_message.values)
    flat = rs.healing(noisy(3, **SHORT | {"slide": 80.0, "white": 5e-5}))
    assert not any("friction drifts by" in text for text in flat.hold_message.values)


def test_fault_slip():
    data = clean(SOFT, SHORT["holds"], 40.0, dt=0.05)
    record = healing_record(data, None, "slip")
    assert record.k == pytest.approx(500.0, rel=0.03)
    np.testing.assert_allclose(np.diff(record.slip), np.diff(data.slip), atol=3e-8)
    coarse = healing_record(data.isel(time=slice(None, None, 600)), None, "slip")
    assert coarse.k == np.inf
    np.testing.assert_allclose(coarse.slip, data.delta_lp[::600], rtol=0, atol=1e-12)


def test_a_transient_agrees_with_linear_theory():
    """Eigenvalues of the linear equations: lambda^2 a Dc + lambda (k Dc + a - b) + k = 0."""
    a, b, Dc, k = 0.007, 0.008, 17e-6, 500.0
    slow = (k * Dc + a - b) / (2.0 * a * Dc)
    shape = Shape(1.0 / slow, 0.0, np.sqrt(k / (a * Dc) - slow**2) / slow)
    data = clean(SOFT, (10.0,), 40.0, dt=0.02)
    tail = data.sel(time=slice(63.0, 80.0))
    friction = tail.friction.values - 0.6
    columns = shape.columns(tail.slip.values)
    for used, largest in ((columns[:, :2], 4e-2), (columns, 4e-3)):
        rest = friction - used @ np.linalg.lstsq(used, friction, rcond=None)[0]
        assert np.abs(rest).max() < largest * np.abs(friction).max()
    assert np.abs(friction).max() > 1e-4


def test_scatter_of_levels_about_their_line_is_estimated():
    rng, n = np.random.default_rng(2), 60
    x = np.linspace(-1.0, 1.0, n)
    designs = np.zeros((n, 2, 2))
    designs[:, 0, 0], designs[:, 0, 1], designs[:, 1, 1] = 1.0, x, 1.0
    errors = np.tile(1e-4 * np.eye(2) * 1e-4, (n, 1, 1))
    for scatter in (0.0, 1e-3):
        noise = np.hypot(scatter, 1e-4) * rng.normal(size=(n, 2))
        columns = designs, designs @ [0.6, 0.01] + noise, errors
        assert scatter_about_line(*columns, 2) == pytest.approx(scatter, rel=0.3, abs=7e-5)
        fitted, covariance = fitted_line(*columns, scatter)
        off = np.abs(fitted - [0.6, 0.01]) / np.sqrt(np.diag(covariance))
        assert 0.05 < off.max() < 3.0


@pytest.mark.parametrize(("digits", "step"), [(9, 1e-9), (4, 1e-4)])
def test_a_record_without_noise_has_the_errors_of_its_digits(digits, step):
    slider = rs.SpringSlider(
        a=0.005, b=0.01, Dc="10 um", sigma="5 MPa", K="5 GPa/m", V0="10 um/s", law="aging"
    )
    data = clean(slider, (10.0, 30.0), 30.0, dt=0.02)
    result = rs.healing(data.assign(friction=data.friction.round(digits)))
    assert (result.hold_status == 0).all()
    exact = truth(slider, (10.0, 30.0))
    assert exact[0, 0] == pytest.approx(0.0204361, abs=1e-6)
    for name, known in (("delta_mu", exact[:, 0]), ("delta_mu_c", exact[:, 1])):
        error = result[f"{name}_error"]
        assert (error >= step * 6**-0.5 * 0.999).all()
        assert (error < max(10.0 * step, 1e-6)).all()
        assert (np.abs(result[name] - known) < 5.0 * error + 1e-7).all()


def test_the_digit_of_rounded_values_is_found():
    values = np.random.default_rng(1).integers(0, 50, 400) * 0.002 + 0.5
    assert digit_of(values) == pytest.approx(0.002)
    assert digit_of(np.append(values, values * (1.0 + 1e-15))) == pytest.approx(0.002)
    assert digit_of(np.random.default_rng(1).normal(size=400)) == 0.0
    assert digit_of(np.full(5, 0.6)) == 0.0


def test_values_that_are_only_nearly_multiples_of_a_step_have_a_resolution():
    """Counts of a converter written in decimals, and decimals in single precision."""
    counts = np.random.default_rng(1).integers(0, 400, 400)
    written = np.round(counts * 2.0**-12, 6)
    single = (0.5 + 1e-4 * counts).astype(np.float32).astype(float)
    assert resolution(written) == pytest.approx(2.0**-12, abs=2e-6)
    assert resolution(single) == pytest.approx(1e-4, rel=2e-3)
    assert rounding(single) == pytest.approx(1e-4 / np.sqrt(12.0), rel=2e-3)


@pytest.mark.parametrize("trend", ["slip", "time", None])
def test_one_hold(trend):
    """A record with one hold has two slides, or only one."""
    data = noisy(5, holds=(30.0,))
    exact = truth(holds=(30.0,))[0]
    both = rs.healing(data, trend=trend)
    assert both.hold_status.item() == 0
    assert abs(both.delta_mu.item() - exact[0]) < 3.5 * both.delta_mu_error.item() < 2e-3
    one = rs.healing(data.sel(time=slice(None, 59.0)), trend=trend, loading=loading_of((30.0,))[0])
    assert "record ends" in one.hold_message.item()
    assert abs(one.delta_mu_c.item() - exact[1]) < 3.5 * one.delta_mu_c_error.item() < 1e-3
