"""`plot.figure`: what the picture of each kind of result shows."""

import contextlib
import re

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.image import imread

import ratestate as rs
from ratestate import ParameterError, plot
from ratestate.dynamics.cycles.regimes import classify
from ratestate.errors import RunWarning
from ratestate.plot.axis import axis_of

SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=9e8, M=3e3, V0=1e-9)
V_LP = rs.logspace("V_lp", 1e-3, 1e-1, 4)
MASS = rs.logspace("M", 1e2, 1e4, 3)


def lines(ax, label):
    """The x and y of the line with this label."""
    (line,) = (line for line in ax.lines if line.get_label() == label)
    return np.asarray(line.get_xdata()), np.asarray(line.get_ydata())


def curve(ax):
    """The x and y of the longest line; nothing but a mark where there is none."""
    longest = max(ax.lines, key=lambda line: len(line.get_xdata()))
    return np.asarray(longest.get_xdata()), np.asarray(longest.get_ydata())


def panels(fig):
    """The axes, by their letters."""
    return sorted(fig.axes, key=lambda ax: ax.get_label())


def drawn(fig):
    """The same, after they have been drawn: warnings, which are errors here, come late."""
    fig.draw_without_rendering()
    return panels(fig)


def test_the_figure_of_a_run_shows_stress_speed_and_phase_plane(looks_as_before):
    run = rs.simulate(SLIDER, rs.Loading.steps(1e-4, (0.05, 0.0), (0.06, 3.2e-3)), 0.2)
    fig = looks_as_before(plot.figure(run), "page_run")
    stress, speed, plane = drawn(fig)
    np.testing.assert_allclose(lines(stress, r"$\mu$, friction")[1], run.mu)
    np.testing.assert_allclose(lines(speed, "slider")[1], 1e3 * run.V)
    t, V = lines(speed, "load point")
    np.testing.assert_allclose(t, [0, 50, 50, 60, 60, 200])
    np.testing.assert_allclose(V, [0.1, 0.1, np.nan, np.nan, 3.2, 3.2])
    assert speed.get_yscale() == plane.get_yscale() == "log"
    (x,), (y,) = lines(plane, "steady at the last $V_{lp}$")
    assert (x, y) == (pytest.approx(0.6 - 0.003 * np.log(3.2e6)), pytest.approx(3.2))
    assert [ax.get_title("left")[-5:] for ax in (stress, speed)] == ["tress", "speed"]


def test_a_long_run_shows_its_last_cycles(looks_as_before):
    run = rs.simulate(SLIDER, rs.Loading.steps(1e-4, (0.05, 2e-2)), 0.5)
    fig = looks_as_before(plot.figure(run), "page_long_run")
    *_, last = panels(fig)
    shown = lines(last, r"$\mu$, friction")[0]
    assert np.ptp(shown) == pytest.approx(1e3 * 5 / float(run.frequency), rel=0.05)
    assert f"the last 5 of {int(run.cycles)} cycles" in last.get_title("left")


def test_the_figure_of_a_limit_cycle_shows_its_period_and_speeds(looks_as_before):
    cycle = rs.limit_cycle(SLIDER, 3.2e-3)
    fig = looks_as_before(plot.figure(cycle), "page_cycle")
    _, speed, plane = panels(fig)
    t, V = lines(speed, "slider")
    assert t[-1] == pytest.approx(1e3 * float(cycle.period))
    assert V.max() == pytest.approx(1e3 * float(cycle.V_max), rel=1e-3)
    assert plane.get_yscale() == "linear"  # for speeds of less than a decade
    assert "quasi-harmonic" in fig.get_suptitle()
    assert "19.76 ms" in fig.get_suptitle()


def test_no_cycle_is_the_page_of_stability():
    fig = plot.figure(rs.limit_cycle(SLIDER, 1e-3))
    assert "Steady sliding at $V_{lp}$ = 1 mm/s is stable" in fig.get_suptitle()


