"""Detection in records with one drop of friction or none, for different sampling."""

import numpy as np
import pytest
import xarray

import ratestate as rs
from ratestate.records.stick_slip.detection import without_outliers


def events_of(t, friction):
    """Return the events of a record at 1 um/s and 5 MPa."""
    columns = {"friction": ("time", friction), "delta_lp": ("time", 1e-6 * t)}
    return rs.events(xarray.Dataset(columns, {"time": t}), sigma="5 MPa", K="1 GPa/m")


@pytest.mark.parametrize("dense", [3, 100, 2000])
@pytest.mark.parametrize(("fall", "number"), [(1.0, 1), (40.0, 1), (160.0, 0)])
def test_detection_does_not_depend_on_triggered_sampling(fall, number, dense):
    """The drop is sampled faster than the 1000 s of loading before it."""
    ends = 1000.0 + fall, 1100.0 + fall, 1500.0 + fall
    t = np.concatenate(
        [
            np.arange(0.0, 1000.0, 2.0),
            np.linspace(1000.0, ends[0], dense, endpoint=False),
            np.arange(ends[0], ends[2], 2.0),
        ]
    )
    friction = np.interp(t, [0.0, 1000.0, *ends], [0.5, 0.7, 0.52, 0.5, 0.54])
    friction += 1e-4 * np.random.default_rng(1).normal(size=t.size)
    assert events_of(t, friction).sizes["event"] == number


def loading(seed=0, noise=1e-3):
    """Return times and friction of 1000 s of slow loading with noise."""
    t = np.arange(1000.0)
    return t, 0.6 + 1e-5 * t + noise * np.random.default_rng(seed).normal(size=t.size)


@pytest.mark.parametrize("size", [0.03, -0.03, 0.3, -0.3])
@pytest.mark.parametrize("samples", [1, 2])
def test_an_outlier_is_not_an_event(samples, size):
    for seed in range(10):
        t, friction = loading(seed)
        friction[600 : 600 + samples] += size
        assert events_of(t, friction).sizes["event"] == 0


@pytest.mark.parametrize("back", [0.0, 0.5, 0.8])
@pytest.mark.parametrize("outlier", [0.0, 0.1, -0.1])
def test_a_drop_within_one_step_is_an_event(outlier, back):
    """Friction stays low after the drop; its first sample is lower by a fraction of the drop."""
    t, friction = loading(noise=2e-4)
    friction[600:] -= 0.03
    friction[600] -= 0.03 * back
    friction[580] += outlier
    friction[620] += outlier
    events = events_of(t, friction)
    assert events.sizes["event"] == 1
    assert float(events.event_time[0]) == pytest.approx(599.5, abs=1.0)


def test_outliers_next_to_drops_do_not_change_events():
    t = np.arange(0.0, 400.0)
    friction = 0.6 + 1e-3 * (t % 40.0) + 1e-4 * np.random.default_rng(0).normal(size=t.size)
    clean = events_of(t, friction)
    assert clean.sizes["event"] == 9
    friction[[60, 100, 150, 219, 300, 301]] += [0.05, -0.05, 0.05, -0.05, 0.1, 0.1]
    events = events_of(t, friction)
    np.testing.assert_allclose(events.event_time, clean.event_time, atol=1.0)


@pytest.mark.parametrize(
    "y",
    [
        [0, 0, 0, 0, 4.9, 0, 0, 0, 0],  # within the noise
        [0, 0, 0, 9, 9, 9, 0, 0, 0],  # of three samples
        [0, 0, 0, 0, 9, -9, -9, -9, -9],  # a peak before a drop
        [9, 9, 9, 9, -8, 0, 0, 0, 0],  # a trough after a drop
        [9, 0, 0, 0, 0, 0, 0, 0, 9],  # ends
        [9, 0, 3, 6, 9, 0, 3, 6, 9],  # few samples a period
    ],
)
def test_other_samples_are_not_replaced(y):
    np.testing.assert_array_equal(without_outliers(np.array(y, float), 1.0), y)
