"""`plot.trace` and `plot.figure` of runs: one, several, without mass, without any motion."""

import contextlib

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

import ratestate as rs
from ratestate import ParameterError, plot
from ratestate.errors import RunWarning
from ratestate.plot.labels import BLUE, RED

SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=2e9, M=3e3, V0=1e-9)
STEP = rs.Loading.steps(1e-4, (0.05, 3.2e-3))
TIMES = np.linspace(0.0, 0.1, 101)


def run_of(loading=STEP, t_end=0.1, **changes):
    return rs.simulate(SLIDER.replace(**changes), loading, t_end)


def drawn(run, **how):
    ax = Figure().subplots()
    return ax, plot.trace(run, ax, **how)


def panels(fig):
    fig.draw_without_rendering()
    return sorted(fig.axes, key=lambda ax: ax.get_label())


def labels(lines):
    return [line.get_label() for line in lines]


def legend(ax):
    return [text.get_text() for text in ax.get_legend().texts]


def test_without_mass_there_is_one_line():
    massless = run_of(M=0.0, K=8e9)
    np.testing.assert_allclose(massless.mu, massless.tau / SLIDER.sigma, rtol=1e-12)
    ax, (black, red) = drawn(massless, tau={"lw": 2.5})
    assert black is red
    assert [*ax.lines] == [black]
    assert (black.get_label(), black.get_lw()) == (r"$\tau/\sigma$ = $\mu$ ($M$ = 0)", 2.5)
    ax, (black, red) = drawn(run_of(M=1e-9))
    assert len(ax.lines) == 2


def test_laws_have_their_own_lines():
    runs = [run_of(law=law) for law in ("slip", "aging")]
    ax, lines = drawn(runs)
    assert [line.get_color() for line in lines] == [RED, BLUE]
    assert lines[1].get_linestyle() != lines[0].get_linestyle()
    assert legend(ax) == labels(lines) == ["slip law", "aging law"]
    assert ax.get_ylabel() == plot.STRESS
    for line, run in zip(lines, runs, strict=True):
        np.testing.assert_allclose(line.get_xdata(), 1e3 * run.time)
        np.testing.assert_allclose(line.get_ydata(), run.tau / 2e6)


def test_runs_are_named_by_what_differs():
    runs = [run_of(K=K, sigma=sigma) for K, sigma in ((2e9, 2e6), (3e9, 2e6), (2e9, 1e6))]
    _, lines = drawn(runs)
    assert labels(lines) == [
        r"$\sigma$ = 2 MPa, $K$ = 2 GPa/m",
        r"$\sigma$ = 2 MPa, $K$ = 3 GPa/m",
        r"$\sigma$ = 1 MPa, $K$ = 2 GPa/m",
    ]
    assert len({tuple(line.get_color()) for line in lines}) == 3
    slow = run_of(rs.Loading.steps(1e-4, (0.05, 1e-3)))
    assert labels(drawn([runs[0], slow])[1]) == ["$V_{lp}$ = 3.2 mm/s", "$V_{lp}$ = 1 mm/s"]
    assert labels(drawn([runs[0], runs[0]])[1]) == ["run 1", "run 2"]
    assert labels(drawn({"stiff": runs[1], 2: runs[0]})[1]) == ["stiff", "2"]


def test_runs_that_differ_in_law_and_K_have_own_colours_and_dashes_by_law():
    runs = [run_of(law=law, K=K) for law in ("slip", "aging") for K in (2e9, 3e9)]
    _, lines = drawn(runs)
    assert len({tuple(line.get_color()) for line in lines}) == 4
    assert [line.get_linestyle() for line in lines] == ["-", "-", "--", "--"]


def test_runs_along_a_dimension_are_named_by_its_values():
    K = xr.DataArray([1e9, 2e9, 4e9], dims="K")
    runs = rs.simulate(SLIDER.replace(K=K), STEP, 0.1, times=TIMES)
    ax, lines = drawn(runs, x="delta_lp")
    assert legend(ax) == [f"$K$ = {value} GPa/m" for value in (1, 2, 4)]
    np.testing.assert_allclose(lines[2].get_ydata(), runs.tau.isel(K=2) / 2e6)
    assert ax.get_xlabel() == "Load-point displacement [\N{GREEK SMALL LETTER MU}m]"
    assert len(drawn(runs.isel(K=1))[1]) == 2