@pytest.mark.parametrize(
    ("changes", "note"),
    [
        ({}, ""),
        ({"M": 0.0}, ""),
        ({"K": np.inf}, "rigid"),
        ({"b": 0.002}, "stable at any stiffness"),
    ],
)
def test_stability(changes, note, looks_as_before):
    slider = SLIDER.replace(**changes)
    fig = looks_as_before(
        plot.figure(rs.stability(slider, 3.2e-3)), "_".join(["page_stability", *changes])
    )
    left, right, turns = (panels if note else drawn)(fig)
    assert any(note in text.get_text() for text in left.texts) or not note
    found = rs.stability(slider, 3.2e-3)
    growth, frequency = curve(right), curve(turns)
    assert np.interp(3.2, *growth) == pytest.approx(float(found.growth_rate), rel=1e-2, abs=0.5)
    assert right.get_ylabel() == "Growth rate [1/s]"
    if np.isinf(slider.K):
        assert [text.get_text() for text in turns.texts] == ["no oscillation"]
    else:
        unit = {"Frequency [Hz]": 1.0, "Frequency [kHz]": 1e-3}[turns.get_ylabel()]
        expected = unit * float(found.omega) / (2 * np.pi)
        assert np.interp(3.2, *frequency) == pytest.approx(expected, rel=1e-2)
    if not note:
        V, K_c = lines(left, "$K_c$")
        assert np.interp(3.2, V, K_c) == pytest.approx(slider.K_c(3.2e-3) / 1e6, rel=1e-3)
        (x,), (y,) = lines(left, "this slider")
        assert (x, y) == pytest.approx((3.2, 900.0))


def test_an_unstable_slider_s_page_says_what_makes_it_stable():
    found = rs.stabilize(SLIDER, 1e-2)
    fig = plot.figure(rs.stability(SLIDER, 1e-2))
    last = fig.get_suptitle().splitlines()[-1]
    for name, value in (("K", found.K_stable / 1e9), ("M", found.M_stable)):
        assert re.search(rf"\${name}\$ \$\\[gl]eq\$ {float(value):.4g} ", last)
    assert f"{float(found.damping_stable) / 1e3:.4g} kPa s/m" in last
    assert "Stable at" not in plot.figure(rs.stability(SLIDER, 1e-3)).get_suptitle()


def test_a_page_without_its_title_keeps_its_panels():
    result = rs.stability(SLIDER, 1e-3)
    fig, titled = plot.figure(result, title=False), plot.figure(result)
    assert fig.get_suptitle() == ""
    heights = []
    for one in (fig, titled):
        one.draw_without_rendering()
        heights.append(one.axes[0].get_position().y1)
    assert heights[0] > heights[1]


def test_stability_is_that_of_the_law_and_of_damping():
    """K_c at all speeds, up to where damping makes sliding stable again."""
    for slider in (
        SLIDER.replace(damping=6e4, K=5e8),
        SLIDER.replace(law="kato-tullis", V_cut=1e-4),
        SLIDER.replace(law="two-state-slip", b2=0.002, Dc2=1e-4),
    ):
        found = rs.stability(slider, 1e-3)
        fig = plot.figure(found)
        left, right, _ = drawn(fig)
        V, K_c = lines(left, "$K_c$")
        for speed in (0.5, 2.0):
            exact = slider.K_c(1e-3 * speed) / 1e6
            assert np.interp(speed, V, K_c) == pytest.approx(exact, rel=1e-3)
        growth = curve(right)
        assert np.interp(1.0, *growth) == pytest.approx(float(found.growth_rate), rel=1e-2, abs=0.5)
        own = "".join(text.get_text() for text in [fig._suptitle])
        assert ("damping" in own) == (slider.damping > 0.0)
        assert (r"V_{cut}" in own) == (slider.law == "kato-tullis")
        names = [line.get_label() for line in left.lines]
        upper = plot.value_text("V_c_upper", float(found.V_c_upper))
        assert (upper in names) == np.isfinite(found.V_c_upper)


