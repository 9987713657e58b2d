"""`events` against exact limit cycles, with and without noise, and its messages."""

import dataclasses
import itertools

import numpy as np
import pytest
import xarray
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import trapezoid
from scipy.stats import norm
from synthetic_records import correlated
from synthetic_stick_slip import cycles

import ratestate as rs
from ratestate.records.stick_slip.catalogue import (
    CUT_BY_END,
    CUT_BY_START,
    GAP,
    LOAD_CHANGES,
    UNDERSAMPLED,
    WHOLE,
)
from ratestate.records.stick_slip.detection import turning_points
from ratestate.records.stick_slip.lines import trend

AGING = rs.SpringSlider(
    a=0.005, b=0.008, Dc="10 um", sigma="4 MPa", M=100, K="600 MPa/m", law="aging"
)
STEPS = rs.Loading.steps("3 um/s", (1300.0, "10 um/s"), (1750.0, "30 um/s"), (1900.0, "100 um/s"))


@pytest.fixture(scope="module")
def drawn():
    return cycles(12)


@pytest.fixture(scope="module")
def experiment():
    """Return a record with four speeds and noise, and the run without noise."""
    t = np.arange(0.0, 1950.0, 0.02)
    options = {"t_end": 1950.0, "V_start": "1 um/s"}
    run = rs.simulate(AGING, STEPS, times=t, **options)
    noise = 5e-4 * np.random.default_rng(1).normal(size=t.size)
    columns = {"friction": ("time", run.tau.values / AGING.sigma + noise)}
    columns["delta_lp"] = ("time", run.delta_lp.values)
    return xarray.Dataset(columns, {"time": t}), rs.simulate(AGING, STEPS, **options)


@pytest.fixture(scope="module")
def measured(experiment):
    return rs.events(experiment[0], sigma="4 MPa")


def test_runs_have_the_drops_and_periods_of_their_limit_cycles(drawn):
    for cycle in drawn:
        events = rs.events(cycle.run(4.2))
        assert 3 <= events.sizes["event"] <= 5
        whole = events.isel(event=events.event_status.values == WHOLE)
        assert whole.sizes["event"] >= 3
        np.testing.assert_allclose(whole.stress_drop, cycle.drop, rtol=1e-6)
        np.testing.assert_allclose(whole.recurrence[1:], cycle.period, rtol=1e-6)
        np.testing.assert_allclose(whole.peak_slip_rate, cycle.V_max, rtol=1e-4)
        assert (whole.stress_drop_error > 0.0).all()


def test_runs_of_even_samples_have_calibrated_errors(drawn):
    """With 1000 samples a period, errors are below 1e-3 or covered by the standard error."""
    for cycle in drawn:
        events = rs.events(cycle.run(3.2, 1000))
        use = np.isin(events.event_status, (WHOLE, UNDERSAMPLED))
        off = np.abs(events.stress_drop / cycle.drop - 1.0).values[use]
        error = (events.stress_drop_error / cycle.drop).values[use]
        assert use.sum() >= 2
        assert (off <= np.maximum(1e-3, 3.0 * error)).all()
        np.testing.assert_allclose(events.recurrence.values[use][1:], cycle.period, rtol=1e-3)


#: quantity -> largest mean z = error/standard error; bounds of fractions in 68 % and 95 % intervals
CALIBRATION = {
    "stress_drop": (0.25, (0.58, 0.78), (0.90, 0.99)),
    "tau_max": (0.25, (0.58, 0.80), (0.90, 0.99)),
    "tau_min": (0.25, (0.58, 0.80), (0.90, 0.99)),
    "event_time": (0.25, (0.58, 0.80), (0.90, 0.99)),
    "recurrence": (0.15, (0.66, 0.84), (0.90, 0.99)),
    "event_start": (0.65, (0.66, 0.84), (0.87, 0.985)),
    "event_end": (0.65, (0.66, 0.90), (0.87, 1.0)),
    "duration": (0.6, (0.66, 0.84), (0.90, 0.985)),
    "slip": (0.4, (0.70, 0.86), (0.92, 0.99)),
}


@pytest.fixture(scope="module")
def errors_over_their_estimates(drawn):
    """Return quantity -> errors divided by standard errors (n,) of 24 noisy records."""
    off: dict = {name: [] for name in CALIBRATION}
    for k, cycle in enumerate(drawn):
        exact = rs.events(cycle.run(8.2))
        exact = exact.isel(event=exact.event_status.values == WHOLE)
        for seed in range(2):
            rng = np.random.default_rng(10 * seed + k)
            samples, noise = 10 ** rng.uniform((2.3, -2.7), (2.9, -1.5))
            events = rs.events(cycle.record(8.2, samples, noise, rng), K=cycle.slider.K)
            events = events.isel(event=np.isin(events.event_status, (WHOLE, UNDERSAMPLED)))
            assert events.sizes["event"] in (7, 8)
            assert 0.7 < events.tau_noise / (noise * cycle.drop) < 1.3
            gaps = np.abs(events.event_time.values[:, None] - exact.event_time.values)
            true = exact.isel(event=gaps.argmin(axis=1))
            true["recurrence"] = xarray.full_like(true.recurrence, cycle.period)
            assert gaps.min(axis=1).max() < 0.1 * cycle.period
            for name, parts in off.items():
                parts.append((events[name].values - true[name].values) / events[f"{name}_error"])
    return {name: np.concatenate(parts) for name, parts in off.items()}


