"""Commands with a friction law in a file of the user's."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from command_line import call, refuse, succeed
from scenario_files import SLIDER
from user_laws import MINE, PLAIN

import ratestate as rs
from ratestate import files
from ratestate.friction.laws import LAW_NAMES, LAWS
from ratestate.interfaces.cli import run_fit
from ratestate.interfaces.cli.run_fit import _python
from ratestate.model.quantities import QUANTITIES
from ratestate.paper import atlas_figure, figures

TEXT = f"""{SLIDER}M = 3000
m = 1.5

[loading]
V_lp = "1 mm/s"

[run]
t_end = "0.05 s"
"""


@pytest.fixture
def mine(law_file, tmp_path, monkeypatch):
    """The name of the law of mine.py, which lies in the current folder beside mine.toml."""
    name = rs.register(law_file(MINE))
    forget(name)
    (tmp_path / "mine.toml").write_text(TEXT)
    monkeypatch.chdir(tmp_path)
    return name


def forget(name):
    """Let a law be one that is not known."""
    for symbol in LAWS[name].parameters:
        del QUANTITIES[symbol]
    del LAWS[name], LAW_NAMES[name], LAW_NAMES[name.partition("@")[0]]


def words(text):
    """A message without the frame and the line breaks that typer gives it."""
    return " ".join(re.sub(r"[^\x00-\x7f]", " ", text).split())


def test_a_run_takes_its_law_from_the_option_and_is_repeated_by_it(mine):
    succeed("run", "mine.toml", "--law-file", "mine.py", "--out", "first.nc")
    first = files.read("first.nc")
    assert json.loads(first.attrs["scenario"])["slider"]["law"] == mine
    forget(mine)
    refused = refuse("run", "--from", "first.nc")
    assert refused.stderr.startswith(f"error: law = '{mine}' is a user's law that is not regis")
    assert mine not in LAWS  # no code was run
    assert (
        call("run", "--from", "first.nc", "--law-file", "mine.py", "--out", "b.nc").exit_code == 0
    )
    np.testing.assert_array_equal(files.read("b.nc").tau, first.tau)


def test_a_store_is_of_the_law_by_its_hash(mine, law_file):
    text = TEXT.replace("m = 1.5", 'law_file = "mine.py"').partition("[run]")[0]
    Path("mine.toml").write_text(f"{text}[sweep]\nfunction = 'stability'\nm = [1.0, 1.5]\n")
    done = call("sweep", "mine.toml", "--store", "s.zarr")
    assert (done.exit_code, "2 finished" in done.stdout) == (0, True)
    forget(mine)
    assert call("sweep", "--status", "--store", "s.zarr").exit_code == 0  # needs no law
    assert mine not in LAWS
    law_file(MINE.replace("(1 - ", "2 * (1 - "))
    status = call("sweep", "mine.toml", "--status", "--store", "s.zarr")
    assert f"law: {mine} in the store, mine@" in status.stdout


def test_figures_and_the_atlas_are_of_the_law_of_the_file(mine, law_file, monkeypatch, tmp_path):
    """Figures of a law without parameters of its own, which the paper does not give."""
    plain, asked = rs.register(law_file(PLAIN, "plain.py")), []
    monkeypatch.setattr(figures, "make", lambda key, law, out, **_: asked.append(law) or [])
    monkeypatch.setattr(
        atlas_figure, "make", lambda law, out, **own: asked.append((law, own)) or []
    )
    assert call("figures", "2", "--law-file", "plain.py").exit_code == 0
    refused = call("figures", "2", "--law-file", "mine.py")
    assert f"'{mine}' needs m, which the paper does not give" in words(refused.stderr)
    given = ("--law-file", "mine.py", "--set", "m=1.5")
    assert call("atlas", *given).exit_code == 0
    assert call("atlas", *given, "--law", "mine").exit_code == 0
    other = refuse("atlas", *given, "--law", "prz")
    said = f"'prz': the law of mine.py is '{mine}'. Add it to --law, or leave --law out"
    assert said in words(other.stderr)
    settings = {"b_over_a": 2.0, "n": 200, "m": 1.5}
    assert asked == [plain, (mine, settings), (mine, settings)]


def test_a_fit_is_of_the_law_of_the_file_and_its_report_registers_it(mine, monkeypatch, tmp_path):
    asked = []
    monkeypatch.setattr(run_fit, "fit_and_report", lambda request, *_: asked.append(request))
    for laws in ([], ["--law", "prz,mine"]):
        assert call("fit", "x.txt", "--law-file", "mine.py", *laws).exit_code == 0
    assert [request.laws for request in asked] == [(mine,), ("prz", mine)]
    slider = rs.SpringSlider(a=0.01, b=0.01, Dc=1e-5, sigma=1e6, K=1e9, law=mine, m=1.0)
    lines = _python(asked[0], slider)["registration"]
    assert lines == f'rs.register("{tmp_path / "mine.py"}")\n'
    assert _python(asked[0]._replace(laws=("prz",)), slider)["registration"] == ""


def test_the_explorer_opens_with_the_law_of_the_file(mine, monkeypatch):
    opened = []
    monkeypatch.setattr("ratestate_explorer.serve", lambda **how: opened.append(how["fragment"]))
    assert call("explore", "mine.toml", "--law-file", "mine.py").exit_code == 0
    assert f"law={mine.replace('@', '%40')}&" in opened[0] + "&"
    assert "m=1.5" in opened[0]
    forget(mine)
    assert call("explore", "--law-file", "mine.py").exit_code == 0
    assert mine in LAWS
