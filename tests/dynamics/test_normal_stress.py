"""Normal stress that varies in time, against the laws as their papers write them."""

import math

import numpy as np
import pytest
import xarray as xr
from textbook import Textbook, drawn, wave

import ratestate as rs

RTOL = 1e-6
TIMES = np.linspace(0.0, 10.0, 11)
UNDAMPED = {"a": 0.003, "b": 0.006, "Dc": 1e-5, "sigma": 2e6, "K": 9e8, "M": 3e3}
SLIDER = UNDAMPED | {"damping": 1e4}
#: law, form of friction and damping, of which each has kernels of its own
COMBINATIONS = [
    ("slip", "log", 1.0),
    ("nagata", "log", 0.0),
    ("two-state-aging", "cut-off", 0.0),
    ("slip", "regularized", 1.0),
]


def histories(V, p, rng):
    """A loading, s(t) with its logarithm's slope, and where s has kinks: of each kind."""
    unit, size = p["Dc"] / V, p["a"] * 10 ** rng.uniform(-0.5, 1.2)
    period = unit * 10 ** rng.uniform(-1, 1)
    start, lasting, target = 2.05 * unit, unit * 10 ** rng.uniform(-2, 0.5), 1.0 + size

    def ramp(t):
        rate = (target - 1.0) / lasting if start < t < start + lasting else 0.0
        s = 1.0 + (target - 1.0) * min(max((t - start) / lasting, 0.0), 1.0)
        return s, rate / s

    def step(t):
        return (1.0 if t < start else 1.0 - 0.5 * size), 0.0

    loading, sigma = rs.Loading.constant(V), p["sigma"]
    yield loading.sigma_sinusoid(size * sigma, period=period), wave(size, period), []
    yield loading.sigma_ramp(start, target * sigma, lasting), ramp, [start, start + lasting]
    yield loading.sigma_step(start, (1.0 - 0.5 * size) * sigma), step, [start]


@pytest.mark.parametrize("mass", [True, False])
@pytest.mark.parametrize(("law", "form", "damped"), COMBINATIONS)
def test_runs_under_varying_stress_agree_with_the_textbook(law, form, damped, mass):
    rng = np.random.default_rng([5, mass, len(law), len(form)])
    p, V = drawn(law, rng)
    p |= {"M": p["M"] * mass, "alpha": 0.3, "K": 3.0 * p["K"]}
    p["damping"] = 0.1 * damped * p["a"] * p["sigma"] / V
    own = {"friction_form": form} | ({"V1": 1e3 * V, "V2": 10.0 * V} if form == "cut-off" else {})
    own = {} if form == "log" else own
    times = TIMES * p["Dc"] / V
    slider = rs.SpringSlider(**p, **own, law=law)
    for loading, s, breaks in histories(V, p, rng):
        run = rs.simulate(slider, loading, times[-1], V_start=V / 3.0, times=times, rtol=RTOL)
        twin = Textbook(law, {**p, **own, "s": s})
        exact = twin.through(twin.steady(V / 3.0), V, times, breaks)
        assert twin.differs(run, exact) < 10.0 * RTOL
        assert run.sigma.values == pytest.approx([p["sigma"] * s(t)[0] for t in times], rel=1e-12)
        assert abs(float(run.energy_residual)) < RTOL
        assert int(run.steps) < 20_000


def test_work_is_stored_or_dissipated():
    """By the trapezoidal rule on the motion itself."""
    loading = rs.Loading.constant(1e-4).sigma_ramp(0.5, 2.2e6, 0.2).sigma_sinusoid(5e4, period=0.3)
    slider = rs.SpringSlider(**(SLIDER | {"damping": 2e6}), alpha=0.2)
    run = rs.simulate(slider, loading, 2.0, rtol=1e-9)
    t, V = run.time.values, run.V.values
    spent = run.sigma.values * run.mu.values * V + slider.damping * V**2
    work = np.trapezoid(run.tau.values * run.V_load.values, t)
    stored = np.diff(run.tau.values[[0, -1]] ** 2)[0] / (2.0 * slider.K)
    stored += 0.5 * slider.M * np.diff(V[[0, -1]] ** 2)[0]
    assert work - np.trapezoid(spent, t) == pytest.approx(stored, abs=2e-5 * work)
    assert np.ptp(run.sigma.values) > 2e5
    assert abs(float(run.energy_residual)) < 1e-9


