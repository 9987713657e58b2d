"""``ratestate fit --per-step``: what it prints in terminals of any width, and writes."""

import re

import numpy as np
import pandas
import pytest
from lab_files import record_columns, write
from rich.console import Console
from synthetic_experiments import experiment
from typer.testing import CliRunner

import ratestate as rs
from ratestate.interfaces.cli import main
from ratestate.report.summary_csv import summary_csv

pytestmark = pytest.mark.usefixtures("in_one_process")
SLIDER = rs.SpringSlider(a=0.009, b=0.012, Dc="20 um", sigma="8 MPa", K="6 GPa/m")
SPEEDS = (3e-6, 3e-5, 3e-6, (0.0, 100.0), 3e-6)
LAWS = ("aging", "slip")  # the worse one first
#: what several steps have together
SHARED = "shared shared_error up_over_down up_over_down_error up_over_down_p_value".split()
NUMBER = r"-?\d+(?:\.\d+)?\(\d+\)"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with the report on an experiment under both laws; what was printed."""
    folder = tmp_path_factory.mktemp("lab")
    data = experiment(SLIDER, SPEEDS, 400e-6, 150, noise=2e-4, seed=1)
    stress = {"Normal_stress(MPa)": np.full(data.time.size, 8.0)}
    write(folder / "many.txt", record_columns(data, **stress))
    arguments = [str(folder / "many.txt"), "--per-step", "--law", ",".join(LAWS)]
    arguments += ["--errors", "covariance"]
    done = CliRunner().invoke(main, ["fit", *arguments, "--out", str(folder / "made")])
    assert done.exit_code == 3, done.output
    return folder / "made", done


@pytest.fixture(scope="module")
def result(folder):
    return rs.files.read(folder[0] / "fit.nc")


def printed(result, width):
    console = Console(width=width, legacy_windows=False)
    with console.capture() as text:
        console.print(*rs.summary(result), sep="\n")
    return text.get().splitlines()


@pytest.mark.parametrize(("width", "tables"), [(140, 2), (80, 4), (50, 6)])
def test_no_number_is_cut_or_broken(result, width, tables):
    lines = printed(result, width)
    heads = [line for line in lines if line.startswith("step ") and "[" in line]
    assert len(heads) == tables
    assert max(map(len, lines)) <= width
    text = "\n".join(lines)
    assert "\N{HORIZONTAL ELLIPSIS}" not in text
    rows = [line for line in lines if re.match(r"[123]  ", line)]
    assert len(rows) == 3 * tables
    # a, b, Dc, K and a - b of three steps under two laws, and a, b and Dc of all
    numbers = [n for line in lines for n in re.findall(rf"(?<=  ){NUMBER}(?=\s|$)", line)]
    for law in LAWS:
        one = result.sel(law=law, step=1)
        error = 1e6 * float(one.standard_error.sel(parameter="Dc"))
        value, digits = numbers_of(numbers, 1e6 * float(one.Dc), error)
        assert value == pytest.approx(1e6 * float(one.Dc), abs=0.3 * error)
        assert digits == pytest.approx(error, rel=0.2)
    assert len(numbers) == 2 * (5 * 3 + 3)
    assert all(time in text for time in ("133.3", "146.7", "280.0"))
    assert all(what in text for what in ("3 -> 30 um/s", "30 -> 3 um/s", "hold 100 s, 3 um/s"))


def numbers_of(texts, value, error):
    """Value and error of the text that is nearest to a value, as a reader takes them."""
    read = []
    for text in texts:
        number, digits = text.rstrip(")").split("(")
        places = len(number.partition(".")[2])
        read.append((float(number), float(digits) * 10.0**-places))
    return min(read, key=lambda one: abs(one[0] - value) + abs(one[1] - error))


def test_warnings_of_every_law_are_in_the_report_once(folder, result):
    path, done = folder
    text, printed = (path / "report.md").read_text("utf-8"), " ".join(done.stdout.split())
    assert (result.warnings.sel(law="aging") != "").any()
    lines = [line for line in text.splitlines() if line.startswith("> - ")]
    for law in LAWS:
        below = "\n".join(line for line in lines if f", {law} law, warning: " in line)
        warnings = result.warnings.sel(law=law).values.tolist()
        assert len(below.splitlines()) == len(
            {one for several in warnings for one in several.splitlines()}
        )
        for step, several in enumerate(warnings, 1):
            for one in several.splitlines():
                assert re.search(
                    rf"> - steps? [\d, ]*\b{step}\b[\d, ]*, .*: {re.escape(one)}", below
                )
                assert text.count(one) == warnings_with(result, one)
                assert one in printed


def warnings_with(result, text):
    """In how many laws' warnings a text is."""
    return sum(text in "\n".join(result.warnings.sel(law=law).values.tolist()) for law in LAWS)


def test_tables_have_all_that_a_paper_quotes(folder, result):
    path, _ = folder
    assert {one.name for one in path.iterdir()} == {
        *("report.md", "fit.png", "fit.nc", "steps.csv", "steps_summary.csv")
    }
    summary = pandas.read_csv(path / "steps_summary.csv").set_index(["law", "quantity"])
    sizes = {"Dc": ("um", 1e-6), "a": (None, 1.0)}
    for law in LAWS:
        for name, (unit, size) in sizes.items():
            row, here = summary.loc[law, name], result.sel(law=law, parameter=name)
            assert row["unit"] == unit or (unit is None and pandas.isna(row["unit"]))
            for head, key in (
                ("value", "shared"),
                ("error", "shared_error"),
                ("scatter", "scatter"),
            ):
                assert size * row[head] == pytest.approx(float(here[key]), rel=1e-8), head
            for head, key in (("up/down", "up_over_down"),):
                assert row[head] == pytest.approx(float(here[key]), rel=1e-8)
    of_one = summary_csv(
        result.assign({name: result[name] * np.nan for name in [*SHARED, "scatter"]})
    )
    assert of_one == ",".join([*summary.index.names, *summary.columns]) + "\n"
    steps = (path / "steps.csv").read_text("utf-8").splitlines()
    assert len(steps) == 1 + 3 * len(LAWS)  # one line each, warnings too
    assert "the numbers of all steps together in steps_summary.csv" in " ".join(
        (path / "report.md").read_text("utf-8").split()
    )
