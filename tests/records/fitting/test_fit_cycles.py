"""Fits of stick-slip and vibration by the features of their cycles."""

import functools

import numpy as np
import pytest
import xarray
from matplotlib.figure import Figure
from naive import FIG2, Naive, one_cycle

import ratestate as rs
from ratestate import plot
from ratestate.dynamics.recipe import recorded_loading
from ratestate.records.fitting.cycles import fit_cycles as fitting
from ratestate.records.fitting.cycles import folding
from ratestate.records.fitting.cycles.fit_cycles import cycles_dataset, diagnose, fit_cycles
from ratestate.records.fitting.cycles.folding import Segment, regular_cuts
from ratestate.records.fitting.cycles.measured import corrected, measure
from ratestate.records.fitting.cycles.waves import FEATURES, cycle_features, limit_waves, wave_at
from ratestate.records.fitting.solutions import solution_from
from ratestate.records.kit.sample_noise import SampleNoise

VIBRATION = rs.SpringSlider(**FIG2)  # the paper's Fig. 2, 1 % below K_c
STICK_SLIP = rs.SpringSlider(
    a=0.005, b=0.008, Dc=1e-5, sigma=4e6, M=100.0, K=9.6e8, mu0=0.6, V0=1e-9
)
BRAKE = VIBRATION.replace(K=7e8)
SYMBOLS = ("a", "b", "Dc", "K", "M")


@functools.cache
def cycle(slider, V_lp):
    """Return the period [s] and tau/sigma of the limit cycle at the phases GRID."""
    values = {s: np.array([getattr(slider, s)]) for s in (*SYMBOLS, "sigma")}
    found = limit_waves(slider.law, values, np.array([V_lp]))
    steady = slider.mu0 + (slider.a - slider.b) * np.log(V_lp / slider.V0)
    return found.period[0], steady + slider.a * found.x[0]


def segment(slider, V_lp, *, cycles=12, samples=60, noise=0.02, correlation=0.0, seed=0, **odd):
    """Return a synthetic segment of cycles; noise is divided by the amplitude.

    odd : jitter of periods, spread of amplitudes, trend, all relative
    """
    rng = np.random.default_rng(seed)
    period, wave = cycle(slider, V_lp)
    lengths = 1.0 + odd.get("jitter", 0.0) * rng.standard_normal(cycles + 3)
    cuts = np.concatenate([[0.0], np.cumsum(lengths)]) - rng.random()
    t = np.arange(int(cycles * samples)) / samples
    phase = np.interp(t, cuts, np.arange(cuts.size))
    size = 1.0 + odd.get("spread", 0.0) * rng.standard_normal(cuts.size)
    y = wave.mean() + (wave_at(wave)(phase) - wave.mean()) * size[phase.astype(int)]
    y += SampleNoise(noise * np.ptp(wave), correlation).draw(t.size, rng)
    y += odd.get("trend", 0.0) * np.ptp(wave) * (t / t[-1] - 0.5)
    return Segment(t * period, y, V_lp)


def record(*segments):
    """Return a record of these segments, one after the other."""
    t, start = [], 0.0
    for part in segments:
        t.append(start + part.t)
        start = t[-1][-1] + part.t[1]
    speeds = [np.full(part.t.size, part.V_lp) for part in segments]
    friction = np.concatenate([part.y for part in segments])
    time = np.concatenate(t)
    return xarray.Dataset(
        {
            "friction": ("time", friction),
            "V_load": ("time", np.concatenate(speeds)),
            "segment_t": ("segment", [part[0] for part in t]),
            "segment_V": ("segment", [part.V_lp for part in segments]),
        },
        {"time": time},
    )


def truth(slider, V_lp, bins):
    values = {s: np.array([getattr(slider, s)]) for s in (*SYMBOLS, "sigma")}
    found = cycle_features(slider.law, values, np.array([V_lp]), [bins], slider.V0)[0][0, 0]
    return found + slider.mu0 * (np.array(FEATURES) == "level")


# --- the model's features -------------------------------------------------------------------------


