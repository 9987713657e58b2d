"""Sentences on machines, and errors; they are in messages.toml."""

from pathlib import Path

from ...model.names import Sentences

message = Sentences(Path(__file__).with_suffix(".toml"))
#: the name of a sentence, ``table.sentence``, and values -> the `ParameterError` that says so
refusal = message.refusal
