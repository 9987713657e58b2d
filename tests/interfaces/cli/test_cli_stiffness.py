"""``ratestate stiffness``: what it prints and writes."""

import functools
import json

import command_line
import numpy as np
import pandas
import pytest
from machine_records import SLIDER, clean, noisy

import ratestate as rs

call = functools.partial(command_line.call, "stiffness")


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """A laboratory's file with two holds."""
    data = noisy(1, clean()).sel(time=slice(0.0, 189.0))
    table = np.column_stack([data.time, 1e6 * data.delta_lp, data.friction])
    path = tmp_path_factory.mktemp("lab") / "machine.txt"
    head = "Time(s)\tDispl(microns)\tFriction"
    np.savetxt(path, table, "%.9g", "\t", header=head, comments="")
    return path


def test_it_prints_and_writes_all(file, tmp_path):
    done = call(file, "--sigma", "10 MPa", "--out", tmp_path)
    assert done.exit_code == 0, done.output
    assert done.stdout.startswith("K = ")
    assert "M: not found" in done.stdout
    names = {f"stiffness.{ending}" for ending in ("nc", "csv", "png")} | {"stiffness_summary.csv"}
    assert {one.name for one in tmp_path.iterdir()} == names
    result = rs.files.read(tmp_path / "stiffness.nc")
    assert abs(float(result.K) - SLIDER.K) < 4.0 * float(result.K_error) < 0.1 * SLIDER.K
    table = pandas.read_csv(tmp_path / "stiffness.csv")
    np.testing.assert_allclose(1e9 * table["slope K (GPa/m)"], result.slope_K)
    K, M, damping = pandas.read_csv(tmp_path / "stiffness_summary.csv").to_dict("records")
    assert (K["quantity"], K["unit"]) == ("K", "GPa/m")
    assert 1e9 * K["value"] == pytest.approx(float(result.K), rel=1e-9)
    assert 1e9 * K["error"] == pytest.approx(float(result.K_error), rel=1e-9)
    assert K["scatter over errors"] == pytest.approx(float(result.K_scatter), rel=1e-9)
    assert (M["quantity"], damping["unit"]) == ("M", "MPa s/m")
    assert np.isnan(M["value"])  # not found


def test_json_and_wrong_use(file):
    done = call(file, "--sigma", "10 MPa", "--json")
    assert done.exit_code == 0
    assert json.loads(done.stdout)["data_vars"]["K"]["attrs"]["units"] == "Pa/m"
    missing = call(file)
    assert missing.exit_code == 2
    assert "Give sigma" in missing.stderr
