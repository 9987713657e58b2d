"""The limit cycle as a curve."""

import numpy as np
import pytest

import ratestate as rs
from ratestate import orbit
from ratestate.paper.parameters import FIG2, FIG4, FIG6

CASES = {
    "stick-slip": (FIG4, 1e-5),
    "stick-slip, aging": (FIG4.replace(law="aging"), 1e-4),
    "hardly any mass": (FIG2.replace(M=1e-4, K=5e8), 3.2e-3),
    "inertial": (FIG4, 0.2),
    "quasi-harmonic": (FIG2, 3.2e-3),
    "soft": (FIG2, 3.1624e-3),
    "slow": (FIG6.replace(law="aging"), 2e-4),
}


@pytest.mark.parametrize("name", CASES)
def test_an_orbit_closes_and_has_the_measures_of_its_cycle(name):
    slider, V_lp = CASES[name]
    run, cycle = orbit(slider, V_lp, return_cycle=True)
    stress = run.tau / slider.sigma
    ends = np.array([stress, slider.a * np.log(run.V), slider.b * np.log(run.theta)])[:, [0, -1]]
    amplitude = float(cycle.amplitude)
    assert np.abs(np.diff(ends)).max() < 1e-6 * amplitude
    assert float(run.time[-1]) == pytest.approx(float(cycle.period), rel=1e-14)
    # the extremes lie between steps: sampled ones are smaller, and hardly so
    assert 0.999 < float(stress.max() - stress.min()) / amplitude < 1.0 + 1e-7
    assert 0.99 < float(run.V.max() / cycle.V_max) < 1.0 + 1e-6
    assert run.sizes["time"] > 40
    for name in ("amplitude", "stress_drop", "frequency", "returns"):
        assert run[name].item() == cycle[name].item() > 0.0
    assert run.cycles.item() == 1
    assert run.cycles.dtype == np.float64


def test_steady_sliding_is_one_point():
    for slider in (FIG2, FIG2.replace(M=0.0, law="aging"), FIG2.replace(K=np.inf)):
        run = orbit(slider, 3e-4)
        assert run.sizes["time"] == 1
        assert run.cycles.item() == 0
        assert float(run.V[0]) == pytest.approx(3e-4, rel=1e-12)
        assert float(run.tau[0]) == pytest.approx(2e6 * (0.6 - 0.003 * np.log(3e5)), rel=1e-12)


def test_a_slider_without_a_cycle_is_refused():
    with pytest.raises(rs.QuasiStaticInstability, match="set M to simulate"):
        orbit(FIG2.replace(M=0.0, K=5e8), 3e-4)
    with pytest.raises(rs.ParameterError, match="sweep over M"):
        orbit(FIG2.replace(M=rs.logspace("M", 1.0, 2.0, 2)), 3e-4)