def test_a_frequency_response(looks_as_before):
    slider = SLIDER.replace(alpha=0.2)
    response = rs.frequency_response(slider, 1e-3, np.geomspace(0.5, 2e3, 300))
    fig = looks_as_before(plot.figure(response), "page_response")
    axes = np.array(fig.axes).reshape(3, 2)
    assert axes[0, 0].get_ylabel() == r"$|\Delta \ln V|$"
    assert axes[2, 0].get_xlabel() == "Frequency [Hz]"
    for column, (name, size) in enumerate((("V_lp", 1e-3), ("sigma", 2e6))):
        f, gain = axes[0, column].lines[0].get_data()
        exact = rs.frequency_response(slider, 1e-3, float(f[100]))
        at = complex(exact[f"V_by_{name}"])
        assert gain[100] == pytest.approx(abs(at) * size / 1e-3, rel=1e-12)
        f, gain = axes[1, column].lines[0].get_data()
        assert gain[100] == pytest.approx(float(exact[f"tau_by_{name}_gain"]) * size / 2e6)
        degrees = axes[2, column].lines[2].get_ydata()[100]
        assert (degrees - np.degrees(np.angle(at)) + 180.0) % 360.0 == pytest.approx(180.0)
        assert axes[0, column].lines[1].get_xdata()[0] == pytest.approx(float(exact.resonance))
    with pytest.raises(rs.ParameterError, match=r"several frequencies"):
        plot.figure(exact)
    swept = rs.frequency_response(
        SLIDER.replace(K=xr.DataArray([9e8, 1e9], dims="K")), 1e-3, [1.0, 2.0]
    )
    with pytest.raises(rs.ParameterError, match=r"response.*Pick one along 'K'"):
        plot.figure(swept)


def test_the_figure_of_a_branch_shows_its_speeds_and_multipliers(looks_as_before):
    branch = rs.continue_cycle(SLIDER, "V_lp", 5e-3, 3e-3, rtol=1e-6)
    fig = looks_as_before(plot.figure(branch), "page_branch")
    _, speeds, multiplier = drawn(fig)
    V, ratio = lines(speeds, r"$V_{\max}$")
    assert np.nanmax(ratio) == pytest.approx(float((branch.V_max / branch.V_lp).max()))
    assert np.nanmin(V) == pytest.approx(1e3 * SLIDER.V_c)
    assert len(multiplier.lines) == 2  # stable, up to the Hopf point, and 1


@pytest.mark.parametrize("function", ["limit_cycle", "stability"])
def test_a_sweep_over_one_axis(function, looks_as_before):
    found = getattr(rs, function)(SLIDER, V_LP)
    fig = looks_as_before(plot.figure(found), f"page_{function}_line")
    axes = (drawn if function == "limit_cycle" else panels)(fig)
    symbol = {"limit_cycle": "frequency", "stability": "growth_rate"}[function]
    x, y = lines(axes[1], plot.label(symbol))
    np.testing.assert_allclose(x, 1e3 * V_LP)
    np.testing.assert_allclose(y, found[symbol])
    assert axes[-1].get_xscale() == "log"
    assert "Load-point velocity" in axes[-1].get_xlabel()
    critical = [line for ax in axes for line in ax.lines if "$V_c$" in line.get_label()]
    assert len(critical) == (3 if function == "stability" else 0)
    for line in critical:
        np.testing.assert_allclose(line.get_xdata(), 1e3 * SLIDER.V_c)


def test_failed_cases_of_a_line_have_crosses(looks_as_before):
    slider = SLIDER.replace(K=5e8, M=xr.DataArray([0.0, 3e3], dims="M"))
    fig = looks_as_before(
        plot.figure(rs.sweep("limit_cycle", slider, V_lp=V_LP)), "page_lines_with_failed_cases"
    )
    (first, *_) = panels(fig)
    crosses = [line for line in first.lines if line.get_marker() == "x"]
    np.testing.assert_allclose([line.get_xdata()[0] for line in crosses], 1e3 * V_LP)
    assert not [line for line in first.lines if line.get_alpha()]


FAST = rs.logspace("V_lp", 1.0, 100.0, 7)
OUTSIDE = "outside the friction law's domain"


def test_cases_outside_the_domain_of_the_friction_law_are_marked():
    """Dots under lines, hatched cells of maps; nothing where all is inside."""
    slow = plot.figure(rs.sweep("limit_cycle", SLIDER.replace(K=4e7), V_lp=V_LP))
    assert not slow.legends
    found = rs.sweep("limit_cycle", SLIDER.replace(K=4e7), V_lp=FAST)
    outside = found.outside_domain.values > 0
    assert outside.any()
    assert not outside.all()
    fig = plot.figure(found)
    assert [text.get_text() for text in fig.legends[0].texts] == [OUTSIDE]
    for ax, times in zip(panels(fig), (1, 1, 2), strict=True):
        assert sorted(lines(ax, OUTSIDE)[0]) == sorted(times * [*FAST.values[outside]])
    slider = SLIDER.replace(K=rs.logspace("K", 1e7, 1e9, 6))
    found = rs.sweep("limit_cycle", slider, V_lp=FAST)
    outside = found.outside_domain.transpose("K", "V_lp").values > 0
    fig = plot.figure(found)
    assert OUTSIDE in [text.get_text() for text in fig.legends[0].texts]
    for ax in panels(fig)[:3]:
        (patch,) = ax.patches
        for i, j in np.ndindex(outside.shape):
            at = (FAST.values[j], slider.K.values[i] / 1e9)
            assert patch.get_path().contains_point(at) == outside[i, j]


