"""Friction that is finite at rest: slip that reverses, and sliders that never do."""

import math

import numpy as np
import pytest
import xarray as xr
from textbook import Reversing, drawn, wave

import ratestate as rs
from ratestate.dynamics.basin import escape
from ratestate.dynamics.cycles.shooting import return_map
from ratestate.dynamics.cycles.system import System, state
from ratestate.dynamics.verdict import verdict
from ratestate.friction.composition import composed_law

RTOL = 1e-6
#: overshoots, sticks and slides back in each cycle
SWINGING = rs.SpringSlider(
    a=0.01,
    b=0.015,
    Dc=1e-5,
    sigma=1e6,
    M=1e3,
    K=1e8,
    mu0=0.05,
    law="aging",
    friction_form="regularized",
)


def swinging(law, rng, mass, damping):
    """Random parameters of weak friction on a soft spring, and the load point's speed."""
    p, V = drawn(law, rng)
    p |= {"mu0": p["a"] * rng.uniform(4, 12), "V0": V * 10 ** rng.uniform(-2, 0)}
    if law == "flash-heating":
        p["mu_w"] = p["mu0"] * rng.uniform(0.2, 0.8)
        p["V_w"] = p["V0"] * math.exp(0.5 * p["mu0"] / (p["b"] - p["a"]))
    p["M"] = mass * 10 ** rng.uniform(0, 2.5) * p["a"] * p["sigma"] * p["Dc"] / V**2
    p["damping"] = damping * p["a"] * p["sigma"] / V
    stiffness = rng.uniform(0.05, 1.0) if mass or damping else 3.0
    return p | {"K": stiffness * p["b"] * p["sigma"] / p["Dc"]}, V


@pytest.mark.parametrize(
    ("law", "mass", "damping"),
    # (each has kernels of its own; benchmarks/combinations.py has them all)
    [
        ("aging", 1, 0.0),
        ("two-state-slip", 1, 0.0),
        ("flash-heating", 1, 0.0),
        ("slip", 1, 0.3),
        ("slip", 0, 0.3),
        ("two-state-slip", 0, 0.0),
    ],
)
def test_a_slider_that_was_pulled_back_agrees_with_the_textbook(law, mass, damping):
    """By SciPy, with V itself as a variable: it slides back, sticks, and is pulled on.

    Where it is damped, under a normal stress that oscillates.
    """
    p, V = swinging(law, np.random.default_rng(7), mass, damping)
    y = Reversing(law, p).steady(V)
    y[0] *= -3.0 if mass else -1.5
    start = {"tau": y[0] * p["sigma"]}
    if mass:
        y[1] = start["V"] = 0.0
    period = 2 * math.pi * math.sqrt(p["M"] / p["K"]) if mass else p["Dc"] / V
    times, loading = np.linspace(0.0, 4.0 * period, 9), rs.Loading.constant(V)
    if damping:
        p["alpha"] = 0.1
        loading = loading.sigma_sinusoid(0.1 * p["sigma"], period=period)
    case = rs.SpringSlider(**p, law=law, friction_form="regularized")
    twin = Reversing(law, p | ({"s": wave(0.1, period)} if damping else {}))
    exact = twin.through(y, V, times, [])
    settings = {"times": times, "V_start": V, "initial": start}
    run = rs.simulate(case, loading, times[-1], rtol=RTOL, **settings)
    assert twin.differs(run, exact) < 100 * RTOL
    assert abs(float(run.energy_residual)) < 10 * RTOL
    assert float(run.V_min) < -0.05 * V
    assert int(run.outside_domain) == 0
    finer = rs.simulate(case, loading, times[-1], rtol=1e-9, **settings)
    assert twin.differs(finer, exact) < 1e-6


def test_energy_is_closed_through_a_thousand_reversals():
    cycle = rs.limit_cycle(SWINGING, 0.1)
    period = float(cycle.period)
    end = 520 * period
    run = rs.simulate(SWINGING, rs.Loading.constant(0.1), end, V_start=0.05, rtol=1e-6)
    later = run.isel(time=run.time > 0.5 * end)
    reversals = np.count_nonzero(np.diff(np.sign(run.V.values)))
    assert 1000 <= reversals <= 1060
    assert abs(float(run.energy_residual)) < 1e-5
    # back and forth in each cycle, and as far as the limit cycle says
    assert float(cycle.V_min) < -0.01 < 0 < 0.2 < float(cycle.V_max)
    assert float(later.V.min()) == pytest.approx(float(cycle.V_min), rel=1e-3)
    assert float(run.amplitude) == pytest.approx(float(cycle.amplitude), rel=1e-6)
    assert float(run.frequency) == pytest.approx(1 / period, rel=1e-6)
    assert float(run.V_min) <= float(run.V.min())
    assert float(run.mu_min) <= float(run.mu.min()) < float(run.mu_min) + 1e-4
    assert int(run.outside_domain) == int(cycle.outside_domain) == 0


def test_no_verdict_calls_a_law_that_lets_slip_reverse_outside_its_domain():
    forward = rs.SpringSlider(**(SWINGING.parameters | {"friction_form": "log"}))
    found = verdict(SWINGING, 0.1)
    assert found.V_min < 0.0
    assert found.reversal_margin < 0.0
    assert "outside the domain" not in found.text
    assert "outside the domain of the friction law" in verdict(forward, 0.1).text


