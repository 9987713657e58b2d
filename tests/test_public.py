"""The package's face: its names, what importing it costs, and verbs that share a file's name."""

import doctest
import importlib
import subprocess
import sys

import pytest

import ratestate


def run(code):
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def test_public_names():
    assert len(ratestate.__all__) <= 15
    for name in ratestate.__all__:
        value = getattr(ratestate, name)
        assert callable(value), name
        assert value.__name__ == name
    assert set(ratestate.__all__) < set(dir(ratestate))
    assert ratestate.__version__[0].isdigit()
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = ratestate.nonsense


def test_importing_loads_nothing_heavy():
    code = """
import sys, ratestate
ratestate.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m").V_c
print(*({"xarray", "pint", "numba", "pandas", "scipy", "matplotlib"} & set(sys.modules)))
"""
    assert run(code) == []


@pytest.mark.parametrize("verb", ["hopf", "simulate"])
@pytest.mark.parametrize(
    "before",
    [
        "",
        "import ratestate.{0}",
        "from ratestate.{0} import {0}",
        "import ratestate.slider, ratestate.{0}",
        "import importlib; importlib.import_module('ratestate.{0}')",
    ],
)
def test_verbs_are_not_hidden_by_their_files(verb, before):
    code = f"""
{before.format(verb)}
import ratestate
from ratestate import {verb}
assert {verb} is ratestate.{verb}, {verb}
assert callable({verb}), {verb}
import ratestate.{verb}
assert callable(ratestate.{verb}), {verb}
"""
    run(code)


@pytest.mark.parametrize("home", sorted(set(ratestate._HOMES.values())))
def test_examples_in_docstrings(home):
    assert doctest.testmod(importlib.import_module(f"ratestate.{home}")).failed == 0
