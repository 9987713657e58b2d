"""simulate: its contract, and its numbers against closed forms and SciPy."""

import math

import naive
import numpy as np
import pytest
import xarray as xr

import ratestate as rs
from ratestate import Loading, SpringSlider, simulate

BASE = naive.FIG2
SLIDER = SpringSlider(**BASE)
STIFF = SLIDER.replace(K=3e9)  # always stable
LAWS = pytest.mark.parametrize("law", ["slip", "aging"])


# The result ---------------------------------------------------------------------------------------


def test_own_steps_are_fine_enough_to_draw():
    """Some 6 steps of Taylor series make a vibration: between them the motion is kept as well."""
    slider = SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=3e3, K=9e8)
    run = simulate(slider, Loading.constant(1e-2), 0.05, V_start=9e-3)
    steps = int(run.steps)
    assert 5 * steps < run.sizes["time"] <= 8 * steps + 1
    assert (np.diff(run.time) > 0).all()
    exact = simulate(slider, Loading.constant(1e-2), 0.05, V_start=9e-3, times=run.time, rtol=1e-12)
    assert np.abs(np.log(run.V / exact.V)).max() < 3e-5
    assert np.abs(np.diff(np.log(run.V))).max() < 0.15


@pytest.mark.parametrize("seed", range(2))
def test_steps_land_on_breaks_and_end(seed):
    """To the last bit, whatever the times: the march lands there, it does not come near."""
    rng = np.random.default_rng(seed)
    for _ in range(20):
        t_end = rng.uniform(0.01, 0.5)
        t1, t2 = np.sort(rng.uniform(0.1, 0.9, 2)) * t_end
        run = simulate(SLIDER, Loading.steps(1e-4, (t1, 1e-3), (t2, 2e-4)), t_end, rtol=1e-4)
        time = run.time.values
        assert time[0] == 0
        assert time[-1] == t_end
        assert np.abs(time - t1).min() == np.abs(time - t2).min() == 0
        # V_load(t) is the speed after a jump, and V has none: tau and V are continuous
        assert run.V_load.sel(time=t1) == 1e-3
        assert run.V_load.sel(time=t2) == 2e-4


def test_last_time_may_pass_t_end_by_rounding():
    for t in (0.3 * (1 + 5e-13), 0.3, 0.3 * (1 - 5e-13)):
        run = simulate(SLIDER, Loading.constant(1e-3), 0.3, V_start=1e-4, times=[0.1, t])
        assert np.isfinite(run.V.values).all()


# The start and the load point ---------------------------------------------------------------------


def test_initial_values_with_a_rigid_drive():
    slider = SLIDER.replace(K=np.inf, M=0.0)
    run = simulate(slider, Loading.constant(1e-3), 0.01, initial={"theta": 10.0}).isel(time=0)
    assert float(run.V) == pytest.approx(1e-3, rel=1e-15)
    assert float(run.theta) == pytest.approx(10.0, rel=1e-13)
    assert run.delta == 0
    V, state = 1e-3 / slider.V0, 10.0 * slider.V0 / slider.Dc
    mu = slider.mu0 + slider.a * np.log(V) + slider.b * np.log(state)
    both = {"theta": 10.0, "tau": slider.sigma * mu}
    again = simulate(slider, Loading.constant(1e-3), 0.01, initial=both).isel(time=0)
    assert float(again.theta) == float(run.theta)
    with pytest.raises(rs.ParameterError, match=r"V_lp = 0 .*K = inf"):  # friction fixes nothing
        simulate(slider, Loading.constant(0.0), 0.01, V_start=1e-6, initial=both)


