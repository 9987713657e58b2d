"""Slip so slow that inertia is below rounding, and rest."""

import numpy as np
import pytest

import ratestate as rs


@pytest.mark.parametrize("law", ["slip", "aging"])
def test_negligible_inertia_leaves_the_quasi_static_motion(law):
    # eta0 w is 1e-43 and less: V rises by ten e-folds a step, which once threw v off tau = sigma mu
    slider = rs.SpringSlider(
        a=0.00186, b=0.00804, Dc="9.56 um", sigma="712 MPa", K=7.4e10, M=3.5, law=law
    )
    loading = rs.Loading.constant(3.1e-11)
    times = np.linspace(0, 1.0e6, 50)[1:]  # the first instability comes after 1.1e6 s
    run, quasi_static = (
        rs.simulate(s, loading, 1.0e6, V_start=4.1e-13, times=times)
        for s in (slider, slider.replace(M=0))
    )
    for name in ("V", "theta", "tau"):
        np.testing.assert_allclose(run[name], quasi_static[name], rtol=2e-5)
    assert float(abs(run.tau / slider.sigma - run.mu).max()) < 1e-12
    # between instabilities speeds span 100 e-folds, and the run must come out of each
    cycle = rs.limit_cycle(slider, 3.1e-11)
    assert 1e7 < float(cycle.period) < 1e9
    assert float(cycle.V_max) / float(cycle.V_min) > 1e30


@pytest.mark.parametrize("law", ["slip", "aging"])
def test_a_heavy_mass_stops_and_starts_again(law):
    # the spring's swing would take V below zero; V = 0 is not in eq. 1, so it sticks for a while
    slider = rs.SpringSlider(
        a=0.0228, b=0.1108, Dc="0.126 um", sigma=11911, M=731068, K=3.9e10, law=law
    )
    cycle = rs.limit_cycle(slider, 0.0106)
    assert int(cycle.status) == 0
    assert 0 < float(cycle.V_min) < 1e-100
    assert 2 * 0.0106 < float(cycle.V_max) < 4 * 0.0106


def test_a_slider_thrown_far_back_is_at_rest_in_few_steps():
    # x falls to -2e5: ln V follows it to -2e5, which is rest, and must not be stepped through
    slider = rs.SpringSlider(
        a=0.0045, b=0.0182, Dc="0.898 mm", sigma=17456, M=31, K=135400, law="aging"
    )
    run = rs.simulate(slider, rs.Loading.constant(6.92), 0.0335, V_start=6871.0)
    assert 1000 < int(run.steps) < 30000
    assert 0 < float(run.V_min) < 1e-200
    assert abs(float(run.energy_residual)) < 1e-5
    assert np.isfinite(run.drop_vars("mu").to_array().values).all()
    assert np.isnan(run.mu[-1])  # V is beyond double precision there
    assert -1000 < float(run.mu_min) < -700  # friction follows the spring, 0.0045 times -2e5
