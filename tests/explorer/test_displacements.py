"""What block and load point of the page are drawn from: their displacements since the start."""

import numpy as np
import pytest

import ratestate as rs
from ratestate.paper.parameters import FIG2, FIG4
from ratestate_explorer import entries, picture
from ratestate_explorer.deadline import Deadline
from ratestate_explorer.entries import entries_of
from ratestate_explorer.state import PageState


def arrays_of(slider, V_lp, **before):
    texts = entries_of(PageState(slider, V_lp, **before))
    return picture.picture(entries.state_of(texts), Deadline(120.0))[1]


def test_the_load_point_goes_steadily_and_the_spring_is_as_long_as_its_stress_says():
    arrays = arrays_of(FIG4, 1e-4)
    time, slip, load = (arrays[f"run_{name}"] for name in ("time", "slip", "load"))
    assert slip[0] == load[0] == 0.0
    assert load == pytest.approx(1e-4 * time, rel=1e-12, abs=1e-18)
    stretch = FIG4.sigma * (arrays["run_stress"] - arrays["run_stress"][0]) / FIG4.K
    assert np.ptp(stretch) > 1e-4  # ten times Dc
    assert load - slip == pytest.approx(stretch, rel=0.0, abs=1e-15)


def test_slip_is_the_integral_of_the_slip_velocity():
    """By SciPy's rule for the run at its own steps, which are close enough for 1 in 1000."""
    from scipy.integrate import cumulative_simpson

    arrays = arrays_of(FIG2, 3.2e-3, V_from=1e-4)
    slipped = cumulative_simpson(arrays["run_V"], x=arrays["run_time"], initial=0.0)
    assert slipped[-1] > 40.0 * FIG2.Dc
    assert arrays["run_slip"] == pytest.approx(slipped, rel=0.0, abs=1e-3 * slipped[-1])


def test_the_load_point_has_the_speed_before_a_step_until_then():
    arrays = arrays_of(FIG2, 3e-4, V_from=1e-4)
    time, load = arrays["run_time"], arrays["run_load"]
    at = np.where(time < 0.0, 1e-4 * (time - time[0]), -1e-4 * time[0] + 3e-4 * time)
    assert load == pytest.approx(at, rel=1e-12, abs=1e-18)


def test_normal_stress_is_sent_where_it_varies_alone():
    arrays = arrays_of(FIG2, 1e-4, sigma_from=1.5e6)
    sigma = arrays["run_sigma"]
    assert sigma.shape == arrays["run_time"].shape
    assert set(sigma) == {1.5e6, 2e6}
    assert (sigma == np.where(arrays["run_time"] < 0.0, 1.5e6, 2e6)).all()
    stretch = (sigma * arrays["run_stress"] - sigma[0] * arrays["run_stress"][0]) / FIG2.K
    assert arrays["run_load"] - arrays["run_slip"] == pytest.approx(stretch, rel=0.0, abs=1e-15)
    assert "run_sigma" not in arrays_of(FIG2, 1e-4)


def test_a_rigid_drive_takes_the_block_along():
    slider = rs.SpringSlider(a=0.003, b=0.004, Dc=1e-5, sigma=1e6, K=np.inf, M=0.0)
    arrays = arrays_of(slider, 1e-4)
    assert (arrays["run_slip"] == arrays["run_load"]).all()


def test_cycles_and_runs_that_are_not_shown_have_none():
    arrays = arrays_of(FIG4, 1e-4)
    assert "cycle_time" in arrays
    assert not {"cycle_slip", "cycle_load", "cycle_sigma"} & set(arrays)
    texts = entries_of(PageState(FIG4, 1e-4))
    arrays = picture.picture(entries.state_of(texts), Deadline(0.0))[1]
    assert arrays["run_slip"].size == arrays["run_load"].size == 0