@pytest.mark.statistics
@pytest.mark.parametrize("name", CALIBRATION)
def test_errors_of_noisy_records_are_calibrated(errors_over_their_estimates, name):
    """Stresses are unbiased, times biased by 0.3 errors; benchmarks/events.py has 200 sliders.

    Bounds are three standard errors of 24 records, whose events are not independent.
    """
    z = errors_over_their_estimates[name]
    z = z[np.isfinite(z)]  # (the first event has no recurrence)
    bias, *parts = CALIBRATION[name]
    assert z.size > 160
    assert abs(z.mean()) < bias
    for level, (low, high) in zip((0.6827, 0.95), parts, strict=True):
        assert low < (np.abs(z) < norm.ppf(0.5 + 0.5 * level)).mean() < high


def test_correlated_noise_enlarges_errors(drawn):
    cycle = drawn[0]
    white, red = (
        rs.events(cycle.record(8.2, 600, 0.01, np.random.default_rng(1), correlation))
        for correlation in (0.0, 0.7)
    )
    assert white.tau_noise_correlation == 0.0
    assert 0.55 < red.tau_noise_correlation < 0.85
    assert float(red.stress_drop_error.median()) > 1.5 * float(white.stress_drop_error.median())


@pytest.mark.parametrize(("time", "most"), [(None, 0), (1.0, 2), (10.0, 2)])
def test_noise_has_no_event(time, most):
    """Noise that wanders rises as fast as it falls, at irregular times."""
    t, found = np.arange(0.0, 600.0, 0.1), []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        wanders = correlated(t, time, rng) if time else rng.normal(size=t.size)
        friction = 0.6 + 1e-3 * wanders + 1e-4 * rng.normal(size=t.size)
        columns = {"friction": ("time", friction), "delta_lp": ("time", 3e-6 * t)}
        events = rs.events(xarray.Dataset(columns, {"time": t}), sigma="5 MPa")
        found.append(events.sizes["event"])
        assert found[-1] or all("0 whole events" in text for text in events.trend_message.values)
    assert sum(number > 0 for number in found) <= most


@pytest.fixture(scope="module")
def sawtooth():
    """Return ten cycles of 21 s, with a fall of 100 kPa in 1 s and noise of 2 kPa."""
    t = np.arange(0.0, 215.0, 0.1)
    tau = 5e6 + 1e5 * np.interp((t + 5.0) % 21.0, [0.0, 20.0, 21.0], [0.0, 1.0, 0.0])
    tau += 2e3 * np.random.default_rng(0).normal(size=t.size)
    columns = {"tau": ("time", tau), "delta_lp": ("time", 1e-5 * t)}
    return xarray.Dataset(columns, {"time": t})


def test_peak_slip_rates_of_few_samples_are_means(sawtooth):
    events = rs.events(sawtooth, K="500 MPa/m")
    assert (events.event_status == UNDERSAMPLED).sum() >= 9
    ratio = (events.peak_slip_rate / (1e-5 + 1e5 / 5e8)).values  # V_lp + drop/(1 s K)
    assert 0.95 < np.nanmean(ratio) < 1.05
    assert 0.02 < np.nanstd(ratio) < 0.12  # noise in 5 samples gives 6 %
    assert events.peak_slip_rate_error.isnull().all()
    assert ["lower bound" in text for text in events.event_message.values] == (
        events.event_status == UNDERSAMPLED
    ).values.tolist()


@pytest.mark.parametrize(("lost", "is_gap"), [((152, 190), True), ((30, 100), False)])
def test_events_in_a_gap_are_not_measured(sawtooth, lost, is_gap):
    """The first fall is from 15 to 16 s; a gap in the loading does not affect it."""
    keep = np.ones(sawtooth.sizes["time"], bool)
    keep[slice(*lost)] = False
    events = rs.events(sawtooth.isel(time=keep), K="500 MPa/m")
    first = events.isel(event=0)
    assert (first.event_status == GAP) == is_gap
    assert np.isnan(first.stress_drop) == is_gap
    assert ("samples are missing" in first.event_message.item()) == is_gap
    assert np.isnan(events.recurrence[1]) == is_gap
    off = (events.stress_drop[1:] - 1e5) / events.stress_drop_error[1:]
    assert np.abs(off).max() < 4.0


