"""``ratestate events``, ``healing`` and ``stiffness``: what they print, write and return."""

import io
import json
from typing import NamedTuple

import machine_records
import numpy as np
import pandas
import pytest
import slide_hold_slide
from command_line import call, succeed
from lab_files import record_columns, write

import ratestate as rs
from ratestate import plot
from ratestate.report.summary_csv import summary_csv

STICK_SLIP = rs.SpringSlider(
    a=0.005, b=0.008, Dc="10 um", sigma="4 MPa", M=100, K="600 MPa/m", law="aging"
)


def stick_slip():
    """Stick-slip at two speeds."""
    t = np.arange(0.0, 500.0, 0.05)
    loading = rs.Loading.steps("10 um/s", (350.0, "30 um/s"))
    run = rs.simulate(STICK_SLIP, loading, 500.0, V_start="5 um/s", times=t)
    noise = 5e-4 * np.random.default_rng(1).normal(size=t.size)
    return run[["delta_lp"]].assign(friction=run.tau / STICK_SLIP.sigma + noise)


class Evaluation(NamedTuple):
    """What is evaluated, with which options, and what is told and written of it."""

    record: object
    options: tuple
    said: tuple
    columns: dict  # of the table: title -> variable, and what is 1 there in SI
    summary: dict  # quantity -> variable, and unit in SI


EVALUATIONS = {
    "events": Evaluation(
        stick_slip,
        ("--sigma", "4 MPa"),
        ("events", "MPa/m, from", "stress drop [kPa]", "event 1: cut by the record's start"),
        {
            "stress drop (MPa)": ("stress_drop", 1e6),
            "stress drop error (MPa)": ("stress_drop_error", 1e6),
        },
        {},
    ),
    "healing": Evaluation(
        lambda: slide_hold_slide.noisy(1),
        (),
        ("Healing in record.txt: 4 of 4 holds evaluated",),
        {"delta mu": ("delta_mu", 1.0), "t hold (s)": ("t_hold", 1.0)},
        {"beta": ("beta", 1.0), "beta c": ("beta_c", 1.0)},
    ),
    "stiffness": Evaluation(
        lambda: machine_records.noisy(1, machine_records.clean()).sel(time=slice(0.0, 189.0)),
        ("--sigma", "10 MPa"),
        ("K = ", "M: not found"),
        {"slope K (GPa/m)": ("slope_K", 1e9)},
        {"K": ("K", 1e9), "M": ("M", 1.0), "damping": ("damping", 1e6)},
    ),
}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Command -> a laboratory's file."""
    written = {}

    def of(command):
        if command not in written:
            path = tmp_path_factory.mktemp("lab") / "record.txt"
            data = EVALUATIONS[command].record()
            written[command] = write(path, record_columns(data), number="{:.9g}".format)
        return written[command]

    return of


@pytest.mark.parametrize("command", EVALUATIONS)
def test_an_evaluation_is_printed_and_written(command, files, tmp_path):
    _, options, said, columns, summary = EVALUATIONS[command]
    done = succeed(command, files(command), *options, "--out", tmp_path / "made")
    assert [words for words in said if words not in done.stdout] == []
    names = {f"{command}.{ending}" for ending in ("nc", "csv", "png")}
    assert {one.name for one in (tmp_path / "made").iterdir()} == {*names, f"{command}_summary.csv"}
    assert (tmp_path / "made" / f"{command}.png").stat().st_size > 1000
    result = rs.files.read(tmp_path / "made" / f"{command}.nc")
    table = pandas.read_csv(tmp_path / "made" / f"{command}.csv")
    for title, (variable, unit) in columns.items():
        np.testing.assert_allclose(unit * table[title], result[variable], rtol=1e-8)
    if summary:
        rows = pandas.read_csv(tmp_path / "made" / f"{command}_summary.csv").set_index("quantity")
        assert rows.columns.tolist() == ["unit", "value", "error", "scatter over errors"]
        for quantity, (variable, unit) in summary.items():
            heads = {"value": "", "error": "_error", "scatter over errors": "_scatter"}
            for head, suffix in heads.items():
                factor = 1.0 if suffix == "_scatter" else unit
                expected = float(result.get(variable + suffix, np.nan))
                np.testing.assert_allclose(factor * rows[head][quantity], expected, rtol=1e-8)
    if command == "events":
        assert f"{result.sizes['event']} events" in done.stdout
        assert result.sizes["event"] > 8
        assert table["event status"][0] == "cut by the start"
    if command == "healing":
        np.testing.assert_allclose(table["V before (um/s)"], 10.0, rtol=1e-3)
        np.testing.assert_allclose(table["t hold (s)"], [3, 10, 30, 100], rtol=0.01)
    if command == "stiffness":
        K, error = float(result.K), float(result.K_error)
        assert abs(K - machine_records.SLIDER.K) < 4.0 * error < 0.1 * machine_records.SLIDER.K
        assert rows.unit[["K", "damping"]].tolist() == ["GPa/m", "MPa s/m"]


