"""limit_cycle: its contract, its statuses, and what physics says must not matter."""

import json
import math

import numpy as np
import pytest
import xarray as xr

import ratestate as rs
from ratestate import SpringSlider, limit_cycle, logspace, simulate

FIG2 = SpringSlider(a=0.003, b=0.006, Dc=1e-5, mu0=0.6, V0=1e-9, sigma=2e6, M=3e3, K=9e8)
STICK = SpringSlider(a=0.005, b=0.008, Dc=1e-5, mu0=0.6, V0=1e-9, sigma=4e6, M=1e2, K=0.96e9)
LAWS = pytest.mark.parametrize("law", ["slip", "aging"])
MEASURES = ["period", "frequency", "amplitude", "V_max", "V_min", "inertia"]
FIRMNESS = ["slow_fraction", "fundamental", "stable", "residual", "error"]


def test_contract():
    found = limit_cycle(STICK, "10 um/s")
    assert list(found.data_vars) == [*MEASURES, *FIRMNESS, "multipliers", "status"]
    assert found.multipliers.dims == ("multiplier",)
    for name in [*MEASURES, *FIRMNESS]:
        assert found[name].dims == ()
        assert found[name].attrs["units"]
        assert found[name].attrs["long_name"]
    assert found.status.dtype == np.int8
    assert found.status == 0
    flags = found.status.attrs["flag_meanings"].split()
    assert len(flags) == len(found.status.attrs["flag_values"])
    assert found.V_lp == 1e-5
    assert SpringSlider(**json.loads(found.attrs["slider"])) == STICK
    assert float(found.V_min) < 1e-5 < float(found.V_max)
    assert 0 < float(found.inertia) < 1