@pytest.mark.parametrize("M", [3e3, 0.0])
def test_both_sides_of_a_step_are_stored(M):
    """The stress of the spring stays; a step at the end of a run has not happened."""
    slider = rs.SpringSlider(**(SLIDER | {"M": M, "K": 3e9}), law="slip", alpha=0.25)
    loading = rs.Loading.constant(1e-4).sigma_step(0.3, 2.02e6)
    run = rs.simulate(slider, loading, 0.5)
    (k,) = np.flatnonzero(np.diff(run.sigma.values))
    t = run.time.values
    assert t[k + 1] == 0.3
    assert t[k] == np.nextafter(0.3, 0.0)
    before, after = run.isel(time=k), run.isel(time=k + 1)
    assert (before.sigma, after.sigma) == (2e6, 2.02e6)
    assert float(after.tau) == float(before.tau)
    saved = rs.simulate(slider, loading, 0.5, times=[0.3])
    for name in ("sigma", "theta", "V", "tau"):
        assert float(saved[name][0]) == pytest.approx(float(after[name]), rel=1e-12), name
    ends = rs.simulate(slider, loading, 0.3)
    assert float(ends.sigma[-1]) == 2e6
    assert float(ends.theta[-1]) == pytest.approx(float(before.theta), rel=1e-12)


def test_extremes_agree_with_the_motion():
    slider = rs.SpringSlider(**(SLIDER | {"damping": 1e6}), alpha=0.2)
    loading = rs.Loading.constant(1e-4).sigma_step(0.5, 2.1e6).sigma_sinusoid(1e5, period=0.17)
    run = rs.simulate(slider, loading, 2.0, rtol=1e-9)
    margin = (run.tau + run.sigma * run.mu) / 2e6
    force = (run.tau - run.sigma * run.mu - slider.damping * run.V) / 2e6
    pairs = {
        "V_max": run.V.max(),
        "V_min": run.V.min(),
        "mu_min": run.mu.min(),
        "reversal_margin": margin.min(),
        "inertial_force": abs(force).max(),
    }
    for name, value in pairs.items():
        assert float(run[name]) == pytest.approx(float(value), rel=1e-5), name
    coarse = rs.simulate(slider, loading, 2.0, rtol=1e-5)
    for name in pairs:
        assert float(coarse[name]) == pytest.approx(float(run[name]), rel=3e-3), name


def test_where_the_slider_moves_with_its_load_point_the_state_decays_with_slip():
    """Under the slip law ln theta is linear: after a step mu returns as exp(-V t/Dc)."""
    slider = rs.SpringSlider(**(SLIDER | {"K": math.inf, "damping": 1e6}), alpha=0.3)
    loading, times = rs.Loading.constant(1e-4).sigma_step(0.2, 2.2e6), np.linspace(0.0, 1.0, 41)
    run = rs.simulate(slider, loading, 1.0, times=times)
    steady = 0.6 - 0.003 * math.log(1e-4 / 1e-6)
    late = times >= 0.2
    lost = 0.3 * math.log(1.1) * np.exp(-(times - 0.2) * 1e-4 / 1e-5)
    mu = np.where(late, steady - lost, steady)
    np.testing.assert_allclose(run.mu, mu, rtol=1e-10)
    np.testing.assert_allclose(run.tau, run.sigma * mu + 1e6 * 1e-4, rtol=1e-10)
    assert float(run.mu_min) == pytest.approx(steady - 0.3 * math.log(1.1), rel=1e-9)
    own = rs.simulate(slider, loading, 1.0)
    assert np.nextafter(0.2, 0.0) in own.time.values
    lowest = steady - 0.3 * math.log(1.1)
    expected = min(2.0 * steady, 2.2 * lowest) + 1e2 / 2e6
    assert float(own.reversal_margin) == pytest.approx(expected, rel=1e-9)


