"""Runs against states in quad precision."""

import math

import numpy as np
import pytest
from quad_precision import TABLE

import ratestate as rs


@pytest.mark.parametrize("name", TABLE)
def test_states_equal_those_in_quad_precision(name):
    parameters, law, V_start, V_lp, t, *exact = TABLE[name]
    slider, loading = rs.SpringSlider(**parameters, law=law), rs.Loading.constant(V_lp)
    found = rs.simulate(slider, loading, t, V_start=V_start, rtol=1e-10, times=[t]).isel(time=-1)
    state = (
        float(found.tau) / parameters["sigma"] - parameters["mu0"],
        math.log(found.V / parameters["V0"]),
        math.log(parameters["V0"] * found.theta / parameters["Dc"]),
    )
    np.testing.assert_allclose(state, exact[:3], rtol=0, atol=2e-8)