def test_cycles_of_a_branch_outside_the_domain_are_marked():
    branch = rs.continue_cycle(SLIDER.replace(K=4e7), "V_lp", 5.0, 10.0, rtol=1e-6)
    outside = branch.outside_domain.values > 0
    x, y = lines(panels(plot.figure(branch))[0], OUTSIDE)
    np.testing.assert_allclose(x, branch.V_lp.values[outside])
    np.testing.assert_allclose(y, branch.amplitude.values[outside])


def test_a_branch_over_stiffness_is_in_the_unit_of_other_pages():
    branch = rs.continue_cycle(SLIDER, "K", 8.9e8, 8e8, V_lp=3.2e-3, rtol=1e-6)
    axes = panels(plot.figure(branch))
    assert [ax.get_xlabel()[-7:] for ax in axes] == 3 * ["[MPa/m]"]
    for ax, name in zip(axes, ["cycle, stable", r"$V_{\max}$"], strict=False):
        x = lines(ax, name)[0]
        assert (np.nanmin(x), np.nanmax(x)) == (pytest.approx(800), pytest.approx(890))
    (own,) = lines(plot.branch(branch), "cycle, stable")[0][:1]
    assert own == pytest.approx(8.9e8)  # axes that branches may share stay in SI


def test_the_legend_of_the_phase_plane_leaves_its_title_alone():
    loading = rs.Loading.sinusoid(1e-3, 5e-5, period=2, t_end=10)
    fig = plot.figure(rs.simulate(SLIDER, loading, 10))
    *_, plane = drawn(fig)
    title = plane._left_title.get_window_extent()
    legend = plane.get_legend().get_window_extent()
    assert legend.x0 > title.x1 + 5 or legend.y0 > title.y1


MANY_SPEEDS = rs.logspace("V_lp", 1e-3, 1e-1, 7)
MANY_MASSES = rs.logspace("M", 1e2, 1e4, 6)


#: what is written on the first map
REGIONS = {
    "limit_cycle": ["quasi-\nharmonic", "steady"],
    "stability": ["stable", "unstable"],
    "simulate": ["no cycle in any case"],
}


@pytest.mark.parametrize("function", ["limit_cycle", "stability", "simulate"])
def test_a_sweep_over_two_axes(function, looks_as_before):
    how = {"V_lp": MANY_SPEEDS}
    if function == "simulate":
        how = {"loading": rs.Loading.constant(MANY_SPEEDS), "t_end": 0.1}
    with pytest.warns(RunWarning) if function == "simulate" else contextlib.nullcontext():
        found = rs.sweep(function, SLIDER.replace(M=MANY_MASSES), **how)
    fig = looks_as_before(plot.figure(found), f"page_{function}_map")
    axes = (drawn if function == "stability" else panels)(fig)[:3]
    symbol = {"limit_cycle": "V_max", "stability": "omega", "simulate": "V_max"}[function]
    (mesh,) = axes[2].collections
    assert [text.get_text() for text in axes[0].texts] == REGIONS[function]
    for ax in axes:  # V_c as a line
        (line,) = ax.lines
        V, M = np.asarray(line.get_xdata()) / 1e3, np.asarray(line.get_ydata())
        np.testing.assert_allclose(V, [SLIDER.replace(M=each).V_c for each in M], rtol=1e-2)
    (legend,) = fig.legends
    assert legend.texts[0].get_text() == "$V_c$: edge of stable sliding"
    factor = 1.0 if function == "stability" else 1e3
    expected = found[symbol].transpose("M", "V_lp").values
    np.testing.assert_allclose(mesh.get_array().reshape(6, 7), factor * expected)
    assert (axes[0].get_xscale(), axes[0].get_yscale()) == ("log", "log")


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("scales", ["linear log", "log linear", "linear linear"])
def test_a_map_shows_all_its_cases_and_nothing_more(scales, reverse):
    """Also over linear axes that do not begin at 0; lines over one axis likewise."""
    spaced = {"linear": np.linspace, "log": np.geomspace}
    order = slice(None, None, -1 if reverse else 1)
    down, right = (spaced[scale] for scale in scales.split())
    sigma = xr.DataArray(down(5e5, 1.9e6, 6)[order], dims="sigma")
    V_lp = xr.DataArray(right(5e-3, 0.1, 7)[order], dims="V_lp")
    brake = rs.SpringSlider(a=0.01, b=0.015, Dc="5 um", sigma=sigma, M=50, K="2 GPa/m")
    result = rs.stability(brake, V_lp)
    maps = [ax for ax in plot.figure(result).axes if ax.get_title("left")]
    assert len(maps) == 3
    for ax in maps:
        corners = ax.collections[0].get_coordinates().reshape(-1, 2)
        ends = np.array([ax.get_xlim(), ax.get_ylim()])
        np.testing.assert_allclose(np.sort(corners, axis=0)[[0, -1]].T, ends, rtol=1e-12)
    for ax in plot.figure(result.isel(sigma=0)).axes:
        (x_low, x_high), (low, high) = ax.get_xlim(), ax.get_ylim()
        for x, y in (line.get_data() for line in ax.lines[:1]):
            assert x_low < min(x) < max(x) < x_high
            assert low < np.nanmin(y) < np.nanmax(y) < high


