"""Events that samples or noise hide: close, small and short events, and few digits."""

import numpy as np
import pytest
import xarray
from synthetic_stick_slip import sawtooth

import ratestate as rs
from ratestate.records.kit.sample_noise import SampleNoise, rounding
from ratestate.records.stick_slip.between_samples import has_several
from ratestate.records.stick_slip.catalogue import SEVERAL, UNDERSAMPLED, WHOLE
from ratestate.records.stick_slip.detection import without_rebounds

DROP = 1e5


def messages(events):
    return [str(text) for text in events.event_message.values]


@pytest.fixture(scope="module")
def damped():
    """Return times, friction and true drop [Pa] of 8 events of a slider with damping.

    Friction of the block overshoots by 2 % of the drop, for less than a step between samples.
    """
    values = {"a": 0.001, "b": 0.0015, "Dc": "30 um", "sigma": "10 MPa", "K": "100 MPa/m"}
    slider = rs.SpringSlider(**values, damping="5 MPa s/m", V0="1 um/s", law="aging")

    def friction(t):
        how = {"V_start": "1 um/s", "times": t, "rtol": 1e-9}
        return rs.simulate(slider, "10 um/s", 500.0, **how).mu.values

    t = np.linspace(0.0, 500.0, 10000)
    peak = friction(np.linspace(200.0, 202.0, 2001)).max()
    trough = friction(np.linspace(203.6, 203.8, 2001)).min()
    return t, friction(t), 1e7 * (peak - trough)


@pytest.mark.parametrize(
    ("noise", "digits", "error"),
    [(0.0, 12, (300.0, 2e3)), (1e-5, 8, (300.0, 2e3)), (0.0, 3, (4082.0, 1e4))],
)
def test_records_without_noise_have_events(damped, noise, digits, error):
    """Errors cover an overshoot between samples, and at least the rounding error."""
    t, friction, true = damped
    friction = friction + noise * np.random.default_rng(0).normal(size=t.size)
    columns = {"friction": ("time", friction.round(digits)), "delta_lp": ("time", 1e-5 * t)}
    events = rs.events(xarray.Dataset(columns, {"time": t}), sigma="10 MPa", K="100 MPa/m")
    assert events.sizes["event"] == 8
    drop, drop_error = events.stress_drop.values[2:], events.stress_drop_error.values[2:]
    assert true == pytest.approx(53.17e3, rel=1e-3)
    assert (np.abs(drop - true) < 2.5 * drop_error).all()
    assert drop.mean() == pytest.approx(true, abs=max(600.0, 0.3 * error[0]))
    assert (drop_error > error[0]).all()
    assert (drop_error < error[1]).all()
    np.testing.assert_allclose(events.recurrence[2:], 62.02, atol=0.02)


def test_a_rebound_does_not_separate_two_events():
    """A rebound rises faster than the spring loads; a slower rise separates two events."""
    y = np.array([0.0, 10.0, 20.0, 30.0, 5.0, 8.0, 4.0, 14.0, 24.0])
    falls = np.array([(3, 4), (5, 6), (8, -1)])
    swings = np.array([0.0, 1.0, 2.0, 3.0, 3.1, 3.19, 3.2, 4.2, 5.2])
    loads = np.array([0.0, 1.0, 2.0, 3.0, 3.1, 3.4, 3.5, 4.5, 5.5])
    assert without_rebounds(y, swings, falls).tolist() == [[3, 6], [8, -1]]
    assert without_rebounds(y, loads, falls).tolist() == falls.tolist()


def test_errors_of_times_include_their_rounding():
    """1.3 samples a second, with times rounded to 0.5 s or exact."""
    rng = np.random.default_rng(1)
    starts = 100.0 * np.arange(1, 9) + rng.uniform(-1.0, 1.0, 8)
    record = sawtooth(starts, np.full(8, DROP), 20.0, rng, 1e2).record
    t = record.time.values / 1.3
    rounded, rows = np.unique(np.round(2.0 * t), return_index=True)
    fine = rs.events(record.assign_coords(time=t + 0.01 * np.sin(t)))
    coarse = rs.events(record.isel(time=rows).assign_coords(time=rounded / 2.0))
    assert float(fine.event_time_error.median()) < 0.1
    assert (coarse.event_time_error > 0.14).all()
    assert rounding(np.array([0.0, 0.3, 0.3, 0.6])) == pytest.approx(0.3 / 12**0.5)


@pytest.mark.parametrize(
    ("gap", "noise"), [(3.0, 1e-3), (3.0, 0.05), (6.0, 0.02), (12.0, 1e-3), (12.0, 0.05)]
)
def test_close_events_are_separated_or_reported(gap, noise):
    """Two close events are found as two, or reported as several, or as a large event."""
    rng = np.random.default_rng(0)
    starts = np.sort([*(100.0 * np.arange(1, 9) + rng.uniform()), 400.0 + gap])
    truth = sawtooth(starts, DROP * rng.uniform(0.7, 1.3, 9), 1.0, rng, noise * DROP)
    events = rs.events(truth.record, K=truth.K)
    several = events.event_status.values == SEVERAL
    large = np.array(["it may be several events" in text for text in messages(events)])
    assert (several | large).sum() <= 1
    assert events.sizes["event"] == (8 if (several | large).any() else 9)
    near = [int(np.abs(truth.times - x).argmin()) for x in events.event_time.values]
    off = (events.stress_drop.values - truth.drops[near]) / events.stress_drop_error.values
    assert np.abs(off[np.isfinite(off) & ~large]).max() < 4.5
    late = (events.event_time.values - truth.times[near]) / events.event_time_error.values
    assert np.abs(late[np.isfinite(late) & ~large]).max() < 4.5
    reported = ["this fall is several events" in text for text in messages(events)]
    assert reported == several.tolist()
    for name in ("stress_drop", "duration", "slip", "peak_slip_rate", "friction_work"):
        half = events[f"{name}_error"].values >= 0.5 * np.abs(events[name].values)
        assert (half | np.isnan(events[f"{name}_error"].values))[several].all()


