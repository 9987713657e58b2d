"""The documentation, as far as it can be told without building it: `make docs` runs the rest."""

import importlib.util
import inspect
import json
import operator
import re
import types
from importlib import metadata
from pathlib import Path

import pytest

import ratestate as rs
from ratestate.friction.laws import LAWS
from ratestate.model.quantities import QUANTITIES
from ratestate.scenario.templates import TEMPLATES

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", *sorted(DOCS.glob("*.md")), *sorted(DOCS.glob("[hrt]*/*.md"))]


def program(path):
    """A script as a module."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


run_code = program(ROOT / "tools" / "run_code.py")
check_links = program(ROOT / "tools" / "check_links.py")
notebooks = program(DOCS / "_ext" / "notebooks.py")


def test_readme_runs():
    with run_code.elsewhere():
        run_code.run_python(ROOT / "README.md")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_scenarios_on_pages_load(page):
    with run_code.elsewhere():
        run_code.load_toml(page)


def test_code_and_output_on_pages_are_checked(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(
        "text\n\n```python\nx = 1\n```\n\n1. more\n\n   ```python\n   assert x == 2\n   ```\n"
    )
    with pytest.raises(AssertionError) as told:
        run_code.run_python(page)
    assert told.traceback[-1].lineno + 1 == 10
    page.write_text('```toml\n[slider]\na = "3 m"\n```\n')
    with run_code.elsewhere(), pytest.raises(rs.ParameterError, match="'3 m' is a length"):
        run_code.load_toml(page)
    shown = "```python\nprint(6)\nprint(7)\n```\n{}\n```text\n6\n{}\n```\n"
    for between, last in (("", 7), ("Text that has to do with something else:", 8)):
        page.write_text(shown.format(between, last))
        run_code.run_python(page)
    page.write_text(shown.format("", 8))
    with pytest.raises(AssertionError, match=r"line 2: shown\n6\n8\n\nbut printed\n6\n7\n"):
        run_code.run_python(page)


def test_the_readme_is_short_and_points_to_what_is_there():
    text = (ROOT / "README.md").read_text()
    lines = text.split("\n")
    assert len(lines) <= 101
    assert {"make figures", "make test"} <= {line.partition("  ")[0] for line in lines[:80]}
    assert [output for *_, output in run_code.blocks(ROOT / "README.md", "python")] != [None]
    links = set(re.findall(r"\]\(([^)]+)\)", text))
    local = {link for link in links if "://" not in link}
    assert len(local) > 12
    assert not [link for link in local if not (ROOT / link).exists()]
    assert set(re.findall(r"ratestate init ([a-z]\S*)", text)) <= {*TEMPLATES}
    wheels = re.findall(r"ratestate-(\d.*?)-py3", text + (DOCS / "install.md").read_text())
    assert {*wheels} == {metadata.version("ratestate")}


def test_reference_values_are_those_of_the_tests():
    from quad_precision import TABLE

    pages = program(DOCS / "_ext" / "reference_values.py").PROBLEMS
    assert {name: row[1:] for name, row in pages.items()} == {k: v[:8] for k, v in TABLE.items()}


def test_every_public_name_with_a_docstring_is_documented(monkeypatch):
    monkeypatch.syspath_prepend(DOCS / "_ext")
    page = (DOCS / "reference" / "api.md").read_text()
    documented = set(re.findall(r"^\.\. auto\w+:: ratestate\.(\S+)", page, re.MULTILINE))
    linked = set(re.findall(r"^\| \{obj\}`rs\.(\S+)", page, re.MULTILINE))
    assert linked == documented
    plain = set(re.findall(r"^\| `rs\.(\S+)`", page, re.MULTILINE))
    described = program(DOCS / "_ext" / "generated.py").VALUES
    functions_of_formulas = {f"laws.{name}" for name in rs.laws.__all__}
    packages = {name for name in plain if inspect.ismodule(operator.attrgetter(name)(rs))}
    assert plain <= {*described} | packages | functions_of_formulas


@pytest.mark.parametrize(
    "page", ["typical_values", "reference/scenario_files", "reference/api", "developer/modules"]
)
def test_tables_shown_in_markdown_are_current(page, monkeypatch):
    """`python docs/_ext/generated.py` writes them anew."""
    monkeypatch.syspath_prepend(DOCS / "_ext")
    text = (DOCS / f"{page}.md").read_text("utf-8")
    current = program(DOCS / "_ext" / "generated.py").current
    assert text.count("<!-- end -->") == text.count("<!-- generated: ") > 0
    assert current(text) == text
    stale = text.replace("\n| ", "\n| x", 1)
    assert current(stale) == text != stale


symbols = program(DOCS / "_ext" / "symbols.py")
materials = program(DOCS / "_ext" / "materials.py")


def test_every_symbol_is_in_the_glossary():
    told = {symbol: text for texts in symbols.read().values() for symbol, text in texts.items()}
    assert told.keys() == QUANTITIES.keys()
    assert symbols.symbols().count("```{glossary}") == len(symbols.read())
    assert "\nDc\n  *critical slip distance* $D_c$ [m]. Slip over which" in symbols.symbols()
    of_law = "\nDc2\n  *critical slip distance of the second state* [m]. A parameter of `two-state-"
    assert of_law in symbols.symbols()
    own = {symbol for law in LAWS.values() for symbol in (*law.parameters, *law.states)}
    own |= {f"{state}_start" for law in LAWS.values() for state in law.states}
    assert symbols.read()[symbols.OF_LAWS].keys() == own - {"theta", "theta_start"}


def test_typical_values_are_complete_and_in_SI():
    entries, sources = materials.read()
    granite = next(e for e in entries if e["source"] == "im2019")
    assert (granite["a"], granite["b"], granite["Dc"]) == ([0.003], [0.006], [1e-5])
    assert next(e for e in entries if e["source"] == "he2013")["Dc"] == [3e-6, 4e-6]
    assert "| 3\xa0µm to 4\xa0µm | weakening; " in materials.values()
    tables = materials.values(), materials.models(), materials.findings()
    assert sum(table.count("\n") - 1 for table in tables) == len(entries)
    assert materials.sources().count("\n") == len(sources) - 1
    for source in sources.values():
        known = re.fullmatch(r"10\.\d{4,5}/\S+", source.get("doi", ""))
        assert known or source["url"].startswith("https://")
    measured = [e for e in entries if materials.kind(e) == "measured"]
    assert sum({"law", *materials.PARAMETERS} <= e.keys() for e in measured) >= 12
    assert all(e["read"] for e in entries)


@pytest.mark.parametrize(
    ("module", "old", "new", "error", "told"),
    [
        ("symbols", "\nK = ", "\nspring = ", AssertionError, ": K, spring"),
        ("symbols", '["Limit cycles"]', '["Limit cycles"]\nK = "2"', AssertionError, ": K, K"),
        ("materials", 'Dc = "8 mm"', 'Dc = "8 MPa"', rs.ParameterError, "Dc = '8 MPa'"),
        ("materials", "a = 0.0143", "a = -0.0143", rs.ParameterError, "a = -0.0143"),
        ("materials", '["3 um", "4 um"]', '["4 um", "3 um"]', AssertionError, "4e-06"),
        ("materials", 'source = "frye2002"', 'source = "frye2003"', AssertionError, "frye2002"),
        ("materials", 'read = "Table 1"\n', "", AssertionError, "geothermal"),
        ("materials", 'law = "slip"', 'laws = "slip"', AssertionError, "laws"),
    ],
)
def test_a_mistake_in_the_tables_of_the_pages_is_found(tmp_path, module, old, new, error, told):
    tables, file = {"symbols": symbols, "materials": materials}[module], tmp_path / "table.toml"
    text = (symbols.TEXTS if module == "symbols" else materials.FILE).read_text("utf-8")
    assert old in text
    file.write_text(text.replace(old, new, 1), "utf-8")
    with pytest.raises(error, match=told):
        tables.read(file)


PAGE = '<h1 id="top">x</h1><a href="{}">y</a><img src="p.png" alt="{}">'


@pytest.mark.parametrize(
    ("link", "alt", "told"),
    [
        ("b.html#top", "a picture", []),
        ("https://example.org/none", "a picture", []),
        ("c.html", "a picture", ["a.html: c.html is not there"]),
        ("b.html#bottom", "a picture", ["a.html: b.html#bottom has no such place"]),
        ("#bottom", "a picture", ["a.html: #bottom has no such place"]),
        ("b.html", " ", ["a.html: picture p.png has no words"]),
    ],
)
def test_links_are_checked(tmp_path, link, alt, told):
    assert list(check_links.problems(tmp_path)) == [f"{tmp_path} holds no page"]
    (tmp_path / "p.png").touch()
    (tmp_path / "a.html").write_text(PAGE.format(link, alt))
    (tmp_path / "b.html").write_text(PAGE.format("a.html", "a picture"))
    assert list(check_links.problems(tmp_path)) == told


@pytest.mark.parametrize(
    ("myst", "markdown"),
    [
        ("{func}`ratestate.fit` fits", "`ratestate.fit` fits"),
        ("{exc}`~ratestate.NotConverged`", "`NotConverged`"),
        ("{meth}`Loading.series <ratestate.Loading.series>`", "`Loading.series`"),
        ("see [Theory](../theory.md#fit) or [a `b`](x.md)", "see Theory or a `b`"),
        ("[doi](https://doi.org/1)", "[doi](https://doi.org/1)"),
        ("::::{grid} 1 1\n:gutter: 3\n\ntext\n::::\n", "\ntext\n"),
        ("| a: b | {x: 1} |", "| a: b | {x: 1} |"),
    ],
)
def test_notebooks_have_markdown_that_jupyter_shows(myst, markdown):
    assert notebooks.plain(myst) == markdown


@pytest.mark.parametrize(("page", "offered"), [("tutorials/one", True), ("howto/one", False)])
def test_tutorials_are_offered_as_notebooks(tmp_path, page, offered):
    executed = tmp_path / "jupyter_execute" / f"{page}.ipynb"
    executed.parent.mkdir(parents=True)
    code = {"cell_type": "code", "metadata": {"tags": ["hide-input"]}, "source": ["1 + 1"]}
    text = {"cell_type": "markdown", "metadata": {}, "source": ["# One\n", "{func}`f`"]}
    executed.write_text(json.dumps({"metadata": {"file_format": "x"}, "cells": [text, code]}))
    context, site = {}, tmp_path / "html"
    notebooks.add_notebook(types.SimpleNamespace(outdir=site), page, "", context, None)
    assert context == ({"notebook": "one.ipynb"} if offered else {})
    assert (site / f"{page}.ipynb").is_file() == offered
    if offered:
        written = json.loads((site / f"{page}.ipynb").read_text())
        sources = ["# One\n`f`", ["1 + 1"]]
        cells = [(cell["source"], cell["metadata"]) for cell in written["cells"]]
        assert cells == [(source, {}) for source in sources]
        assert written["metadata"] == {}
