"""limit_cycle: its contract, its statuses, and what physics says must not matter."""

import contextlib
import warnings

import numpy as np
import pytest
import xarray as xr

import ratestate as rs
from ratestate import SpringSlider, limit_cycle, simulate
from ratestate.dynamics.cycles import attractor
from ratestate.engine.model import RUNAWAY

FIG2 = SpringSlider(a=0.003, b=0.006, Dc=1e-5, mu0=0.6, V0=1e-9, sigma=2e6, M=3e3, K=9e8)
STICK = SpringSlider(a=0.005, b=0.008, Dc=1e-5, mu0=0.6, V0=1e-9, sigma=4e6, M=1e2, K=0.96e9)
LAWS = pytest.mark.parametrize("law", ["slip", "aging"])
MEASURES = ["period", "frequency", "amplitude", "stress_drop", "V_max", "V_min", "inertia"]


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
    with pytest.raises(rs.SolverError, match="set M to simulate the slip event"):
        limit_cycle(slider, 1e-5)
    K = xr.DataArray([5e8, 5e9], dims="K")
    batch = limit_cycle(slider.replace(K=K), 1e-5)
    assert batch.status[1] == 1
    assert batch.status[0] > 1
    for name in MEASURES:
        assert np.isnan(batch[name][0]), name


# Where b >> a and K is near K_c_qs the slip law's motion may never repeat.
CHAOS = SpringSlider(a=0.01, b=0.2, Dc=1e-5, sigma=1e6, K=1.1 * 1.9e10, M=6e4)


def test_not_converged_carries_its_best(monkeypatch):
    """Cycles that do not settle are refused, not guessed."""
    monkeypatch.setattr(attractor, "MAX_SEARCH_STEPS", 50)
    with pytest.raises(rs.NotConverged, match=r"no_convergence.*period doubling") as caught:
        limit_cycle(CHAOS, 1e-3)
    assert caught.value.best.status > 1
    assert np.isfinite(caught.value.best.period)
    assert np.isfinite(caught.value.best.amplitude)
    K = xr.DataArray([CHAOS.K, np.inf], dims="K")
    batch = limit_cycle(CHAOS.replace(K=K), 1e-3)
    assert batch.status[0] > 1
    assert batch.status[1] == 1
    assert np.isnan(batch.amplitude[0])


def test_a_cycle_beside_stable_sliding_after_a_chaotic_transient():
    """A law with a cut-off speed; 399 returns of `simulate` at rtol 1e-11 have this amplitude.

    Of sliders that differ by 1e-7 about half end on the cycle, and the others in steady sliding.
    """
    p = {"a": 0.009346826, "b": 0.06181169, "Dc": 4.735297e-6, "sigma": 7053861.0}
    K = xr.DataArray(1.7761977e11 * (1.0 + 1e-7 * np.arange(16.0)), dims="K")
    slider = SpringSlider(**p, K=K, M=1.1741926e8, V_cut=3.00612e-6, law="kato-tullis")
    found = limit_cycle(slider, 8.009534e-7)
    assert set(found.status.values.tolist()) == {0, 1}
    assert found.amplitude[found.status == 0].values == pytest.approx(0.49147715, rel=1e-4)


# The cycle by other means -------------------------------------------------------------------------


def sliders(ratio, beta, eta, law):
    """Sliders with these K/K_c_qs, b/a and, at V_lp = 1 mm/s, eta; in the dimension case."""
    values = np.broadcast_arrays([0.0], ratio, beta, eta)[1:]
    ratio, beta, eta = (xr.DataArray(np.array(v, float), dims="case") for v in values)
    a, sigma, Dc = 0.005, 4e6, 1e-5
    return SpringSlider(
        a=a,
        b=a * beta,
        Dc=Dc,
        sigma=sigma,
        K=ratio * (beta - 1) * a * sigma / Dc,
        M=eta * a * sigma * Dc / 1e-3**2,
        law=law,
    )


def march(slider, V_lp, t_end):
    """Amplitude and frequency of the last cycle of a run from V_lp/10."""
    loading, end = rs.Loading.constant(V_lp), t_end * xr.DataArray([1.0], dims="time")
    run = simulate(slider, loading, t_end, V_start=V_lp / 10, times=end, rtol=1e-11)
    return run.amplitude, run.frequency


def off(found, exact):
    """Relative difference of amplitude or period, whichever is larger."""
    amplitude = np.abs(found.amplitude / exact.amplitude - 1)
    return np.maximum(amplitude, np.abs(found.period / exact.period - 1)).values


