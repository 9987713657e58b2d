"""What the reading of a record says, from messages.toml."""

from pathlib import Path

from ...errors import ParameterError
from ...model.sentences import Sentences

#: a note or a part of a message: its name, ``table.sentence``, and values -> text
message = Sentences(Path(__file__).with_suffix(".toml"))


def refusal(sentence, /, **values):
    """The `ParameterError` of a sentence, ``table.sentence``, with these values."""
    return ParameterError(message(sentence, **values))
