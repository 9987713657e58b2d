"""K = inf: the state along given speeds, against integrals of high precision."""

import mpmath
import numpy as np
import pytest
import xarray as xr

import ratestate as rs
from ratestate.engine.rigid import states
from ratestate.engine.rigid_steps import Lines, integrated
from ratestate.friction.laws import LAWS as FORMULAS
from ratestate.paper.laws import LAWS

V0 = 1e-6
mp = mpmath.MPContext()
mp.dps = 25


def exact(law, psi, V, rate, dt, Dc):
    """psi after a line of speeds."""
    psi, V, rate, dt, Dc = map(mp.mpf, (psi, V, rate, dt, Dc))
    end = V + rate * dt
    decay = mp.exp(-dt * (V + end) / 2 / Dc)
    if rate == 0:
        if law == "slip":
            return (psi + mp.log(V / V0)) * decay - mp.log(V / V0)
        return mp.log((mp.exp(psi) - V0 / V) * decay + V0 / V)

    def forced(u):  # over u = ln V
        speed = mp.exp(u)
        weight = mp.exp(-(end**2 - speed**2) / (2 * rate * Dc))
        return weight if law == "slip" else weight * V0 * speed / (rate * Dc)

    squares = [end**2 - 2 * rate * Dc * k for k in range(1, 50)]
    knots = {mp.log(V), mp.log(end), *(mp.log(x) / 2 for x in squares if x > 0)}
    knots |= {*mp.linspace(mp.log(V), mp.log(end), 12)}
    first, last = sorted([mp.log(V), mp.log(end)])
    inside = [u for u in knots if first <= u <= last]
    found = mp.quad(forced, sorted(inside, reverse=bool(rate < 0)))
    if law == "slip":
        return (psi + mp.log(V / V0)) * decay + found - mp.log(end / V0)
    return mp.log(mp.exp(psi) * decay + found)


@pytest.mark.parametrize("law", LAWS)
def test_lines_of_all_kinds(law):
    """Over up to nine decades of speed, up and down, and from 0.001 to 300 Dc of slip."""
    rng = np.random.default_rng(3)
    for kind in range(16):
        V, end = 10 ** rng.uniform(-9, 0, 2)
        if kind % 4 == 0:
            end = V * (1 + 0.1 * rng.normal())
        if kind % 4 == 1:
            end = V
        Dc, slip, psi = 10 ** rng.uniform(-6, -3), 10 ** rng.uniform(-3, 2.5), rng.uniform(-20, 20)
        dt = slip * Dc * 2 / (V + end)
        rate = (end - V) / dt
        found, start = np.empty(1), np.zeros(1)
        states(FORMULAS[law], psi, start + dt, start, start + V, start + rate, Dc, V0, found)
        rounding = 1e-15 * (20 + abs(psi)) + 3e-16 * max(V / end, 1.0)  # of V + rate dt
        assert abs(found[0] - exact(law, psi, V, rate, dt, Dc)) < rounding, (V, end, slip, psi)


@pytest.mark.parametrize("law", LAWS)
def test_a_sweep_over_a_history(law):
    """Line after line, at times between them and at their ends; each case has its own scales."""
    loading = rs.Loading.series([0, 0.01, 0.02, 0.02, 0.05], [1e-4, 3e-6, 2e-3, 1e-5, 1e-5])
    Dc = xr.DataArray([1e-6, 2e-5], dims="Dc", coords={"Dc": [1e-6, 2e-5]})
    times = np.array([0.0, 0.004, 0.01, 0.013, 0.0199, 0.03])
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc=Dc, sigma=2e6, K=np.inf, M=3e3, law=law)
    found = rs.simulate(slider, loading, 0.05, times=times, V_start=3e-4)
    ends = np.append(loading.t[1:], 0.05)
    for each in Dc.values:
        psi, now, theta = mp.log(V0 / mp.mpf(3e-4)), 0.0, []
        for t in times:
            for begin, end, V, rate in zip(loading.t, ends, loading.V, loading.rate, strict=True):
                until = min(t, end)
                if begin <= now < until:
                    psi = exact(law, psi, V + rate * (now - begin), rate, until - now, each)
                    now = until
            theta.append(float(mp.exp(psi) * each / V0))
        np.testing.assert_allclose(found.theta.sel(Dc=each), theta, rtol=1e-12)


def test_many_lines_add_no_error():
    """The last periods of many repeat: no drift over 10^5 lines."""
    loading = rs.Loading.sinusoid(1e-4, 5e-5, t_end=40.0, period=0.1)
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=np.inf, M=0.0)
    times = np.linspace(0.05, 39.95, 400)
    theta = rs.simulate(slider, loading, 40.0, times=times).theta.values
    np.testing.assert_allclose(theta[300:], theta[200], rtol=1e-11)
    assert abs(theta[0] / theta[200] - 1.0) > 0.004


