"""What a command line cannot have: found before the work, told in words, and nothing is written."""

import re

import pytest
from command_line import call
from lab_files import MU, T, X, write
from scenario_files import SLIDER

from ratestate.interfaces.cli import run_fit
from ratestate.paper import atlas_figure, figures
from ratestate.scenario.scenario import FUNCTIONS

LAB = f"""{SLIDER}M = 3000
[loading]
V_lp = "1 mm/s"
[run]
t_end = "0.1 s"
"""
BRANCH = ("branch", "lab.toml")
ENDS = ("--start", "3 mm/s", "--stop", "2 mm/s")
SWEEP = ("sweep", "lab.toml", "--store", "x")
#: what is typed, and what is told of it
REFUSED = [
    # files to read
    (["run", "none.toml"], "error: none.toml does not exist"),
    (["run"], "give either a file or --from"),
    (["run", "lab.toml", "--from", "x.nc"], "give either a file or --from"),
    (["cycle", "lab.toml", "--law-file", "none.py"], "error: law file none.py does not exist"),
    (["run", "--from", "none.nc"], "error: none.nc does not exist"),
    (["run", "--from", "lab.toml"], "ends in .nc or .zarr"),
    # files to write
    (["cycle", "lab.toml", "--out", "x.txt"], "Give a name that ends in .nc, .csv or .zarr"),
    (["cycle", "lab.toml", "--plot", "x.nc"], "Give a name that ends in .png or .pdf"),
    (["cycle", "lab.toml", "--out", "no/x.nc"], "error: the folder of no/x.nc does not exist"),
    (["cycle", "lab.toml", "--out", "folder.nc"], "folder.nc is a folder, and is not replaced"),
    (["cycle", "lab.toml", "--out", "/proc/x.nc"], "error: /proc/x.nc: cannot be written: "),
    (["figures", "1", "--out", "lab.toml"], "error: lab.toml: cannot be written: File exists"),
    # templates
    (["init", "barke"], "error: 'barke' is unknown. Give one of lab, brake, "),
    (["init", "lab", "--out", "lab.tml"], "does not end in .toml"),
    (["init", "lab", "--out", "no/lab.toml"], "error: the folder of no/lab.toml does not exist"),
    # options of other commands
    ([*BRANCH, "--start", "1 mm/s"], "both are needed"),
    ([*BRANCH, "--parameter", "Q", *ENDS], "parameter = 'Q'"),
    ([*BRANCH, "--start", "1 mm", "--stop", "2 mm"], "start = '1 mm' is a length"),
    ([*BRANCH], "[sweep]: is missing. Give the parameter that the branch follows"),
    (["explore", "--port", "99999"], "--port"),
    (["explore", "--save", "x.html", "--port", "8765"], "--port cannot be used with --save"),
    (["explore", "--save", "x.html", "--no-browser"], "--no-browser cannot be used with --save"),
    (["figures", "7"], "'7'"),
    (["figures", "--law", "sloth"], "sloth"),
    (["figures", "--oops"], "--oops"),
    (["figures", "--law", "nagata"], "'nagata' needs c, which the paper does not give"),
    (["atlas", "--law", "nagata", "--set", "q=1"], "the law's own"),
    (["atlas", "--law", "nagata", "--set", "c=1 um"], "plain number"),
    (["cycle", "lab.toml", "--units", "V=MPa"], "--units V = '1 MPa' is a stress"),
    (["cycle", "lab.toml", "--units", "speed=um/s"], "--units: speed is not a quantity"),
    (["sweep", "lab.toml"], "--store"),
    (["sweep", "--store", "x"], "FILE.toml"),
    ([*SWEEP, "--chunk", "0"], "--chunk"),
    ([*SWEEP, "--device", "tpu"], "--device"),
    ([*SWEEP, "--job-script"], "--job-script"),
    ([*SWEEP, "--verify"], "it needs --status"),
    ([*SWEEP, "--slurm", "jobs=1", "--scheduler", "tcp://a:1"], "--slurm"),
    (["sweep", "--store", "x", "--slurm", "cores=four", "--job-script"], "slurm: cores = four is"),
    # records
    (["fit", "r.txt"], "no normal stress.*--sigma '20 MPa'"),
    (["fit", "r.txt", "--time", "3 s"], "'3 s' is not START,END"),
    (["fit", "r.txt", "--law", "slip, Rina"], "law = 'Rina' is unknown"),
    (["fit", "r.txt", "--max-rows", "0"], "--max-rows = 0 is not a usable number"),
    (["fit", "r.txt", "--lab-format", "bad.toml"], r"\[units\] time = 'm' is not valid\. Give a"),
    (["fit", "none.txt", "--out", "new/made"], "none.txt"),
    (["fit", "."], "fit of .,"),
    (["fit", "r.txt", "--sigma", "9 MPa", "--out", "."], "is not a report of ratestate fit"),
    (["events", "r.txt"], "Give sigma"),
    (["stiffness", "r.txt"], "Give sigma"),
    (["healing", "r.txt", "--out", "made"], "no hold"),
    (["healing", "r.txt", "--noise", "nonsense"], "nonsense"),
    (["healing", "r.txt", "--trend", "other"], "other"),
]


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with a scenario, a record without normal stress, and what is in the way."""
    monkeypatch.chdir(tmp_path)
    for folder in ("folder.nc", "folder.zarr"):
        (tmp_path / folder).mkdir()
    (tmp_path / "lab.toml").write_text(LAB)
    (tmp_path / "bad.toml").write_text("[units]\ntime = 'm'\n")
    (tmp_path / "report.md").write_text("# Minutes of a meeting\n")
    write(tmp_path / "r.txt", {"Time(s)": T, "Displ(microns)": X, "Friction": MU})
    return tmp_path


@pytest.mark.parametrize(("arguments", "message"), REFUSED, ids=[" ".join(a) for a, _ in REFUSED])
def test_wrong_commands_are_refused_before_the_work(arguments, message, here, monkeypatch):
    def never(*_, **__):
        raise AssertionError

    for name in FUNCTIONS.keys() - {"continue_cycle"}:  # which checks its own ends
        monkeypatch.setitem(FUNCTIONS, name, FUNCTIONS[name]._replace(call=never))
    for place in (figures, atlas_figure):
        monkeypatch.setattr(place, "make", never)
    monkeypatch.setattr(run_fit, "fit", never)
    before = {path: path.is_file() and path.read_bytes() for path in here.rglob("*")}
    result = call(*arguments)
    said = " ".join(re.sub("[\u2500-\u257f]", "", result.stderr).split())
    assert re.search(message if ".*" in message or "\\" in message else re.escape(message), said)
    assert (result.exit_code, result.stdout) == (2, ""), result.output
    assert "Traceback" not in said
    assert {path: path.is_file() and path.read_bytes() for path in here.rglob("*")} == before
