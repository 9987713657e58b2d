"""What functions say of arguments that they cannot use, and of branches that end early."""

from pathlib import Path

from ..model.sentences import Sentences

sentence = Sentences(Path(__file__).with_suffix(".toml"))
#: the name of a sentence, ``table.sentence``, and values -> the `ParameterError` that says so
refusal = sentence.refusal
