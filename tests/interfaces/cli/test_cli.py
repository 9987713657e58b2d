"""The command line: what it writes, says and returns."""

import json
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path
from urllib.parse import parse_qsl

import numpy as np
import pytest
from command_line import call, refuse, succeed
from matplotlib.figure import Figure

import ratestate
from ratestate import files, scenario
from ratestate.interfaces import cli
from ratestate.interfaces.cli.command import GROUP_OF, parameters_of
from ratestate.paper import atlas_figure, claims_table, figures
from ratestate.paper.claim import Claim, exact
from ratestate.scenario import templates

ROW = Claim(id="x", where="sec. 1", claim="Water is wet.", paper="wet", unit="", **exact(1.0))


@pytest.fixture
def made(monkeypatch):
    """List of (figure, law) that were asked for; the claims are one row."""
    asked = []

    def make(number, law, out, *, title):
        asked.append((number, law) if title else (number, law, "no title"))
        return [out / f"{figures.FIGURES[number].stem(law)}.png"]

    monkeypatch.setattr(figures, "make", make)
    monkeypatch.setattr(claims_table, "claims", lambda law: [ROW])
    return asked


@pytest.fixture
def charted(monkeypatch):
    """List of what atlases were asked for."""
    asked = []

    def make(law, out, **options):
        asked.append((law, options))
        return [out / f"atlas_{law}.png"]

    monkeypatch.setattr(atlas_figure, "make", make)
    return asked


def test_version():
    result = succeed("--version")
    assert result.output.strip() == ratestate.__version__


def help_of(*arguments):
    """The help of a command, in one line."""
    result = succeed(*arguments, "--help")
    return " ".join(result.output.split())


#: as they are called: "lab describe" is one of a group
COMMANDS = [f"{group} {name}".strip() for name, group in GROUP_OF.items()]


@pytest.mark.parametrize("command", ["", *COMMANDS])
def test_help_has_an_example_and_the_exit_codes(command):
    text = help_of(*command.split())
    assert text.count(f"Example: ratestate {command}".rstrip()) == 1
    for code in (
        "0 done",
        "1 a bug in ratestate",
        "2 error or wrong usage",
        "3 some cases failed",
        "130 interrupted",
    ):
        assert code in text
    assert "--debug" in text


def test_helps_show_words_in_brackets():
    assert "named in the table [output] are written" in help_of("run")
    assert "as [sweep] says" in help_of("branch")
    helps = "".join(help_of(*command.split()) for command in COMMANDS)
    assert "\\[" not in helps
    for command, function in zip(COMMANDS, cli.COMMANDS, strict=True):
        for word in re.findall(r"\[\w+\]", function.__doc__):
            assert word in help_of(*command.split())


def test_every_description_is_of_a_parameter():
    tables = tomllib.loads((Path(cli.__file__).parent / "commands.toml").read_text())
    shared, groups = tables.pop("shared"), tables.pop("groups")
    parameters = {one.__name__: {p.name for p in parameters_of(one)} for one in cli.COMMANDS}
    assert tables.keys() == parameters.keys()
    for command, described in tables.items():
        assert described.keys() - {"module", "group"} <= parameters[command]
        assert {described.get("group")} <= {None, *groups}
    assert shared.keys() <= set().union(*parameters.values())


def write_holds(path):
    """A record with three holds, which no template has."""
    slider = ratestate.SpringSlider(a=0.008, b=0.01, Dc=1e-5, sigma=1e7, K=2e10, law="aging")
    speeds = [(t, V) for t in (20.0, 60.0, 130.0) for t, V in ((t, 0.0), (t + 10.0, 1e-5))]
    t = np.arange(0.0, 170.0, 0.02)
    run = ratestate.simulate(slider, ratestate.Loading.steps(1e-5, *speeds), t[-1], times=t)
    friction = run.tau / slider.sigma + 2e-4 * np.random.default_rng(1).normal(size=t.size)
    columns = np.transpose([t, run.delta_lp * 1e6, friction, np.full(t.size, 10.0)])
    head = "Time(s)\tDispl(microns)\tFriction\tNormal stress(MPa)"
    np.savetxt(path, columns, "%.6g", delimiter="\t", header=head, comments="")