def test_two_clean_drops_are_events(drawn):
    """The records begin and end in the middle of loading; noise is 1 % of the drop."""
    records = [c.record(2, 600, 0.01, np.random.default_rng(i)) for i, c in enumerate(drawn[:6])]
    found = [rs.events(record, K="1 GPa/m").sizes["event"] for record in records]
    assert found.count(2) == 5  # the sixth is a smooth oscillation


def test_records_of_several_speeds(measured, experiment):
    simulated = rs.events(experiment[1])
    assert measured.sizes["event"] == simulated.sizes["event"] == 29
    assert measured.event_status[0] == CUT_BY_START
    both = slice(1, None)
    off = (measured.stress_drop - simulated.stress_drop).values[both]
    z = off / measured.stress_drop_error.values[both]
    assert np.abs(z).max() < 4.5
    assert 0.5 < z.std() < 1.6
    np.testing.assert_allclose(measured.K, AGING.K, atol=4.0 * float(measured.K_error), rtol=0.0)
    assert 1e-4 < float(measured.K_error / measured.K) < 0.01
    for name, within in (("slip", 0.05), ("duration", 3.0)):
        known = np.flatnonzero(measured[name].notnull().values)
        assert known.size > 25  # (a duration may be less than a step between samples)
        both = np.intersect1d(known, np.arange(1, 29))
        off = (measured[name] - simulated[name]).values[both]
        assert np.abs(off / measured[f"{name}_error"].values[both]).max() < 4.5
        np.testing.assert_allclose(measured[name][both], simulated[name][both], rtol=within)
    assert (measured.duration[both] >= 0.0).all()
    changed = ["V_lp has changed" in text for text in measured.event_message.values]
    assert np.flatnonzero(changed).tolist() == [6, 13, 20]
    assert measured.recurrence[changed].isnull().all()
    expected = [3e-6] * 6 + [1e-5] * 7 + [3e-5] * 7 + [1e-4] * 9
    np.testing.assert_allclose(measured.V_lp[1:], expected[1:], rtol=1e-3)


def test_stress_drop_grows_with_the_logarithm_of_recurrence(measured, experiment):
    """As in section 3.2 of the paper, the drops of the limit cycles lie on the line."""
    B, error = (measured.trend_B.sel(abscissa="recurrence"), measured.trend_B_error[0])
    V = np.array([3e-6, 1e-5, 3e-5, 1e-4])
    exact = [rs.limit_cycle(AGING, float(one)) for one in V]
    drops = [float(cycle.amplitude) * AGING.sigma for cycle in exact]
    times = [float(cycle.period) for cycle in exact]
    slope = np.polyfit(np.log10(times), drops, 1)[0]
    assert abs(B - slope) < 3.0 * error
    assert 0.0 < error < 0.1 * B
    assert measured.trend_B.sel(abscissa="V_lp") < -10.0 * measured.trend_B_error[1]
    assert measured.trend_events.values.tolist() == [24, 24]


def test_work_and_energy_are_integrals(experiment):
    run = experiment[1]
    events = rs.events(run)
    for k in (3, 12):
        one = events.isel(event=k)
        inside = run.sel(time=slice(float(one.event_start), float(one.event_end)))
        work = trapezoid(inside.tau.values, inside.delta.values)
        assert float(one.friction_work) == pytest.approx(work, rel=3e-3)  # (trapezoid rule)
        assert float(one.slip) == pytest.approx(float(np.ptp(inside.delta.values)), rel=3e-3)
        stored = (float(one.tau_max) ** 2 - float(one.tau_min) ** 2) / (2.0 * AGING.K)
        assert float(one.spring_energy) == pytest.approx(stored, rel=1e-9)
        assert float(one.friction_drop) == pytest.approx(float(one.stress_drop) / AGING.sigma)


@pytest.mark.parametrize(("M", "kind"), [(100.0, "fast"), (1e-4, "slow")])
def test_slip_limited_by_inertia_is_fast(M, kind):
    """Near critical stiffness slip is slow; with enough mass, inertia limits it."""
    K = AGING.sigma * (AGING.b - AGING.a) / AGING.Dc * (0.5 if kind == "fast" else 0.97)
    damping, t_end = ({}, 150.0) if kind == "fast" else ({"damping": 1e8}, 60.0)
    slider = dataclasses.replace(AGING, M=M, K=K, **damping)
    run = rs.simulate(slider, rs.Loading.constant("10 um/s"), t_end, V_start="5 um/s")
    events = rs.events(run)
    assert events.sizes["event"] > 1
    assert set(events.event_kind.values[1:-1].tolist()) == {kind}
    # if the mass is unknown, the ratio to V_lp decides
    unknown = rs.events(run[["tau", "delta_lp"]].drop_attrs(), K=K)
    ratio = (unknown.peak_slip_rate / unknown.V_lp).values
    assert ((unknown.event_kind == "fast").values == (ratio >= 100.0)).all()


