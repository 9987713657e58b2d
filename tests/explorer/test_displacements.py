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


@pytest.mark.parametrize(
    ("slider", "V_lp", "before"),
    [
        (FIG4, 1e-4, {}),
        (FIG2, 3e-4, {"V_from": 1e-4}),
        (FIG2, 1e-4, {"sigma_from": 1.5e6}),
    ],
)
def test_the_spring_is_as_long_as_its_stress_says(slider, V_lp, before):
    """The load point has its speed before time 0, and the normal stress is sent if it varies."""
    arrays = arrays_of(slider, V_lp, **before)
    time, slip, load = (arrays[f"run_{name}"] for name in ("time", "slip", "load"))
    assert slip[0] == load[0] == 0.0
    earlier = before.get("V_from", V_lp) * (np.minimum(time, 0.0) - time[0])
    assert load == pytest.approx(earlier + V_lp * np.maximum(time, 0.0), rel=1e-12, abs=1e-18)
    assert ("run_sigma" in arrays) == ("sigma_from" in before)
    sigma = np.where(time < 0.0, before.get("sigma_from", slider.sigma), slider.sigma)
    assert np.array_equal(arrays.get("run_sigma", sigma), sigma)
    tau = sigma * arrays["run_stress"]
    assert load - slip == pytest.approx((tau - tau[0]) / slider.K, rel=0.0, abs=1e-15)


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
