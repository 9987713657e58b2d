"""Results in other units, and what reads them afterwards."""

import numpy as np
import pytest
import xarray as xr
from ratestate.scenario import from_result

import ratestate as rs
from ratestate.files import csv_text, read, write
from ratestate.model.conversion import in_si

SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3000)


@pytest.fixture(scope="module")
def run():
    step = rs.Loading.steps("0.1 mm/s", (1.0, "0.3 mm/s"))
    return rs.simulate(SLIDER, step, 2.0, times=np.linspace(0, 2, 201))


@pytest.fixture(scope="module")
def steady():
    return rs.stability(SLIDER.replace(M=rs.logspace("M", 1000, 3000, 3)), "3 mm/s")


def test_values_and_units(run):
    mine = rs.in_units(run, V="um/s", tau="MPa", time="ms")
    np.testing.assert_allclose(mine.V, 1e6 * run.V, rtol=1e-15)
    np.testing.assert_allclose(mine.tau, 1e-6 * run.tau, rtol=1e-15)
    assert float(mine.time[-1]) == 2000.0
    assert [mine[name].units for name in ("V", "tau", "time")] == ["um/s", "MPa", "ms"]
    assert mine.attrs == run.attrs
    assert run.V.units == "m/s"
    others = ["V", "tau"]
    xr.testing.assert_identical(mine.drop_vars([*others, "time"]), run.drop_vars([*others, "time"]))
    xr.testing.assert_identical(rs.in_units(run, t="ms"), rs.in_units(run, time="ms"))


def test_back_to_si(run):
    mine = rs.in_units(rs.in_units(run, V="um/s", tau="psi"), V="mm/hour")
    back = in_si(mine)
    for name in ("V", "tau"):
        np.testing.assert_allclose(back[name], run[name], rtol=1e-14)
        assert back[name].units == run[name].units
    assert in_si(run) is run


@pytest.mark.parametrize(
    ("units", "message"),
    [
        ({"v": "um/s"}, "no variable v; expected one of V, .*; did you mean V?"),
        ({"V": "MPa"}, r"V: 'MPa' is a stress \[Pa\]; expected a speed"),
        ({"V": "parsnip"}, "V: 'parsnip' has an unknown unit"),
        ({"status": "1"}, "status is no quantity with a unit"),
        ({"V": 3}, "V = 3: a unit is a str, such as 'um/s'"),
    ],
)
def test_refused(run, units, message):
    with pytest.raises(rs.ParameterError, match=message):
        rs.in_units(run, **units)


def test_what_made_a_converted_result(steady):
    mine = rs.in_units(steady, M="t/m^2", V_lp="mm/s")
    np.testing.assert_allclose(mine.M, [1.0, np.sqrt(3.0), 3.0], rtol=1e-12)
    scenario = from_result(mine)
    np.testing.assert_allclose(scenario.slider.M, steady.M, rtol=1e-15)
    assert scenario.settings["V_lp"] == 3e-3


def test_figures_of_a_converted_result(run):
    from matplotlib.figure import Figure

    from ratestate.plot import phase, trace

    mine = rs.in_units(run, V="um/s", tau="MPa", time="ms", V_load="um/s")
    for draw in (trace, phase):
        ours, theirs = Figure().subplots(), Figure().subplots()
        draw(run, ours)
        draw(mine, theirs)
        assert ours.get_xlabel() == theirs.get_xlabel()
        for one, other in zip(ours.lines, theirs.lines, strict=True):
            np.testing.assert_allclose(one.get_xydata(), other.get_xydata(), rtol=1e-14)


def test_files_of_a_converted_result(run, tmp_path):
    mine = rs.in_units(run, V="um/s", tau="MPa", time="ms", delta_lp="um")
    assert csv_text(mine).startswith("time [ms],V [um/s],theta [s],delta [m],delta_lp [um],")
    record = rs.read_lab(write(mine, tmp_path / "run.csv"))
    np.testing.assert_allclose(record.delta_lp, run.delta_lp, atol=1e-15)
    np.testing.assert_allclose(record.tau, run.tau, rtol=1e-14)
    kept = read(write(mine, tmp_path / "run.nc"))
    assert kept.V.units == "um/s"
    np.testing.assert_allclose(in_si(kept).V, run.V, rtol=1e-14)


def test_units_that_mean_nothing_or_something_else(run):
    friction = run.tau / 2e6  # which keeps the attributes of tau
    odd = run.assign(friction=friction.assign_attrs(units="Pa"), mine=friction, amplitude=50.0)
    odd.amplitude.attrs["units"] = "%"
    back = in_si(odd)
    xr.testing.assert_identical(back.friction, odd.friction)
    xr.testing.assert_identical(back.mine, odd.mine)
    assert float(back.amplitude) == 0.5
    with pytest.raises(rs.ParameterError, match=r"V: .* is a stress"):
        in_si(run.assign(V=run.V.assign_attrs(units="Pa")))


@pytest.mark.parametrize(
    ("symbol", "unit"), [("Dc", "inch"), ("sigma", "psi"), ("K", "kPa/ft"), ("M", "lb/ft^2")]
)
def test_each_case_of_a_converted_sweep_is_one_slider(symbol, unit):
    """Converted there and back, a value may differ in its last digit."""
    first = getattr(SLIDER, symbol)
    axis = xr.DataArray(first * np.linspace(1.0, 3.0, 41), dims=symbol)
    result = rs.stability(SLIDER.replace(**{symbol: axis}), "3 mm/s")
    mine = rs.in_units(result, **{symbol: unit})
    assert any(in_si(mine)[symbol].values != result[symbol].values)  # else this shows nothing
    for i in range(41):
        slider = from_result(mine.isel({symbol: i})).slider
        assert getattr(slider, symbol) == pytest.approx(float(axis[i]), rel=1e-15)
    part = from_result(mine.isel({symbol: slice(5, 9)})).slider
    assert getattr(part, symbol).sizes == {symbol: 4}
