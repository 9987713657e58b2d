"""`plot.figure` of fits of steps: where its markers are, and what it says of its panels."""

import warnings

import numpy as np
import pytest
from matplotlib.colors import to_hex
from synthetic_experiments import experiment

import ratestate as rs
from ratestate import plot
from ratestate.plot.labels import LAWS

pytestmark = pytest.mark.usefixtures("in_one_process")
SLIDER = rs.SpringSlider(a=0.009, b=0.012, Dc="20 um", sigma="8 MPa", K="6 GPa/m")
LAWS_OF_FIT = ("slip", "aging")


@pytest.fixture(scope="module")
def result():
    """Two steps up, one down and a hold, under both laws."""
    speeds = (3e-6, 1e-5, 3e-6, (0.0, 100.0), 3e-6, 2e-5)
    data = experiment(SLIDER, speeds, 300e-6, 150, noise=2e-4, seed=4)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rs.FitWarning)
        return rs.fit(data, SLIDER, law=LAWS_OF_FIT, per_step=True, errors="covariance")


@pytest.fixture(scope="module")
def page(result):
    fig = plot.figure(result)
    fig.draw_without_rendering()
    return fig


def labelled(fig, text):
    """The axes whose label on either axis has this text."""
    return [ax for ax in fig.axes if text in ax.get_xlabel() + ax.get_ylabel()]


def legend(fig):
    (found,) = (part.legends[0] for part in fig.subfigs if part.legends)
    return [text.get_text() for text in found.get_texts()]


@pytest.mark.parametrize(
    ("symbol", "letter", "factor"), [("a_minus_b", "a-b", 1e3), ("Dc", "D_c", 1e6)]
)
def test_every_estimate_has_a_marker_inside_its_panel(result, page, symbol, letter, factor):
    (ax,) = labelled(page, letter)
    assert len(ax.containers) == 6  # up, down and hold under both laws
    x, y = [], []
    for container in ax.containers:
        line = container.lines[0]
        assert line.get_color() in [LAWS[law].color for law in LAWS_OF_FIT]
        places = line.get_transform().transform(line.get_xydata())
        assert ax.bbox.shrunk(0.99, 0.99).contains(*places.min(axis=0))
        assert ax.bbox.shrunk(0.99, 0.99).contains(*places.max(axis=0))
        x, y = [*x, *line.get_xdata()], [*y, *line.get_ydata()]
    np.testing.assert_allclose(sorted(y), np.sort(factor * result[symbol], axis=None))
    np.testing.assert_allclose(sorted(x), np.sort(np.repeat(1e6 * result.V_after, 2)))
    low, high = ax.get_ylim()
    assert high - low < 1.3 * np.ptp(
        [*y, 0.0, *factor * result.interval.sel(parameter=symbol)[..., 0, :].values.ravel()]
    )


def test_estimates_along_the_experiment_are_where_they_were_made(result, page):
    for ax in labelled(page, "Load-point displacement"):
        x = np.concatenate([container.lines[0].get_xdata() for container in ax.containers])
        np.testing.assert_allclose(sorted(x), np.sort(np.repeat(1e3 * result.step_delta_lp, 2)))
        low, high = ax.get_xlim()
        assert low < x.min() < x.max() < high < 1.3 * x.max()


def test_holds_at_one_speed_are_drawn_against_hold_time(result):
    speed = 1e-5 * (1.0 + 1e-5 * result.step)
    holds = result.assign(
        V_after=speed, kind=("step", ["hold"] * 4), t_hold=("step", [3.0, 30.0, 300.0, 1000.0])
    )
    fig = plot.figure(holds)
    (ax,) = [ax for ax in labelled(fig, "D_c") if "Hold time [s]" in ax.get_xlabel()]
    x = np.concatenate([container.lines[0].get_xdata() for container in ax.containers])
    assert sorted(set(x)) == [3.0, 30.0, 300.0, 1000.0]
    mixed = plot.figure(holds.assign(kind=("step", [*["hold"] * 3, "step"])))
    assert len(labelled(mixed, "Number of the step")) == 2
    assert any(ax.get_title() == "step 4: hold 1000 s" for ax in fig.axes)


def test_markers_of_laws_are_beside_each_other(page):
    (ax,) = labelled(page, "D_c")
    shifts = {
        container.lines[0].get_color(): container.lines[0].get_transform().transform((1.0, 1.0))
        - ax.transData.transform((1.0, 1.0))
        for container in ax.containers
    }
    (first, second) = (shifts[LAWS[law].color] for law in LAWS_OF_FIT)
    np.testing.assert_allclose(first, 0.0, atol=1e-9)
    np.testing.assert_allclose(second, [0.035 * page.dpi, 0.0], atol=1e-9)


def test_each_step_has_its_curves_above_their_residuals(result, page):
    below = [*labelled(page, "Displacement ["), *labelled(page, "Time [")]
    assert [ax.get_xlabel() for ax in below] == [
        *["Displacement [\N{GREEK SMALL LETTER MU}m]"] * 3,
        "Time [s]",
    ]
    for ax, step in zip(below, (1, 2, 4, 3), strict=True):
        one = result.sel(step=step)
        for line, law in zip(ax.lines, LAWS_OF_FIT, strict=False):
            expected = 1e3 * (one.friction - one.friction_fit.sel(law=law))
            np.testing.assert_allclose(line.get_ydata(), expected)
            assert line.get_color() == LAWS[law].color
    curves = [ax for ax in page.axes if ax.get_title().startswith("step 1: 3")]
    _, first, second, *_ = curves[0].lines
    assert first.get_linewidth() > 1.5 * second.get_linewidth()
    assert (first.get_linestyle(), second.get_linestyle()) == ("-", "--")
    assert to_hex(second.get_color()) == LAWS["aging"].color


def test_the_legend_has_what_is_drawn(result, page):
    lines = ["recorded", "slip law", "aging law"]
    assert legend(page) == [*lines, "step up", "step down", "hold"]
    assert legend(plot.figure(result.isel(step=[0]))) == lines  # one step has curves alone
    assert legend(plot.figure(result.isel(step=[0, 3]))) == [*lines, "step up"]