def test_examples_work_when_copied(made, charted, monkeypatch, tmp_path):
    """Those of all helps, and of templates, one after the other.

    Pictures are left empty: other tests look at them, and drawing is half of the time.
    """
    served, done = [], set()
    monkeypatch.setattr(Figure, "savefig", lambda _, path, **how: Path(path).touch())

    def run_once(line):
        name, *arguments = shlex.split(line)
        assert name == "ratestate"
        if line not in done:
            done.add(line)
            result = call(*arguments)
            assert result.exit_code == 0, (line, result.output)

    monkeypatch.setattr("ratestate_explorer.serve", lambda **how: served.append(how))
    monkeypatch.chdir(tmp_path)
    for name in ("record", "fig3"):
        assert call("init", name).exit_code == 0
    write_holds(tmp_path / "holds.txt")
    for command in ["", *COMMANDS]:
        (line,) = (
            line
            for line in call(*command.split(), "--help").output.splitlines()
            if "Example: " in line
        )
        run_once(line.partition("Example: ")[2].strip())
    for name in ("lab", "record"):  # what they compute is tested with the templates
        for line in templates.commands(name):
            run_once(line.partition("    ")[0])
    assert served == [{"port": 8765, "open_browser": True, "fragment": ""}]
    assert made == [("2", "slip"), ("4", "slip")]
    assert charted == [(law, {"b_over_a": 1.6, "n": 200}) for law in ("slip", "aging")]
    names = {"lab.toml", "lab.png", "brake.toml", "cycle.png", "fig3.zarr", "figures", "fitted"}
    names |= {"record.toml", "record.txt", "record.png", "fig3.toml", "response.png"}
    names |= {"holds.txt", "healed", "catalogue"}
    assert {path.name for path in tmp_path.iterdir()} == names


def test_the_explorer_opens_with_a_files_slider(tmp_path, monkeypatch):
    from ratestate_explorer.entries import state_of

    served = []
    monkeypatch.setattr("ratestate_explorer.serve", lambda **how: served.append(how))
    rig = tmp_path / "rig.toml"
    lines = """[slider]
a = 0.003
b = 0.0061234567
Dc = "12.3456789 um"
sigma = "2 MPa"
K = "inf Pa/m"
law = "aging"
[loading]
V_lp = "1 um/s"
steps = [{ t = "1 s", V_lp = "3 um/s" }, { t = "2 s", V_lp = "7 um/s" }]
"""
    rig.write_text(lines)
    result = succeed("explore", rig, "--no-browser")
    asked = state_of(dict(parse_qsl(served[0]["fragment"])))
    wanted = scenario.load(rig, "stability")
    assert asked.slider == wanted.slider
    assert (asked.V_lp, asked.V_from) == (7e-6, None)
    rig.write_text(lines + '[sweep]\nM = ["1 kg/m^2", "2 kg/m^2"]\n')
    result = refuse("explore", rig)
    assert "a sweep over M" in " ".join(result.output.split())
    assert len(served) == 1


