"""The public names, what importing the package costs, and the examples in docstrings."""

import ast
import doctest
import importlib.util
import operator
import re
import subprocess
import sys
import types
from pathlib import Path

import pytest

import ratestate

PACKAGES = ratestate._PACKAGES
PUBLIC = [
    f"{package}.{name}".lstrip(".")
    for package in ("", *PACKAGES)
    for name in dir(getattr(ratestate, package) if package else ratestate)
    if not name.startswith("_")
]


def test_completion_finds_what_the_page_lists_and_all_of_it_exists():
    page = (Path(__file__).parents[1] / "docs/reference/api.md").read_text("utf-8")
    listed = re.findall(r"^\| .*?`rs\.([\w.]+).*\| \S.* \|$", page, re.MULTILINE)
    assert sorted(listed) == sorted(PUBLIC)
    for path in PUBLIC:
        assert operator.attrgetter(path)(ratestate) is not None
    assert set(ratestate.__all__) == set(dir(ratestate)) - {"__version__"}
    assert ratestate.__version__[0].isdigit()
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = ratestate.nonsense


@pytest.mark.parametrize("path", PUBLIC)
def test_no_public_name_is_both_an_object_and_a_module(path):
    value = operator.attrgetter(path)(ratestate)
    module = importlib.util.find_spec(f"ratestate.{path}") if is_in_a_package(path) else None
    assert (module is not None) == isinstance(value, types.ModuleType)


def is_in_a_package(path):
    """Whether a module of this path could be imported."""
    parent = path.rpartition(".")[0]
    return not parent or hasattr(operator.attrgetter(parent)(ratestate), "__path__")


def test_type_checkers_see_every_public_name_but_the_paper():
    tree = ast.parse(Path(ratestate.__file__).read_text("utf-8"))
    (block,) = (node for node in tree.body if isinstance(node, ast.If))
    seen = {alias.asname: f"{node.module or ''}" for node in block.body for alias in node.names}
    assert seen == ratestate._HOMES | dict.fromkeys({*PACKAGES} - {"paper"}, "")


def test_importing_loads_nothing_heavy_and_packages_come_when_they_are_used():
    code = """
import sys, ratestate
ratestate.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m").V_c
print(*({"xarray", "pint", "numba", "pandas", "scipy", "matplotlib"} & set(sys.modules)))
print(ratestate.files.read.__name__)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["read"]


def test_the_package_has_few_packages():
    entries = {p.name for p in Path(ratestate.__file__).parent.iterdir()} - {"__pycache__"}
    packages = {name for name in entries if "." not in name}
    assert len(packages) <= 12
    assert "friction" in packages
    assert len(entries - {"__init__.py", "py.typed"}) <= 16


DOCUMENTED = {*ratestate._HOMES.values(), "formulas", "laws", "plot", "plot.runs"}
DOCUMENTED |= {"friction.quasi_static", "friction.closed_forms"}


@pytest.mark.parametrize("home", sorted(DOCUMENTED))
def test_examples_in_docstrings(home):
    assert doctest.testmod(importlib.import_module(f"ratestate.{home}")).failed == 0