@pytest.mark.parametrize(
    ("slider", "V_lp", "period", "amplitude", "rtol"),
    [
        (FIG2, 3.2e-3, 0.019764896443215, 0.00123469636703, 1e-11),
        (FIG2.replace(law="aging"), 3.2e-3, 0.019835727664857, 0.00229919602080, 1e-11),
        (STICK, 1e-5, 29.97526508532, 0.061396405204, 1e-10),
        (STICK, 1e-7, 4205.987027919, 0.089865449566, 1e-10),
        (STICK.replace(law="aging"), 1e-5, 32.676591512, 0.07356797895, 1e-9),
    ],
    ids=["P1", "P4a", "P2", "P3", "P4b"],
)
def test_reference_cycles(slider, V_lp, period, amplitude, rtol):
    """Table of numerics.md, P1 and P4 settled."""
    found = limit_cycle(slider, V_lp, rtol=1e-10)
    assert float(found.period) == pytest.approx(period, rel=rtol)
    assert float(found.amplitude) == pytest.approx(amplitude, rel=rtol)
    assert float(found.stress_drop) == pytest.approx(amplitude * slider.sigma, rel=rtol)
    assert 0 < float(found.error) <= 1e-10
    assert found.stable
    rough = limit_cycle(slider, V_lp, rtol=1e-5)
    assert 1e-12 < off(rough, found) < float(rough.error) <= 1e-5


@LAWS
def test_errors_bound_the_true_errors_of_random_sliders(law):
    """Neither too small nor far too large, of random sliders and close to the Hopf point."""
    rng = np.random.default_rng(42)
    n = 20
    beta, eta = 1 + 10 ** rng.uniform(-1, 0.7, n), 10 ** rng.uniform(-12, 3, n)
    below = rng.uniform(0.02, 0.995, n)
    within = 1 + eta * (1 - 10 ** rng.uniform(-9, 0, n))
    slider = sliders(np.where((eta < 1e-5) | (rng.random(n) < 0.4), below, within), beta, eta, law)
    exact = limit_cycle(slider, 1e-3, rtol=1e-10)
    cycle = (exact.status == 0).values
    assert cycle.mean() > 0.97
    exactly = exact.error.values[cycle]
    for rtol in (1e-5, 1e-8):
        found = limit_cycle(slider, 1e-3, rtol=rtol)
        np.testing.assert_array_equal(found.status == 0, cycle)
        error, far = found.error.values[cycle], off(found, exact)[cycle]
        assert (far <= error + exactly).all(), np.nanmax(far / error)
        precise = exactly < 0.1 * rtol
        assert precise.mean() > 0.7
        assert (error[precise] <= rtol).all()
        assert np.median(error) > 1e-3 * rtol
        assert np.median(far / error) > 1e-3
        assert far.max() > 0.01 * rtol  # the test is not blind


@LAWS
@pytest.mark.parametrize("K", [6.3e8, 9e8, 2.4e9, 6e10])
def test_small_cycles_follow_the_hopf_bifurcation(law, K):
    """Just above V_c the amplitude grows as the normal form says, or jumps, as the type says."""
    slider = FIG2.replace(K=K, law=law)
    point = rs.hopf(slider)
    epsilon = xr.DataArray(10.0 ** -np.arange(2, 11), dims="epsilon")
    V_lp = float(point.V_c) * (1 + epsilon)
    epsilon = V_lp / float(point.V_c) - 1  # as rounded
    found = limit_cycle(slider, V_lp, rtol=1e-8)
    assert (found.status == 0).all()
    ratio = found.amplitude / (point.amplitude_coefficient * np.sqrt(epsilon))
    if point.type == "subcritical":
        assert (np.diff(found.amplitude) < 0).all()  # down to that of the fold's other side
        assert float(found.amplitude[-1] / found.amplitude[0]) > 0.9
        assert (found.multipliers[:, 0].real < 0.95).all()
        return
    rounding = 2.0**-52 / epsilon * 20  # of K_c - K
    assert (np.abs(ratio - 1) < 2 * epsilon + rounding).all()
    assert (np.abs(found.frequency / point.frequency - 1) < 2 * epsilon).all()
    assert (found.error < 1e-8 + 2 * rounding).all()
    # one return takes away twice as much of a small distance as it adds to that from steady sliding
    added = rs.stability(slider, V_lp).growth_rate * found.period
    taken = -np.log(found.multipliers[:, 0].real)
    np.testing.assert_allclose(taken[:4], 2 * added[:4], rtol=0.03)