def test_init_lists_what_there_is(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = call("init", "--list")
    assert (result.exit_code, result.stderr) == (0, "")
    lines = result.stdout.splitlines()
    assert [line.split()[0] for line in lines] == [*scenario.TEMPLATES]
    named = "lab brake fault record fig2 fig3 fig4 fig6 slide-hold-slide".split()
    assert {*named} < {*scenario.TEMPLATES}
    assert all(re.fullmatch(r"[a-z0-9-]+ {2,}[A-Z][ -~]+", line) for line in lines)
    assert max(map(len, lines)) <= 80
    assert len({line.index(line.split("  ")[-1].strip()) for line in lines}) == 1  # one column
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize("name", ["lab", "record", "recorded-loading"])
def test_init_writes_what_can_be_run(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = succeed("init", *([] if name == "lab" else [name]))
    wanted = templates.files_of(name)
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == wanted
    assert scenario.load(tmp_path / f"{name}.toml").function == "simulate"
    listed = [line.strip() for line in result.stdout.splitlines()[2:]]
    assert listed == templates.commands(name)
    assert call("init", name, "--out", "-").stdout == wanted[f"{name}.toml"]
    (tmp_path / "there").mkdir()
    result = succeed("init", name, "--out", "there/my rig.toml")
    found = {path.name for path in (tmp_path / "there").iterdir()}
    assert found == {"my rig.toml", *wanted} - {f"{name}.toml"}
    assert "run 'there/my rig.toml' --plot" in result.stdout
    assert ("fit there/record.txt --out" in result.stdout) == (name == "record")


@pytest.mark.parametrize("there", ["record.toml", "record.txt"])
def test_init_writes_nothing_if_a_file_exists(there, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / there).write_text("mine")
    result = call("init", "record")
    assert (result.exit_code, result.stdout) == (2, "")
    other = "name" if there.endswith(".toml") else "folder"
    assert result.stderr == f"error: {there} exists. Give another {other} with --out.\n"
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {there: "mine"}


def test_init_leaves_nothing_if_a_file_cannot_be_written(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    replace = files.replace

    def full(path, write):
        if path.suffix == ".txt":  # the second
            raise OSError(28, "No space left on device", str(path))
        return replace(path, write)

    monkeypatch.setattr(files, "replace", full)
    result = refuse("init", "record")
    assert result.stderr == "error: record.txt: No space left on device\n"
    assert not [*tmp_path.iterdir()]


def test_json_lists_what_was_made(made, charted, tmp_path):
    found = json.loads(call("figures", "2", "--json", "--out", tmp_path).stdout)
    assert found == {"files": [str(tmp_path / "fig2_slip.png")]}
    found = json.loads(call("figures", "all", "--json", "--out", tmp_path).stdout)
    assert found["claims"][0]["claim"] == "Water is wet."
    assert len(found["files"]) == 11
    found = json.loads(call("atlas", "--json", "--out", tmp_path).stdout)
    assert found == {"files": [str(tmp_path / f"atlas_{law}.png") for law in ("slip", "aging")]}


def test_help_names_the_endings_of_files():
    """Written there by hand, since the formats would load what help must not."""
    listed = [("RESULT", files.READABLE), ("FILE", files.NUMBERS), ("FILE", files.place.PICTURES)]
    for what, endings in listed:
        assert f" {what}{'|'.join(endings)} " in help_of("run")


def test_help_and_version_load_nothing_heavy():
    heavy = {"xarray", "numba", "numpy", "matplotlib", "pint"}
    code = f"""
import sys
from ratestate.interfaces.cli import main
from ratestate.interfaces.cli.command import GROUP_OF
try:
    main(["--version"])
except SystemExit:
    pass
print(*({heavy} & set(sys.modules)))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == [ratestate.__version__]


def test_pictures_and_scenarios_load_no_scipy_that_only_records_need():
    code = """
import sys, ratestate.plot, ratestate.interfaces.cli.run_scenario
print(*(name for name in ("signal", "stats", "optimize") if f"scipy.{name}" in sys.modules))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not done.stdout.split()


ALL = [*"123456", "scheme", "branches", "basins"]


@pytest.mark.parametrize(
    ("arguments", "asked", "claims"),
    [
        (["all", "--law", "aging"], [(name, "aging") for name in ALL], True),
        (["scheme", "4", "2", "4"], [(name, "slip") for name in ("2", "4", "scheme")], False),
        (["2", "--no-titles"], [("2", "slip", "no title")], False),
    ],
)
def test_figures_come_once_and_in_the_papers_order(arguments, asked, claims, made, tmp_path):
    result = succeed("figures", *arguments, "--out", tmp_path)
    assert made == asked
    written = {"claims_aging.md", "claims_aging.json"} if claims else set()
    assert {path.name for path in tmp_path.iterdir()} == written
    assert ("Water is wet." in result.stdout) == claims
    last, law, *_ = asked[-1]
    assert f"{figures.FIGURES[last].stem(law)}.png" in result.stderr


OWN = ("--set", "V_cut=2", "--set", "M=1e-3")


@pytest.mark.parametrize(
    ("arguments", "laws", "options"),
    [
        ([], ("slip", "aging"), {}),
        (["--law", "slip", "--b-over-a", 1.6, "--n", 50], ("slip",), {"b_over_a": 1.6, "n": 50}),
        (["--law", "kato-tullis", *OWN], ("kato-tullis",), {"V_cut": 2.0, "M": 1e-3}),
    ],
)
def test_atlas_is_of_both_laws_unless_one_is_named(arguments, laws, options, charted, tmp_path):
    result = succeed("atlas", *arguments, "--out", tmp_path / "new")
    assert charted == [(law, {"b_over_a": 2.0, "n": 200} | options) for law in laws]
    assert str(tmp_path / "new" / f"atlas_{laws[-1]}.png") in result.stderr


def test_atlas_without_instability_is_one_message(tmp_path):
    result = refuse("atlas", "--b-over-a", 0.5, "--out", tmp_path)
    assert result.stderr.splitlines()[-1].startswith("error: --b-over-a = 0.5 ")
    assert list(tmp_path.iterdir()) == []
