"""K = inf: the state along given speeds, against SciPy."""

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import solve_ivp

import ratestate as rs

V0 = 1e-6


def test_errors_do_not_accumulate_over_many_segments_of_a_sinusoid():
    """The last periods of many repeat: no drift over 10^5 lines."""
    loading = rs.Loading.sinusoid(1e-4, 5e-5, t_end=40.0, period=0.1)
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=np.inf, M=0.0)
    times = np.linspace(0.05, 39.95, 400)
    theta = rs.simulate(slider, loading, 40.0, times=times).theta.values
    np.testing.assert_allclose(theta[300:], theta[200], rtol=1e-11)
    assert abs(theta[0] / theta[200] - 1.0) > 0.004


@pytest.mark.parametrize("steps", [1, 150])
def test_speeds_before_and_after_a_jump_are_stored(steps):
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


@pytest.mark.parametrize("M", [0.0, 3e3])
def test_stress_has_both_sides_of_a_kink_if_there_is_mass(M):
    """The load point's force M dV/dt begins at once; V does not jump."""
    rate, damping = 2e-3, 1e6
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=np.inf, M=M, damping=damping)
    loading = rs.Loading.series([0.0, 0.1, 0.2], [1e-4, 1e-4, 1e-4 + 0.1 * rate])
    run = rs.simulate(slider, loading, 0.2)
    assert (np.nextafter(0.1, 0.0) in run.time) == (M > 0.0)
    inertia = np.where(run.time < 0.1, 0.0, M * rate)
    np.testing.assert_allclose(run.tau, 2e6 * run.mu + damping * run.V + inertia, rtol=1e-14)
    assert float(run.inertial_force) == pytest.approx(M * rate / 2e6, rel=1e-12, abs=1e-15)
    saved = rs.simulate(slider, loading, 0.2, times=[0.1, 0.15])
    opposing = 2e6 * saved.mu + damping * saved.V
    np.testing.assert_allclose(saved.tau, opposing + M * rate, rtol=1e-14)
    assert float(saved.reversal_margin) == pytest.approx(
        float((run.tau / 2e6 + run.mu).min()), rel=1e-9
    )


@pytest.mark.parametrize("form", ["log", "regularized"])
def test_rigid_sliders_have_the_same_bits_alone_and_among_others(form):
    """Beside sliders on springs, and alone."""
    K = xr.DataArray([1e9, np.inf, 2e9, np.inf, np.inf], dims="K")
    Dc = xr.DataArray(np.geomspace(1e-6, 1e-4, 9), dims="Dc")
    p = {"a": 0.006, "b": 0.004, "sigma": 2e6, "friction_form": form}
    loading, times = rs.Loading.steps(1e-4, (0.1, 3e-3)), [0.05, 0.1, 0.13, 0.4]
    run = rs.simulate(rs.SpringSlider(**p, Dc=Dc, K=K), loading, 0.4, times=times)
    assert (run.status == 0).all()
    for i in (0, 4, 8):
        alone = rs.SpringSlider(**p, Dc=float(Dc[i]), K=np.inf)
        one = rs.simulate(alone, loading, 0.4, times=times)
        for k in (1, 3, 4):
            for name in ("V", "theta", "tau", "mu_min", "V_max", "steps"):
                same = run[name].isel(Dc=i, K=k)
                np.testing.assert_array_equal(same, one[name], err_msg=name)


#: d ln theta/dt at constant normal stress, from V and theta
RATES = {
    "aging": lambda V, theta, Dc: 1.0 / theta - V / Dc,
    "slip": lambda V, theta, Dc: -V / Dc * np.log(V * theta / Dc),
    "prz": lambda V, theta, Dc: 0.5 * (1.0 - (V * theta / Dc) ** 2) / theta,
}


@pytest.mark.parametrize("law", RATES)
@pytest.mark.parametrize("form", ["log", "regularized"])
def test_ramps_under_oscillating_stress_by_scipy(law, form):
    """Speeds from 1e-12 to 1e-3 m/s and back, with alpha; V, theta and friction at saved times."""
    a, b, Dc, sigma, alpha = 0.008, 0.012, 1e-6, 2e6, 0.4
    t_up, t_end, low, high, amplitude, period = 0.2, 0.3, 1e-12, 1e-3, 3e5, 0.07
    p = {"a": a, "b": b, "Dc": Dc, "sigma": sigma, "alpha": alpha, "mu0": 0.6, "V0": V0}
    slider = rs.SpringSlider(**p, K=np.inf, law=law, friction_form=form)
    loading = rs.Loading.series([0.0, t_up, t_up, t_end], [low, high, high, 3e-6])
    loading = loading.sigma_sinusoid(amplitude, period=period)
    times = np.linspace(0.01, t_end, 59)
    run = rs.simulate(slider, loading, t_end, times=times, V_start=1e-6)
    assert 3000 < int(run.steps) < 5500
    omega, rate = 2.0 * np.pi / period, (high - low) / t_up
    fall = (3e-6 - high) / (t_end - t_up)

    def slope(t, y, V):
        wave = amplitude * np.sin(omega * t)
        growth = amplitude * omega * np.cos(omega * t) / (sigma + wave)
        return RATES[law](V(t), np.exp(y), Dc) - alpha / b * growth

    parts, first, y = [], 0.0, np.log(Dc / 1e-6)
    for last, V in ((t_up, lambda t: low + rate * t), (t_end, lambda t: high + fall * (t - t_up))):
        at = times[(times > first) & (times < last - 1e-9)]
        ends = {"t_eval": [*at, last], "rtol": 3e-14, "atol": 1e-14, "method": "DOP853"}
        found = solve_ivp(slope, (first, last), [y], args=(V,), **ends).y[0]
        parts, first, y = [*parts, found[:-1]], last, found[-1]
    log_theta = np.concatenate([*parts, [y]])
    kept = np.abs(times - t_up) > 1e-9
    np.testing.assert_allclose(np.log(run.theta)[kept], log_theta, rtol=0, atol=1e-11)
    V = np.where(times < t_up, low + rate * times, high + fall * (times - t_up))[kept]
    state = 0.6 + b * (log_theta + np.log(V0 / Dc))
    if form == "regularized":
        mu = a * np.arcsinh(0.5 * V / V0 * np.exp(state / a))
    else:
        mu = state + a * np.log(V / V0)
    np.testing.assert_allclose(run.V[kept], V, rtol=1e-12)
    np.testing.assert_allclose(run.mu[kept], mu, rtol=0, atol=1e-13)
    np.testing.assert_allclose(run.tau, run.sigma * run.mu, rtol=1e-13)
