"""Errors for what cannot be fitted; their sentences are in refusals.toml."""

from pathlib import Path

from ...errors import ParameterError
from ...model.sentences import Sentences

_SENTENCES = Sentences(Path(__file__).with_suffix(".toml"))


def refusal(sentence, /, **values):
    """The `ParameterError` of a sentence, ``table.sentence``, with these values."""
    return ParameterError(_SENTENCES(sentence, **values))