@pytest.mark.parametrize(
    ("initial", "message"),
    [
        ({"V": 2e-3}, "initial V is given, .* K = inf"),
        ({"V": 2e-3, "theta": 1.0, "tau": 1e6}, r"Leave V out, and theta or tau\.$"),
        (
            {"theta": 1.0, "tau": 1e6},
            r"initial theta and tau do not agree: if K = inf, .* Leave theta or tau out\.$",
        ),
        (
            {"V": 1e-3, "theta": 1.0, "tau": 1e6},
            r"V, theta and tau do not agree: .* must be sigma mu = .* Pa\.",
        ),
    ],
)
@pytest.mark.parametrize("M", [0.0, 3e3])
def test_initial_values_that_a_rigid_drive_refuses(initial, message, M):
    slider = SLIDER.replace(K=np.inf, M=M)
    with pytest.raises(rs.ParameterError, match=message):
        simulate(slider, Loading.constant(1e-3), 0.01, initial=initial)


def test_a_start_at_a_speed_beyond_double_precision_is_refused():
    slider = STIFF.replace(M=0.0)

    def start(v, **parameters):
        """The first row where friction is the stress at V = V0 exp(v), theta = Dc/V0."""
        tau = slider.sigma * (slider.mu0 + slider.a * v)
        initial = {"theta": slider.Dc / slider.V0, "tau": tau}
        moving = slider.replace(**parameters)
        return simulate(moving, Loading.constant(1e-3), 1e-300, initial=initial).isel(time=0)

    # (far below V0 the slider rests)
    assert math.log(float(start(-590.0).V) / slider.V0) == pytest.approx(-590.0, rel=1e-12)
    with pytest.raises(rs.QuasiStaticInstability):  # accepted, to run away at once
        start(596.3)  # V0 exp(596.37) is 1e250 m/s
    with pytest.raises(rs.ParameterError, match=r"^initial theta and tau: .* V = 10\^250\.01"):
        start(596.4)
    # with mass the speed is the load point's, whatever the stress
    assert float(start(596.4, M=1.0).V) == pytest.approx(1e-3, rel=1e-13)


def test_slip_follows_from_the_spring():
    loading = Loading.series([0, 0.1, 0.1, 0.3], [1e-4, 2e-3, 0, 1e-3])
    run = simulate(SLIDER, loading, 0.3, V_start=1e-4, rtol=1e-9, times=np.linspace(0, 0.3, 3001))
    np.testing.assert_allclose(run.delta, run.delta_lp - run.tau / 9e8, rtol=1e-14, atol=1e-18)
    np.testing.assert_array_equal(run.delta_lp, loading.delta_lp(run.time.values))
    np.testing.assert_array_equal(run.V_load, loading.V_load(run.time.values))
    # ... and that is the integral of V (by Simpson)
    dt = run.time.values[1]
    V = run.V.values
    slip = np.cumsum((V[:-2:2] + 4 * V[1:-1:2] + V[2::2]) * dt / 3)
    np.testing.assert_allclose(run.delta.values[2::2] - run.delta.values[0], slip, atol=2e-11)


# Numbers: SciPy -----------------------------------------------------------------------------------

#: times, repeated where the speed jumps, and speeds
HISTORIES = {
    "steps": ([0, 0.05, 0.05, 0.11, 0.11, 0.15], [1e-3, 1e-3, 3e-3, 3e-3, 5e-4, 5e-4]),
    "hold": ([0, 0.05, 0.05, 10.0, 10.0, 10.05], [1e-3, 1e-3, 0.0, 0.0, 1e-3, 1e-3]),
    "ramps": ([0, 0.05, 0.1, 0.2], [1e-3, 1e-3, 5e-3, 1e-3]),
    "up from rest": ([0, 0.05, 0.25, 0.3], [0.0, 0.0, 4e-3, 4e-3]),
}