def test_a_cycle_is_found_if_a_run_ends_on_it():
    """Above K_c, aging law: a cycle where marching from V_lp/10 finds one, else steady sliding."""
    beta, eta = 2.0, 0.05
    above = np.array([0.001, 0.003, 0.005, 0.0054, 0.0065, 0.009, 0.02])
    slider = sliders((1 + eta) * (1 + above), beta, eta, "aging")
    assert rs.stability(slider, 1e-3).stable.all()
    found = limit_cycle(slider, 1e-3)
    amplitude, frequency = march(slider, 1e-3, xr.DataArray(np.full(7, 60.0), dims="case"))
    cycle = (amplitude > 0.002).values  # 0.4 a
    assert 2 < cycle.sum() < 6
    np.testing.assert_array_equal(found.status == 0, cycle)
    assert ((amplitude < 1e-4) | (amplitude > 0.01)).all()  # all has settled
    np.testing.assert_allclose(found.amplitude[cycle], amplitude[cycle], rtol=1e-7)
    np.testing.assert_allclose(found.frequency[cycle], frequency[cycle], rtol=1e-7)
    assert found.stable.all()


def test_cycles_that_rounding_hides_are_refused():
    """K within some 1e-8 of K_c_qs, slip law: 1 - x at the maximum decides and is near rounding.

    An answer must be the march's, or none.
    """
    ratio = np.array([1.0000000029736542, 0.9999999939871425, 0.9999999982897817])
    beta = np.array([8.876906879406981, 5.620786420412522, 6.4598021176661])
    eta = np.array([1.2428649481345794e-08, 1.6080802097855824e-08, 1.7852125578693688e-09])
    for rtol in (1e-3, 1e-6, 1e-9):
        found = limit_cycle(sliders(ratio, beta, eta, "slip"), 1e-3, rtol=rtol)
        cycle = found.isel(case=found.status == 0)
        assert ((found.status == 0) | (found.status > 1)).all()
        assert (cycle.amplitude > 0).all()
        assert (cycle.period > 0).all()
        assert ((cycle.error > 0) & (cycle.error <= 1e-2)).all()
        # the load point's way in a period bounds the stress it can build up
        pulled = sliders(ratio, beta, eta, "slip").K / 4e6 * 1e-3 * found.period
        assert (cycle.amplitude < pulled[found.status == 0]).all()


# Everywhere ---------------------------------------------------------------------------------------


def test_an_unresolved_waveform_has_no_fundamental():
    """176 e-folds of speed in a cycle: the fundamental seemed to have 4.8 times the variance."""
    slider = sliders([1.0], [8.137994458761113], [9.017628378517905e-20], "slip")
    assert not limit_cycle(slider, 1e-3, rtol=1e-10).fundamental > 1.01


def test_a_late_runaway_is_found():
    """Without inertia and barely softer than K_c_qs, after some 300 returns."""
    slider = sliders([0.9999], [6.011872336272722], [0.0], "aging")
    found = limit_cycle(slider, 1e-3, rtol=1e-6)
    assert found.status == RUNAWAY


#: V_lp; law, a, b, Dc, sigma, mu0, V0, M, damping and K [SI]
EXTREMES = [
    # b/a = 62 and eta = 1e-27: a leap divides by less than the smallest normal numbers
    (
        1.6419010190734186e-12,
        *("slip", 0.4178780182907628, 25.964722866337695, 5.219450366639041e-07),
        *(319980822.5903632, 0.2819964488391411, 4.153486472338758e-11, 0.03504002391400254),
        *(0.0, 1.5661611321438102e16),
    ),
    # b - a = 2e-6 a: returns whose derivatives are not finite
    (
        1.5254458845804432e-10,
        *("aging", 6.558388334583894e-05, 6.558400926982032e-05, 1.5190640691350459),
        *(2.0900807128179326, 0.6472560618972623, 2.1030758218787744e-10, 1.530020272873964e-07),
        *(0.09907421804265333, 1.6330978904422534e-10),
    ),
]


@pytest.mark.parametrize(("V_lp", "values"), [(V_lp, values) for V_lp, *values in EXTREMES])
def test_extreme_parameters_warn_of_nothing(V_lp, values):
    symbols = "law a b Dc sigma mu0 V0 M damping K".split()
    slider = SpringSlider(**dict(zip(symbols, values, strict=True)))
    with warnings.catch_warnings(), contextlib.suppress(rs.SolverError):
        warnings.simplefilter("error")
        limit_cycle(slider, V_lp)


def test_stress_drop_of_a_run_under_another_normal_stress():
    slider = FIG2.replace(K=8e8)
    pull = rs.Loading.constant(3e-3).sigma_step(0.5, 3e6)
    run = simulate(slider, pull, 3.0, V_start=1e-3, times=np.linspace(2.8, 3.0, 20001))
    last = run.sel(time=slice(3.0 - 1.5 / float(run.frequency), 3.0))
    drop = float(last.tau.max() - last.tau.min())
    assert float(run.stress_drop) == pytest.approx(drop, rel=1e-4)
    expected = limit_cycle(slider.replace(sigma=3e6), 3e-3)
    assert float(run.stress_drop) == pytest.approx(float(expected.stress_drop), rel=1e-4)
