"""``ratestate healing``: what it prints, writes and returns; its page."""

import functools
import io
import json

import command_line
import numpy as np
import pandas
import pytest
from slide_hold_slide import noisy

import ratestate as rs
from ratestate import plot
from ratestate.report.summary_csv import summary_csv

call = functools.partial(command_line.call, "healing")


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """A laboratory's file with holds."""
    data = noisy(1)
    columns = {"Time(s)": data.time, "Displ(microns)": 1e6 * data.delta_lp}
    columns |= {"Friction": data.friction}
    path = tmp_path_factory.mktemp("lab") / "holds.txt"
    table = np.column_stack([np.asarray(values) for values in columns.values()])
    np.savetxt(path, table, "%.9g", "\t", header="\t".join(columns), comments="")
    return path


def test_it_prints_and_writes_all(file, tmp_path):
    done = call(file, "--out", tmp_path)
    assert done.exit_code == 0, done.output
    assert "Healing in holds.txt: 4 of 4 holds evaluated" in done.stdout
    names = {f"healing.{ending}" for ending in ("nc", "csv", "png")}
    assert {one.name for one in tmp_path.iterdir()} == {*names, "healing_summary.csv"}
    table = pandas.read_csv(tmp_path / "healing.csv")
    result = rs.files.read(tmp_path / "healing.nc")
    np.testing.assert_allclose(table["V before (um/s)"], 10.0, rtol=1e-3)
    np.testing.assert_allclose(table["delta mu"], result.delta_mu)
    np.testing.assert_allclose(table["t hold (s)"], [3, 10, 30, 100], rtol=0.01)
    rates = pandas.read_csv(tmp_path / "healing_summary.csv").set_index("quantity")
    assert rates.columns.tolist() == ["unit", "value", "error", "scatter over errors"]
    assert rates.index.tolist() == ["beta", "beta c"]
    assert rates.value["beta"] == pytest.approx(float(result.beta), rel=1e-9)
    assert rates.error["beta c"] == pytest.approx(float(result.beta_c_error), rel=1e-9)


def test_rates_that_a_slider_predicts_are_in_the_summary():
    from slide_hold_slide import SLIDER

    result = rs.healing(noisy(1), SLIDER)
    table = pandas.read_csv(io.StringIO(summary_csv(result)), keep_default_na=False)
    (row,) = table[table.quantity == "beta predicted"].to_dict("records")
    assert row["law"] == SLIDER.law
    assert float(row["value"]) == pytest.approx(float(result.beta_predicted[0]), rel=1e-9)
    assert table["law"].tolist().count("") == 2  # measured


def test_json_and_a_window(file):
    done = call(file, "--time", "0 s,120 s", "--json")
    assert done.exit_code == 3  # the record ends in a hold
    document = json.loads(done.stdout)
    assert document["dims"]["hold"] == 3
    status = document["data_vars"]["hold_status"]["data"]
    assert status[:2] == [0, 0]
    assert status[2] != 0


def test_the_page_shows_each_hold():
    from slide_hold_slide import SLIDER

    result = rs.healing(noisy(1), SLIDER)
    fig = plot.figure(result)
    fig.draw_without_rendering()
    record, healing, relaxation = sorted(fig.axes, key=lambda ax: ax.get_title("left"))
    assert len(record.patches) == 4
    (steady,) = (line for line in record.lines if np.isnan(line.get_ydata()).any())
    np.testing.assert_array_equal(steady.get_ydata(), result.friction_steady)
    for ax, name in ((healing, "delta_mu"), (relaxation, "delta_mu_c")):
        assert ax.get_xscale() == "log"
        shown = {line.get_label(): line.get_ydata() for line in ax.lines}
        (predicted,) = (y for label, y in shown.items() if label.startswith("slip"))
        np.testing.assert_allclose(predicted, 1e3 * result[f"{name}_predicted"][0])
        (container,) = ax.containers
        np.testing.assert_allclose(container.lines[0].get_ydata(), 1e3 * result[name])
