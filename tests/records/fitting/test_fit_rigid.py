"""Fits with K = inf, of rigid machines and of machines that are not rigid."""

import warnings

import numpy as np
import pytest
from synthetic_records import assert_finds, record

import ratestate as rs
from ratestate.records.fitting.forward import Forward
from ratestate.records.fitting.problem import samples_of
from ratestate.records.fitting.unknowns import to_coordinate

RIGID = rs.SpringSlider(a=0.008, b=0.010, Dc=1e-5, sigma=1e7, V0=1e-6, K=np.inf, law="slip")
T = np.arange(600) * 0.3


@pytest.mark.parametrize(
    ("law", "speeds"), [("slip", (1e-6, 5e-6, 2e-6)), ("aging", (5e-6, 1e-6, 1e-5))]
)
def test_a_sample_at_the_time_of_a_step_counts_as_after_it(law, speeds):
    """`simulate` does so as well; the steps are at samples 200 and 400."""
    loading = rs.Loading.steps(speeds[0], (T[200], speeds[1]), (T[400], speeds[2]))
    data = record(RIGID, loading, T, noise=1e-5, law=law).drop_vars("delta_lp")
    rigid = RIGID.replace(law=law)
    result = rs.fit(data, rigid, free=("a", "b", "Dc"), loading=loading, errors="covariance")
    off = result.friction_fit - data.friction
    assert np.abs(off).max() < 5e-5
    assert_finds(result, RIGID, ("a", "b", "Dc"), widest=0.01)


def test_a_hold_is_refused():
    """Friction has no value at rest."""
    truth = RIGID.replace(K=1e12)
    for loading in (
        rs.Loading.steps(1e-6, (T[200], 0.0), (T[400], 1e-6)),
        rs.Loading.constant(1e-6).ramp(T[200], 0.0, 5.0),
    ):
        data = record(truth, loading, T, noise=1e-5).drop_vars("delta_lp")
        with pytest.raises(rs.ParameterError, match=r"V_lp = 0 m/s with K = inf, .* finite K"):
            rs.fit(data, RIGID, free=("a", "b", "Dc"), loading=loading)


def test_derivatives_are_exact():
    """After a step ln(V theta/Dc) decays with slip, which gives a closed form."""
    loading = rs.Loading.steps(1e-6, (T[200], 5e-6))
    data = record(RIGID, loading, T, noise=1e-5).drop_vars("delta_lp")
    checked = samples_of(data, RIGID, loading=loading, trend=None, against="time")
    forward = Forward(checked, RIGID, ("a", "b", "Dc"))
    slips = 5e-6 * np.maximum(T - T[200], 0.0) / RIGID.Dc
    rise = np.where(np.arange(T.size) < 200, 0.0, np.log(5.0))
    decay = np.exp(-slips)
    exact = {
        "a": RIGID.a * rise,
        "b": rise * (decay - 1.0),
        "Dc": RIGID.b * rise * slips * decay,
    }
    point = np.array([to_coordinate(name, getattr(RIGID, name)) for name in exact])
    friction, slopes = forward.jacobian(point)
    change = RIGID.a * rise + RIGID.b * rise * (decay - 1.0)
    np.testing.assert_allclose(friction - friction[0], change, rtol=0, atol=1e-13)
    for slope, truth in zip(slopes.T, exact.values(), strict=True):
        np.testing.assert_allclose(slope, truth, rtol=0, atol=3e-8 * np.abs(truth).max())


def warned(data, loading):
    """Return the warnings of a fit with K = inf under this loading."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        rs.fit(data, RIGID, free=("a", "b", "Dc"), loading=loading, errors="covariance")
    return " ".join(str(warning.message) for warning in caught)


def moved(lag=0.0, takes=0.0, K=np.inf, seed=0, last=5e-6):
    """Return a record of a load point that moves later or accelerates, and a loading.

    The loading has neither the lag nor the acceleration.
    """
    t = np.arange(3000) * 0.1
    loading = rs.Loading.steps(1e-6, (60.04, 5e-6), (180.04, last))
    truth = rs.Loading.steps(1e-6, (60.04 + lag, 5e-6), (180.04 + lag, last))
    if takes:
        truth = rs.Loading.constant(1e-6).ramp(60.04, 5e-6, takes)
    data = record(RIGID.replace(K=K), truth, t, noise=2e-4, seed=seed).drop_vars("delta_lp")
    return data, loading


@pytest.mark.parametrize(
    "cause", [{"K": 1e11}, {"lag": 0.3}, {"takes": 0.5}], ids=lambda cause: str(cause)
)
def test_the_warning_names_a_spring_and_a_late_load_point(cause):
    text = warned(*moved(**cause))
    assert "a spring, or a load point that moves later or more gradually than recorded" in text
    assert "Or check the clock" in text


@pytest.mark.parametrize(
    ("lag", "last", "side"), [(1.0, 1e-6, "later"), (-0.3, 5e-6, "earlier")], ids=str
)
def test_the_warning_names_a_lag_that_no_spring_explains(lag, last, side):
    text = warned(*moved(lag=lag, last=last))
    assert "a spring" not in text
    named = text.split("a load point that moves about ")[1].split(f" {side} than recorded")[0]
    number, unit = named.split()
    assert 0.7 < float(number) * {"s": 1.0, "ms": 1e-3}[unit] / abs(lag) < 1.4


def test_a_rigid_machine_has_no_such_warning():
    text = warned(*moved())
    assert "a spring" not in text
    assert "load point that moves" not in text