def test_regimes_on_a_map_are_separated_and_named():
    K, V_lp = rs.logspace("K", 3e8, 3e9, 12), rs.logspace("V_lp", 1e-6, 1e-1, 12)
    cycles = rs.sweep("limit_cycle", SLIDER.replace(K=K), V_lp=V_lp, progress=False)
    ax = panels(plot.figure(cycles))[0]
    regimes = classify(cycles).regime
    names = {text.get_text().replace("\n", "") for text in ax.texts}
    assert names == {"quasi-harmonic", "steady", "stick-slip"}
    for text in ax.texts:
        V, stiffness = text.get_position()
        near = regimes.sel(V_lp=V / 1e3, K=1e9 * stiffness, method="nearest")
        assert str(near.values) == text.get_text().replace("\n", "")
    found = regimes.transpose("K", "V_lp").values
    beside = [(found[:, 1:], found[:, :-1]), (found[1:], found[:-1])]
    edges = sum(
        int(((one != other) & (one != "steady") & (other != "steady")).sum())
        for one, other in beside
    )
    (separating,) = (c for c in ax.collections if isinstance(c, LineCollection))
    assert len(separating.get_segments()) == edges > 3
    critical = [line for line in ax.lines if line.get_color() == "k"]
    for line in critical:
        V, stiffness = np.asarray(line.get_xdata()) / 1e3, 1e9 * np.asarray(line.get_ydata())
        np.testing.assert_allclose(SLIDER.K_c(xr.DataArray(V, dims="V")), stiffness, rtol=1e-2)
    assert critical


@pytest.mark.parametrize(
    ("slider", "V_lp"),
    [
        (SLIDER.replace(M=MANY_MASSES), 1e-3 * MANY_SPEEDS),  # stable throughout
        (SLIDER.replace(M=MANY_MASSES, b=0.002), MANY_SPEEDS),
        (SLIDER.replace(M=MANY_MASSES, K=np.inf), MANY_SPEEDS),
    ],
)
def test_a_map_without_an_edge_of_stability(slider, V_lp):
    fig = plot.figure(rs.stability(slider, V_lp.assign_coords(V_lp=V_lp)))
    assert not fig.legends
    first = panels(fig)[0]
    assert not first.lines
    assert [text.get_text() for text in first.texts] == ["stable"]


def test_over_other_axes_the_edge_is_where_K_is_K_c():
    found = rs.stability(SLIDER.replace(M=MANY_MASSES, K=rs.logspace("K", 3e8, 3e9, 8)), 3.2e-3)
    fig = plot.figure(found)
    assert fig.legends[0].texts[0].get_text() == "$K$ = $K_c$: edge of stable sliding"
    (line,) = panels(fig)[0].lines
    M, K = (line.get_xdata(), line.get_ydata())
    if "Mass" not in panels(fig)[0].get_xlabel():
        M, K = K, M
    expected = [SLIDER.replace(M=each).K_c(3.2e-3) / 1e9 for each in M]
    np.testing.assert_allclose(K, expected, rtol=2e-3)


