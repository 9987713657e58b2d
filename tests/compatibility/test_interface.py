"""What users rely on by name is there, as it was before the package had its present layout."""

import json
from pathlib import Path

import pytest
from interface_names import commands, documented, is_key, statuses, variables

import ratestate as rs

BEFORE = json.loads((Path(__file__).parent / "recorded.json").read_text())


def test_public_names_of_the_release_still_exist():
    assert set(BEFORE["all"]) <= set(rs.__all__)


def test_documented_objects_and_their_parameters():
    now = documented()
    for path, before in BEFORE["documented"].items():
        parameters, first = now[path]["parameters"], len(before["parameters"])
        assert set(before["parameters"]) <= set(parameters), path
        # in the order in which they may be given; what is new comes after
        assert [p for p in parameters if p in before["parameters"]] == before["parameters"], path
        assert first <= len(parameters), path
        assert set(before["members"]) <= set(now[path]["members"]), path


def test_commands_and_their_options():
    """Options by name; arguments, whose names nobody types, by their number."""
    now = commands()
    for command, before in BEFORE["commands"].items():
        options, arguments = _by_name(before), len(before) - len(_by_name(before))
        assert options <= _by_name(now[command]), command
        assert arguments == len(now[command]) - len(_by_name(now[command])), command


def _by_name(parameters):
    return {name for name in parameters if name.startswith("-")}


@pytest.mark.parametrize("table", BEFORE["keys"])
def test_keys_of_scenario_files(table):
    everywhere = sorted({key for keys in BEFORE["keys"].values() for key in keys})
    assert set(BEFORE["keys"][table]) <= {key for key in everywhere if is_key(table, key)}
    assert not is_key(table, "nonsense")


def test_variables_of_results():
    now = variables()
    for function, before in BEFORE["variables"].items():
        for part, names in before.items():
            assert set(names) <= set(now[function][part]), (function, part)


def test_names_of_statuses():
    now = statuses()
    assert {code: now[code] for code in BEFORE["statuses"]} == BEFORE["statuses"]
