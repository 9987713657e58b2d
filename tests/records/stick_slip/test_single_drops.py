"""A record with one drop of friction, or with none: what is an event, however it is sampled."""

import numpy as np
import pytest
import xarray

import ratestate as rs


def found(t, friction):
    """Events of a record at 1 um/s and 5 MPa."""
    columns = {"friction": ("time", friction), "delta_lp": ("time", 1e-6 * t)}
    return rs.events(xarray.Dataset(columns, {"time": t}), sigma="5 MPa", K="1 GPa/m")


@pytest.mark.parametrize("dense", [3, 100, 2000])
@pytest.mark.parametrize(("fall", "number"), [(1.0, 1), (40.0, 1), (160.0, 0)])
def test_a_drop_is_as_steep_as_it_is_in_time(fall, number, dense):
    """It is recorded faster than the loading of 1000 s before it, as if triggered."""
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
    assert found(t, friction).sizes["event"] == number
