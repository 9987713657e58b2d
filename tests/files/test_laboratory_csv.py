"""Tables in a laboratory's units."""

import io

import numpy as np
import pandas
import pytest
import xarray

import ratestate as rs
from ratestate.files import laboratory_csv
from ratestate.model.conversion import in_units
from ratestate.model.quantities import attrs


@pytest.fixture
def data():
    drop = np.array([2.5e6, np.nan, 3.5e6])
    flags = {"flag_values": np.array([0, 1], np.int8), "flag_meanings": "whole cut_by_the_end"}
    variables = {
        "stress_drop": ("event", drop, attrs("stress_drop")),
        "stress_drop_error": ("event", 1e-3 * drop, attrs("stress_drop_error")),
        "slip": ("event", [1e-5, 2e-5, 3e-5], attrs("slip")),
        "event_status": ("event", np.array([0, 1, 0], np.int8), attrs("event_status") | flags),
        "event_message": ("event", ["", "cut, by the end", ""], attrs("event_message")),
        "tau": ("time", np.zeros(5), attrs("tau")),
    }
    return xarray.Dataset(variables, {"event": ("event", [1, 2, 3], {"long_name": "event"})})


def test_units_fit_and_errors_are_beside_values(data):
    text = laboratory_csv(data, "event")
    table = pandas.read_csv(io.StringIO(text), keep_default_na=False)
    assert table.columns.tolist() == [
        "event",
        "stress drop (MPa)",
        "stress drop error (MPa)",
        "slip (um)",
        "event status",
        "event message",
    ]
    assert table["stress drop (MPa)"].tolist() == ["2.5", "", "3.5"]
    assert [float(x) for x in table["stress drop error (MPa)"][[0, 2]]] == [
        2.5e-3,
        3.5e-3,
    ]
    np.testing.assert_allclose(table["slip (um)"], [10.0, 20.0, 30.0], rtol=1e-12)
    assert table.iloc[1, 4:].tolist() == ["cut by the end", "cut, by the end"]


@pytest.mark.parametrize("factor", [1e-6, 1e6])
@pytest.mark.parametrize(
    ("name", "unit", "size"),
    [
        *(("V_before", "um/s", 1e-6), ("tau_max", "MPa", 1e6), ("Dc", "um", 1e-6)),
        *(("step_delta_lp", "mm", 1e-3), ("t_hold", "s", 1.0), ("K", "GPa/m", 1e9)),
        *(("damping", "MPa s/m", 1e6), ("M", "kg/m^2", 1.0), ("trend_slip", "1/m", 1.0)),
    ],
)
def test_a_quantity_has_one_unit_whatever_its_values(name, unit, size, factor):
    one = xarray.Dataset({name: ("event", [2.0 * factor * size], attrs(name))})
    heading = f"{name.replace('_', ' ')} ({unit})"
    (value,) = pandas.read_csv(io.StringIO(laboratory_csv(one, "event")))[heading]
    assert value == pytest.approx(2.0 * factor, rel=1e-9)
    empty = laboratory_csv(one.isel(event=[]), "event")
    assert empty == f"{heading}\n"


def test_lines_of_a_text_are_joined_in_one_cell():
    texts = ["one\ntwo, three", "four"]
    text = laboratory_csv(xarray.Dataset({"warnings": ("step", texts)}), "step")
    assert text == 'warnings\n"one | two, three"\nfour\n'


def test_units_may_be_chosen(data):
    chosen = laboratory_csv(data, "event", {"stress_drop": "kPa"})
    assert "stress drop (kPa)" in chosen
    assert "\n1,2500,2.5,10," in chosen
    assert laboratory_csv(in_units(data, slip="mm"), "event") == laboratory_csv(data, "event")


@pytest.mark.parametrize(
    ("dim", "units", "text"),
    [
        ("steps", {}, "no variable along 'steps'"),
        ("event", {"drop": "kPa"}, "no variable drop"),
        ("event", {"slip": "kPa"}, "slip = 'kPa'"),
    ],
)
def test_unknown_variables_are_refused(data, dim, units, text):
    with pytest.raises(rs.ParameterError, match=text):
        laboratory_csv(data, dim, units)