def test_the_message_on_a_runaway_has_the_critical_stiffness_of_that_time():
    """K is above the critical one of the slider, and below that of its raised normal stress."""
    slider = rs.SpringSlider(**(UNDAMPED | {"M": 0.0, "K": 7e8}), law="nagata", c=0.0)
    loading = rs.Loading.constant(1e-4).sigma_ramp(0.5, 4e6, 2.0)
    assert slider.K > slider.K_c_qs > 0.5 * slider.K
    run = rs.simulate(slider, rs.Loading.constant(1e-4), 60.0, V_start=1.2e-4)
    assert float(run.V_max) < 3e-4
    with pytest.raises(rs.QuasiStaticInstability) as told:
        rs.simulate(slider, loading, 60.0)
    assert 15.0 < float(told.value.best.time[-1]) < 30.0
    assert (
        "K = 700 MPa/m is 0.5833 times K_c_qs = 1.2 GPa/m at the normal stress of that time, sigma "
        "= 4 MPa, and V grows without bound"
    ) in str(told.value)
    assert "add damping or set M" in str(told.value)


def test_a_series_equals_its_steps_and_ramps():
    slider, V = rs.SpringSlider(**SLIDER, alpha=0.1), [1e-4] * 5
    series = rs.Loading.series(
        [0, 0.2, 0.2, 0.3, 0.5], V, sigma=["2 MPa", 2e6, 2.1e6, 1.9e6, 1.9e6]
    )
    ramps = (
        rs.Loading.constant(1e-4).sigma_step(0.2, 2.1e6).sigma_ramp(0.2 + 1e-9, 1.9e6, 0.1 - 1e-9)
    )
    times = [0.1, 0.25, 0.5]
    one, other = (rs.simulate(slider, x, 0.5, times=times, rtol=1e-9) for x in (series, ramps))
    np.testing.assert_allclose(one.V, other.V, rtol=1e-6)
    np.testing.assert_allclose(one.sigma, [2e6, 2e6, 1.9e6], rtol=1e-12)


AT = rs.Loading.constant(1e-4)
SINUSOID = AT.sigma_sinusoid("1 MPa", period=1.0)
ROWS = [0, 1], [1, 1]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: AT.sigma_step(1, "3 MPa s"), "sigma from t = 1.0 s on"),
        (lambda: AT.sigma_step(1, 0.0), "must be > 0"),
        (lambda: AT.sigma_step(0, 1e6), "> 0"),
        (lambda: AT.sigma_ramp(1, 1e6, 0), "> 0"),
        (
            lambda: AT.sigma_step(2, 1e6).sigma_step(1, 2e6),
            "t = 1.0 s must come after t = 2.0 s, b",
        ),
        (lambda: SINUSOID.sigma_sinusoid(1.0, period=1.0), "has a sinusoid already"),
        (lambda: AT.sigma_sinusoid(1.0), "either a period or a frequency"),
        (lambda: AT.sigma_sinusoid(-1.0, period=1), "amplitude = -1 Pa"),
        (lambda: rs.Loading.series(*ROWS, sigma=[1e6]), "sigma has 1 values for 2 times"),
        (lambda: rs.Loading.series(*ROWS, sigma=[1e6, 0.0]), "sigma[1] = 0 Pa"),
        (
            lambda: rs.Loading.series(*ROWS, sigma=[1e6, 1e6]).sigma_step(0.5, 2e6),
            "the series already has a normal stress",
        ),
        (
            lambda: rs.Loading.series(*ROWS).sigma_step(1.0, 2e6),
            "t = 1.0 s is not before the end of",
        ),
    ],
)
def test_impossible_histories_are_refused(make, words):
    with pytest.raises(rs.ParameterError) as told:
        make()
    assert words in str(told.value)


