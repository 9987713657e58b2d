"""Results in other units, and functions that read them."""

import numpy as np
import pytest
import xarray as xr

import ratestate as rs
from ratestate.files import csv_text, read, write
from ratestate.model.conversion import in_si
from ratestate.scenario import from_result

SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3000)


@pytest.fixture(scope="module")
def run():
    step = rs.Loading.steps("0.1 mm/s", (1.0, "0.3 mm/s"))
    return rs.simulate(SLIDER, step, 2.0, times=np.linspace(0, 2, 201))


@pytest.fixture(scope="module")
def steady():
    return rs.stability(SLIDER.replace(M=rs.logspace("M", 1000, 3000, 3)), "3 mm/s")


def test_converted_values_and_units(run):
    converted = rs.in_units(run, V="um/s", tau="MPa", time="ms")
    np.testing.assert_allclose(converted.V, 1e6 * run.V, rtol=1e-15)
    np.testing.assert_allclose(converted.tau, 1e-6 * run.tau, rtol=1e-15)
    assert float(converted.time[-1]) == 2000.0
    assert [converted[name].units for name in ("V", "tau", "time")] == ["um/s", "MPa", "ms"]
    assert converted.attrs == run.attrs
    assert run.V.units == "m/s"
    names = ["V", "tau", "time"]
    xr.testing.assert_identical(converted.drop_vars(names), run.drop_vars(names))
    xr.testing.assert_identical(rs.in_units(run, t="ms"), rs.in_units(run, time="ms"))


def test_conversion_back_to_si(run):
    converted = rs.in_units(rs.in_units(run, V="um/s", tau="psi"), V="mm/hour")
    back = in_si(converted)
    for name in ("V", "tau"):
        np.testing.assert_allclose(back[name], run[name], rtol=1e-14)
        assert back[name].units == run[name].units
    assert in_si(run) is run


@pytest.mark.parametrize(
    ("units", "message"),
    [
        ({"v": "um/s"}, r"no variable v\. .* Did you mean V\?"),
        ({"V": "MPa"}, "V = 'MPa' is a stress"),
        ({"V": "parsnip"}, "V = 'parsnip' has an unknown unit"),
        ({"status": "1"}, "status is not a quantity"),
        ({"V": 3}, "V = 3 is not a str"),
    ],
)
def test_wrong_names_and_units_are_refused(run, units, message):
    with pytest.raises(rs.ParameterError, match=message):
        rs.in_units(run, **units)


def test_scenario_of_a_converted_result(steady):
    converted = rs.in_units(steady, M="t/m^2", V_lp="mm/s")
    np.testing.assert_allclose(converted.M, [1.0, np.sqrt(3.0), 3.0], rtol=1e-12)
    scenario = from_result(converted)
    np.testing.assert_allclose(scenario.slider.M, steady.M, rtol=1e-15)
    assert scenario.settings["V_lp"] == 3e-3


def test_files_of_a_converted_result(run, tmp_path):
    converted = rs.in_units(run, V="um/s", tau="MPa", time="ms", delta_lp="um")
    assert csv_text(converted).startswith("time [ms],V [um/s],theta [s],delta [m],delta_lp [um],")
    record = rs.read_lab(write(converted, tmp_path / "run.csv"))
    np.testing.assert_allclose(record.delta_lp, run.delta_lp, atol=1e-15)
    np.testing.assert_allclose(record.tau, run.tau, rtol=1e-14)
    kept = read(write(converted, tmp_path / "run.nc"))
    assert kept.V.units == "um/s"
    np.testing.assert_allclose(in_si(kept).V, run.V, rtol=1e-14)


def test_variables_with_the_units_of_other_quantities(run):
    friction = run.tau / 2e6  # has the attributes of tau
    odd = run.assign(friction=friction.assign_attrs(units="Pa"), ratio=friction, amplitude=50.0)
    odd.amplitude.attrs["units"] = "%"
    back = in_si(odd)
    xr.testing.assert_identical(back.friction, odd.friction)
    xr.testing.assert_identical(back.ratio, odd.ratio)
    assert float(back.amplitude) == 0.5
    with pytest.raises(rs.ParameterError, match=r"V = .* is a stress"):
        in_si(run.assign(V=run.V.assign_attrs(units="Pa")))


@pytest.mark.parametrize(
    ("symbol", "unit"), [("Dc", "inch"), ("sigma", "psi"), ("K", "kPa/ft"), ("M", "lb/ft^2")]
)
def test_each_case_of_a_converted_sweep_is_one_slider(symbol, unit):
    """A value that is converted to another unit and back may differ in its last digit."""
    first = getattr(SLIDER, symbol)
    axis = xr.DataArray(first * np.linspace(1.0, 3.0, 41), dims=symbol)
    result = rs.stability(SLIDER.replace(**{symbol: axis}), "3 mm/s")
    converted = rs.in_units(result, **{symbol: unit})
    assert any(in_si(converted)[symbol].values != result[symbol].values)  # else nothing is tested
    for i in range(41):
        slider = from_result(converted.isel({symbol: i})).slider
        assert getattr(slider, symbol) == pytest.approx(float(axis[i]), rel=1e-15)
    part = from_result(converted.isel({symbol: slice(5, 9)})).slider
    assert getattr(part, symbol).sizes == {symbol: 4}