@pytest.mark.parametrize(
    ("command", "options", "code"),
    [
        ("events", ("--sigma", "4 MPa", "--K", "600 MPa/m", "--M", "100 kg/m^2"), 0),
        ("healing", ("--time", "0 s,120 s"), 3),  # the record ends in a hold
    ],
)
def test_json_has_all_numbers(command, options, code, files):
    done = call(command, files(command), *options, "--json")
    assert done.exit_code == code, done.output
    document = json.loads(done.stdout)
    assert document["title"] == f"ratestate {command}"
    data = {name: variable["data"] for name, variable in document["data_vars"].items()}
    if command == "events":
        drops = [x for x in data["stress_drop"] if x is not None]
        assert 3e5 < min(drops) < max(drops) < 5e5
        assert data["K"] == 6e8
    else:
        assert data["hold_status"][:2] == [0, 0] != data["hold_status"][2:]
        assert data["hold_status"][2] != 0


@pytest.fixture(scope="module")
def healed():
    """Healing, with what a slider predicts of it."""
    return rs.healing(slide_hold_slide.noisy(1), slider=slide_hold_slide.SLIDER)


def test_rates_that_a_slider_predicts_are_in_the_summary(healed):
    table = pandas.read_csv(io.StringIO(summary_csv(healed)), keep_default_na=False)
    (row,) = table[table.quantity == "beta predicted"].to_dict("records")
    assert row["law"] == slide_hold_slide.SLIDER.law
    assert float(row["value"]) == pytest.approx(float(healed.beta_predicted[0]), rel=1e-9)
    assert table["law"].tolist().count("") == 2  # measured


def test_the_page_shows_each_hold(healed):
    fig = plot.figure(healed)
    fig.draw_without_rendering()
    record, healing, relaxation = sorted(fig.axes, key=lambda ax: ax.get_title("left"))
    assert len(record.patches) == 4
    (steady,) = (line for line in record.lines if np.isnan(line.get_ydata()).any())
    np.testing.assert_array_equal(steady.get_ydata(), healed.friction_steady)
    for ax, name in ((healing, "delta_mu"), (relaxation, "delta_mu_c")):
        assert ax.get_xscale() == "log"
        shown = {line.get_label(): line.get_ydata() for line in ax.lines}
        (predicted,) = (y for label, y in shown.items() if label.startswith("slip"))
        np.testing.assert_allclose(predicted, 1e3 * healed[f"{name}_predicted"][0])
        (container,) = ax.containers
        np.testing.assert_allclose(container.lines[0].get_ydata(), 1e3 * healed[name])


def test_the_legends_of_healing_have_units_and_unused_holds(healed):
    status = healed.hold_status.copy(data=[0, 5, 0, 0])
    rates = {"beta": 9.57e-4, "beta_error": 3.29e-4, "beta_scatter": 10.7}
    record, healing, _ = plot.figure(healed.assign(hold_status=status, **rates)).axes
    names = [text.get_text() for text in record.get_legend().get_texts()]
    assert names[:2] == ["hold", "hold, not evaluated"]
    rate = healing.get_legend().get_texts()[0].get_text()
    assert "= (0.96 \N{PLUS-MINUS SIGN} 0.33)" in rate
    assert "per decade\npoints scatter by 11 times" in rate
