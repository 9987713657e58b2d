"""The reference values: quad-precision states, and the amplitudes of the paper."""

import math

import numpy as np
import pytest
from quad_precision import FIG2, STICK, TABLE

import ratestate as rs


@pytest.mark.parametrize("name", TABLE)
def test_states(name):
    parameters, law, V_start, V_lp, t, *exact = TABLE[name]
    slider, loading = rs.SpringSlider(**parameters, law=law), rs.Loading.constant(V_lp)
    found = rs.simulate(slider, loading, t, V_start=V_start, rtol=1e-10, times=[t]).isel(time=-1)
    state = (
        float(found.tau) / parameters["sigma"] - parameters["mu0"],
        math.log(found.V / parameters["V0"]),
        math.log(parameters["V0"] * found.theta / parameters["Dc"]),
    )
    np.testing.assert_allclose(state, exact[:3], rtol=0, atol=2e-8)


@pytest.mark.parametrize(
    ("law", "V_lp", "amplitude", "frequency"),
    [
        ("slip", 1e-4, 0.04696781, 0.4192088),
        ("slip", 1e-2, 0.01899449, 74.91234),
        ("slip", 1e-1, 0.02583319, 380.3364),
        ("slip", 1.0, 0.1654362, 487.4721),
        ("aging", 1e-2, 0.03625932, 53.27594),
    ],
)
def test_figures_4_and_5(law, V_lp, amplitude, frequency):
    found = rs.limit_cycle(rs.SpringSlider(**STICK, law=law), V_lp)
    assert float(found.amplitude) == pytest.approx(amplitude, rel=1e-6)
    assert float(found.frequency) == pytest.approx(frequency, rel=3e-7)
    assert found.frequency < 493.2  # f_n, never passed


@pytest.mark.parametrize(
    ("law", "amplitude", "frequency"),
    [("slip", 0.00569786, 2.962584), ("aging", 0.01961776, 2.222700)],
)
def test_figure_6(law, amplitude, frequency):
    found = rs.limit_cycle(rs.SpringSlider(**FIG2 | {"K": 1.0005 * 6e8}, law=law), 2e-4)
    assert float(found.amplitude) == pytest.approx(amplitude, rel=1e-6)
    assert float(found.frequency) == pytest.approx(frequency, rel=3e-7)