def test_events_that_are_not_whole_have_a_message(experiment):
    run = experiment[1]
    whole = rs.events(run)
    middle = float(whole.event_start[3]), float(whole.event_time[5])
    part = rs.events(run.sel(time=slice(middle[0] + 1e-3, middle[1])))
    assert part.event_status.values.tolist() == [CUT_BY_START, WHOLE, CUT_BY_END]
    assert part.stress_drop.isnull().values.tolist() == [True, False, True]
    assert part.event_message.values.tolist() == [
        "cut by the record's start",
        "the last event is not whole",
        "cut by the record's end",
    ]
    # V_lp rises while the block slips
    t = np.linspace(0.0, 400.0, 4001)
    y = 2e6 - 1e5 * np.abs((t % 100.0) / 50.0 - 1.0)
    columns = {"tau": ("time", y), "V_load": ("time", np.where(t < 175.0, 1e-6, 1e-5))}
    events = rs.events(xarray.Dataset(columns, {"time": t}), K="1 GPa/m")
    assert LOAD_CHANGES in events.event_status.values
    assert "V_lp changes during the event" in events.event_message.values[1]


def test_a_smooth_oscillation_has_no_stiffness():
    """The block slips throughout, so K must be given; else quantities that need K are NaN."""
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", M=3000, K="900 MPa/m")
    t = np.arange(0.0, 0.4, 2e-4)
    loading = rs.Loading.constant("3.3 mm/s")
    run = rs.simulate(slider, loading, 2.4, V_start="3 mm/s", times=2.0 + t)
    record = run[["tau", "delta_lp"]].drop_attrs()
    events = rs.events(record)
    period = float(rs.limit_cycle(slider, "3.3 mm/s").period)
    assert events.sizes["event"] == pytest.approx(0.4 / period, abs=1.5)  # one a period
    assert events["K"].isnull()
    assert events.slip.isnull().all()
    assert "Give K" in events.attrs["stiffness"]
    assert all("stiffness is unknown" in text for text in events.event_message.values)
    known = rs.events(record, K="900 MPa/m")
    assert known.slip[1:-1].notnull().all()


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (lambda data: data.drop_vars("friction"), "neither tau nor friction"),
        (lambda data: data.drop_vars("delta_lp"), "neither delta_lp nor V_load"),
        (lambda data: data.isel(time=slice(20)), "20 samples"),
        (lambda data: data.isel(time=slice(None, None, -1)), "times must increase"),
        (lambda data: data.assign(friction=data.friction.where(data.time != 1.0)), "row 50"),
        (lambda data: data.to_dataarray(), "DataArray"),
        (lambda data: data.expand_dims(K=2), "ick one case"),
    ],
)
def test_other_records_are_refused(experiment, change, text):
    with pytest.raises(rs.ParameterError, match=text):
        rs.events(change(experiment[0]), sigma="4 MPa")


def test_friction_alone_needs_a_normal_stress(experiment):
    with pytest.raises(rs.ParameterError, match="Give sigma"):
        rs.events(experiment[0])
    with pytest.raises(rs.ParameterError, match="no parameter least"):
        rs.events(experiment[0], least=1.0)


@given(st.lists(st.floats(-1e6, 1e6), min_size=3, max_size=60), st.floats(1e-3, 1e5))
def test_turning_points_alternate_and_are_far_apart(values, threshold):
    y = np.array(values)
    turns = turning_points(y, threshold)
    for (i, one), (j, other) in itertools.pairwise(turns):
        assert i < j
        assert one == -other
        assert one * (y[i] - y[j]) > threshold
        assert one * y[i] == (one * y[i : j + 1]).max()


def test_errors_of_lines_are_calibrated():
    """Events at seven speeds share a deviation from the line: 95 % intervals of B."""
    rng = np.random.default_rng(7)
    V = np.repeat([1e-6, 3e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3], 8)
    shared = np.repeat(np.arange(7), 8)
    held = []
    for _ in range(400):
        drop = (
            1e5 - 2e4 * np.log10(V) + 3e3 * rng.normal(size=7)[shared] + 1e3 * rng.normal(size=56)
        )
        line = trend(V, drop, V, "V_lp")
        held.append(abs(line.B + 2e4) < 2.2 * line.B_error)
    assert 0.85 < np.mean(held) < 0.99
    assert trend(V[:8], drop[:8], V[:8], "V_lp").message.startswith(
        "V_lp varies by a factor of only 1"
    )
