"""Sentences on what goes wrong with a sweep: each is used, and filled in with what it names."""

import ast
import string
from pathlib import Path

import pytest

from ratestate import sweeps

TEXT = "\n".join(path.read_text() for path in sorted(Path(sweeps.__file__).parent.glob("*.py")))
SENTENCES = {
    f"{table}.{name}": text
    for table, texts in sweeps.sentence.tables.items()
    for name, text in texts.items()
}
#: function -> what it puts before the name of a sentence
FILLED_BY = {"sentence": "", "_refusal": "slurm."}


def uses():
    """(name of a sentence, names of its values; None where they are not written out)."""
    for call in ast.walk(ast.parse(TEXT)):
        if not (isinstance(call, ast.Call) and isinstance(call.func, ast.Name)):
            continue
        if call.func.id in FILLED_BY and isinstance(call.args[0], ast.Constant):
            names = {keyword.arg for keyword in call.keywords}
            yield FILLED_BY[call.func.id] + call.args[0].value, names


def test_what_is_used_is_there_and_filled():
    for name, values in uses():
        wanted = {field for _, field, _, _ in string.Formatter().parse(SENTENCES[name]) if field}
        assert None in values or wanted <= values, name


@pytest.mark.parametrize("name", SENTENCES)
def test_what_is_there_is_used(name):
    assert f'"{name}"' in TEXT or f'"{name.partition(".")[2]}"' in TEXT
