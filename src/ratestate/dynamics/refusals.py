"""What functions say of arguments that they cannot use, of idle runs, of branches that end early.

Every `ParameterError` that this package makes is a sentence of refusals.toml, but for that of a
status of the engine, whose text is engine/statuses.toml's (`simulation.cases.failure`).
"""

from pathlib import Path

from ..model.sentences import Sentences

sentence = Sentences(Path(__file__).with_suffix(".toml"))
#: the name of a sentence, ``table.sentence``, and values -> the `ParameterError` that says so
refusal = sentence.refusal