@pytest.mark.parametrize(
    ("loading", "words"),
    [
        (
            AT.sigma_sinusoid("2 MPa", period=1.0),
            "sigma would fall to 0 Pa between t = 0 s and t =",
        ),
        (
            AT.sigma_step(1.0, "0.9 MPa").sigma_sinusoid(1e6, period=1.0),
            "sigma would fall to -100000 Pa between t = 1 s",
        ),
        (
            rs.Loading.series([0, 5], [1e-4, 1e-4], sigma=[2.00001e6, 2e6]),
            "begins at sigma = 2000010 Pa, and the slider has sigma = 2000000 Pa",
        ),
    ],
)
def test_histories_that_contradict_the_slider_are_refused(loading, words):
    with pytest.raises(rs.ParameterError) as told:
        rs.simulate(rs.SpringSlider(**SLIDER), loading, 3.0)
    assert words in str(told.value)


def test_histories_just_inside_their_limits_are_accepted():
    """An amplitude just below sigma; a series within 1e-6; a trough after the end of the run."""
    changes = {"K": 1e11, "M": 0.0, "a": 0.01, "b": 0.005, "damping": 1e7}
    stiff = rs.SpringSlider(**(SLIDER | changes))
    deep = rs.Loading.constant(1e-4).sigma_sinusoid(1.99e6, period=1.0)
    assert float(rs.simulate(stiff, deep, 1.0, times=[0.75]).sigma[0]) == pytest.approx(1e4)
    near = rs.Loading.series([0, 5], [1e-4, 1e-4], sigma=[2e6 * (1 + 9e-7), 2e6])
    assert int(rs.simulate(rs.SpringSlider(**SLIDER), near, 0.1).status) == 0
    early = rs.Loading.constant(1e-4).sigma_sinusoid(3e6, period=1.0)
    assert int(rs.simulate(stiff, early, 0.6, times=[0.1]).status) == 0
    with pytest.raises(rs.ParameterError, match="would fall"):
        rs.simulate(stiff, early, 0.63)


def test_a_dimension_called_sigma_is_refused():
    sigma = xr.DataArray([2e6, 3e6], dims="sigma")
    slider = rs.SpringSlider(**(SLIDER | {"sigma": sigma}))
    steps = rs.Loading.constant(1e-4).sigma_step(0.1, 2.5e6)
    with pytest.raises(rs.ParameterError, match="Rename the dimension"):
        rs.simulate(slider, steps, 0.2)
    renamed = slider.replace(sigma=sigma.rename(sigma="sigma_0"))
    assert rs.simulate(renamed, steps, 0.2).sigma.dims == ("sigma_0", "time")


V_LATER = xr.DataArray([2e-4, 5e-4], dims="V_later")
SIGMA_LATER = xr.DataArray([2.2e6, 2.5e6, 1.8e6], dims="sigma_later")
BOTH_VARY = {
    "steps": lambda V, s: rs.Loading.steps(1e-4, (0.05, V)).sigma_step(0.02, s),
    "ramp": lambda V, s: rs.Loading.constant(V).sigma_ramp(0.02, s, 0.01).sigma_step(0.05, 2e6),
    "series": lambda V, s: rs.Loading.series(
        [0.0, 0.02, 0.02, 0.05, 0.1], [1e-4, 1e-4, V, V, 1e-4], sigma=[2e6, 2e6, s, 2e6, 2e6]
    ),
    "sinusoids": lambda V, s: rs.Loading.sinusoid(V, 1e-5, period=0.03, t_end=0.1).sigma_sinusoid(
        s / 10, period=0.02
    ),
}


