"""``ratestate lab describe``, and what ``ratestate fit`` makes of several files and of a format."""

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest
from command_line import call, refuse, succeed
from synthetic_records import SLIDER, STEP, record

from ratestate import describe_lab, files
from ratestate.interfaces.cli import command
from ratestate.records.reading.rows import MAX_ROWS


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a record, as one file and as two; its titles say little; no normal stress."""
    folder = tmp_path_factory.mktemp("lab")
    data = record(SLIDER, STEP, np.linspace(0.0, 140.0, 701), noise=3e-4)
    table = np.column_stack([data.time, 1e6 * data.delta_lp, 20 * data.friction])
    for name, rows in (
        ("r.txt", slice(0, 701)),
        ("a.txt", slice(0, 300)),
        ("b.txt", slice(300, 701)),
    ):
        part = table[rows] - [table[rows][0, 0] if name == "b.txt" else 0.0, 0.0, 0.0]
        np.savetxt(folder / name, part, "%.9g", "\t", header="Zeit (s)\tch1\tch2", comments="")
    return folder


OPTIONS = ("--columns", "delta_lp=2", "--columns", "tau=ch2", "--units", "delta_lp=um,tau=MPa",
           "--sigma", "20 MPa", "--K", "60 GPa/m")  # fmt: skip


@pytest.fixture
def lab(folder, monkeypatch):
    monkeypatch.chdir(folder)
    done = succeed("lab", "describe", "r.txt", *OPTIONS)
    Path("mylab.toml").write_text(done.stdout, "utf-8")
    return done.stdout


def test_a_description_is_printed(lab):
    columns, units = {"delta_lp": 2, "tau": "ch2"}, {"delta_lp": "um", "tau": "MPa"}
    assert lab == describe_lab("r.txt", columns, units, sigma="20 MPa", K="60 GPa/m")
    assert tomllib.loads(lab)["machine"] == {"K": "60 GPa/m"}
    done = call("lab", "describe", "r.txt", "--lab-format", "mylab.toml", "--M", "3000 kg/m^2")
    assert tomllib.loads(done.stdout)["machine"] == {"K": "60 GPa/m", "M": "3000 kg/m^2"}
    done = refuse("lab", "describe", "r.txt")
    assert "no column is recognized as delta_lp or V_load" in done.stderr
    assert done.stdout == ""


def test_a_fit_needs_no_other_option_than_the_format(lab):
    given = ("--lab-format", "mylab.toml", "--free", "a,b,Dc", "--errors", "covariance")
    done = call("fit", "r.txt", *given, "--out", "made")
    assert done.exit_code in (0, 3), done.output
    result = files.read("made/fit.nc")
    slider = json.loads(result.attrs["slider"])
    assert (slider["K"], slider["sigma"]) == (6e10, 2e7)  # of the machine, and of the record
    np.testing.assert_allclose(result.Dc, SLIDER.Dc, rtol=0.1)
    assert "read_lab('r.txt', lab_format='mylab.toml')" in Path("made/report.md").read_text("utf-8")
    again = call("fit", "r.txt", *OPTIONS[:6], "--sigma", "20 MPa", "--K", "6e10 Pa/m", "--json")
    assert again.exit_code in (0, 3), again.output  # no column of the file is recognized as sigma
    np.testing.assert_allclose(json.loads(again.stdout)["attrs"]["slider"]["sigma"], 2e7)
    # what is given goes first
    own = call("fit", "r.txt", *given, "--K", "50 GPa/m", "--json")
    assert json.loads(own.stdout)["attrs"]["slider"]["K"] == 5e10


def test_several_files_are_joined(lab):
    names, given = ["a.txt", "b.txt"], ("--lab-format", "mylab.toml")
    call("fit", *names, *given, "--join", "restart", "--out", "joined")
    two, one = (
        files.read("joined/fit.nc"),
        json.loads(call("fit", "r.txt", *given, "--json").stdout),
    )
    for symbol in ("a", "b", "Dc"):
        np.testing.assert_allclose(two[symbol], one["data_vars"][symbol]["data"], rtol=1e-3)
    text = Path("joined/report.md").read_text("utf-8")
    assert text.startswith("# Fit of a.txt, b.txt")
    assert "read_lab(['a.txt', 'b.txt'], lab_format='mylab.toml'" in text
    done = call("fit", *names, *given, "--join", "absolute")
    assert (done.exit_code, "b.txt begins at 0 s (line 2)" in done.stderr) == (2, True)


def test_the_help_says_how_many_rows_are_read():
    tables = tomllib.loads((Path(command.__file__).parent / "commands.toml").read_text("utf-8"))
    assert tables["shared"]["max_rows"]["show_default"] == str(MAX_ROWS)
