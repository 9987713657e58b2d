"""`plot.fit`, and `plot.figure` of a fit: what is drawn, and what is written beneath it."""

import warnings
from itertools import pairwise

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from scipy.stats import norm
from synthetic_records import SLIDER, STEP, record

import ratestate as rs
from ratestate import ParameterError, plot
from ratestate.model.quantities import with_error
from ratestate.plot.curves import MAX_SAMPLES, _envelope, record_of
from ratestate.plot.figures.fit_parts import SIZE, likelihood, non_gaussian, write
from ratestate.records.fitting.by_law import results_by_law, stiffness_over_critical

HOLD = rs.Loading.steps("10 um/s", (30.0, 0.0), (130.0, "10 um/s"))


@pytest.fixture(scope="module")
def both():
    """A step, fitted under both laws."""
    data = record(SLIDER, STEP, np.linspace(0.0, 140.0, 701), noise=3e-4)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rs.FitWarning)  # that the aging law does not fit
        return rs.fit(data, SLIDER, law=("slip", "aging"), errors="covariance")


@pytest.fixture(scope="module")
def held():
    """A hold, fitted under one law."""
    data = record(SLIDER, HOLD, np.linspace(0.0, 180.0, 601), noise=3e-4)
    return rs.fit(data, SLIDER, ("a", "b", "Dc"), loading=HOLD, errors="covariance")


@pytest.fixture(scope="module")
def drawn(both):
    """The picture of the step."""
    fig = plot.fit(both)
    fig.draw_without_rendering()
    return fig


def panels(fig):
    """The axes by their names in the mosaic."""
    return {ax.get_label(): ax for ax in fig.axes}


def lines(ax, label):
    """The x and y of the line with this label."""
    (line,) = (line for line in ax.lines if line.get_label() == label)
    return np.asarray(line.get_xdata()), np.asarray(line.get_ydata())


def texts(fig):
    """All that is written in the table of estimates."""
    return [text.get_text().replace("\N{MINUS SIGN}", "-") for text in fig.axes[-1].texts]


def test_a_fit_looks_as_before(both, held, looks_as_before):
    looks_as_before(plot.fit(both), "fit_step")
    looks_as_before(plot.fit(held), "fit_hold")


def test_record_curves_and_residuals_are_those_of_the_result(both, drawn):
    found = panels(drawn)
    ax = found["record"]
    x, y = lines(ax, "recorded")
    np.testing.assert_allclose(x, 1e6 * both.delta_lp.sel(law="slip"))
    np.testing.assert_allclose(y, both.friction.sel(law="slip"))
    for law in ("slip", "aging"):
        np.testing.assert_allclose(lines(ax, f"{law} law")[1], both.friction_fit.sel(law=law))
        left = np.asarray(found[f"{law} record"].lines[0].get_ydata())
        np.testing.assert_allclose(left, 1e3 * both.residual.sel(law=law))
    (fill,) = ax.collections  # the law that fits best has the only band
    corners = fill.get_paths()[0].vertices[:, 1]
    band = both.band.sel(law="slip")
    assert corners.min() == pytest.approx(float(band.min()))
    assert corners.max() == pytest.approx(float(band.max()))


def test_the_step_is_seen_from_close_by(both, drawn):
    found = panels(drawn)
    (close,) = (name for name in found if name.startswith("1 \N{RIGHTWARDS ARROW} 10"))
    low, high = found[close].get_xlim()
    Dc = 1e6 * float(both.Dc.max())
    assert 100.0 - 4 * Dc < low < 100.0 < 100.0 + 6 * Dc < high < 100.0 + 20 * Dc
    assert found[close].get_title("left").endswith("1 \N{RIGHTWARDS ARROW} 10 \u03bcm/s")
    assert found["record"].get_xlim() == pytest.approx((0.0, 500.0))
    assert "701 samples of friction, under the slip and aging laws" in drawn.get_suptitle()


def test_the_table_tells_the_estimates_with_their_errors(both, drawn):
    written = texts(drawn)
    for law, part in results_by_law(both).items():
        assert f"{law} law" in written
        for symbol, factor in (("a", 1e3), ("Dc", 1e6), ("K", 1e-9)):
            error = float(part.standard_error.sel(parameter=symbol))
            said = with_error(factor * float(part[symbol]), factor * error)
            assert said.replace("+-", "\N{PLUS-MINUS SIGN}") in written
    assert "$D_c$ [\u03bcm]" in written


def test_a_hold_is_drawn_over_time_unless_asked_otherwise(held):
    fig = plot.figure(held)
    fig.draw_without_rendering()
    found = panels(fig)
    assert found["record"].get_shared_x_axes().joined(found["record"], found["slip record"])
    assert found["slip record"].get_xlabel() == "Time since the record's start [s]"
    said = [text.get_text() for text in found["record"].texts]
    assert said[0] == "hold 100 s"
    at = [line.get_xdata()[0] for line in found["record"].lines if line.get_linestyle() == ":"]
    np.testing.assert_allclose(at, [30.0, 130.0])
    assert any(name.startswith("hold 100 s \N{RIGHTWARDS ARROW} 10") for name in found)
    other = Figure().subplots()
    plot.fit(held, other, x="delta_lp")
    assert other.get_xlabel().startswith("Load-point displacement [")
    assert other.get_xlim()[1] == pytest.approx(1e6 * 80.0 * 1e-5)


