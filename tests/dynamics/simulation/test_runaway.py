"""A run without mass that runs away: the error carries the run up to there."""

import json

import numpy as np
import pytest

import ratestate as rs
from ratestate import files, scenario
from ratestate.errors import SolverError
from ratestate.paper.parameters import FIG2

SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="500 MPa/m")
LOADING = rs.Loading.constant("10 um/s")


def runaway(t_end=60.0, **arguments):
    with pytest.raises(rs.QuasiStaticInstability) as raised:
        rs.simulate(SLIDER, LOADING, t_end, V_start="1 um/s", **arguments)
    return raised.value


@pytest.fixture(scope="module")
def best():
    return runaway().best


def test_the_message_has_the_time_and_a_remedy(best):
    message = str(runaway())
    assert f"simulate stopped at t = {float(best.time[-1]):.9g} s" in message
    assert "set M to simulate the slip event" in message
    assert "K = 500 MPa/m is 0.8333 times K_c_qs = 600 MPa/m, and V grows without" in message


def test_the_run_up_to_a_runaway_is_complete(best):
    """Every number is known, also those of the whole run, and what it was made with."""
    for name, values in best.data_vars.items():
        assert np.isfinite(values).all(), name
    assert int(best.status) == 5
    assert float(best.V_max) == float(best.V[-1]) == float(best.V.max())
    assert float(best.V_min) == 1e-6
    assert 0 < abs(float(best.energy_residual)) < 1e-6
    sooner = runaway(t_end=3.0).best  # nothing depends on what would have followed
    assert float(sooner.energy_residual) == pytest.approx(float(best.energy_residual), rel=1e-3)
    assert best.attrs["title"] == "ratestate simulate"
    assert json.loads(best.attrs["scenario"])["t_end"] == 60.0


def test_a_run_up_to_a_runaway_is_written_and_repeated(best, tmp_path):
    again = files.read(files.write(best, tmp_path / "best.nc"))
    assert again.equals(best)
    with pytest.raises(rs.QuasiStaticInstability) as raised:
        scenario.run(scenario.from_result(again))
    assert raised.value.best.equals(best)


def test_any_run_that_fails_has_its_motion_up_to_there(monkeypatch):
    monkeypatch.setattr("ratestate.engine.dispatch.MAX_PATH_ROWS", 300)
    loading = rs.Loading.steps("0.1 mm/s", (1.0, "3.2 mm/s"))
    with pytest.raises(SolverError, match="step_limit") as caught:
        rs.simulate(FIG2, loading, t_end=11)
    run = caught.value.best
    assert 1.0 < float(run.time[-1]) < 11.0
    assert float(run.V[-1]) > 1e-3
