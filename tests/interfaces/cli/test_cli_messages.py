"""Messages on records name the options of the command line beside those of Python."""

import inspect
import re
import tomllib
from pathlib import Path

import pytest
from command_line import call, refuse

import ratestate.records
from ratestate.interfaces.cli import laboratory
from ratestate.interfaces.cli.options import Reading

OPTIONS = {
    parameter
    for function in (laboratory.fit, laboratory.events, laboratory.healing, Reading)
    for parameter in inspect.signature(function).parameters
}
FOLDER = Path(ratestate.records.__file__).parent
# (what the machine's stiffness is found by is said in Python's words alone)
FILES = [path for path in FOLDER.rglob("*.toml") if path.parent.name != "machine"]
#: an option with a value, such as per_step=True, columns={{ or time=(None
GIVEN = re.compile(r"\b(\w+)=(?:'|\(|None|\.\.\.|\{\{)")


def sentences():
    for path in FILES:
        for table, of_table in tomllib.loads(path.read_text("utf-8")).items():
            for name, text in of_table.items():
                in_python = re.sub(r"--[\w-]+ \S+", "", str(text))
                options = {*GIVEN.findall(in_python)} & (OPTIONS | {"units"})
                if options and path.name != "column_names.toml":
                    yield pytest.param(str(text), options, id=f"{path.parent.name}-{table}.{name}")


@pytest.mark.parametrize(("text", "options"), [*sentences()])
def test_options_of_python_stand_beside_those_of_the_command(text, options):
    for name in options:
        assert re.search(rf"\(command line: .*--{name.replace('_', '-')}\b", text), name


def test_more_than_25_messages_name_options():
    assert len([*sentences()]) > 25


@pytest.mark.parametrize(
    ("head", "words"),
    [
        ("Aika (s)\tDispl(um)\tFriction", "--columns time='Aika (s)'"),
        ("Time\tDispl(um)\tFriction", "--units time=s"),
    ],
)
def test_the_remedy_can_be_typed(tmp_path, head, words):
    """Its own words, with the titles of the file; given so, it is not asked for again."""
    path = tmp_path / "record.txt"
    path.write_text("\n".join([head, *(f"{i}\t{i}\t0.6" for i in range(50))]))
    said = refuse("fit", path)
    assert f"(command line: {words})" in said.stderr
    option, value = words.split(" ", 1)
    again = call("fit", path, option, value.replace("'", ""))
    assert words not in again.stderr


@pytest.mark.parametrize(
    ("option", "meant"), [("--each", "--per-step"), ("--per-stp", "--per-step")]
)
def test_an_unknown_option_names_the_one_that_is_meant(option, meant):
    said = refuse("fit", option, "record.txt")
    assert f"No such option: {option} (Possible options: {meant})" in said.stderr


def test_a_missing_scenario_file_names_the_file_or_the_template_that_is_meant(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    said = call("stability", "brake").stderr
    assert said == (
        "error: brake does not exist. `ratestate init brake` writes a scenario file, brake.toml.\n"
    )
    call("init", "brake")
    assert call("stability", "brake").stderr == (
        "error: brake does not exist. Did you mean brake.toml?\n"
    )
