"""Sliders without mass or damping at speeds at which friction hardly depends on V: beyond V1."""

import math

import numpy as np
import pytest
from helpers.textbook import Textbook
from scipy.integrate import solve_ivp

import ratestate as rs
from ratestate.dynamics.simulation import engine_cases
from ratestate.friction.forms import RESOLVED

A, B, DC, SIGMA, V = 0.01, 0.015, 1e-5, 1e7, 1e-3
COMMON = {"a": A, "b": B, "Dc": DC, "sigma": SIGMA, "mu0": 0.6, "V0": 1e-6, "M": 0.0}
#: [s] in which the load point moves by Dc
UNIT = DC / V


@pytest.fixture(autouse=True)
def few_steps(monkeypatch):
    """A run that makes no headway ends soon."""
    monkeypatch.setattr(engine_cases, "MAX_STEPS", 2e4)


def run(K, V1, V2, V_start, *, end=10.0, rtol=1e-6):
    slider = rs.SpringSlider(**COMMON, K=K, friction_form="cut-off", V1=V1, V2=V2)
    times = [end * UNIT]
    return rs.simulate(
        slider, rs.Loading.constant(V), times[0], V_start=V_start, times=times, rtol=rtol
    )


def instability(twin, V_start, V_lp):
    """When 1/V comes to 0 [s]: over slip it is smooth, with a time that goes by as dt = dD/V."""
    p, (_, log_V, *log_theta) = twin.p, twin.steady(V_start)

    def per_slip(_, y):
        u, theta = y[0], np.exp(y[2:])
        s, d_lns = p["s"](y[1])
        rates = twin.evolution(1.0 / u, theta, 0.0)
        rates = [rate / th * u for rate, th in zip(rates, theta, strict=True)]
        rates[0] -= p["alpha"] / p["b"] * d_lns * u
        effects = twin.effects(1.0 / u, theta)[1]
        drive = p["K"] * (V_lp * u - 1.0) / p["sigma"] / s - d_lns * twin.mu(1.0 / u, theta) * u
        drive -= sum(b * rate for b, rate in zip(effects, rates, strict=True))
        return [-drive * (1.0 + p["V1"] * u) / (p["a"] * p["V1"]), u, *rates]

    def stopped(_, y):
        return y[0] - 1e-12

    stopped.terminal = True
    start = [math.exp(-log_V), 0.0, *log_theta]
    found = solve_ivp(per_slip, (0.0, 1.0), start, "LSODA", rtol=1e-11, atol=1e-13, events=stopped)
    assert found.status == 1
    return found.y[1, -1]


@pytest.mark.parametrize(("V1", "amplitude"), [(1e-4, 0.02), (1e-8, 0.0)])
def test_the_instability_is_where_1_over_V_is_0(V1, amplitude):
    p = COMMON | {"b2": 0.003, "Dc2": 3e-5, "K": 3e9, "alpha": 0.2, "V1": V1, "V2": 1e-2}
    omega = math.pi

    def wave(t):
        s = 1.0 + amplitude * math.sin(omega * t)
        return s, amplitude * omega * math.cos(omega * t) / s

    slider = rs.SpringSlider(**p, law="two-state-aging", friction_form="cut-off")
    loading = rs.Loading.constant(1e-5).sigma_sinusoid(amplitude * SIGMA, period=2.0)
    exact = instability(Textbook("two-state-aging", {**p, "s": wave}), 1e-6, 1e-5)
    for rtol in (1e-6, 1e-10):
        with pytest.raises(rs.QuasiStaticInstability) as told:
            rs.simulate(slider, loading, 100.0, V_start=1e-6, rtol=rtol)
        best = told.value.best
        assert float(best.time[-1]) == pytest.approx(exact, rel=rtol)
        assert 20.0 < math.log(float(best.V_max) / V1) < 21.0


def test_on_either_side_of_the_critical_stiffness():
    """Of what friction loses with slip and gains with V, far above V1 and near V2."""
    V1, V2 = 1e-6, 3e-3
    critical = SIGMA / DC * (B * V2 / (V2 + V) - A * V1 / (V1 + V))
    stiff = run(1.05 * critical, V1, V2, 1.01 * V)
    assert float(stiff.V[-1]) == pytest.approx(V, rel=1e-6)
    assert float(stiff.V_max) < 1.05 * V
    for V_start in (1.01 * V, 0.99 * V):
        with pytest.raises(rs.QuasiStaticInstability):
            run(0.95 * critical, V1, V2, V_start)


@pytest.mark.parametrize("rtol", [1e-6, 1e-12])
@pytest.mark.parametrize("ratio", [1e3, 1e6, 1e8])
def test_far_above_both_cut_offs_it_follows_its_load_point(ratio, rtol):
    """Friction is then a number, and the spring's force with it."""
    result = run(2.0 * B * SIGMA / DC, V / ratio, 1e-3 * V, 0.5 * V, end=40.0, rtol=rtol)
    assert float(result.V[-1]) == pytest.approx(V, rel=0.1 * rtol + 1e-13 * ratio)
    exact = 0.6 - A * math.log1p(1.0 / ratio) + B * math.log1p(1e-3)
    assert float(result.tau[-1]) / SIGMA == pytest.approx(exact, abs=1e-8 * A)
    assert abs(float(result.energy_residual)) < 1e-12


def test_a_speed_that_friction_does_not_resolve_is_refused():
    stiff, slow = 2.0 * B * SIGMA / DC, 1e-3 * V
    for off in (-0.1, 0.1):
        V1 = V * math.exp(-RESOLVED - off)
        if off < 0.0:
            assert float(run(stiff, V1, slow, 0.99 * V).V[-1]) == pytest.approx(V, rel=1e-4)
            continue
        with pytest.raises(rs.SolverError, match=r"not_finite.*far above V1\): check") as told:
            run(stiff, V1, slow, 0.99 * V)
        assert not isinstance(told.value, rs.QuasiStaticInstability)


def test_a_leap_from_slow_sliding_ends_where_spring_and_friction_fall_alike():
    """The first steps overshoot V1 by far: they are rejected, not taken for a runaway.

    From V/200, at one age of contacts, K (1 - V_lp/V) is part of (b sigma/Dc) ln(V theta/Dc).
    """
    result = run(2.0 * B * SIGMA / DC, V / 7e6, 1e-3 * V, 5e-3 * V)
    w, part = float(result.V_max) / V, 0.2 / 1.2
    assert 2.0 * (1.0 - 1.0 / w) == pytest.approx(part * math.log(200.0 * w), rel=0.01)
    assert 1.9 < w < 2.1
