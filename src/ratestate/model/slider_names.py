"""Names of a slider's parameters: those of every slider, and those of its law."""

import dataclasses
import functools

from ..errors import ParameterError
from ..friction.laws import DEFAULT, friction_law, owners
from .names import check_keywords
from .quantities import QUANTITIES, expected
from .user_laws import register


def names_first(kind):
    """The `__init__` of the class of sliders, which now checks names before all else."""
    init, common = kind.__init__, [field.name for field in dataclasses.fields(kind)]
    methods = {*dir(kind), *common}

    @functools.wraps(init)
    def checked(self, *args, **given):
        law = law_of(given.get("law", DEFAULT))
        check_names(law, given, common, methods)
        given["law"] = law.name
        init(self, *args, **given)

    return checked


def law_of(law):
    """The law with a name or synonym, or a user's class of laws, which is registered.

    ParameterError for any other.
    """
    return friction_law(register(law) if isinstance(law, type) else law)


def check_names(friction, given, common, methods):
    """Raise ParameterError for a parameter that the law does not have, and for one that it lacks.

    given : the names given as keywords; common, methods : those of every slider,
        of which Python tells where one is missing, and its other attributes
    """
    names = (*common, *friction.parameters)
    if taken := [name for name in friction.parameters if name in methods]:
        raise ParameterError(
            f"law = {friction.name!r} has a parameter {taken[0]}, which sliders have of their own; "
            f"rename it"
        )
    for name in given:
        having = owners(name)
        if having and name not in friction.parameters:
            raise ParameterError(
                f"law = {friction.name!r} has no parameter {name}, which belongs to "
                f"{' and '.join(map(repr, having))}; leave {name} out, or choose such a law"
            )
    check_keywords("SpringSlider", given, names)
    for name in friction.parameters:
        if name not in given:
            raise ParameterError(
                f"law = {friction.name!r} needs {name}, {QUANTITIES[name].long_name}; "
                f"{expected(name)}"
            )