def radau_features(parameters, V_lp):
    """Return ln amplitude and ln period of a closed cycle by SciPy's Radau."""
    values = {s: np.array([parameters[s]]) for s in (*SYMBOLS, "sigma")}
    found = limit_waves("slip", values, np.array([V_lp]))
    case = Naive(**parameters)
    psi, G = found.u[0]
    inertia = case.M * V_lp**2 / (case.sigma * case.Dc)  # a eta
    stress = case.steady(V_lp)[0] + case.b * psi + inertia * G
    start = np.array([stress, np.log(case.Dc / V_lp) + psi])
    turn = one_cycle(case, *start, V_lp, 1.5 * found.period[0], 1e-9)
    np.testing.assert_allclose(turn.end, start, rtol=0, atol=1e-6)
    return np.log([turn.amplitude, turn.period])


def test_derivatives_agree_with_an_independent_solver():
    parameters, V_lp, step = FIG2 | {"K": 5e8}, 3.2e-3, 3e-3
    sides = [
        radau_features(parameters | {"K": parameters["K"] * np.exp(h)}, V_lp) for h in (step, -step)
    ]
    # one bin in 4096 is no smoothing
    values = {s: np.array([parameters[s]] * 2) for s in (*SYMBOLS, "sigma")}
    values["K"] = values["K"] * np.exp([step, -step])
    found, *_ = cycle_features("slip", values, np.array([V_lp]), [4096], parameters["V0"])
    up, down = found[:, 0, :2]
    np.testing.assert_allclose(up, sides[0], rtol=0, atol=2e-5)
    expected = (sides[0] - sides[1]) / (2.0 * step)
    np.testing.assert_allclose((up - down) / (2.0 * step), expected, rtol=5e-3)


# --- the record's features ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("slider", "V_lp", "kinds"),
    [(BRAKE, 3.2e-3, {"noise": 0.08}), (STICK_SLIP, 1e-5, {"noise": 0.03, "correlation": 0.7})],
)
@pytest.mark.parametrize("records", [4, pytest.param(24, marks=pytest.mark.statistics)])
def test_features_are_measured_within_their_errors(slider, V_lp, kinds, records):
    z, raw = [], []
    for seed in range(records):
        found = measure(segment(slider, V_lp, seed=seed, **kinds))
        known = truth(slider, V_lp, found.cycles.profile.size)
        found = corrected(found, wave_at(cycle(slider, V_lp)[1]), known)
        error = np.sqrt(np.diag(found.covariance))
        z.append(((found.values - known) / error)[found.used])
        raw.append(((found.raw - known) / error)[0])
    z = np.array([row[:4] for row in z])
    assert 0.5 < np.sqrt(np.mean(z**2)) < 1.5
    assert np.abs(z.mean(axis=0)).max() < 3.4 / np.sqrt(records)  # 3.4 errors
    # without the correction noise makes amplitudes too large, or smooths them off
    assert abs(np.mean(raw)) > abs(z[:, 0].mean())


def test_scatter_between_cycles_enlarges_errors():
    calm, rough = (
        measure(segment(BRAKE, 3.2e-3, cycles=30, jitter=jitter, spread=spread))
        for jitter, spread in ((0.0, 0.0), (0.05, 0.1))
    )
    ratio = np.sqrt(np.diag(rough.covariance) / np.diag(calm.covariance))
    # a mean of 29 periods that scatter by 5 %
    assert np.sqrt(rough.covariance[1, 1]) == pytest.approx(0.05 / np.sqrt(29), rel=0.4)
    assert ratio[0] > 1.5
    assert any("differ by more than the noise" in text for text in rough.warnings)
    assert calm.warnings == ()


def test_a_trend_is_removed_and_noted():
    plain, drifting = (measure(segment(BRAKE, 3.2e-3, trend=x)) for x in (0.0, 1.5))
    np.testing.assert_allclose(drifting.values[:5], plain.values[:5], atol=2e-2)
    assert any("trend of friction at 3.2 mm/s" in text for text in drifting.notes)
    assert drifting.warnings == ()


# --- the fit --------------------------------------------------------------------------------------


def check_estimates(found, slider, widest):
    """Check that all estimates are within 4 errors, and errors below `widest`."""
    estimates = found.inference.estimates
    for name in estimates.by_name:
        one = estimates.by_name[name]
        known = slider.a - slider.b if name == "a_minus_b" else getattr(slider, name)
        is_free = name in found.problem.unknowns.names
        apart = np.log(one.value / known) if is_free else one.value - known
        error = one.relative_error if is_free else one.error
        assert abs(apart) < 4.0 * error, name
        assert error < widest, name


