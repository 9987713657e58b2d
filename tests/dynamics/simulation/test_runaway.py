"""A run without mass that runs away: the error carries the run up to there."""

import json
import pickle

import numpy as np
import pytest

import ratestate as rs
from ratestate import files, scenario
from ratestate.errors import NotConverged, SolverError
from ratestate.paper.parameters import FIG2

SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="500 MPa/m")
LOADING = rs.Loading.constant("10 um/s")
#: of a run from 1 um/s on [s]
INSTABILITY = 2.159599


def runaway(t_end=60.0, **arguments):
    with pytest.raises(rs.QuasiStaticInstability) as raised:
        rs.simulate(SLIDER, LOADING, t_end, V_start="1 um/s", **arguments)
    return raised.value


@pytest.fixture(scope="module")
def best():
    return runaway().best


def test_the_message_says_when_and_what_to_do(best):
    message = str(runaway())
    assert f"simulate stopped at t = {float(best.time[-1]):.9g} s" in message
    assert "set M to simulate the slip event" in message
    assert "K = 500 MPa/m is 0.8333 times K_c_qs = 600 MPa/m, and V grows without" in message


def test_the_run_ends_at_the_instability(best):
    fine = runaway(rtol=1e-11).best
    for run, rtol in ((best, 1e-5), (fine, 1e-9)):
        assert float(run.time[-1]) == pytest.approx(float(fine.time[-1]), rel=rtol)
    assert float(best.time[-1]) == pytest.approx(INSTABILITY, rel=1e-5)
    assert 3e8 < float(best.V[-1]) < 3.5e8


def test_up_to_there_it_is_the_run(best):
    shorter = rs.simulate(SLIDER, LOADING, 2.0, V_start="1 um/s", times=[0.5, 1.0, 2.0])
    for name, atol in (("V", 1e-2), ("tau", 2e-5), ("theta", 1e-2)):
        along = np.interp(shorter.time, best.time, np.log(best[name]))
        np.testing.assert_allclose(along, np.log(shorter[name]), rtol=0, atol=atol, err_msg=name)
    delta = best.delta_lp - best.tau / SLIDER.K
    np.testing.assert_allclose(best.delta, delta, atol=1e-15)


def test_it_is_whole(best):
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


def test_it_does_not_depend_on_what_was_to_be_saved(best):
    """Of saved times none is that of the instability: the solver's own steps take their place."""
    assert runaway(times=[0.0, 1.0, 50.0]).best.equals(best)


def test_it_is_written_and_made_again(best, tmp_path):
    again = files.read(files.write(best, tmp_path / "best.nc"))
    assert again.equals(best)
    with pytest.raises(rs.QuasiStaticInstability) as raised:
        scenario.run(scenario.from_result(again))
    assert raised.value.best.equals(best)


def test_errors_are_pickled_with_what_they_carry(best):
    assert pickle.loads(pickle.dumps(runaway())).best.equals(best)
    assert SolverError("why").best is NotConverged("why").best is None


def test_any_run_that_fails_has_its_motion_up_to_there(monkeypatch):
    monkeypatch.setattr("ratestate.engine.dispatch.MAX_PATH_ROWS", 300)
    loading = rs.Loading.steps("0.1 mm/s", (1.0, "3.2 mm/s"))
    with pytest.raises(SolverError, match="step_limit") as caught:
        rs.simulate(FIG2, loading, t_end=11)
    run = caught.value.best
    assert 1.0 < float(run.time[-1]) < 11.0
    assert float(run.V[-1]) > 1e-3
