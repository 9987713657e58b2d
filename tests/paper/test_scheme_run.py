"""The paper's own scheme: its equations, its order, and what it is not for."""

import math

import numpy as np
import pytest

import ratestate as rs
from ratestate import scenario
from ratestate.paper.parameters import FIG2
from ratestate.paper.scheme import last_cycle

VARIANTS = pytest.mark.parametrize(
    ("law", "euler"), [("slip", False), ("aging", False), ("aging", True)]
)


@VARIANTS
def test_each_step_is_eqs_8_and_9(law, euler):
    """In physical variables, along a ramp."""
    dt, K, M = 1e-4, 9e8, 3e3
    loading = rs.Loading.series([0.0, 0.01], [2e-3, 3e-3])
    run = rs.paper.im2017(FIG2.replace(law=law), loading, 0.01, dt, V_start=1e-3, euler=euler)
    t, V, theta, tau = (run[k].values for k in ("time", "V", "theta", "tau"))
    np.testing.assert_allclose(np.diff(t), dt, rtol=1e-9)
    np.testing.assert_allclose([V[0], theta[0], tau[0]], [1e-3, 1e-2, 2e6 * run.mu[0]], rtol=1e-13)
    mu = 0.6 + 0.003 * np.log(V / 1e-9) + 0.006 * np.log(1e-9 * theta / 1e-5)
    np.testing.assert_allclose(run.mu, mu, rtol=1e-13)
    omega = math.sqrt(K / M)
    delta, d_lp = run.delta.values, run.delta_lp.values
    # eq. 8: K (delta_lp - delta) oscillates about the friction of the step's end
    c, s = math.cos(omega * dt), math.sin(omega * dt)
    swing = K * (d_lp[1:] - delta[:-1]) - 2e6 * mu[1:]
    stress = 2e6 * mu[1:] + swing * c - K * V[:-1] / omega * s
    np.testing.assert_allclose(tau[1:], stress, rtol=1e-9)
    # eq. 9: V_new is twice the mean velocity less the old one
    np.testing.assert_allclose(V[1:], 2 * np.diff(delta) / dt - V[:-1], rtol=1e-7)
    z = V[1:] * dt / 1e-5
    if law == "slip":
        new = 1e-5 / V[1:] * (V[1:] * theta[:-1] / 1e-5) ** np.exp(-z)
    elif euler:
        new = (theta[:-1] + dt) / (1 + z)
    else:
        new = 1e-5 / V[1:] + (theta[:-1] - 1e-5 / V[1:]) * np.exp(-z)
    np.testing.assert_allclose(theta[1:], new, rtol=1e-11)


def end(run):
    return np.array([run.tau[-1] / 6e3, np.log(run.V[-1]), np.log(run.theta[-1])])


@VARIANTS
def test_the_scheme_converges_at_order_1(law, euler):
    """To what `simulate` finds, across a step and a hold, whose times are no multiples of dt."""
    slider = FIG2.replace(law=law)
    loading = rs.Loading.steps(1e-3, (0.00501, 2e-3), (0.01503, 0.0), (0.016, 2e-3))
    exact = end(rs.simulate(slider, loading, 0.02, rtol=1e-12))
    runs = [rs.paper.im2017(slider, loading, 0.02, 0.02 / n, euler=euler) for n in (1e3, 2e3, 4e3)]
    assert {0.00501, 0.01503, 0.016, 0.02} <= set(runs[0].time.values)
    errors = [np.abs(end(run) - exact).max() for run in runs]
    slopes = np.log2([errors[0] / errors[1], errors[1] / errors[2]])
    assert ((slopes > 0.9) & (slopes < 1.1)).all(), slopes
    assert errors[0] > 1e-4  # else it would not be this scheme


@pytest.mark.parametrize("dt", [1e-5, 1e-6, 1e-7])
def test_small_steps_are_accurate(dt):
    """No root is lost to rounding."""
    loading = rs.Loading.constant(2e-3)
    exact = end(rs.simulate(FIG2, loading, 0.02, V_start=1e-3, rtol=1e-10))
    error = end(rs.paper.im2017(FIG2, loading, 0.02, dt, V_start=1e-3)) - exact
    assert 500 * dt < np.abs(error).max() < 800 * dt


def test_the_last_cycle_agrees_with_limit_cycle():
    loading, dt = rs.Loading.constant(3.3e-3), 1e-6
    cycle = rs.limit_cycle(FIG2, 3.3e-3)
    run = rs.paper.im2017(FIG2, loading, 2.0, dt, V_start=3e-3)
    amplitude, frequency = last_cycle(run)
    assert amplitude == pytest.approx(float(cycle.amplitude), rel=0.02)
    assert frequency == pytest.approx(float(cycle.frequency), rel=1e-3)
    coarse = run.isel(time=slice(None, None, 200))  # the cubic finds what lies between the steps
    assert last_cycle(coarse) == pytest.approx((amplitude, frequency), rel=1e-4)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"slider": FIG2.replace(M=0.0)}, "needs M > 0"),
        ({"slider": FIG2.replace(K=math.inf)}, "needs K < inf"),
        ({"slider": FIG2.replace(law="prz")}, "needs law='slip' or 'aging'"),
        ({"slider": FIG2.replace(damping=1e4)}, "needs damping=0"),
        ({"slider": FIG2.replace(friction_form="regularized")}, "needs friction_form='log'"),
        ({"loading": rs.Loading.constant(1e-3).sigma_step(0.1, 3e6)}, "needs a constant sigma"),
        ({"euler": True}, "needs law='aging' for euler=True"),
        ({"slider": FIG2.replace(M=rs.logspace("M", 1e2, 1e3, 2))}, "one slider under one loading"),
        ({"loading": rs.Loading.constant(0.0)}, "Give V_start"),
        ({"dt": 3.15 / math.sqrt(3e5)}, r"dt = .* s is 3\.15/omega"),
        ({"dt": 0.0}, "dt = 0 s must be > 0"),
        ({"dt": 1e-15}, "Give a larger dt"),
    ],
)
def test_wrong_arguments_of_im2017_are_refused(changes, message):
    given = {"slider": FIG2, "loading": rs.Loading.constant(1e-3), "t_end": 1.0, "dt": 1e-4}
    with pytest.raises(rs.ParameterError, match=message):
        rs.paper.im2017(**given | changes)


def test_a_run_has_no_scenario_file():
    run = rs.paper.im2017(FIG2, rs.Loading.constant(1e-3), 1e-3, dt=1e-4)
    with pytest.raises(rs.ParameterError, match=r"title 'ratestate paper.im2017' has no scenario"):
        scenario.from_result(run)
