"""Error and warning messages of the functions in `dynamics`.

Every `ParameterError` that this package makes is a sentence of refusals.toml, or the text of a
status in engine/statuses.toml (`simulation.engine_cases.failure`).
"""

from pathlib import Path

from ..friction.composition import PART_MARK, composed_law
from ..friction.forms import FORMS
from ..friction.laws import one_length_laws
from ..model.names import Sentences

sentence = Sentences(Path(__file__).with_suffix(".toml"))
#: the name of a sentence, ``table.sentence``, and values -> the `ParameterError` that says so
refusal = sentence.refusal


def check_one_length(function, law):
    """Raise ParameterError, for a function by name, unless a law, by name, is of one length."""
    if not composed_law(law).one_length:
        names = " and ".join(map(repr, one_length_laws()))
        base_name, *parts = law.split(PART_MARK)
        parts = [f"friction = {part!r}" if part in FORMS else part for part in parts]
        law = " with ".join(filter(None, (repr(base_name), " and ".join(parts))))
        raise refusal("law.one_length", function=function, law=law, names=names)
