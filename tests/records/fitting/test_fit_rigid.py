"""Fits with K = inf: the friction of a machine that is rigid, or is taken for it."""

import numpy as np
import pytest
from synthetic_records import record

import ratestate as rs

RIGID = rs.SpringSlider(a=0.008, b=0.010, Dc=1e-5, sigma=1e7, V0=1e-6, K=np.inf, law="slip")
T = np.arange(600) * 0.3


@pytest.mark.parametrize("law", ["slip", "aging"])
@pytest.mark.parametrize("speeds", [(1e-6, 5e-6, 2e-6), (5e-6, 1e-6, 1e-5)], ids=["up", "down"])
def test_a_sample_at_the_time_of_a_step_is_that_after_it(law, speeds):
    """As `simulate` has it; the steps are at samples, 200 and 400."""
    loading = rs.Loading.steps(speeds[0], (T[200], speeds[1]), (T[400], speeds[2]))
    data = record(RIGID, loading, T, noise=1e-5, law=law).drop_vars("delta_lp")
    rigid = RIGID.replace(law=law)
    result = rs.fit(data, rigid, free=("a", "b", "Dc"), loading=loading, errors="covariance")
    off = result.friction_fit - data.friction
    assert np.abs(off).max() < 5e-5
    for name in ("a", "b", "Dc"):
        error = float(result.standard_error.sel(parameter=name))
        assert 0.0 < error < 0.01 * getattr(RIGID, name)
        assert abs(float(result[name]) - getattr(RIGID, name)) < 4.0 * error
