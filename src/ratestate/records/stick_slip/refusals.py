"""Errors for what has no events, and messages on events; the sentences are in refusals.toml."""

from pathlib import Path

from ...model.names import Sentences

sentence = Sentences(Path(__file__).with_suffix(".toml"))
#: the name of a sentence, ``table.sentence``, and values -> the `ParameterError` that says so
refusal = sentence.refusal