def test_fit_of_vibration_recovers_the_slider():
    data = record(segment(VIBRATION, 3.2e-3, cycles=20, samples=50))
    start = VIBRATION.replace(a=0.002, b=0.0055)
    found = fit_cycles(data, start, ("a", "b"))
    check_estimates(found, VIBRATION, 1e-2)
    assert found.problem.dof == 3
    # chi-squared is that of the features as finally corrected
    (one,) = found.problem.measured
    off, used = (found.features[0] - one.values)[one.used], np.ix_(one.used, one.used)
    assert found.chi2 == pytest.approx(off @ np.linalg.solve(one.covariance[used], off), rel=1e-6)
    assert found.chi2 < 17.0
    result = cycles_dataset(found)
    assert (result.start_status == "converged").all()
    assert float(result.start_chi2[0]) == pytest.approx(float(result.chi2), abs=0.05)
    assert float(result.a) == found.inference.estimates.by_name["a"].value
    assert result.parameter.values.tolist() == ["a", "b", "mu0", "a_minus_b"]
    for name in result.parameter.values:
        lower, upper = result.interval.sel(parameter=name, level=0.95)
        assert lower < result[name] < upper, name
    rms = float(np.sqrt((result.residual**2).mean()))
    assert rms == pytest.approx(0.02 * float(np.ptp(cycle(VIBRATION, 3.2e-3)[1])), rel=0.25)
    assert result.warnings.item().splitlines() == diagnose(found)[1]


@pytest.fixture(scope="module")
def vibration():
    """Return a record of vibration, and the fit of b to it."""
    data = record(segment(VIBRATION, 3.2e-3, cycles=20, samples=50))
    return data, fit_cycles(data, VIBRATION, ("b",))


def test_fits_that_lose_their_cycles_are_refused(vibration, monkeypatch):
    """No search finds a cycle after the features have been corrected."""
    problems = []

    def without_cycle(problem, *start):
        problems.append(problem.measured)
        if problem.measured is not problems[0]:
            raise rs.ParameterError("no motion")
        return solution_from(problem, *start)

    monkeypatch.setattr(fitting, "solution_from", without_cycle)
    data, _ = vibration
    with pytest.raises(rs.ParameterError, match=r"no limit cycle .* b free under the slip law"):
        fit_cycles(data, VIBRATION, ("b",))
    assert problems[-1] is not problems[0]


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
def test_two_laws_are_fitted_side_by_side(vibration):
    data, slip = vibration
    both = rs.fit(data, VIBRATION, ("b",), law=("slip", "aging"), against="cycles")
    assert float(both.b.sel(law="slip")) == slip.inference.estimates.by_name["b"].value
    assert both.fitted.dims == ("law", "segment", "feature")
    assert float(both.aic_difference.min()) == 0.0
    assert "AIC" in both.attrs["comparison"]
    assert "Neither" not in both.attrs["comparison"]


# --- what cannot be fitted ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "free", "words"),
    [
        ({"M": 0.0}, ("a", "b"), "no limit cycle"),
        ({"K": np.inf}, ("a", "b"), "does not oscillate"),
        ({"b": 0.002}, ("Dc",), "Free b"),
        ({}, ("a", "sigma"), "not a parameter of the fit"),
        ({}, ("a", "lag"), "a delay of a load point that moves steadily"),
        ({}, ("a", "alpha"), "normal stress, which is constant here, has no effect"),
        (
            {},
            SYMBOLS,
            "5 parameters .* only 5 features .* 10 um/s amplitude, period, rise, high",
        ),
    ],
)
def test_sliders_that_cannot_be_fitted(change, free, words):
    data = record(segment(STICK_SLIP, 1e-5))
    with pytest.raises(rs.ParameterError, match=words):
        rs.fit(data, STICK_SLIP.replace(**change), free, against="cycles")


def test_records_that_cannot_be_fitted():
    whole = segment(BRAKE, 3.2e-3)
    rng = np.random.default_rng(1)
    few = Segment(whole.t[:110], whole.y[:110], whole.V_lp)
    noise = whole._replace(y=rng.standard_normal(whole.t.size))
    sparse = segment(BRAKE, 3.2e-3, cycles=40, samples=4)
    irregular = segment(BRAKE, 3.2e-3, cycles=25, jitter=0.45)
    for part, words in (
        (few, "fewer than 3"),
        (noise, "no oscillation"),
        (sparse, "fewer than 6 samples"),
        (irregular, "irregular|no oscillation"),
    ):
        with pytest.raises(rs.ParameterError, match=words):
            measure(part)


