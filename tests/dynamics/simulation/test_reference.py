"""The reference values: quad-precision states, limit cycles by shooting, amplitudes of the paper.

The states are those of ../shared/numerics.md, section 5.  Its periods and amplitudes are means over
the last three cycles before t, of which P1, P4a and P4b had not quite settled: where simulate
measures the same three cycles they agree to 1e-8, with the settled cycle to 1e-6 only.  The oracle
of the settled cycle is a root of the return map by SciPy's LSODA (naive.py).
"""

import math

import naive
import numpy as np
import pytest
from quad_precision import FIG2, STICK, TABLE

import ratestate as rs

names = pytest.mark.parametrize("name", TABLE)


def run(name, rtol, t_end=None, **settings):
    parameters, law, V_start, V_lp, t, *_ = TABLE[name]
    slider = rs.SpringSlider(**parameters, law=law)
    t = t_end or t
    loading = rs.Loading.constant(V_lp)
    return rs.simulate(slider, loading, t, V_start=V_start, rtol=rtol, **{"times": [t]} | settings)


def errors(name, rtol):
    parameters = TABLE[name][0]
    found = run(name, rtol).isel(time=-1)
    state = (
        float(found.tau) / parameters["sigma"] - parameters["mu0"],
        math.log(found.V / parameters["V0"]),
        math.log(parameters["V0"] * found.theta / parameters["Dc"]),
    )
    return np.abs(np.subtract(state, TABLE[name][5:8]))


@names
def test_states(name):
    assert (errors(name, 1e-10) < 2e-8).all()


@names
def test_states_at_the_default_tolerance(name):
    found = errors(name, 1e-6)
    assert (found < 500e-6).all()
    assert found.max() > 1e-8  # or the tolerance had no effect


@names
def test_cycles_before_t(name):
    """Mean period and amplitude of the last three complete cycles."""
    t, period, amplitude = TABLE[name][4], *TABLE[name][8:]
    cycles = [run(name, 1e-10, t - k * period) for k in range(3)]
    assert np.mean([1 / c.frequency for c in cycles]) == pytest.approx(period, rel=1e-8)
    # P4b's amplitude still changes by 4e-7 a cycle, so it depends on which minima were counted
    tolerance = 3e-7 if name == "P4b" else 1e-8
    assert np.mean([c.amplitude for c in cycles]) == pytest.approx(amplitude, rel=tolerance)


@pytest.mark.parametrize("name", ["P1", "P2", "P4b"])
def test_limit_cycle(name):
    parameters, law, _, V_lp, t, *_, table_period, table_amplitude = TABLE[name]
    found = rs.limit_cycle(rs.SpringSlider(**parameters, law=law), V_lp, rtol=1e-10)
    assert found.status == 0
    assert float(found.period) == pytest.approx(table_period, rel=1e-6)
    assert float(found.amplitude) == pytest.approx(table_amplitude, rel=1e-6)
    assert float(found.frequency) == pytest.approx(1 / float(found.period), rel=1e-15)
    # A point of the section V = V_lp to start the shooting from, at the last stress maximum
    coarse = run(name, 1e-9, times=None)
    time, tau = coarse.time.values, coarse.tau.values
    i = int(np.argmax(np.where(time > t - 1.5 * table_period, tau, 0.0)[:-1]))
    fine = run(name, 1e-9, times=np.linspace(time[i - 1], time[i + 1], 1001))
    at = fine.isel(time=int(np.argmax(fine.tau.values)))
    stress, log_theta = float(at.tau) / parameters["sigma"], math.log(float(at.theta))
    twin = naive.Naive(**parameters, law=law)
    cycle = naive.limit_cycle(
        twin,
        stress,
        log_theta,
        V_lp,
        3 * table_period,
        tol=1e-12,
        method="LSODA",
        newtons=2 if t == 10 else 1,
    )
    assert cycle.residual < 1e-10
    assert float(found.period) == pytest.approx(cycle.period, rel=1e-9)
    assert float(found.amplitude) == pytest.approx(cycle.amplitude, rel=1e-8)
    assert float(found.V_max) == pytest.approx(cycle.V_max, rel=1e-7)
    assert float(found.V_min) == pytest.approx(cycle.V_min, rel=1e-7)
    assert float(found.inertia) == pytest.approx(cycle.inertia, rel=1e-6)


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