def test_a_single_fall_is_not_several():
    rng, t = np.random.default_rng(0), np.arange(200.0)
    fall = -DROP * (0.5 + np.arctan((t - 100.0) / 8.0) / np.pi)
    for noise in (10.0, 0.03 * DROP):
        many = [fall + noise * rng.normal(size=t.size) for _ in range(100)]
        assert not any(has_several(y, (0, 20, 180, 199), SampleNoise(noise)) for y in many)
    two = 0.5 * (fall + np.roll(fall, 70))
    assert has_several(two, (0, 20, 190, 199), SampleNoise(0.02 * DROP))


@pytest.mark.parametrize(("size", "found"), [(0.02, False), (0.2, True)])
def test_small_falls_in_the_loading_are_reported(size, found):
    """A fall of 0.2 drops in noise of 0.05 drops is below the threshold, but significant."""
    count = 0
    for seed in range(2):
        rng = np.random.default_rng(seed)
        starts = np.sort([*(200.0 * np.arange(1, 7)), 500.0])
        drops = np.where(starts == 500.0, size * DROP, DROP)
        truth = sawtooth(starts, drops, 1.0, rng, 0.05 * DROP)
        events = rs.events(truth.record, K=truth.K)
        assert events.sizes["event"] == 6
        assert float(events.detection_threshold) > size * DROP
        reported = ["may span two events" in text for text in messages(events)]
        count += reported[2]
        assert not any(reported[:2] + reported[3:])
    assert count == (2 if found else 0)


@pytest.mark.parametrize(("noise", "expected"), [(0.02, False), (0.1, True)])
def test_drops_close_to_the_threshold_are_reported(noise, expected):
    rng = np.random.default_rng(2)
    truth = sawtooth(60.0 * np.arange(1, 9), np.full(8, DROP), 1.0, rng, noise * DROP)
    events = rs.events(truth.record, K=truth.K)
    assert 8.0 < float(events.detection_threshold / events.tau_noise) < 12.0 or expected
    near = ["similar events may be missing" in text for text in messages(events)]
    measured = np.isfinite(events.stress_drop.values)
    close = (events.stress_drop < 2.0 * events.detection_threshold).values
    np.testing.assert_array_equal(np.array(near)[measured], close[measured])
    assert close.any() == expected


def test_durations_below_a_step_are_not_resolved():
    """A duration of 0.2 steps between samples is NaN, or has an error of that size; 20 are 20."""
    rng = np.random.default_rng(3)
    starts = 100.0 * np.arange(1, 11) + rng.uniform(0.0, 1.0, 10)
    short, long = (
        rs.events(sawtooth(starts, np.full(10, DROP), width, rng, 1e3).record)
        for width in (0.2, 20.0)
    )
    unresolved = short.duration.isnull().values
    assert unresolved.sum() >= 3
    assert ["less than one step between samples" in x for x in messages(short)] == [*unresolved]
    assert (short.duration - 0.2 < 4.0 * short.duration_error).values[~unresolved].all()
    assert not any("may be several" in text for text in [*messages(short), *messages(long)])
    np.testing.assert_allclose(long.duration, 19.0, atol=4.0)


@pytest.mark.parametrize(("noise", "uneven"), [(0.01, 0.0), (0.1, 0.8), (0.2, 0.0)])
def test_noise_does_not_bias_drops(noise, uneven):
    """Noise is at most a fifth of the drop; benchmarks/events.py has 9 records of each kind."""
    off, relative = [], []
    for seed in range(3):
        rng = np.random.default_rng(seed)
        starts = np.cumsum(200.0 * np.exp(0.1 * rng.normal(size=8)))
        truth = sawtooth(starts, np.full(8, DROP), 2.0, rng, noise * DROP, uneven=uneven)
        events = rs.events(truth.record, K=truth.K)
        use = np.isin(events.event_status, (WHOLE, UNDERSAMPLED)) & events.stress_drop.notnull()
        events = events.isel(event=use.values)
        assert events.sizes["event"] >= 7
        near = [int(np.abs(truth.times - x).argmin()) for x in events.event_time.values]
        off.append((events.stress_drop.values - truth.drops[near]) / events.stress_drop_error)
        relative.append(events.stress_drop.values / truth.drops[near] - 1.0)
    off, relative = np.concatenate(off), np.concatenate(relative)
    assert abs(np.median(relative)) < 0.005 + 0.25 * noise
    assert 0.5 < (np.abs(off) < 1.0).mean() < 0.97
    assert (np.abs(off) < 2.0).mean() > 0.87