def test_broadcasting(tmp_path):
    sweep = FIG2.replace(M=logspace("M", 1e2, 1e4, 3))
    V_lp = logspace("V_lp", 1e-3, 1e-1, 4)
    found = limit_cycle(sweep, V_lp, rtol=1e-6)
    for name in [*MEASURES, "status"]:
        assert found[name].dims == ("M", "V_lp")
    stable = rs.stability(sweep, V_lp).stable
    np.testing.assert_array_equal(found.status == 1, stable)
    np.testing.assert_array_equal(found.status == 0, ~stable)
    assert {0, 1} == set(found.status.values.ravel().tolist())
    one = limit_cycle(FIG2.replace(M=1e3), 0.1, rtol=1e-6)
    for name in MEASURES:
        value = float(found[name].sel(M=1e3, V_lp=0.1))
        assert value == pytest.approx(float(one[name]), rel=1e-5), name
    found.to_netcdf(tmp_path / "cycles.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "cycles.nc", engine="h5netcdf") as back:
        xr.testing.assert_equal(found, back.load())


@pytest.mark.parametrize(
    "slider",
    [
        FIG2,  # V_lp below V_c
        FIG2.replace(b=0.003),
        FIG2.replace(b=0.002),
        FIG2.replace(b=-0.001),
        FIG2.replace(K=np.inf),
        FIG2.replace(M=0.0, K=5e9),
        FIG2.replace(K=1e10, law="aging"),
    ],
    ids=["V < V_c", "b = a", "b < a", "b < 0", "K = inf", "M = 0", "stiff"],
)
def test_steady_sliding(slider):
    found = limit_cycle(slider, 1e-3)
    assert found.status == 1
    assert found.amplitude == 0
    assert found.inertia == 0
    assert found.V_max == found.V_min == 1e-3
    assert np.isnan(found.period)
    assert np.isnan(found.frequency)


@LAWS
def test_quasi_static_instability(law):
    slider = STICK.replace(M=0.0, K=5e8, law=law)
    with pytest.raises(rs.SolverError, match="M > 0 removes"):
        limit_cycle(slider, 1e-5)
    K = xr.DataArray([5e8, 5e9], dims="K")
    batch = limit_cycle(slider.replace(K=K), 1e-5)
    assert batch.status[1] == 1
    assert batch.status[0] > 1
    for name in MEASURES:
        assert np.isnan(batch[name][0]), name


@LAWS
def test_reference_velocity_is_a_matter_of_taste(law):
    """V0 with mu0 shifted to match is the same friction."""
    V0, mu0 = 1e-6, 0.6 + (0.005 - 0.008) * math.log(1e-6 / 1e-9)
    for V_lp in (1e-6, 1e-2, 1.0):
        one = limit_cycle(STICK.replace(law=law), V_lp, rtol=1e-8)
        two = limit_cycle(STICK.replace(law=law, V0=V0, mu0=mu0), V_lp, rtol=1e-8)
        three = limit_cycle(STICK.replace(law=law, mu0=0.1), V_lp, rtol=1e-8)
        for name in MEASURES:
            for other in (two, three):
                assert float(other[name]) == pytest.approx(float(one[name]), rel=3e-8), name


@LAWS
def test_three_numbers_decide(law):
    """Equal K/K_c_qs, eta and b/a: the same cycle in units of a, Dc/V_lp and V_lp."""
    rng = np.random.default_rng(2)
    slider, V_lp = STICK.replace(law=law), 1e-3
    eta = float(slider.eta(V_lp))
    one = limit_cycle(slider, V_lp)
    for _ in range(6):
        a, Dc, sigma, V = 10.0 ** rng.uniform([-3, -7, 4, -10], [-1.5, -2, 9, 1])
        other = SpringSlider(
            a=a,
            b=1.6 * a,
            Dc=Dc,
            sigma=sigma,
            M=eta * a * sigma * Dc / V**2,
            K=0.96e9 / 1.2e9 * 0.6 * a * sigma / Dc,
            V0=V_lp * rng.uniform(0.01, 100),
            law=law,
        )
        assert float(other.K / other.K_c_qs) == pytest.approx(0.8, rel=1e-12)
        two = limit_cycle(other, V)
        ratio = {"amplitude": a / 0.005, "period": Dc / 1e-5 * V_lp / V, "inertia": 1}
        ratio |= {"V_max": V / V_lp, "V_min": V / V_lp, "frequency": 1 / ratio["period"]}
        for name in MEASURES:
            assert float(two[name] / one[name]) == pytest.approx(ratio[name], rel=1e-7), name


@LAWS
@pytest.mark.parametrize("V_lp", [1e-7, 1e-3, 3e-2, 1.0])
def test_measures_are_those_of_the_motion(law, V_lp):
    """Against a finely saved run over the settled cycle (V_min in particular)."""
    slider = STICK.replace(law=law)
    cycle = limit_cycle(slider, V_lp, rtol=1e-9)
    period = float(cycle.period)
    n = 400 if V_lp > 1e-2 else 40
    loading = rs.Loading.constant(V_lp)
    long = simulate(slider, loading, n * period, V_start=V_lp / 10, rtol=1e-9)
    late = long.isel(time=long.time > (n - 1.5) * period)
    between = np.linspace(0, 1, 9)[:-1]
    t = late.time.values
    times = (t[:-1, None] + np.diff(t)[:, None] * between).ravel()
    saved = simulate(slider, loading, n * period, V_start=V_lp / 10, rtol=1e-9, times=times)
    stress = saved.tau / 4e6
    assert float(cycle.amplitude) == pytest.approx(float(stress.max() - stress.min()), rel=1e-4)
    assert float(cycle.V_max) == pytest.approx(float(saved.V.max()), rel=5e-3)
    assert float(cycle.V_min) == pytest.approx(float(saved.V.min()), rel=5e-3)
    force = float(np.abs(stress - saved.mu).max() / cycle.amplitude)
    assert float(cycle.inertia) == pytest.approx(force, rel=5e-3)
    assert float(cycle.V_max) >= float(saved.V.max()) * (1 - 1e-6)
    assert float(cycle.V_min) <= float(saved.V.min()) * (1 + 1e-6)


@pytest.mark.parametrize("rtol", [1e-3, 1e-5])
@LAWS
def test_accuracy_asked_for(law, rtol):
    """Loose cycles, extremes of V included, are close to tight ones: soft springs, large drops."""
    kappa = xr.DataArray([0.02, 0.1, 0.5, 0.9], dims="kappa")
    beta = xr.DataArray([1.3, 2.0, 4.5], dims="beta")
    eta = xr.DataArray([1e-20, 1e-10, 1e-4, 0.1, 10.0], dims="eta")
    a, sigma, Dc, V_lp = 0.005, 4e6, 1e-5, 1e-3
    slider = SpringSlider(
        a=a,
        b=a * beta,
        Dc=Dc,
        sigma=sigma,
        K=kappa * (beta - 1) * a * sigma / Dc,
        M=eta * a * sigma * Dc / V_lp**2,
        law=law,
    )
    loose, tight = limit_cycle(slider, V_lp, rtol=rtol), limit_cycle(slider, V_lp, rtol=1e-9)
    assert (tight.status == 0).all()
    np.testing.assert_array_equal(loose.status, tight.status)
    for name, factor in [("amplitude", 3), ("period", 3), ("V_max", 10), ("inertia", 10)]:
        error = float(np.abs(loose[name] / tight[name] - 1).max())
        assert error < factor * rtol, (name, error)
    assert (np.abs(np.log(loose.V_min / tight.V_min)) < 200 * rtol).all()
    assert (tight.V_min < V_lp).all()
    assert (tight.V_max > V_lp).all()


@LAWS
def test_small_cycles_beyond_the_boundary(law):
    """Just below K_c the slip law's amplitude grows as a square root, at the Hopf frequency."""
    slider, V_lp = STICK.replace(law=law), 3e-2
    K_c = float(slider.K_c(V_lp))
    for epsilon in (1e-3, 4e-3):
        found = limit_cycle(slider.replace(K=(1 - epsilon) * K_c), V_lp, rtol=1e-7)
        assert found.status == 0
        omega_c = V_lp / 1e-5 * math.sqrt(0.6)
        # quasi-static omega_c is exact at the boundary; the cycle is a little slower
        assert float(found.frequency) < omega_c / (2 * math.pi) * (1 + 1e-3)
        assert float(found.frequency) > 0.9 * omega_c / (2 * math.pi)
    above = limit_cycle(slider.replace(K=1.01 * K_c), V_lp)
    assert above.status == 1


# Where b >> a and K is near K_c_qs the slip law's cycles do not repeat: multipliers below -1
CHAOS = SpringSlider(a=0.01, b=0.12, Dc=1e-5, sigma=1e6, K=1.06 * 1.1e10, M=1.425e5)


def test_not_converged_carries_its_best():
    """Cycles that do not settle are refused, not guessed."""
    with pytest.raises(rs.NotConverged, match="no_convergence.*period doubling") as caught:
        limit_cycle(CHAOS, 1e-3)
    assert caught.value.best.status > 1
    assert np.isfinite(caught.value.best.period)
    assert np.isfinite(caught.value.best.amplitude)
    K = xr.DataArray([CHAOS.K, np.inf], dims="K")
    batch = limit_cycle(CHAOS.replace(K=K), 1e-3)
    assert batch.status[0] > 1
    assert batch.status[1] == 1
    assert np.isnan(batch.amplitude[0])
