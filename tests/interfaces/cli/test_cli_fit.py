"""``ratestate fit``: what it prints, writes and returns."""

import dataclasses
import functools
import json
import re
import tomllib
import warnings
from pathlib import Path

import command_line
import numpy as np
import pytest
from lab_files import record_columns, write
from naive import FIG2
from synthetic_records import SLIDER, STEP, record

import ratestate as rs
from ratestate import files
from ratestate.interfaces.cli import command, run_fit
from ratestate.model.quantities import with_error
from ratestate.model.units import to_si

WINDOW = ["--time", "10 s,135 s"]


call = functools.partial(command_line.call, "fit")


def written(path, *, noise=3e-4, sigma=True, rows=701):
    """A laboratory's file of a velocity step."""
    data = record(SLIDER, STEP, np.linspace(0.0, 140.0, rows), noise=noise)
    stress = {"Normal_stress(MPa)": np.full(rows, 20.0)} if sigma else {}
    return write(path, record_columns(data, **stress), number="{:.9g}".format)


def _options():
    """What commands.toml says of the options."""
    return tomllib.loads((Path(command.__file__).parent / "commands.toml").read_text())["fit"]


def test_help_states_the_initial_guesses():
    """commands.toml repeats them, so that the help need not load what fits."""
    options = _options()
    assert {s: options[s]["show_default"] for s in run_fit.STARTS} == run_fit.STARTS
    assert options["K"]["show_default"] == f"sigma times {run_fit.STIFFNESS:.0f}/m"
    defaults = {field.name: field.default for field in dataclasses.fields(rs.SpringSlider)}
    assert float(options["M"]["show_default"]) == defaults["M"]
    assert to_si("V0", options["V0"]["show_default"]) == defaults["V0"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a record, and a report on it under both laws; what was printed."""
    folder = tmp_path_factory.mktemp("lab")
    written(folder / "step.txt", rows=351)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        done = call("step.txt", "--law", "slip,aging", *WINDOW, "--out", "made")
    return folder, done


def test_fit_prints_the_steps_found_and_the_estimates_under_both_laws(folder):
    path, done = folder
    result = files.read(path / "made" / "fit.nc")
    assert "velocity step 1 -> 10 um/s at 100.0 s" in done.stdout
    for law in ("slip", "aging"):
        one = result.sel(law=law)
        error = 1e6 * float(one.standard_error.sel(parameter="Dc"))
        assert with_error(1e6 * float(one.Dc), error) in done.stdout
    assert result.attrs["comparison"].split(":")[0] in " ".join(done.stdout.split())
    assert "fit of step.txt, slip and aging laws ..." in done.stderr
    assert "note: sigma = 20 MPa is the median of the record, because none was given" in done.stdout
    assert float(result.Dc.sel(law="slip")) == pytest.approx(SLIDER.Dc, rel=0.2)
    assert result.attrs["source"] == "step.txt"


def test_warnings_of_a_law_that_fits_clearly_worse_do_not_come_first(folder):
    path, done = folder
    result = files.read(path / "made" / "fit.nc")
    said = str(result.warnings.sel(law="aging").item()).splitlines()
    assert said  # it does not fit what the slip law made
    assert done.exit_code == 0
    assert "warning:" not in done.stdout
    report = (path / "made" / "report.md").read_text("utf-8")
    assert report.index(said[0].split(";")[0]) > report.index("| a |")


def test_a_fit_that_carries_warnings_ends_with_3_and_says_so_first(folder, monkeypatch):
    path, _ = folder
    monkeypatch.chdir(path)
    done = call("step.txt", "--law", "aging", *WINDOW, "--out", "aging")
    assert done.exit_code == 3
    assert "warning: aging law: " in done.stdout
    report = (path / "aging" / "report.md").read_text("utf-8")
    assert report.index("warning: aging law: ") < report.index("| a |")


def test_the_report_has_the_estimates_and_the_picture(folder):
    path, _ = folder
    report = (path / "made" / "report.md").read_text("utf-8")
    result = files.read(path / "made" / "fit.nc").sel(law="slip")
    (row,) = (line for line in report.splitlines() if line.startswith("| K [GPa/m] |"))
    cells = [cell.strip().strip("*") for cell in row.split("|")[1:-1]]
    error = 1e-9 * float(result.standard_error.sel(parameter="K"))
    assert cells[1] == with_error(1e-9 * float(result.K), error).replace("+-", "\u00b1")
    low, high = (float(text) for text in cells[3].split(" to "))
    ends = 1e-9 * result.interval.sel(parameter="K", level=0.95).values
    assert (low, high) == (pytest.approx(ends[0], abs=error), pytest.approx(ends[1], abs=error))
    assert report.startswith("# Fit of step.txt\n")
    (picture,) = re.findall(r"!\[.*\]\((.*)\)", report)
    assert (path / "made" / picture).read_bytes()[:4] == b"\x89PNG"
    assert sorted(p.name for p in (path / "made").iterdir()) == ["fit.nc", "fit.png", "report.md"]


def test_the_lines_of_the_report_make_the_result_again(folder, monkeypatch):
    path, _ = folder
    report = (path / "made" / "report.md").read_text("utf-8")
    code = report.partition("```python\n")[2].partition("```")[0]
    monkeypatch.chdir(path)
    lines, made = code.replace('"fit.png"', '"again.png"'), {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rs.FitWarning)
        exec(lines, made)
    stored = files.read(path / "made" / "fit.nc")
    for name in ("a", "b", "Dc", "K", "mu0"):
        np.testing.assert_allclose(made["result"][name], stored[name], rtol=1e-12)
    assert (path / "again.png").is_file()
    best = stored.sel(law="slip")
    assert made["fitted"] == SLIDER.replace(
        **{name: float(best[name]) for name in ("a", "b", "Dc", "K", "mu0")}
    )


def test_json_and_options(tmp_path):
    path = written(tmp_path / "step.txt", sigma=False, rows=401)
    given = ["--sigma", "20 MPa", "--K", "64 GPa/m", "--free", "a, b,Dc", "--trend", "none"]
    noise = ["--noise", "white=3e-4,red=1e-5,time=1 s", "--errors", "covariance"]
    done = call(path, *given, *noise, "--columns", "friction=3", "--units", "friction=1", "--json")
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    variables, attrs = found["data_vars"], found["attrs"]
    assert attrs["free"] == ["a", "b", "Dc"]
    assert variables["warnings"]["data"] == ""
    assert (attrs["slider"]["sigma"], attrs["slider"]["K"]) == (2e7, 6.4e10)
    assert "K" not in variables
    assert variables["noise_red"]["data"] == 1e-5
    assert variables["a"]["data"] == pytest.approx(SLIDER.a, rel=0.05)
    assert [path.name for path in tmp_path.iterdir()] == ["step.txt"]


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
def test_parameters_of_the_law_are_set_or_free(folder):
    """Of two laws one has them; what is neither is asked for, what no law has is refused."""
    path, _ = folder
    both = (path / "step.txt", "--law", "slip,two-state-slip", *WINDOW, "--errors", "covariance")
    done = call(*both, "--free", "a,b,Dc,K,b2", "--set", "Dc2=120 um", "--json")
    answer = json.loads(done.stdout)
    assert answer["attrs"]["slider"]["Dc2"] == 1.2e-4
    assert answer["attrs"]["free"] == ["a", "b", "Dc", "b2", "K"]
    slip, two = answer["data_vars"]["b2"]["data"]
    assert slip is None
    assert abs(two) < 2e-3  # the record has one state
    lacking = call(*both, "--free", "a,b,Dc,K,b2")
    assert "Dc2 is neither free nor given. Add --set Dc2=VALUE" in lacking.stderr
    own = _options()["of_law"]
    assert "its value, or first guess if --free names it" in own["help"]
    assert own["show_default"].endswith("else required")  # as Dc2 above
    foreign = call(*both, "--set", "c=1")
    said = " ".join(foreign.stderr.replace("│", " ").split())
    assert "'c' is not a parameter of the law's own" in said
    unnamed = call(*both, "--set", "120 um")
    assert "'120 um' has no NAME=..." in " ".join(unnamed.stderr.split())


def test_a_fit_of_cycles_writes_its_report_and_picture(tmp_path):
    slider = rs.SpringSlider(**FIG2).replace(K=7e8)
    t = np.linspace(0.0, 2.0, 4001)
    run = rs.simulate(slider, rs.Loading.constant(3.2e-3), 2.0, V_start=3e-3, times=t)
    noise = 1e-4 * np.random.default_rng(1).normal(size=t.size)
    data = run[["delta_lp"]].assign(friction=run.tau / slider.sigma + noise)
    write(tmp_path / "cycles.txt", record_columns(data.isel(time=slice(1000, None))))
    options = ["--sigma", "2 MPa", "--K", "7e8 Pa/m", "--M", f"{slider.M} kg/m^2"]
    options += ["--a", slider.a, "--Dc", "10 um", "--free", "b", "--against", "cycles"]
    out = tmp_path / "made"
    done = call(tmp_path / "cycles.txt", *options, "--out", out)
    assert done.exit_code in (0, 3), done.output
    assert {one.name for one in out.iterdir()} == {"fit.nc", "fit.png", "report.md"}
    result = files.read(out / "fit.nc")
    assert float(result.b) == pytest.approx(slider.b, rel=0.02)
    assert f"chi-square {float(result.chi2):.3g}" in " ".join(done.stdout.split())
