"""A slope follows the load point as it moved, overshoots included."""

import numpy as np
import pytest
import xarray

import ratestate as rs

SLIDER = rs.SpringSlider(
    law="aging", a=0.009, b=0.012, Dc="10 um", sigma="10 MPa", K="12 GPa/m", V0="10 um/s"
)


@pytest.mark.parametrize(("excess", "lasts"), [(0.06, 0.088), (0.1, 0.05), (0.0, 0.05)])
def test_an_overshoot_does_not_move_the_stiffness(excess, lasts):
    """The spring loads within 50 ms, all of it at the overshoot's speed."""
    V = 1e-4
    loading = rs.Loading.steps("10 um/s", (60, V * (1.0 + excess)), (60 + lasts, V))
    t = np.concatenate([np.arange(0, 59, 0.05), np.arange(59, 66, 0.005)])
    run = rs.simulate(SLIDER, loading, t[-1], times=t, rtol=1e-9)
    noise = 1e-4 * np.random.default_rng(1).normal(size=t.size)
    segments = {"segment_t": ("segment", loading.t), "segment_V": ("segment", loading.V)}
    record = xarray.Dataset(segments | {"delta_lp": ("time", run.delta_lp.values)}, {"time": t})
    friction = ("time", run.tau.values / 10e6 + noise)
    result = rs.machine_stiffness(record.assign(friction=friction), "10 MPa")
    assert result.slope_kind.values.tolist() == ["step_up"]
    assert result.slope_start.values == pytest.approx([60.0], abs=1e-12)
    assert float(result.K) == pytest.approx(12e9, rel=0.025)
    assert float(result.K_error) < 0.04 * 12e9
