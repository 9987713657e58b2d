"""The project's own files agree with each other."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.mark.parametrize(("hooks", "tool"), [("ruff-pre-commit", "ruff"), ("mirrors-mypy", "mypy")])
def test_hooks_are_of_the_locked_versions(hooks, tool):
    """What a commit is checked by is what `make check` checks by."""
    text = (ROOT / ".pre-commit-config.yaml").read_text()
    (hook,) = re.findall(rf"{hooks}\n +rev: v(\S+)", text)
    (locked,) = re.findall(rf"^{tool}==(\S+)", (ROOT / "requirements.lock").read_text(), re.M)
    assert hook == locked


def test_the_build_has_the_locked_uv():
    """uv is not in the lock, which it makes: the Makefile names its version, and noxfile.py too."""
    (wanted,) = re.findall(r"^UV_VERSION := (\S+)", (ROOT / "Makefile").read_text(), re.M)
    (named,) = re.findall(r'"uv==(\S+)"', (ROOT / "noxfile.py").read_text())
    assert named == wanted
