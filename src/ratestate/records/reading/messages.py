"""What the reading of a record says, from messages.toml."""

from pathlib import Path

from ...model.names import Sentences

#: a note or a part of a message: its name, ``table.sentence``, and values -> text
message = Sentences(Path(__file__).with_suffix(".toml"))
#: the same -> the `ParameterError` that says so
refusal = message.refusal
