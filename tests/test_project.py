"""The project's own files agree with each other, and a release is made of them."""

import contextlib
import hashlib
import importlib
import re
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
RECIPE = (ROOT / "conda" / "recipe" / "recipe.yaml").read_text()


@pytest.fixture(scope="module")
def make_dist():
    """tools/make_dist.py as a module."""
    sys.path.insert(0, str(ROOT / "tools"))
    try:
        yield importlib.import_module("make_dist")
    finally:
        sys.path.remove(str(ROOT / "tools"))


@pytest.mark.parametrize(("hooks", "tool"), [("ruff-pre-commit", "ruff"), ("mirrors-mypy", "mypy")])
def test_hooks_are_of_the_locked_versions(hooks, tool):
    """What a commit is checked by is what `make check` checks by."""
    text = (ROOT / ".pre-commit-config.yaml").read_text()
    (hook,) = re.findall(rf"{hooks}\n +rev: v(\S+)", text)
    (locked,) = re.findall(rf"^{tool}==(\S+)", (ROOT / "requirements.lock").read_text(), re.M)
    assert hook == locked


def test_the_build_has_the_locked_programs():
    """uv, by the version that names a file of the Makefile's, and what builds the wheel."""
    (wanted,) = re.findall(r"^UV_VERSION := (\S+)", (ROOT / "Makefile").read_text(), re.M)
    lock = (ROOT / "tools" / "build.lock").read_text()
    assert f"\nuv=={wanted} " in lock
    requires = tomllib.loads((ROOT / "pyproject.toml").read_text())["build-system"]["requires"]
    assert all(f"\n{one} " in lock for one in requires)


def test_actions_are_of_one_commit_each():
    """The workflow that publishes uses what the tests are run with."""
    uses = {}
    for path in (ROOT / ".github" / "workflows").glob("*.yml"):
        for action, commit in re.findall(r"uses: (\S+)@(\S+)", path.read_text()):
            assert re.fullmatch("[0-9a-f]{40}", commit), action
            uses.setdefault(action, set()).add(commit)
    assert len(uses) == 4
    assert all(len(commits) == 1 for commits in uses.values())


def listed(section):
    """The items of a list of the conda recipe, such as "run"."""
    (items,) = re.findall(rf"^  {section}:\n((?:    - .*\n)+)", RECIPE, re.MULTILINE)
    lowest = re.search(r'python_min: "(.*)"', RECIPE)[1]
    return set(re.findall(r"- (.*)", items.replace("${{ python_min }}", lowest)))


def test_the_conda_recipe_says_what_pyproject_says():
    project = PROJECT["project"]
    spaced = {re.sub(r"(?=[<>=!~])", " ", one, count=1) for one in project["dependencies"]}
    renamed = {re.sub("^matplotlib ", "matplotlib-base ", one) for one in spaced}
    assert listed("run") == renamed | {f"python {project['requires-python']}"}
    (builder,) = PROJECT["build-system"]["requires"]
    lowest = project["requires-python"].removeprefix(">=")
    assert listed("host") == {f"python {lowest}.*", "pip", builder.replace("==", " ==")}
    assert f'version: "{project["version"]}"' in RECIPE
    ((name, where),) = project["scripts"].items()
    assert f"- {name} = {where}\n" in RECIPE
    for line in (project["description"], project["license"], project["urls"]["Paper"]):
        assert f": {line}\n" in RECIPE


def test_citations_are_of_this_version():
    version = PROJECT["project"]["version"]
    citation = (ROOT / "CITATION.cff").read_text()
    assert re.findall(r"^version: (.*)$", citation, re.MULTILINE) == [version]
    for page in ("README.md", "docs/cite.md"):
        entries = re.findall(r"version += \{(.*?)\}", (ROOT / page).read_text())
        assert entries == [version], page


@pytest.mark.parametrize(
    ("label", "file", "line"),
    [
        ("Repository", "CITATION.cff", "repository-code: {}"),
        ("Documentation", "CITATION.cff", "url: {}"),
        ("Issues", "docs/help.md", "The issue tracker is <{}>."),
    ],
)
def test_addresses_are_those_of_pyproject(label, file, line):
    """A file has the line if pyproject.toml gives the address, and no other."""
    urls = PROJECT["project"]["urls"]
    wanted = [line.format(urls[label])] if label in urls else []
    pattern = "^" + line.format(r"\S+?") + "$"
    assert re.findall(pattern, (ROOT / file).read_text(), re.MULTILINE) == wanted


CHANGES = """# Changelog

## [Unreleased]

- New.

## [0.1.0] - 2026-01-01

### Added

- Old.
"""


@pytest.mark.parametrize(
    ("changes", "is_release", "notes"),
    [
        (CHANGES, False, "- New."),
        (CHANGES, True, "### Added\n\n- Old."),
        (CHANGES.replace("- New.\n", ""), False, "### Added\n\n- Old."),
        (CHANGES.replace("0.1.0", "0.0.9"), True, None),
    ],
)
def test_release_notes_are_the_section_of_the_version(make_dist, changes, is_release, notes):
    with contextlib.nullcontext() if notes else pytest.raises(make_dist.Failed, match="no section"):
        made = make_dist.release_notes(changes, "0.1.0", is_release=is_release)
        assert made == f"# ratestate 0.1.0\n\n{notes}\n"
    with pytest.raises(make_dist.Failed, match=r"the tag v9\.9\.9 is not v"):
        make_dist.make("v9.9.9")


def test_the_published_recipe_differs_in_its_source_only(make_dist, tmp_path):
    archive = tmp_path / "ratestate-0.1.0.tar.gz"
    archive.write_bytes(b"all of it")
    sums = make_dist.sums_of([archive])
    assert sums == {archive.name: hashlib.sha256(b"all of it").hexdigest()}
    made = make_dist.published(RECIPE, archive.name, sums[archive.name]).split("\n")
    before = RECIPE.split("\n")
    assert [line for line in before if line not in made] == [
        "  path: ../../dist/ratestate-${{ version }}.tar.gz"
    ]
    assert [line for line in made if line not in before] == [
        f"  url: {make_dist.PYPI}/{archive.name}",
        f"  sha256: {sums[archive.name]}",
    ]
    with pytest.raises(make_dist.Failed, match="no source that is a path"):
        make_dist.published("\n".join(made), archive.name, sums[archive.name])