def test_failed_cases_are_told_from_those_without_a_cycle():
    slider = SLIDER.replace(K=5e8, M=xr.DataArray([0.0, 3e3], dims="M"))
    many = SLIDER.replace(K=5e8, M=xr.DataArray([0.0, 1e3, 2e3, 3e3, 4e3, 5e3], dims="M"))
    (first, *_) = panels(plot.figure(rs.sweep("limit_cycle", many, V_lp=MANY_SPEEDS)))
    gray = next(found for found in first.collections if found.get_cmap().name == "gray")
    gray = gray.get_array().reshape(6, 7)
    np.testing.assert_array_equal(np.isnan(gray), [[False] * 7, *(5 * [[True] * 7])])
    one = plot.figure(rs.sweep("limit_cycle", slider, V_lp=1e-3)).axes[0]
    assert [line.get_xdata()[0] for line in one.lines if line.get_alpha()] == [0.0]


@pytest.mark.parametrize(
    ("values", "at", "names"),
    [
        ([3e3, 1e3], [3e3, 1e3], None),
        ([1e3, 3e3, 2e3], [0, 1, 2], ["1000", "3000", "2000"]),
        ([3e3], [3e3], None),
    ],
)
def test_values_of_an_axis_may_have_any_order(values, at, names):
    M = xr.DataArray(values, dims="M")
    found = rs.stability(SLIDER.replace(M=M, K=xr.DataArray([9e8, np.inf], dims="K")), 1e-3)
    (first, *_) = (drawn if names else panels)(plot.figure(found))
    y = axis_of(found, "M")
    assert y.values.tolist() == at
    assert y.names == names
    assert axis_of(found, "K").names == ["900", "inf"]
    assert sum(len(line.get_xdata()) for line in first.lines) >= 2 * len(values)
    assert y.edges.size == len(values) + 1


def test_an_axis_without_effect_is_drawn():
    found = rs.stability(SLIDER.replace(mu0=xr.DataArray([0.5, 0.6], dims="mu0")), 1e-3)
    first, *_ = panels(plot.figure(found))
    np.testing.assert_allclose(lines(first, "$K_c$")[1], 2 * [float(found.K_c) / 1e6])


def test_results_without_a_figure_are_refused():
    slider = SLIDER.replace(M=MASS, a=xr.DataArray([0.003, 0.004], dims="a"))
    with pytest.raises(ParameterError, match="one or two axes, and this one has 3"):
        plot.figure(rs.stability(slider, V_LP))
    for other in (xr.Dataset(), None, rs.stability(SLIDER, 1e-3).drop_attrs()):
        with pytest.raises(ParameterError, match=r"figure\(\) draws a Dataset"):
            plot.figure(other)


@pytest.mark.parametrize("part", ["amplitude", "V_max"])
def test_a_part_of_the_variables_of_a_sweep_gives_fewer_panels(part):
    found = rs.limit_cycle(SLIDER.replace(M=MANY_MASSES), MANY_SPEEDS)
    fig = plot.figure(found[[part]])
    assert sum(ax.get_label() != "<colorbar>" for ax in fig.axes) == 1
    assert len(plot.figure(found[[part]].isel(M=0)).axes) == 1
    with pytest.raises(rs.ParameterError, match=r"none of .* \(amplitude, frequency, V_max\)"):
        plot.figure(found[["error"]])


def test_a_run_out_of_a_sweep():
    loading = rs.Loading.steps(1e-4, (0.05, V_LP))
    run = rs.simulate(SLIDER, loading, 0.1, times=np.linspace(0.0, 0.1, 50)).isel(V_lp=0)
    t, V = lines(panels(plot.figure(run))[1], "load point")
    np.testing.assert_allclose(t, [0.0, 50.0, 50.0, 100.0])
    np.testing.assert_allclose(V, 1e3 * run.V_load[[0, 0, -1, -1]])


def test_a_page_shows_one_branch():
    branch = rs.continue_cycle(SLIDER.replace(K=6.06e8), "V_lp", 3e-3, 2e-3).reset_coords()
    two = xr.concat([branch, branch], "K")
    with pytest.raises(ParameterError, match="Pick one along 'K'"):
        plot.figure(two)
    plot.figure(two.isel(K=1))
    for few in (0, 1):
        with pytest.raises(ParameterError, match=f"has {few} points, too few"):
            plot.figure(two.isel(K=1, point=slice(few)))


