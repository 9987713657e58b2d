"""Names of a slider's parameters: those of every slider, and those of its law."""

import dataclasses
import functools

from ..errors import ParameterError
from ..friction.laws import DEFAULT, LAWS, friction_law
from .names import check_keywords
from .quantities import QUANTITIES, expected


def names_first(kind):
    """The `__init__` of the class of sliders, which now checks names before all else."""
    init, common = kind.__init__, [field.name for field in dataclasses.fields(kind)]

    @functools.wraps(init)
    def checked(self, *args, **given):
        check_names(friction_law(given.get("law", DEFAULT)), given, common)
        init(self, *args, **given)

    return checked


def check_names(friction, given, common):
    """Raise ParameterError for a parameter that the law does not have, and for one that it lacks.

    given : the names given as keywords; common : those of every slider, of which Python tells
    """
    names = (*common, *friction.parameters)
    for name in given:
        owners = [law.name for law in LAWS.values() if name in law.parameters]
        if owners and name not in friction.parameters:
            raise ParameterError(
                f"law = {friction.name!r} has no parameter {name}, which belongs to "
                f"{' and '.join(map(repr, owners))}; leave {name} out, or choose such a law"
            )
    check_keywords("SpringSlider", given, names)
    for name in friction.parameters:
        if name not in given:
            raise ParameterError(
                f"law = {friction.name!r} needs {name}, {QUANTITIES[name].long_name}; "
                f"{expected(name)}"
            )