def test_multipliers_of_a_cycle_that_reverses_are_how_disturbances_fade():
    """By runs from beside the cycle, whose stress maxima are followed from one to the next."""
    cycle = rs.limit_cycle(SWINGING, 0.1, rtol=1e-9)
    period, multiplier = float(cycle.period), complex(cycle.multipliers[0]).real
    assert -0.5 < multiplier < -0.1
    times = np.linspace(7 * period, 12 * period, 100_001)
    run = rs.simulate(
        SWINGING, rs.Loading.constant(0.1), times[-1], V_start=0.05, rtol=1e-10, times=times
    )
    tau = run.tau.values / 1e6
    peak = 1 + np.flatnonzero((tau[:-2] < tau[1:-1]) & (tau[1:-1] >= tau[2:]) & (tau[1:-1] > 0))
    bend = tau[peak - 1] - 2 * tau[peak] + tau[peak + 1]
    high = tau[peak] - (tau[peak + 1] - tau[peak - 1]) ** 2 / (8 * bend)
    changes = np.diff(high)
    assert changes[1:] / changes[:-1] == pytest.approx(multiplier, rel=0.02)


def test_a_slider_that_rests_may_be_pulled_either_way():
    """From V = 0, with stress below and above what friction holds; and with none at all."""
    start = {"V": 0.0, "theta": 1e-3}
    for tau in (-2e5, 0.0, 2e5):
        run = rs.simulate(
            SWINGING.replace(mu0=0.1, b=0.0101),
            rs.Loading.constant(0.0),
            0.05,
            V_start=1e-3,
            initial=start | {"tau": tau},
            times=[0.0, 0.001, 0.05],
        )
        assert float(run.V[0]) == 0.0
        assert float(run.V[1]) * tau > 0.0 or abs(float(run.V[1])) < 1e-12
        assert abs(float(run.V[-1])) < 1e-6 * max(abs(float(run.V[1])), 1e-3)
        if tau != 0.0:
            assert abs(float(run.energy_residual)) < 1e-5
    mirrored = [
        rs.simulate(
            SWINGING,
            rs.Loading.constant(0.0),
            0.01,
            V_start=1e-3,
            initial=start | {"tau": tau},
            times=[0.004, 0.01],
        )
        for tau in (-3e5, 3e5)
    ]
    for name in ("tau", "V", "mu"):
        np.testing.assert_allclose(mirrored[0][name], -mirrored[1][name], rtol=1e-5)


@pytest.mark.parametrize("M", [2.94e8, 1.1e9])
def test_friction_near_0_keeps_its_digits(M):
    """mu falls to 1e-10 at V_lp and beyond; then the slider slides back.  By SciPy."""
    p = {"a": 0.0192, "b": 0.104, "Dc": 1e-5, "sigma": 1e6, "mu0": 0.7, "V0": 1e-9, "K": 1.437e9}
    p["M"] = M
    twin = Reversing("slip", p)
    slider = rs.SpringSlider(law="slip", friction_form="regularized", **p)
    times, loading = np.array([0.0, 1.6, 2.1, 3.0, 5.0, 8.0]), rs.Loading.constant(1e-5)
    exact = twin.through(twin.steady(1e-6), 1e-5, times, [])
    errors = []
    for rtol in (1e-6, 1e-8, 1e-10):
        run = rs.simulate(slider, loading, 8.0, V_start=1e-6, times=times, rtol=rtol)
        assert int(run.steps) < 10_000
        assert float(run.V_min) < -5e-5
        errors.append(twin.differs(run, exact))
    assert 1e-7 < errors[0] < 1e-4
    assert errors[1] < 0.1 * errors[0]
    assert errors[2] < min(0.1 * errors[1], 3e-8)
    if M == 2.94e8:  # at the default rtol, by an 80-bit integrator
        run = rs.simulate(slider, loading, 2.1, V_start=1e-6, times=[2.1])
        assert abs(math.log(float(run.V[0]) / 1.7463793517e-4)) < 1e-5
        assert 0.0 < float(run.mu[0]) < 2e-9


@pytest.mark.parametrize("barrier", [3.0, 10.64, 40.0])
def test_a_return_from_the_section_takes_a_whole_period(barrier):
    """Though rounding may put a start on the section on either side of it."""
    n, rng = 300, np.random.default_rng(0)
    values = {"a": 1.0, "b": 1.769, "Dc": 1.0, "sigma": 1.0, "mu0": barrier, "V0": np.ones(n)}
    p = np.stack(composed_law("aging+regularized").coefficient_arrays(1.0, values), axis=-1)
    infinite = np.full(n, np.inf)
    system = System("aging+regularized", np.full(n, 0.885), p, np.full(n, 0.0309), infinite)
    u = rng.uniform(0.1, 1.0, (n, 2))
    returns = return_map(system, state(system, u), np.full(n, 1e-6))
    assert returns.has_returned.all()
    period = returns.numbers["period"]
    assert 6.0 < period.min() < period.max() < 12.0


def test_nothing_leaves_steady_sliding_that_attracts_all_there_is():
    """At 1.116 K_c: steps of a decade come back in plain runs, and so does all else."""
    values = {"a": 0.0471, "b": 0.0834, "Dc": 1.84e-8, "sigma": 1.53e6, "M": 2e11, "mu0": 0.472}
    slider = rs.SpringSlider(
        law="aging", friction_form="regularized", V0=3.19e-8, K=3.47e12, **values
    )
    V = 1.43e-8
    found = escape(slider, V)
    assert str(found.outcome.values) == "none"
    assert np.isinf([found.step_up, found.kick_up, found.kick_down]).all()
    assert float(found.step_down) == 0.0
    V_start = xr.DataArray(V / np.array([7.5, 15.0, 100.0]), dims="step")
    run = rs.simulate(slider, rs.Loading.constant(V), 1500.0, V_start=V_start, times=[1500.0])
    np.testing.assert_allclose(run.V, V, rtol=1e-4)