@pytest.mark.parametrize("kind", BOTH_VARY)
def test_speed_and_normal_stress_that_both_vary_in_a_sweep(kind):
    """Over all combinations; each is what it is alone."""
    slider = rs.SpringSlider(**(SLIDER | {"sigma": 2e6}), alpha=0.2)
    loading = BOTH_VARY[kind]
    runs = rs.simulate(slider, loading(V_LATER, SIGMA_LATER), 0.1, times=[0.04, 0.1], V_start=1e-4)
    assert dict(runs.sizes).items() >= {"V_later": 2, "sigma_later": 3, "time": 2}.items()
    for i, j in ((0, 0), (1, 2)):
        own = loading(float(V_LATER[i]), float(SIGMA_LATER[j]))
        alone = rs.simulate(slider, own, 0.1, times=[0.04, 0.1], V_start=1e-4)
        case = runs.isel(V_later=i, sigma_later=j)
        for name in ("tau", "V", "theta", "sigma", "V_load", "mu_min", "energy_residual"):
            np.testing.assert_array_equal(case[name], alone[name], err_msg=name)


def test_alpha_and_constant_normal_stress_change_nothing():
    """Not even a bit: a slider's alpha is for normal stress that varies."""
    runs = [
        rs.simulate(rs.SpringSlider(**UNDAMPED, **more), rs.Loading.steps(1e-4, (0.1, 2e-4)), 0.5)
        for more in ({}, {"alpha": 0.3})
    ]
    np.testing.assert_array_equal(runs[0].V, runs[1].V)
    assert "sigma" not in runs[0]


def test_a_rigid_slider_at_a_step_at_the_end():
    slider = rs.SpringSlider(**(SLIDER | {"K": math.inf}), alpha=0.2)
    run = rs.simulate(
        slider, rs.Loading.constant(1e-4).sigma_step(1.0, 2.1e6), 1.0, times=[0.5, 1.0]
    )
    assert run.sigma.values.tolist() == [2e6, 2e6]
    assert run.theta.values == pytest.approx([0.1, 0.1], rel=1e-12)


def test_a_fall_beyond_double_precision_is_not_a_runaway():
    """Under velocity strengthening the motion would come back, from where no double follows."""
    changes = {"a": 5e-4, "b": 3e-4, "M": 0.0, "damping": 0.0}
    slider = rs.SpringSlider(**(SLIDER | changes), law="nagata", c=0.0)
    loading = rs.Loading.constant(1e-4)
    with pytest.raises(rs.SolverError, match="beyond double precision"):
        rs.simulate(slider, loading.sigma_step(0.1, 1.2e6), 0.2)
    run = rs.simulate(slider, loading.sigma_ramp(0.1, 1.2e6, 1e-6), 0.2)
    assert 1e-3 < float(run.V_max) < math.inf


def test_changes_of_stress_after_the_end_are_ignored():
    """For what sigma falls to, case by case, and for whether anything disturbs steady sliding."""
    amplitude = xr.DataArray([1e5, 3e6], dims="case")
    t_end = xr.DataArray([20.0, 4.0], dims="case")
    slider = rs.SpringSlider(**(SLIDER | {"K": 1e11, "a": 0.02, "M": 0.0, "damping": 1e8}))
    swept = rs.Loading.constant(1e-4).sigma_sinusoid(amplitude, period=10.0)
    assert rs.simulate(slider, swept, t_end).sizes["case"] == 2
    with pytest.raises(rs.ParameterError, match="would fall"):
        rs.simulate(slider, swept, t_end + 5.0)
    falling = rs.Loading.constant(1e-4).sigma_ramp(1.0, 1e5, 100.0).sigma_sinusoid(2e5, period=1.0)
    assert int(rs.simulate(slider, falling, 2.0).status) == 0
    unstable = rs.SpringSlider(**(SLIDER | {"K": 3e8}))
    steady = rs.Loading.constant(1e-4)
    for late in (steady.sigma_step(2.0, 2.1e6), steady.sigma_sinusoid(0.0, period=1.0)):
        with pytest.warns(rs.RunWarning, match="nothing disturbs it"):
            rs.simulate(unstable, late, 1.0)
    rs.simulate(unstable, steady.sigma_step(0.5, 2.1e6), 1.0)
