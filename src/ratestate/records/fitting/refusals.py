"""Errors for what cannot be fitted; their sentences are in refusals.toml."""

from pathlib import Path

from ...model.names import Sentences

sentence = Sentences(Path(__file__).with_suffix(".toml"))
#: the name of a sentence, ``table.sentence``, and values -> the `ParameterError` that says so
refusal = sentence.refusal
