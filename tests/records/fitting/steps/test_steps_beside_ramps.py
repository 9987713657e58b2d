"""Velocity steps beside a ramp of normal stress, or with varying normal stress."""

import numpy as np
import pytest
import xarray

import ratestate as rs
from ratestate.records.fitting.steps.windows import windows_of

pytestmark = pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
SLIDER = rs.SpringSlider(
    a=0.009, b=0.011, Dc="12 um", sigma="10 MPa", K="8 GPa/m", alpha=0.25, V0="3 um/s", law="aging"
)
START = SLIDER.replace(a=0.007, b=0.009, Dc="16 um", K="6 GPa/m", alpha=0.1)
NAMES = ["a", "b", "Dc"]


def recorded(loading, end, seed=2):
    t = np.arange(0.0, end, 0.1)
    run = rs.simulate(SLIDER, loading, t[-1], times=t, rtol=1e-9)
    noise = 2e-4 * np.random.default_rng(seed).normal(size=t.size)
    sigma = run.get("sigma", SLIDER.sigma)
    return run[["delta_lp"]].assign(friction=run.tau / sigma + noise, sigma=sigma)


def fitted(data, **settings):
    return rs.fit(data, START, per_step=True, errors="covariance", **settings)


def deviations(result, steps):
    truth = np.array([getattr(SLIDER, name) for name in NAMES])
    estimates = np.array([result[name].values[steps] for name in NAMES]).T
    return (estimates - truth) / result.standard_error.sel(parameter=NAMES).values[steps]


def test_a_short_ramp_does_not_bias_the_steps_before_it():
    loading = rs.Loading.steps("3 um/s", (100.0, "10 um/s"), (140.0, "3 um/s"))
    data = recorded(loading.sigma_ramp(260.0, "11 MPa", 1.0), 390.0)
    result = fitted(data)
    assert result.kind.values.tolist() == ["step", "step", "normal stress"]
    assert float(result.step_t[2]) == pytest.approx(260.0, abs=0.15)
    assert np.abs(deviations(result, slice(0, 2))).max() < 3.5
    shared, error = (
        result[name].sel(parameter=NAMES).values for name in ("shared", "shared_error")
    )
    truth = np.array([getattr(SLIDER, name) for name in NAMES])
    assert np.abs((shared - truth) / error).max() < 3.5
    assert (error < 0.02 * truth).all()
    assert abs(float(result.alpha[2]) - 0.25) < 4.0 * float(result.standard_error[2, -1])
    assert (result.warnings.values[:2] == "").all()


def test_a_step_with_varying_normal_stress_is_left_out_of_the_joint_fit():
    """Normal stress rises by 4 % for a while after the third step."""
    loading = rs.Loading.steps("3 um/s", (60, "10 um/s"), (90, "3 um/s"), (160, "10 um/s"))
    loading = loading.sigma_ramp(165.0, "10.4 MPa", 2.0).sigma_ramp(168.0, "10 MPa", 2.0)
    data = recorded(loading, 195.0)
    result, two = fitted(data), fitted(data.sel(time=slice(0.0, 159.0)))
    assert result.kind.values.tolist() == ["step"] * 3
    assert int(result.shared_degrees) == int(two.shared_degrees) == 3
    spoilt = str(result.warnings[2].item())
    assert "normal stress varies by 4 % in this window, and alpha is held at 0.1," in spoilt
    assert "so the joint estimates leave it out" in spoilt
    assert "normal stress varies" not in "".join(result.warnings.values[:2].tolist())
    assert np.abs(deviations(result, slice(0, 2))).max() < 3.5
    assert "normal stress varies by 4 %" in " ".join(str(rs.summary(result)).split())


def test_a_step_in_a_ramp_begins_with_it():
    """A window after a ramp begins at the ramp's end, if that is before the step."""
    t = np.arange(0.0, 300.0, 0.1)
    x = 1e-6 * np.interp(t, [0.0, 150.0, 300.0], [0.0, 450.0, 1950.0])
    for begin, lasts in ((140.0, 1.0), (140.0, 20.0)):
        sigma = 1e7 * np.interp(t, [begin, begin + lasts], [1.0, 1.1])
        columns = {"delta_lp": x, "sigma": sigma, "friction": 0.0 * t}
        data = xarray.Dataset({name: ("time", one) for name, one in columns.items()}, {"time": t})
        step = next(window for window in windows_of(data) if window.kind == "step")
        assert step.begin >= (begin + lasts - 0.2 if lasts < 10.0 else begin - 0.2)
        assert step.begin < 150.0
