"""Sentences of messages: each one is used in its package."""

import tomllib
from pathlib import Path

import pytest

import ratestate

FILES = sorted(Path(ratestate.__file__).parent.rglob("messages.toml"))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.parent.name)
def test_every_sentence_is_used(file):
    source = "".join(path.read_text("utf-8") for path in file.parent.rglob("*.py"))
    for table, texts in tomllib.loads(file.read_text("utf-8")).items():
        for name in texts:
            # by its name, or by a name that is put together
            uses = f'"{table}.{name}"', f'f"{table}.{{', f'_refusal("{name}"'
            assert any(use in source for use in uses), f"{table}.{name}"
