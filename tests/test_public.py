"""The package's public names, what importing it costs, and functions that share a file's name."""

import doctest
import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

import ratestate


def run(code, *arguments, **environment):
    command = [sys.executable, "-c", code, *arguments]
    done = subprocess.run(
        command, env=os.environ | environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def test_public_names():
    assert len(ratestate.__all__) <= 45
    for name in ratestate.__all__:
        value = getattr(ratestate, name)
        assert callable(value), name
        assert value.__name__ == name
    assert set(ratestate.__all__) < set(dir(ratestate))
    assert ratestate.__version__[0].isdigit()
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = ratestate.nonsense


def test_importing_loads_nothing_heavy_and_packages_come_when_they_are_used():
    code = """
import sys, ratestate
ratestate.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m").V_c
print(*({"xarray", "pint", "numba", "pandas", "scipy", "matplotlib"} & set(sys.modules)))
print(ratestate.files.read.__name__)
"""
    assert run(code) == ["read"]


IMPORTS = [
    "",
    "import ratestate.{function}",
    "from ratestate.{function} import K_c",
    "import ratestate.model.slider, ratestate.{function}",
    "import importlib; importlib.import_module('ratestate.{function}')",
]
AFTERWARDS = """
import ratestate
from ratestate import {function}
assert {function} is ratestate.{function}, {function}
assert callable({function}), {function}
import ratestate.{function}
assert callable(ratestate.{function}), {function}
"""


@pytest.mark.parametrize("name", ratestate._MODULES)
def test_modules_are_found_by_their_documented_paths(name):
    module = importlib.import_module(f"ratestate.{ratestate._MODULES[name]}")
    documented = importlib.import_module(f"ratestate.{name}")
    public = [key for key in vars(module) if not key.startswith("_")]
    assert public
    assert all(getattr(documented, key) is getattr(module, key) for key in public)
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = documented.nonsense
    if name not in ratestate._HOMES:  # else the function has the name
        assert getattr(ratestate, name) is module


def test_the_package_has_few_packages():
    entries = {p.name for p in Path(ratestate.__file__).parent.iterdir()} - {"__pycache__"}
    packages = {name for name in entries if "." not in name}
    assert len(packages) <= 11
    assert "friction" in packages
    assert len(entries - {"__init__.py", "py.typed"}) <= 14


def test_functions_are_not_hidden_by_modules_of_their_names():
    # each in a process that has not imported ratestate, but all that it takes so long to import
    code = """
import os, sys, pint, xarray
for code in sys.argv[1:]:
    if not os.fork():
        exec(code)
        os._exit(0)
    assert os.wait()[1] == 0, code
print("ratestate" in sys.modules)
"""
    codes = [(before + AFTERWARDS).format(function="stability") for before in IMPORTS]
    assert run(code, *codes) == ["False"]


DOCUMENTED = {*ratestate._HOMES.values(), *ratestate._MODULES.values(), "laws", "plot.runs"}


@pytest.mark.parametrize("home", sorted(DOCUMENTED))
def test_examples_in_docstrings(home):
    assert doctest.testmod(importlib.import_module(f"ratestate.{home}")).failed == 0