def test_a_hold_at_the_end_lasts_until_the_last_sample():
    loading = rs.Loading.steps("10 um/s", (30.0, 0.0))
    data = record(SLIDER, loading, np.linspace(0.0, 130.0, 401), noise=3e-4)
    data = data.assign_coords(time=data.time + 1000.0)
    result = rs.fit(data, SLIDER, ("b",), errors="covariance")
    (change,) = record_of(result).changes
    assert change.text() == "hold 100 s"


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
def test_a_fit_under_a_long_recorded_loading():
    """It has more rows than fit into an attribute."""
    t = np.concatenate([[0.0], np.linspace(39.0, 41.0, 1200), [140.0]])
    loading = rs.Loading.series(t, np.interp(t, [39.5, 40.5], [1e-6, 1e-5]))
    data = record(SLIDER, loading, np.linspace(0.0, 140.0, 301), noise=3e-4)
    both = rs.fit(data, SLIDER, law=("slip", "aging"), loading=loading, errors="covariance")
    assert both.loading_0_t.size == 2 * t.size
    assert record_of(both).changes == []
    plot.figure(both)


def test_a_fit_of_an_earlier_version_has_no_marks_of_steps(both):
    before = both.assign_attrs(loading='{"t": [0.0, 40.0], "V": [1e-6, 1e-5], "rate": [0.0, 0.0]}')
    assert record_of(before).changes == []
    assert len(record_of(both).changes) == 1
    plot.fit(before)


@pytest.mark.parametrize(("width", "shrinks"), [(7.2, False), (2.5, True)])
def test_letters_of_a_table_are_as_large_as_its_figure_allows(width, shrinks):
    cells = [("A wide heading", ["0.0123 +- 0.0004"]) for _ in range(4)]
    fig = Figure(figsize=(width, 1.0))
    ax = fig.add_axes((0.0, 0.0, 1.0, 1.0))
    write(ax, ["slip"], cells)
    assert (ax.texts[0].get_fontsize() < SIZE) == shrinks
    for row in (0.5, 1.5):
        texts = [text for text in ax.texts if text.get_position()[1] == row]
        ends = sorted(text.get_window_extent().extents[[0, 2]].tolist() for text in texts)
        assert all(right[0] - left[1] > 2.0 for left, right in pairwise(ends))
        assert 0.0 <= ends[0][0] < ends[-1][1] <= 100.0 * width


def test_data_that_are_not_fits_are_refused(both):
    with pytest.raises(ParameterError, match="the Dataset that fit returns"):
        plot.fit(both.drop_attrs())
    with pytest.raises(ParameterError, match="x = 'slip' is unknown"):
        plot.fit(both, x="slip")


def test_many_samples_lose_no_noise():
    rng = np.random.default_rng(0)
    x, y = np.arange(3.5 * MAX_SAMPLES), rng.normal(size=int(3.5 * MAX_SAMPLES))
    thin_x, thin_y = _envelope(x, y)
    assert 0.5 * MAX_SAMPLES < thin_x.size <= MAX_SAMPLES
    assert (thin_y.min(), thin_y.max()) == (y.min(), y.max())
    first = y[x < thin_x[2]]
    assert set(thin_y[:2]) == {first.min(), first.max()}
    np.testing.assert_array_equal(_envelope(x[:9], y[:9])[1], y[:9])


def test_profiles_and_posteriors_have_a_row_of_their_own(both, looks_as_before):
    z = np.linspace(-2.2, 2.2, 9)
    center = both.Dc.values[:, None]
    values, deviance = np.full((2, 2, both.sizes["parameter"], 9), np.nan)
    i = both.parameter.values.tolist().index("Dc")
    values[:, i], deviance[:, i] = center * (1.0 + 0.05 * z), z**2
    dims = ("law", "parameter", "profile_point")
    samples = np.random.default_rng(0).normal(size=(2, 400, both.sizes["parameter"])) * 0.01 + 1.0
    more = both.assign(
        profile_value=(dims, values),
        profile_deviance=(dims, deviance),
    )
    assert non_gaussian(both) == []
    assert non_gaussian(more) == ["a", "b", "Dc", "K"]
    fig = looks_as_before(plot.fit(more), "fit_profiles")
    drawn = [ax for ax in fig.axes if "likelihood of" in ax.get_title("left")]
    assert len(drawn) == 4  # a row without gaps
    x, y = drawn[2].lines[0].get_data()
    expected = np.exp(-0.5 * ((1e-6 * x / float(both.Dc[0]) - 1.0) / 0.05) ** 2)
    np.testing.assert_allclose(y, expected, atol=2e-3)
    x, y = drawn[0].lines[0].get_data()  # no profile: the Gaussian of the logarithm
    part = results_by_law(both)["slip"]
    spread = float(part.standard_error.sel(parameter="a") / part.a)
    np.testing.assert_allclose(y, np.exp(-0.5 * (np.log(1e-3 * x / float(part.a)) / spread) ** 2))
    sampled = more.assign(posterior=(("law", "sample", "parameter"), samples))
    assert non_gaussian(sampled) == ["a", "b", "Dc", "K"]
    ax = Figure().subplots()
    likelihood(sampled, "a", ax)
    heights, edges, _ = ax.patches[0].get_data()
    assert heights.max() == 1.0
    assert 1e-3 * edges[[0, -1]] == pytest.approx([1 - 0.029, 1 + 0.029], abs=0.006)