def test_runs_with_times_of_their_own():
    t_end = xr.DataArray([0.1, 0.2], dims="case")
    times = t_end * xr.DataArray(np.linspace(0, 1, 11), dims="time")
    runs = rs.simulate(SLIDER, STEP, t_end, times=times)
    _, lines = drawn(runs)
    assert [line.get_xdata()[-1] for line in lines] == [100.0, 200.0]
    np.testing.assert_allclose(drawn(runs.isel(case=1))[1][0].get_xdata()[-1], 200.0)


def test_a_failed_run_is_named_as_such():
    K = xr.DataArray([4e8, 5e8, 8e9], dims="K")
    runs = rs.simulate(SLIDER.replace(K=K, M=0.0), STEP, 0.1, times=TIMES)
    shown = ["$K$ = 0.5 GPa/m (no answer)", "$K$ = 8 GPa/m"]
    assert legend(drawn(runs)[0])[1:] == shown
    *_, plane = panels(plot.figure(runs))
    assert np.isfinite(plane.get_xlim()).all()
    assert "Runs over" in plot.figure(runs.isel(K=[0, 1])).get_suptitle()


@pytest.mark.parametrize(
    ("runs", "message"),
    [
        ([], "the list of runs is empty"),
        ({}, "the list of runs is empty"),
        ([rs.stability(SLIDER, 1e-3)], "a run is not a Dataset"),
        (3, "a run is not a Dataset"),
    ],
)
def test_data_that_are_not_runs_are_refused(runs, message):
    with pytest.raises(ParameterError, match=message):
        drawn(runs)


def test_runs_over_two_dimensions():
    two = SLIDER.replace(K=xr.DataArray([1e9, 2e9], dims="K"), M=xr.DataArray([1, 2], dims="M"))
    runs = rs.simulate(two, STEP, 0.1, times=TIMES)
    with pytest.raises(ParameterError, match=r"2 dimensions \(K, M\).*Pick values"):
        drawn(runs)
    with pytest.raises(ParameterError, match="a run has the dimension 'K'"):
        drawn([runs.isel(M=0)])


def test_a_page_compares_runs(looks_as_before):
    K = xr.DataArray([6e8, 9e8, 2e9], dims="K")
    runs = rs.simulate(SLIDER.replace(K=K), STEP, 0.1, times=TIMES)
    fig = looks_as_before(plot.figure(runs), "page_runs")
    stress, speed, plane = panels(fig)
    names = [f"$K$ = {value} GPa/m" for value in (0.6, 0.9, 2)]
    assert legend(stress) == names
    assert legend(speed) == ["load point"]
    assert labels(speed.lines) == ["load point", *names]
    np.testing.assert_allclose(speed.lines[2].get_ydata(), 1e3 * runs.V.isel(K=1))
    assert "3 runs, slip (Ruina) law" in fig.get_suptitle()
    assert "$M$ = 3000" in fig.get_suptitle()
    assert "$K$" not in fig.get_suptitle()
    assert sum(line.get_marker() == "x" for line in plane.lines) == 1


def test_a_page_of_laws_and_one_of_a_single_run():
    runs = {law: run_of(law=law) for law in ("slip", "aging")}
    stress, *_ = panels(fig := plot.figure(runs))
    assert [line.get_color() for line in stress.lines] == [RED, BLUE]
    assert "aging (Dieterich) law and slip (Ruina) law" in fig.get_suptitle()
    assert plot.figure([runs["slip"]]).get_suptitle() == plot.figure(runs["slip"]).get_suptitle()
    with pytest.raises(ParameterError, match="a figure of several runs"):
        plot.figure([runs["slip"].assign_attrs(title="other")])


@pytest.mark.parametrize("number", [5, 6])
def test_a_page_of_many_runs_is_that_of_their_sweep(number):
    K = rs.logspace("K", 1e9, 2e9, number)
    runs = rs.simulate(SLIDER.replace(K=K), STEP, 0.1, times=TIMES)
    compared = "runs" in plot.figure(runs).get_suptitle()
    assert compared == (number == 5)
    assert "Runs over" in plot.figure(runs.isel(time=[-1])).get_suptitle()