@pytest.mark.parametrize("steps", [1, 150])
def test_both_sides_of_a_jump_are_stored(steps):
    """However many jumps; a ramp has none."""
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K=np.inf)
    jumps = 1.0 + np.arange(steps)
    speeds = [1e-5 if i % 2 == 0 else 1e-6 for i in range(steps)]
    loading = rs.Loading.steps(1e-6, *zip(jumps, speeds, strict=True))
    run = rs.simulate(slider, loading, steps + 1.0)
    at = np.searchsorted(run.time, jumps)
    np.testing.assert_array_equal(run.time[at], jumps)
    np.testing.assert_array_equal(run.time[at - 1], np.nextafter(jumps, 0.0))
    np.testing.assert_array_equal(run.V[at], speeds)
    np.testing.assert_array_equal(run.V[at - 1], [1e-6, *speeds[:-1]])
    mu, ratio = run.mu.values, np.append(10.0, 10.0 ** (2 * (np.arange(1, steps) % 2 == 0) - 1.0))
    np.testing.assert_allclose(mu[at] - mu[at - 1], 0.003 * np.log(ratio), rtol=1e-9)
    ramp = rs.simulate(slider, rs.Loading.series([0.0, 1.0, 2.0], [1e-6, 1e-5, 1e-5]), 2.0)
    assert np.nextafter(1.0, 0.0) not in ramp.time


def test_a_law_without_a_closed_form_over_a_history():
    """Two states of the slip law that evolve over one distance are one, which has a closed form."""
    loading = rs.Loading.series([0, 0.01, 0.02, 0.02, 0.05], [1e-4, 3e-6, 2e-3, 1e-5, 1e-5])
    common = {"a": 0.003, "Dc": 1e-6, "sigma": 2e6, "K": np.inf, "M": 3e3}
    one = rs.SpringSlider(**common, b=0.006)
    two = rs.SpringSlider(**common, b=0.004, b2=0.002, Dc2=1e-6, law="two-state-slip")
    closed, found = (rs.simulate(slider, loading, 0.05, V_start=3e-4) for slider in (one, two))
    for name in ("theta", "theta2"):
        np.testing.assert_allclose(np.log(found[name] / closed.theta), 0.0, atol=2e-11)
    np.testing.assert_allclose(found.mu_min, closed.mu_min, rtol=1e-11)
    law, lines = two.friction_law, Lines(*(np.array([x]) for x in (0.0, 1e-4, 0.0)))
    p, times, psi = (1.0,) * law.n_coefficients, np.array([0.0, 1.0]), np.empty(4)
    lost = integrated(law, (np.nan, np.nan), times, lines, (0, 1), p, 1e-6, V0, psi)
    assert lost == 0  # of the times could be reached


def test_a_record_of_normal_stress():
    """Against the integral of the linear equation that the state of the slip law obeys."""
    rng, n, Dc, alpha, b = np.random.default_rng(4), 400, 1e-5, 0.3, 0.006
    t = np.cumsum(10 ** rng.uniform(-3, -1, n)) - 1e-3
    t[0] = 0.0
    V, sigma = 10 ** rng.uniform(-5, -4, n), 2e6 * np.append(1.0, rng.uniform(0.5, 2.0, n - 1))
    loading = rs.Loading.series(t, V, sigma=sigma)
    slider = rs.SpringSlider(a=0.003, b=b, Dc=Dc, sigma=2e6, K=np.inf, alpha=alpha)
    run = rs.simulate(slider, loading, t[-1], V_start=3e-4)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    z = [np.log(V[0] / 3e-4)]  # ln(V theta/Dc)
    for i in range(n - 1):
        since = 0.5 * (t[i + 1] - t[i]) * (1.0 + nodes)
        rate, growth = (np.diff(x[i : i + 2])[0] / (t[i + 1] - t[i]) for x in (V, sigma))
        speed = V[i] + rate * since
        slip = 0.5 * (speed + V[i + 1]) * (t[i + 1] - t[i] - since) / Dc  # still to come
        forced = rate / speed - alpha / b * growth / (sigma[i] + growth * since)
        whole = 0.5 * (V[i] + V[i + 1]) * (t[i + 1] - t[i]) / Dc
        added = 0.5 * (t[i + 1] - t[i]) * np.sum(weights * forced * np.exp(-slip))
        z.append(z[-1] * np.exp(-whole) + added)
    np.testing.assert_array_equal(run.time, t)
    np.testing.assert_allclose(np.log(run.V * run.theta / Dc), z, atol=3e-11)
    np.testing.assert_allclose(run.sigma, sigma, rtol=1e-12)
