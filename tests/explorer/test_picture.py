"""Parts of a picture that the page draws: displacements, marks of critical values, long curves."""

import numpy as np
import pytest

import ratestate as rs
from ratestate.dynamics.verdict import verdict
from ratestate.paper.parameters import FIG1, FIG2, FIG4
from ratestate_explorer import entries, picture
from ratestate_explorer.deadline import Deadline
from ratestate_explorer.entries import entries_of
from ratestate_explorer.picture import MOST_SENT, decimated, marks
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


def test_cycles_and_runs_that_are_not_shown_have_none():
    arrays = arrays_of(FIG4, 1e-4)
    assert "cycle_time" in arrays
    assert not {"cycle_slip", "cycle_load", "cycle_sigma"} & set(arrays)
    texts = entries_of(PageState(FIG4, 1e-4))
    arrays = picture.picture(entries.state_of(texts), Deadline(0.0))[1]
    assert arrays["run_slip"].size == arrays["run_load"].size == 0


AGING = FIG2.replace(law="aging", K=601e6)


def test_marks_on_controls_are_the_critical_values_of_the_verdict():
    steady = rs.stability(AGING, 1e-4)
    found = marks(answer := verdict(AGING, 1e-4))
    assert found["K"] == [["K_c", float(steady.K_c)], ["K_fold", answer.K_fold]]
    assert found["V_lp"] == [["V_c", float(steady.V_c)]]
    assert answer.K_fold > float(steady.K_c)


def test_both_critical_speeds_are_marked_where_there_are_two():
    slider = FIG2.replace(friction_form="cut-off", V1=1e-2, V2=1e-2, K=400e6, M=0.0)
    names = [name for name, _ in marks(verdict(slider, 1e-3))["V_lp"]]
    steady = rs.stability(slider, 1e-3)
    expected = ["V_c", "V_c_upper"]
    assert names == [n for n in expected if np.isfinite(steady[n]) and steady[n] > 0.0]
    assert "V_c_upper" in names


@pytest.mark.parametrize(
    ("slider", "there"),
    [
        (FIG4, ["K"]),  # softer than K_c_qs: unstable at any speed and mass
        (FIG2.replace(a=0.01), []),  # strengthening
        (FIG2.replace(damping=1e3), ["K", "V_lp"]),  # eq. 6 does not hold
        (FIG1, ["K"]),  # a rigid spring has no critical speed or mass
    ],
)
def test_missing_critical_values_are_not_marked(slider, there):
    found = marks(verdict(slider, 1e-4))
    assert [field for field, rows in found.items() if rows] == there


def test_thinned_curves_keep_their_extremes():
    place = np.arange(99_600) % 83  # each piece has four extremes, none at its start
    x, y = (1.0 * (place == high) - (place == low) for high, low in ((20, 40), (30, 50)))
    x[40_000], x[60_000] = 2.0, -2.0
    which = decimated(x, y)
    assert 0.9 * MOST_SENT < len(which) <= MOST_SENT
    assert {0, 40_000, 60_000, 99_599} <= set(which.tolist())
    assert (np.diff(which) > 0).all()


def test_short_curves_are_sent_whole():
    x = np.arange(MOST_SENT + 1.0)
    assert decimated(x[:-1], x[:-1]) == slice(None)
    assert 2 < len(decimated(x, x)) < MOST_SENT