@LAWS
@pytest.mark.parametrize("M", [0.0, 3e3])
@pytest.mark.parametrize("history", HISTORIES)
def test_against_scipy(history, M, law):
    parameters = BASE | {"M": M, "K": 3e9 if M == 0 else 9e8}
    slider = SpringSlider(**parameters, law=law)
    twin = naive.Naive(**parameters, law=law)
    t, V = HISTORIES[history]
    lines = zip(t[:-1], t[1:], V[:-1], V[1:], strict=True)
    segments = [(t0, V0, (V1 - V0) / (t1 - t0)) for t0, t1, V0, V1 in lines if t1 > t0]
    # LSODA gives up in the hold, and takes a third of the time elsewhere
    how = {"tol": 1e-10} if history == "hold" else {"tol": 1e-12, "method": "LSODA"}
    exact = naive.march(twin, twin.steady(1e-3), segments, t[-1], **how)
    loading = Loading.series(t, V)
    for rtol, bound in ((1e-10, 3e-8), (1e-6, 1e-4)):
        run = simulate(slider, loading, t[-1], V_start=1e-3, rtol=rtol, times=[t[-1]])
        found = np.array([run.tau[0] / 2e6, np.log(run.V[0]), np.log(run.theta[0])])
        assert (np.abs(found - exact) / [0.003, 1, 1] < bound).all(), (rtol, found - exact)
        assert abs(run.energy_residual) < 10 * rtol
        if M == 0:
            assert float(run.tau[0]) == pytest.approx(2e6 * float(run.mu[0]), rel=1e-13)


@LAWS
@pytest.mark.parametrize("rtol", [1e-4, 1e-7])
@pytest.mark.parametrize("M", [0.0, 100.0])
def test_reloading_after_rest_in_contact(law, M, rtol):
    """From hardly any stress: V rises over hundreds of e-folds and tau = sigma mu all the while.

    Rounding in tau - sigma mu must not be amplified from step to step where V grows so fast.
    """
    slider = STIFF.replace(law=law, M=M)
    t_end = 0.9 * 1.1e6 / 3e9 / 1e-3
    times = np.linspace(0.05, 1, 20) * t_end
    run = simulate(
        slider, Loading.constant(1e-3), t_end, initial={"tau": 0.0}, times=times, rtol=rtol
    )
    assert np.log(run.V[0]) < -150
    np.testing.assert_allclose(run.tau, 3e9 * 1e-3 * times, rtol=1e-5)  # it sticks
    late = run.isel(time=slice(2, None))
    np.testing.assert_allclose(late.tau, 2e6 * late.mu, rtol=0, atol=20 * rtol * 6e3)
    after = simulate(
        slider, Loading.constant(1e-3), 1.0, initial={"tau": 0.0}, times=[1.0], rtol=rtol
    )
    assert float(after.V[0]) == pytest.approx(1e-3, rel=max(1e-6, 100 * rtol))


# Numbers: energy ----------------------------------------------------------------------------------


@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-9])
@LAWS
def test_energy_residual(law, rtol):
    """Over masses from none to large, through steps, holds, ramps and stick-slip."""
    M = xr.DataArray([0.0, 1e-3, 1.0, 100.0, 3e3, 1e5], dims="M")
    K = xr.DataArray([3e9, 1e10, 6.5e8, 1e8], dims="K")
    slider = SLIDER.replace(M=M, K=K, law=law)
    loadings = [
        Loading.steps(1e-3, (0.05, 0.0), (1.0, 5e-3)),
        Loading.series([0, 0.3, 0.3, 0.7, 1.2], [1e-3, 5e-3, 0, 1e-3, 0]),
        Loading.constant(1e-3),
    ]
    for loading in loadings:
        run = simulate(slider, loading, 1.2, V_start=2e-4, rtol=rtol)
        done = run.status == 0
        assert (run.energy_residual.where(done, 0) < 10 * rtol).all()
        assert (run.energy_residual.where(done, 0) > -10 * rtol).all()
        assert np.isfinite(run.energy_residual.where(done, 0)).all()
        assert done.sum() >= 20
        assert np.abs(run.energy_residual.where(done, 0)).max() > 1e-20


