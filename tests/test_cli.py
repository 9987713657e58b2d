"""The command line: what it writes, says and returns."""

import os
import subprocess
import sys

import pytest
from typer.testing import CliRunner

import ratestate
from ratestate import ParameterError, SolverError
from ratestate.cli import main
from ratestate.paper import atlas, claims, figures
from ratestate.paper.claim import Claim, exact

ROW = Claim(id="x", where="sec. 1", claim="Water is wet.", paper="wet", unit="", **exact(1.0))


def call(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture
def made(monkeypatch):
    """List of (figure, law) that were asked for; the claims are one row."""
    asked = []

    def make(number, law, out):
        asked.append((number, law))
        return [out / f"{figures.stem(number, law)}.png"]

    monkeypatch.setattr(figures, "make", make)
    monkeypatch.setattr(claims, "claims", lambda law: [ROW])
    return asked


def test_version():
    result = call("--version")
    assert result.exit_code == 0
    assert result.output.strip() == ratestate.__version__


@pytest.mark.parametrize(
    ("arguments", "example"), [([], "figures"), (["figures"], "figures"), (["atlas"], "atlas")]
)
def test_help_has_an_example(arguments, example):
    result = call(*arguments, "--help")
    assert result.exit_code == 0
    assert f"Example: ratestate {example}" in result.output


def test_help_and_version_load_nothing_heavy():
    heavy = {"xarray", "numba", "numpy", "matplotlib", "pint"}
    code = f"""
import sys
from ratestate.cli import main
try:
    main(["--version"])
except SystemExit:
    pass
print(*({heavy} & set(sys.modules)))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == [ratestate.__version__]


def test_a_figure_is_written_and_listed(tmp_path):
    out = tmp_path / "new" / "folder"
    result = call("figures", "1", "--out", out)
    assert result.exit_code == 0, result.output
    names = ["fig1.nc", "fig1.pdf", "fig1.png"]
    assert sorted(path.name for path in out.iterdir()) == names
    assert all(str(out / name) in result.stderr for name in names)
    assert result.stdout == ""


def test_all_is_every_figure_the_scheme_and_the_claims(made, tmp_path):
    result = call("figures", "all", "--law", "aging", "--out", tmp_path)
    assert result.exit_code == 0, result.output
    assert made == [(name, "aging") for name in [1, 2, 3, 4, 5, 6, "scheme", "branches", "basins"]]
    assert {path.name for path in tmp_path.iterdir()} == {"claims_aging.md", "claims_aging.json"}
    assert "Water is wet." in result.stdout
    assert "scheme_aging.png" in result.stderr


def test_both_laws_share_a_folder(made, tmp_path):
    for law in ("slip", "aging"):
        assert call("figures", "--law", law, "--out", tmp_path).exit_code == 0
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {f"claims_{law}.{end}" for law in ("slip", "aging") for end in ("md", "json")}


def test_figures_come_in_the_paper_s_order(made, tmp_path):
    assert call("figures", "scheme", "4", "2", "4", "--out", tmp_path).exit_code == 0
    assert made == [(2, "slip"), (4, "slip"), ("scheme", "slip")]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("arguments", [["7"], ["1", "none"], ["1", "--law", "sloth"], ["--oops"]])
def test_bad_arguments_exit_2(made, tmp_path, arguments):
    result = call("figures", *arguments, "--out", tmp_path)
    assert result.exit_code == 2
    assert arguments[-1].strip("-") in result.stderr
    assert made == []


@pytest.mark.parametrize(
    "error", [ParameterError("K = -1 Pa/m"), SolverError("stopped at t = 3 s")]
)
def test_errors_are_one_message_and_exit_2(monkeypatch, tmp_path, error):
    def fail(*_):
        raise error

    monkeypatch.setattr(figures, "make", fail)
    result = call("figures", "2", "--out", tmp_path)
    assert result.exit_code == 2
    assert result.stderr.splitlines()[-1] == f"error: {error}"
    assert "Traceback" not in result.output


def test_folder_that_is_a_file_exits_2(made, tmp_path):
    path = tmp_path / "taken"
    path.write_text("")
    result = call("figures", "1", "--out", path)
    assert result.exit_code == 2
    assert "error: cannot write" in result.stderr
    assert str(path) in result.stderr
    assert made == []


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may write anywhere")
def test_read_only_folder_exits_2(made, tmp_path):
    tmp_path.chmod(0o500)
    result = call("figures", "1", "--out", tmp_path)
    tmp_path.chmod(0o700)
    assert result.exit_code == 2
    assert "error: cannot write" in result.stderr
    assert made == []


def test_interrupt_exits_130(monkeypatch, tmp_path):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(figures, "make", interrupt)
    result = call("figures", "1", "--out", tmp_path)
    assert result.exit_code == 130
    assert "interrupted" in result.stderr


@pytest.fixture
def charted(monkeypatch):
    """List of what atlases were asked for."""
    asked = []

    def make(law, out, **options):
        asked.append((law, options))
        return [out / f"atlas_{law}.png"]

    monkeypatch.setattr(atlas, "make", make)
    return asked


def test_atlas_is_of_both_laws_unless_one_is_named(charted, tmp_path):
    result = call("atlas", "--out", tmp_path / "new")
    assert result.exit_code == 0, result.output
    assert charted == [(law, {"b_over_a": 2.0, "n": 200}) for law in ("slip", "aging")]
    assert str(tmp_path / "new" / "atlas_aging.png") in result.stderr
    charted.clear()
    result = call("atlas", "--law", "slip", "--b-over-a", 1.6, "--n", 50, "--out", tmp_path)
    assert charted == [("slip", {"b_over_a": 1.6, "n": 50})]


@pytest.mark.parametrize("arguments", [["--n", "1"], ["--law", "sloth"], ["--b-over-a", "two"]])
def test_atlas_refuses_what_it_cannot_read(charted, tmp_path, arguments):
    result = call("atlas", *arguments, "--out", tmp_path)
    assert result.exit_code == 2
    assert f"Invalid value for '{arguments[0]}'" in result.stderr
    assert charted == []


def test_atlas_without_instability_is_one_message(tmp_path):
    result = call("atlas", "--b-over-a", 0.5, "--out", tmp_path)
    assert result.exit_code == 2
    last = result.stderr.splitlines()[-1]
    assert last == "error: b_over_a = 0.5 must be one number > 1, such as 2"
    assert list(tmp_path.iterdir()) == []