def test_a_transient_is_left_out_and_noted():
    part = segment(BRAKE, 3.2e-3, cycles=20)
    period = cycle(BRAKE, 3.2e-3)[0]
    grow = 1.0 - 0.7 * np.exp(-part.t / (1.5 * period))
    grown = part._replace(y=part.y.mean() + (part.y - part.y.mean()) * grow)
    found, plain = measure(grown), measure(part)
    assert found.values[0] == pytest.approx(plain.values[0], abs=0.03)
    # the one parameter is well determined, without warnings
    result = rs.fit(record(grown), BRAKE.replace(b=0.006), free="b", against="cycles")
    assert result.warnings.item() == ""
    assert "A transient, the first " in result.identifiability.item()
    assert {n: result.attrs[n] for n in ("title", "against", "free")} == {
        "title": "ratestate fit",
        "against": "cycles",
        "free": '["b"]',
    }
    assert float(result.a_minus_b) == pytest.approx(BRAKE.a - float(result.b), rel=1e-12)
    error = result.standard_error.sel(parameter=["b", "a_minus_b"])
    assert float(error[1]) == pytest.approx(float(error[0]), rel=1e-6)


def test_the_result_keeps_the_speeds_and_can_be_drawn():
    parts = [segment(BRAKE, V_lp, noise=0.01) for V_lp in (3.2e-3, 2e-3)]
    data = record(*parts)
    result = rs.fit(data, BRAKE.replace(b=0.006), free="b", against="cycles")
    loading = recorded_loading(result)
    assert loading.V.tolist() == [3.2e-3, 2e-3]
    before = float(data.segment_t[1] - result.time[0])
    assert loading.t == pytest.approx([0.0, before], abs=1e-9)
    ax = Figure().subplots()
    plot.fit(result, ax=ax)
    assert ax.get_xlabel().startswith("Time")
    (mark,) = (line for line in ax.lines if len(set(line.get_xdata())) == 1)
    unit = 1e3 if "[ms]" in ax.get_xlabel() else 1.0
    assert mark.get_xdata()[0] == pytest.approx(unit * before)
    with pytest.raises(rs.ParameterError, match="Give time"):
        plot.fit(result, ax=ax, x="delta_lp")
    assert len(plot.figure(result).axes) >= 3


def test_more_samples_than_can_be_used_are_refused_by_fits_of_cycles(monkeypatch):
    part = segment(BRAKE, 3.2e-3)
    monkeypatch.setattr(folding, "MOST", part.t.size)
    assert measure(part).segment.t.size == part.t.size
    monkeypatch.setattr(folding, "MOST", part.t.size - 1)
    words = "has 720 samples in .* cycles, .* at most 719 samples.* a window of fewer cycles"
    with pytest.raises(rs.ParameterError, match=words):
        rs.fit(record(part), BRAKE, ("a", "b"), against="cycles")
    with pytest.raises(rs.ParameterError, match="0 samples, but at least 30"):
        rs.fit(record(part).isel(time=slice(0, 0)), BRAKE, ("a", "b"), against="cycles")
    percent = record(part).assign(friction=100.0 * record(part).friction)
    with pytest.raises(rs.ParameterError, match="in per cent"):
        rs.fit(percent, BRAKE, ("a", "b"), against="cycles")
    # samples so dense that neighbours are averaged count as their averages
    dense = segment(BRAKE, 3.2e-3, samples=4000)
    monkeypatch.setattr(folding, "MOST", dense.t.size // 2)
    assert measure(dense).segment.t.size == dense.t.size // 2


@pytest.mark.parametrize(("small", "words"), [(1, "first cycle at"), (2, "first 2 cycles at")])
def test_cycles_left_out_are_counted(small, words):
    t = np.arange(900) / 100.0
    size = np.where(t < small + 0.2, 0.6, 1.0)  # tau falls through its middle at 0.2, 1.2, ...
    y = size * np.sin(2.0 * np.pi * (t - 0.7))
    _, notes = regular_cuts(Segment(t, y, 1e-5), 1.0)
    assert notes == (f"a transient, the {words} 10 um/s, is left out",)
