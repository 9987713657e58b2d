"""``ratestate events``: what it prints and writes."""

import functools
import json

import command_line
import numpy as np
import pandas
import pytest

import ratestate as rs
from ratestate import files

SLIDER = rs.SpringSlider(
    a=0.005, b=0.008, Dc="10 um", sigma="4 MPa", M=100, K="600 MPa/m", law="aging"
)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """A laboratory's file of stick-slip at two speeds."""
    t = np.arange(0.0, 500.0, 0.05)
    loading = rs.Loading.steps("10 um/s", (350.0, "30 um/s"))
    run = rs.simulate(SLIDER, loading, 500.0, V_start="5 um/s", times=t)
    friction = run.tau.values / SLIDER.sigma + 5e-4 * np.random.default_rng(1).normal(size=t.size)
    columns = {"Time(s)": t, "Displ(um)": 1e6 * run.delta_lp.values, "Friction": friction}
    path = tmp_path_factory.mktemp("record") / "p1234.txt"
    pandas.DataFrame(columns).to_csv(path, sep="\t", index=False)
    return path


call = functools.partial(command_line.call, "events")


def test_it_prints_a_table_and_writes_files(written, tmp_path):
    result = call(written, "--sigma", "4 MPa", "--out", tmp_path / "made")
    assert result.exit_code == 0, result.output
    events = files.read(tmp_path / "made" / "events.nc")
    count = events.sizes["event"]
    assert count > 8
    assert f"{count} events" in result.stdout
    assert "MPa/m, from" in result.stdout
    assert "stress drop [kPa]" in result.stdout
    assert "event 1: cut by the record's start" in result.stdout
    table = pandas.read_csv(tmp_path / "made" / "events.csv")
    assert len(table) == count
    np.testing.assert_allclose(table["stress drop (MPa)"], events.stress_drop / 1e6, rtol=1e-9)
    errors = table["stress drop error (MPa)"]
    np.testing.assert_allclose(errors, events.stress_drop_error / 1e6, rtol=1e-9)
    assert table["event status"][0] == "cut by the start"
    assert (tmp_path / "made" / "events.png").stat().st_size > 1000


def test_json_has_all_numbers(written):
    result = call(written, "--sigma", "4 MPa", "--K", "600 MPa/m", "--M", "100 kg/m^2", "--json")
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert document["title"] == "ratestate events"
    drops = [x for x in document["data_vars"]["stress_drop"]["data"] if x is not None]
    assert 3e5 < min(drops) < max(drops) < 5e5
    assert document["data_vars"]["K"]["data"] == 6e8
