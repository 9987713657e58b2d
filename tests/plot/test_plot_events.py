"""The page of catalogues of stick-slip events."""

import numpy as np
import pytest
import xarray
from synthetic_stick_slip import sawtooth

import ratestate as rs
from ratestate import plot

SLIDER = rs.SpringSlider(
    a=0.005, b=0.008, Dc="10 um", sigma="4 MPa", M=100, K="600 MPa/m", law="aging"
)


@pytest.fixture(scope="module")
def catalogue():
    loading = rs.Loading.steps("10 um/s", (450.0, "30 um/s"), (600.0, "100 um/s"))
    return rs.events(rs.simulate(SLIDER, loading, 650.0, V_start="5 um/s"))


def test_one_catalogue_and_several(catalogue):
    one = plot.figure(catalogue)
    assert len(one.axes) == 3
    several = plot.figure({"measured": catalogue, "simulated": catalogue})
    assert len(several.axes) == 4
    record, below = several.axes[0], several.axes[-1]
    peaks = record.lines[1].get_xydata()
    np.testing.assert_allclose(peaks[:, 1], 1e-6 * catalogue.tau_max.values)
    assert below.get_xlabel() == "$V_{lp}$ [\N{GREEK SMALL LETTER MU}m/s]"
    assert several.axes[-2].get_xlabel() == "Recurrence interval [s]"
    texts = [text.get_text() for text in below.get_legend().get_texts()]
    assert texts[0].startswith("measured: \N{MINUS SIGN}")
    assert texts[0].endswith("kPa a decade")


def test_the_lines_are_those_of_the_catalogue(catalogue):
    axes = plot.figure(catalogue).axes
    for ax, abscissa in zip(axes[1:], ("recurrence", "V_lp"), strict=True):
        fitted = next(line for line in ax.lines if line.get_linestyle() == "-")
        x, y = fitted.get_data()
        line = catalogue.sel(abscissa=abscissa)
        slope = (y[1] - y[0]) / np.log10(x[1] / x[0])
        assert slope == pytest.approx(1e-3 * float(line.trend_B), rel=1e-9)


def test_a_single_speed_has_no_panel_of_its_own():
    """Intervals have errors, a narrow range has a linear axis, several events in a fall a cross."""
    rng = np.random.default_rng(1)
    starts = np.sort([*(100.0 * np.arange(1, 9)), 404.0])
    found = rs.events(sawtooth(starts, np.full(9, 1e5), 1.0, rng, 1e3).record)
    record, drops = plot.figure(found).axes
    assert "several events in one fall" in record.get_title(loc="left") + str(record.texts)
    (crosses,) = (line.get_xdata() for line in record.lines if line.get_marker() == "x")
    np.testing.assert_allclose(crosses, found.event_time.values[3])
    assert drops.get_xscale() == "linear"
    low, high = drops.get_xlim()
    reach = (found.recurrence + found.recurrence_error).values[[1, 2, 5, 6, 7]]
    assert (reach < high).all()
    assert high < 1.5 * reach.max()
    assert low > 0.5 * float(found.recurrence.min())


def test_no_events_still_have_a_page():
    t = np.arange(100.0)
    y = 2e6 + np.random.default_rng(0).normal(size=100)
    data = xarray.Dataset({"tau": ("time", y), "delta_lp": ("time", 1e-6 * t)}, {"time": t})
    assert len(plot.figure(rs.events(data, K="1 GPa/m")).axes) == 1  # the record alone


def test_other_results_beside_catalogues_are_refused(catalogue):
    cycle = rs.limit_cycle(SLIDER, "10 um/s")
    with pytest.raises(rs.ParameterError, match="results of events alone"):
        plot.figure([catalogue, cycle])
    with pytest.raises(rs.ParameterError, match="4 catalogues at most"):
        plot.figure([catalogue] * 5)
