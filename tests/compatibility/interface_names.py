"""What users rely on by name: public objects, commands, keys of scenario files, variables.

``python tests/compatibility/interface_names.py`` prints it.  recorded.json is what it printed
before the package was given its present layout: names may be added to it, and none of these may go.
"""

import importlib
import inspect
import json
import re
import sys
from pathlib import Path

import typer

import ratestate as rs
from ratestate.errors import ParameterError

ROOT = Path(__file__).parents[2]
DOCUMENTED = re.compile(r"^\.\. auto\w+:: ratestate\.(\S+)", re.MULTILINE)
SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=3e3, K=9e8)
RESULTS = {
    "stability": lambda: rs.stability(SLIDER, 1e-2),
    "simulate": lambda: rs.simulate(SLIDER, rs.Loading.constant(1e-2), 0.02, V_start=1e-3),
    "limit_cycle": lambda: rs.limit_cycle(SLIDER, 1e-2, rtol=1e-5),
    "hopf": lambda: rs.hopf(SLIDER),
    "continue_cycle": lambda: rs.continue_cycle(SLIDER, "V_lp", 3.5e-3, 3.3e-3),
    "sweep": lambda: rs.sweep(rs.stability, SLIDER, V_lp=rs.logspace("V_lp", 1e-2, 2e-2, 2)),
    "fit": lambda: rs.fit(
        rs.read_lab(ROOT / "src/ratestate/scenario/templates/record.txt"),
        rs.SpringSlider(a=0.01, b=0.01, Dc=1e-5, sigma=2e7, K=6e10),
    ),
    "read_lab": lambda: rs.read_lab(ROOT / "src/ratestate/scenario/templates/record.txt"),
    "classify": lambda: named("classify")(rs.limit_cycle(SLIDER, 1e-2)),
    "orbit": lambda: named("orbit")(SLIDER, 1e-2),
}
TABLES = ("slider", "loading", "run", "sweep", "output")


def named(path):
    """The object at a path below ratestate, by the import that the documentation names."""
    module, _, name = path.rpartition(".")
    return getattr(importlib.import_module(f"ratestate.{module}") if module else rs, name)


def signature(value):
    """Names of the parameters of a function; of a class also its public attributes."""
    members = [name for name in dir(value) if not name.startswith("_")]
    try:
        parameters = list(inspect.signature(value).parameters)
    except ValueError:
        parameters = []
    return {"parameters": parameters, "members": members if inspect.isclass(value) else []}


def documented():
    """Path -> signature of every object of docs/reference/api.md."""
    paths = DOCUMENTED.findall((ROOT / "docs/reference/api.md").read_text())
    return {path: signature(named(path)) for path in paths}


def commands():
    """Command -> its options and arguments, each with all its spellings."""
    app = typer.main.get_command(importlib.import_module("ratestate.interfaces.cli").main)
    found = {"": app, **app.commands}
    return {
        name: sorted("/".join([*p.opts, *p.secondary_opts]) for p in command.params)
        for name, command in found.items()
    }


def is_key(table, key):
    """Whether a key may stand in a table of a scenario file."""
    try:
        named("scenario.loads")(f"[{table}]\n{key} = 1\n")
    except ParameterError as error:
        lines = [line for line in str(error).splitlines() if f"[{table}] {key}:" in line]
        refusals = ("unknown key", "wrong table", "is not a parameter")
        return not any(words in line for line in lines for words in refusals)
    return True


def keys():
    """Table -> the keys that may stand in it, of all that stand in any."""
    known = importlib.import_module("ratestate.scenario.known_keys")
    words = sorted({key for table in TABLES for key in known.keys_of(table)})
    return {table: [key for key in words if is_key(table, key)] for table in TABLES}


def variables():
    """Function -> names of the variables, coordinates and attributes of its result."""
    return {
        name: {
            part: sorted(map(str, getattr(result, part)))
            for part in ("data_vars", "coords", "attrs")
        }
        for name, result in ((name, make()) for name, make in RESULTS.items())
    }


def statuses():
    """Code -> name of each status."""
    attrs = rs.limit_cycle(SLIDER, 1e-2, rtol=1e-5).status.attrs
    codes = map(str, attrs["flag_values"].tolist())
    return dict(zip(codes, attrs["flag_meanings"].split(), strict=True))


def interface():
    """All of it."""
    return {
        "all": sorted(rs.__all__),
        "documented": documented(),
        "commands": commands(),
        "keys": keys(),
        "variables": variables(),
        "statuses": statuses(),
    }


if __name__ == "__main__":
    json.dump(interface(), sys.stdout, indent=1, sort_keys=True)
