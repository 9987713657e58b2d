"""What works without the extra `explorer`, and what the explorer says then."""

import subprocess
import sys

import pytest

import ratestate as rs
from ratestate.interfaces.cli import main
from ratestate.paper.parameters import FIG2

NEEDED = ("fastapi", "starlette", "uvicorn", "websockets")


def test_ratestate_runs_without_the_packages_of_the_explorer():
    code = f"""
import importlib, pkgutil, sys
sys.modules.update(dict.fromkeys({NEEDED}))
import ratestate as rs
for module in pkgutil.walk_packages(rs.__path__, "ratestate."):
    importlib.import_module(module.name)
slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", M=3000, K="900 MPa/m")
run = rs.simulate(slider, rs.Loading.steps("0.1 mm/s", (1.0, "3.2 mm/s")), t_end=1.2)
print(int(run.status), "ratestate_explorer" in sys.modules)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["0", "False"]


def test_the_explorer_says_what_to_install(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "uvicorn", None)
    said = r"needs uvicorn\. Install the extra: pip install 'ratestate\[explorer\]'"
    with pytest.raises(rs.ParameterError, match=said):
        rs.explore(FIG2, 1e-3)
    with pytest.raises(SystemExit) as done:
        main(["explore", "--no-browser"])
    assert done.value.code == 2
    assert "pip install 'ratestate[explorer]'" in capsys.readouterr().err
