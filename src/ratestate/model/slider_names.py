"""Names of a slider's parameters: those of every slider, and those of its law."""

import dataclasses
import functools

from ..errors import ParameterError
from ..friction.composition import form_of
from ..friction.forms import forms_with, parameters_of
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
        check_names(law, form_of(law, given.get("friction")), given, common, methods)
        given["law"] = law.name
        init(self, *args, **given)

    return checked


def law_of(law):
    """The law with a name or synonym, or a user's class of laws, which is registered.

    ParameterError for any other.
    """
    return friction_law(register(law) if isinstance(law, type) else law)


def check_names(law, form, given, common, methods):
    """Raise ParameterError for a parameter that the law or its form does not have, or lacks.

    form : the name of the form of friction; given : the names given as keywords
    common, methods : names of the parameters of every slider, of which Python tells where one is
        missing, and of its other attributes
    """
    own = {**law.parameters, **parameters_of(form)}
    if taken := [name for name in law.parameters if name in methods]:
        raise ParameterError(
            f"law = {law.name!r} has a parameter {taken[0]}, which sliders have of their own; "
            f"rename it"
        )
    for name in given:
        for kind, chosen, having in (
            ("law", law.name, owners(name)),
            ("friction", form, forms_with(name)),
        ):
            if having and name not in own:
                raise ParameterError(
                    f"{kind} = {chosen!r} has no parameter {name}, which belongs to "
                    f"{' and '.join(map(repr, having))}; leave {name} out, or choose such a {kind}"
                )
    check_keywords("SpringSlider", given, (*common, *own))
    for name in own:
        if name not in given:
            needing = f"law = {law.name!r}" if name in law.parameters else f"friction = {form!r}"
            raise ParameterError(
                f"{needing} needs {name}, {QUANTITIES[name].long_name}; {expected(name)}"
            )