def test_the_page_of_cycles(both, looks_as_before):
    t = np.linspace(0.0, 1.0, 400)
    wave = 0.6 + 0.01 * np.cos(20 * np.pi * t)
    features = {"amplitude": 0.02, "period": 0.1, "rise": 0.04, "high": 0.02, "drop": 0.01}
    values = np.array([[*features.values(), 0.6]])
    error = 0.01 * values
    along = ("segment", "feature")
    names = ["a", "b", "Dc", "mu0"]
    part = both.isel(law=0, drop=True).sel(parameter=names, other=names)
    made = xr.Dataset(
        {
            **{name: part[name] for name in (*names, "standard_error", "interval")},
            "correlation": part.correlation,
            "friction": ("time", wave + 1e-4),
            "friction_fit": ("time", wave),
            "residual": ("time", 0 * wave + 1e-4),
            "measured": (along, values),
            "measured_error": (along, error),
            "fitted": (along, values + [[1, -1, 0, 2, 0, 0]] * error),
            "used": (along, np.array([[True, True, True, True, False, True]])),
            "chi2": 3.21,
        },
        {"time": t, "feature": [*features, "level"]},
    )
    made = made.assign_coords(law="slip")
    made.attrs = part.attrs | {"against": "cycles"}
    fig = looks_as_before(plot.figure(made), "page_fit_of_cycles")
    found = panels(fig)
    assert np.ptp(lines(found["b"], "slip law")[0]) == pytest.approx(0.4, rel=0.02)
    off = found["c"].lines[-1].get_ydata()
    np.testing.assert_allclose(off, [1, -1, 0, 2, np.nan, 0], atol=1e-9)
    assert "3.21" in texts(fig)


def test_the_error_of_stiffness_over_critical_is_that_of_draws(both):
    part = results_by_law(both)["slip"]
    ratio, error = stiffness_over_critical(part)
    names = ["K", "Dc", "a_minus_b"]
    values = np.array([float(part[name]) for name in names])
    spread = part.standard_error.sel(parameter=names).values
    correlation = part.correlation.sel(parameter=names, other=names).values
    shrunk = 0.05  # so that the ratio is linear in them
    normal = np.random.default_rng(0).multivariate_normal(np.zeros(3), correlation, 40_000)
    drawn = values + shrunk * spread * normal
    K, Dc, a_minus_b = drawn.T
    ratios = K * Dc / (-a_minus_b * SLIDER.sigma)
    assert ratio == pytest.approx(ratios.mean(), rel=1e-2)
    assert error == pytest.approx(ratios.std() / shrunk, rel=0.03)


def test_the_lines_of_residuals_hold_95_percent_of_the_noise(both, drawn):
    """At +- the normal quantile, by SciPy, times the level of white and red noise together."""
    for law, part in results_by_law(both).items():
        level = norm.ppf(0.975) * np.hypot(float(part.noise_white), float(part.noise_red))
        flat = [line.get_ydata() for line in panels(drawn)[f"{law} record"].lines[1:4]]
        heights = sorted(float(y[0]) for y in flat)
        np.testing.assert_allclose(heights, [-1e3 * level, 0.0, 1e3 * level], rtol=1e-4)


def test_a_long_legend_has_two_rows_beside_a_close_up(both):
    """The laws' names are as long as they are; a held parameter of a law is in the title."""
    own = {"law": "two-state-slip", "b2": 0.0, "Dc2": "12 um"}
    data = record(SLIDER, STEP, np.linspace(0.0, 140.0, 701), noise=3e-4)
    laws = ("slip", "two-state-slip")
    result = rs.fit(data, SLIDER.replace(**own), ("a", "b"), law=laws, errors="covariance")
    fig = plot.fit(result)
    assert panels(fig)["record"].get_legend()._ncols == 2
    assert "$D_{c2}$ = 12" in fig.get_suptitle()
    assert panels(plot.fit(both))["record"].get_legend()._ncols == 4