# Observables --------------------------------------------------------------------------------------


@LAWS
def test_the_largest_inertial_force_may_be_that_of_the_start(law):
    """Steady sliding has none; thrown, the slider has what tau - sigma mu leaves it at once."""
    slider = SLIDER.replace(M=1.0, K=1e10, law=law)
    steady = simulate(slider, Loading.constant(1e-3), 1e-3)
    assert float(steady.inertial_force) < 1e-12
    thrown = simulate(slider, Loading.constant(1e-3), 1e-3, initial={"V": 2e-3})
    assert float(thrown.inertial_force) == pytest.approx(0.003 * np.log(2.0), rel=1e-9)


# Rigid drive, K = inf -----------------------------------------------------------------------------


# M = 0: the instability ---------------------------------------------------------------------------


@LAWS
def test_quasi_static_instability(law):
    V_lp = 1e-3
    parameters = BASE | {"M": 0.0, "K": 3e8}
    slider = SpringSlider(**parameters, law=law)
    twin = naive.Naive(**parameters, law=law)

    def fast(t, y):
        return twin.log_velocity(*y) - math.log(1e3)

    fast.terminal = True
    start = twin.steady(V_lp / 2)
    # Beyond 1 km/s what is left of time is about Dc/V = 1e-8 s
    run_up = twin.solve([start[0], start[2]], 0, 1.0 / V_lp, V_lp, tol=1e-10, events=fast)
    exact = run_up.t_events[0][0]
    assert 1e-6 * exact > 1e-8
    with pytest.raises(rs.SolverError, match=r"M = 0.*set M to simulate the slip event") as caught:
        simulate(slider, Loading.constant(V_lp), 1.0 / V_lp, V_start=V_lp / 2, rtol=1e-9)
    found = float(str(caught.value).split("t = ")[1].split(" s")[0])
    assert found == pytest.approx(exact, rel=1e-6)
    assert type(caught.value).__name__ == "QuasiStaticInstability"
    before = simulate(slider, Loading.constant(V_lp), 0.9 * exact, V_start=V_lp / 2)
    assert before.status == 0


def test_a_rigid_run_along_a_sampled_record_is_shown_at_its_rows_too():
    t = np.linspace(0.0, 1.0, 101)
    loading = Loading.series(t, 1e-3 * (1.0 + 0.1 * np.sin(6.0 * t)))
    run = simulate(SLIDER.replace(K=np.inf, M=0.0), loading, 1.0)
    assert np.isin(t, run.time).all()
    assert run.sizes["time"] == int(run.steps) + 1


def test_cycles_are_counted_however_small_they_become():
    """Of sliding that comes to rest in steady sliding; its amplitude is then none."""
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=3e3, K=9e8)
    V, loading = 2.5e-3, rs.Loading.constant(2.5e-3)
    period = 2.0 * np.pi / float(rs.stability(slider, V).omega)
    for rtol in (1e-4, 1e-9):
        runs = [
            rs.simulate(slider, loading, n * period, V_start=0.5 * V, rtol=rtol, times=[0.0])
            for n in (20.25, 200.25, 2000.25)
        ]
        counts = [int(run.cycles) for run in runs]
        assert counts[0] == 19
        assert all(30 <= count < 100 for count in counts[1:])
        assert runs[0].amplitude > 0.0 == runs[1].amplitude == runs[2].frequency


@pytest.mark.parametrize("speed", ["3.2 mm/s", 3.2e-3, rs.logspace("V_lp", 1e-3, 1e-2, 2)])
def test_a_speed_is_a_constant_loading(speed):
    slider = SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3000)
    runs = [simulate(slider, x, "0.1 s", V_start=1e-3) for x in (speed, Loading.constant(speed))]
    xr.testing.assert_identical(*runs)
    with pytest.raises(rs.ParameterError, match="V_lp = '3 m' is a length"):
        simulate(slider, "3 m", "0.1 s")