@pytest.mark.parametrize("V", [1e-3, 2e-2])
def test_a_constant_quantity_has_short_ticks(V):
    stable = rs.stability(SLIDER, V).stable
    with contextlib.nullcontext() if stable else pytest.warns(RunWarning):
        run = run_of(rs.Loading.constant(V), 5.0)
    stress, speed, plane = panels(plot.figure(run))
    mu = 0.6 - 0.003 * np.log(V / 1e-9)
    for axis, value in (
        (stress.yaxis, mu),
        (speed.yaxis, 1e3 * V),
        (plane.xaxis, mu),
        (plane.yaxis, 1e3 * V),
    ):
        ticks = [text.get_text() for text in axis.get_ticklabels()]
        assert len(ticks) >= 2
        assert max(map(len, ticks)) <= 5, ticks
        low, high = axis.get_view_interval()
        assert low < value < high
        assert 0.08 < (high - low) / value < 0.25


def test_a_small_motion_fills_its_axis():
    run = run_of(rs.Loading.constant(1e-3)).assign(tau=lambda run: run.tau * (1 + 2e-5 * run.time))
    ax, _ = drawn(run)
    low, high = ax.get_ylim()
    assert 1e-6 < high - low < 2e-6


def test_a_later_run_widens_the_range_of_a_constant_one():
    ax, _ = drawn(run_of(rs.Loading.constant(1e-4)))
    run = run_of()
    plot.trace(run, ax)
    low, high = ax.get_ylim()
    assert low < float(run.tau.min() / 2e6) < float(run.tau.max() / 2e6) < high


def test_a_run_that_ran_away_is_drawn():
    with pytest.raises(rs.QuasiStaticInstability) as raised:
        run_of(M=0.0, K=5e8)
    fig = plot.figure(raised.value.best)
    _, speed, _ = panels(fig)
    assert "up to the quasi-static instability" in fig.get_suptitle()
    assert speed.get_yscale() == "log"


def test_a_run_against_slip_begins_at_zero():
    run = run_of()
    ax, lines = drawn(run, x="delta")
    slip, stress = lines[0].get_data()
    assert ax.get_xlabel() == "Slip [\u03bcm]"
    assert slip[0] == 0.0
    np.testing.assert_allclose(1e-6 * slip, run.delta - run.delta[0], rtol=1e-12)
    np.testing.assert_array_equal(stress, run.tau / SLIDER.sigma)
    assert float(run.delta[0]) < -1e-5  # by the stretch of the spring


def test_another_abscissa_is_refused():
    with pytest.raises(ParameterError, match=r"x = 'delt' is unknown.* Did you mean delta"):
        drawn(run_of(), x="delt")


def test_the_phase_plane_shows_one_run():
    ax = Figure().subplots()
    line = plot.phase(run_of(), ax)
    assert line in ax.lines
    sweep = rs.simulate(SLIDER.replace(M=xr.DataArray([1.0, 2.0], dims="M")), STEP, 0.1)
    for other, message in ((sweep, "dimension 'M'"), (None, "simulate")):
        with pytest.raises(ParameterError, match=message):
            plot.phase(other, ax)


def test_times_are_counted_from_another_one():
    run = run_of(t_end=0.06)
    twice = plot.since(plot.since(rs.in_units(run, time="ms"), 0.02), 0.03)
    np.testing.assert_allclose(twice.time, run.time - 0.05, atol=1e-15)
    assert twice.attrs["t_zero"] == pytest.approx(0.05)
    times = xr.DataArray([[0.0, 0.06], [0.0, 0.05]], dims=("M", "time"))
    slider = SLIDER.replace(M=xr.DataArray([1.0, 2.0], dims="M"))
    own = rs.simulate(slider, STEP, 0.06, times=times)
    np.testing.assert_allclose(plot.since(own, 0.05).t, times - 0.05)
    with pytest.raises(ParameterError, match="simulate"):
        plot.since(xr.Dataset(), 0.0)