def test_the_slider_s_stiffness_has_the_unit_of_K_c():
    b = xr.DataArray([0.001, 0.003000001], dims="b")  # K_c from -400 MPa/m to 0.2 kPa/m
    (ax, *_) = panels(plot.figure(rs.stability(SLIDER.replace(b=b), 1e-6)))
    assert ax.get_ylabel().endswith("[MPa/m]")
    np.testing.assert_allclose(lines(ax, "$K$ of the slider")[1], 900.0)


@pytest.mark.parametrize(("ending", "magic"), [("png", b"\x89PNG"), ("pdf", b"%PDF")])
def test_pictures_are_the_same_bytes_each_time(ending, magic, tmp_path):
    fig = Figure(figsize=(1, 1))
    first, second = (
        plot.save(fig, tmp_path / f"{name}.{ending}").read_bytes() for name in ("a", "b")
    )
    assert first[:4] == magic
    assert first == second
    assert len([*tmp_path.iterdir()]) == 2


def test_labels_of_a_figure_without_layout_are_not_cut_off(tmp_path):
    sizes = []
    for label in ("", "label"):
        fig = Figure(figsize=(2, 2))
        fig.add_axes((0.0, 0.0, 1.0, 1.0)).set(ylabel=label)
        sizes.append(imread(plot.save(fig, tmp_path / "a.png")).shape)
    assert sizes[1][1] > sizes[0][1]


def test_steady_sliding_beside_a_branch_is_stable_as_the_slider_says():
    slider, V_lp = SLIDER.replace(damping=1e5), 1e-2
    K_c = slider.K_c(V_lp)
    assert K_c < 0.9 * SLIDER.K_c(V_lp)
    branch = rs.continue_cycle(slider, "K", 1.02 * K_c, 0.9 * K_c, V_lp=V_lp, rtol=1e-6)
    ax = plot.branch(branch, Figure().subplots())
    ends = lines(ax, "steady sliding, unstable")[0][-1], lines(ax, "steady sliding, stable")[0][0]
    np.testing.assert_allclose(ends, K_c, rtol=2e-4)


def test_amplitudes_lie_along_one_dimension():
    cycles, ax = rs.limit_cycle(SLIDER, V_LP), Figure().subplots()
    line = plot.amplitudes(cycles, ax, "frequency")
    np.testing.assert_array_equal(line.get_xdata(), cycles.frequency)
    with pytest.raises(ParameterError, match="x = 'M' is unknown"):
        plot.amplitudes(cycles, ax, "M")
    of_masses = rs.limit_cycle(SLIDER.replace(M=MASS), 1e-2)
    line = plot.amplitudes(of_masses, ax, "period")
    np.testing.assert_array_equal(line.get_xdata(), of_masses.period)
    for other in (of_masses, cycles.isel(V_lp=0), cycles[["period"]], None):
        with pytest.raises(ParameterError, match="limit cycles along one dimension"):
            plot.amplitudes(other, ax)


def test_maps_need_an_atlas():
    ax, cycle = Figure().subplots(), rs.limit_cycle(SLIDER, 1e-2)
    chart = rs.atlas(2.0, n=4, transition=False)
    for function, data in ((plot.atlas, cycle), (plot.transition, chart)):
        with pytest.raises(ParameterError, match=r"no variable regime.* ratestate\.atlas"):
            function(data, ax)
    with pytest.raises(ParameterError, match="no variable period along K_over_K_c_qs"):
        plot.contours(chart, "period", ax, [1.0, 2.0])
    for levels in ([0.0, 1.0], [10.0, 1.0], [1.0], 5):
        with pytest.raises(ParameterError, match="cannot be contours"):
            plot.contours(chart, "slip_per_cycle", ax, levels)
    plot.contours(chart, "slip_per_cycle", ax, (1.0, 10.0))


@pytest.mark.parametrize("name", ["a.svg", "a", "nowhere/a.png"])
def test_pictures_have_a_known_ending_and_a_folder(name, tmp_path):
    with pytest.raises(ParameterError, match=r"Give a name that ends in|Make "):
        plot.save(Figure(), tmp_path / name)
