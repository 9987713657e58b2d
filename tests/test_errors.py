"""Errors: their fields, their text, and how commands and scenario files name the parameter."""

import copy
import pickle

import pytest
import xarray as xr
from lab_files import MU, SIGMA, T, X, write
from typer.testing import CliRunner

from ratestate.errors import MissingFileError, ParameterError
from ratestate.interfaces.cli import main
from ratestate.model.units import to_si

LENGTH, STRESS = "Give a length such as '10 um'.", "Give a stress such as '2 MPa'."
MASS = "Give a mass per area such as '3000 kg/m^2'."


def error_of(symbol, value):
    with pytest.raises(ParameterError) as caught:
        to_si(symbol, value)
    return caught.value


@pytest.mark.parametrize(
    ("symbol", "given", "value", "unit", "problem", "remedy"),
    [
        ("Dc", "10 MPa", "'10 MPa'", "", "is a stress", LENGTH),
        ("sigma", -2e6, "-2e+06", "Pa", "must be > 0", STRESS),
        ("M", xr.DataArray([1.0, -2.0], dims="M"), "-2", "kg/m^2", "at M[1] must be >= 0", MASS),
    ],
)
def test_an_error_has_symbol_value_unit_problem_and_remedy(
    symbol, given, value, unit, problem, remedy
):
    error = error_of(symbol, given)
    assert vars(error) == {
        "symbol": symbol,
        "value": value,
        "unit": unit,
        "problem": problem,
        "remedy": remedy,
        "sentence": "",
    }
    shown = f"{value} {unit}".strip()
    assert str(error) == f"{symbol} = {shown} {problem}. {remedy}"
    assert error.text(f"--{symbol}") == f"--{symbol} = {shown} {problem}. {remedy}"
    assert error.text("") == f"{shown} {problem}. {remedy}"


@pytest.mark.parametrize("copied", [copy.copy, lambda error: pickle.loads(pickle.dumps(error))])
@pytest.mark.parametrize("kind", [ParameterError, MissingFileError])
def test_copies_have_all_fields(copied, kind):
    error = kind("does not exist", "Give its path.", symbol="path", value="'x.csv'")
    error.sentence = "file.missing"
    other = copied(error)
    assert type(other) is kind
    assert (vars(other), str(other)) == (vars(error), str(error))
    assert isinstance(other, FileNotFoundError) == (kind is MissingFileError)


def test_commands_name_the_option(tmp_path):
    record = write(tmp_path / "record.txt", (T, X, MU, SIGMA))
    done = CliRunner().invoke(main, ["fit", str(record), "--sigma", "3 m"])
    assert done.exit_code == 2
    assert f"error: --sigma = '3 m' is a length. {STRESS}" in done.stderr.splitlines()
