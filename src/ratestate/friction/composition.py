"""A friction law with what else stands in the balance of forces, as one law.

Kernels are compiled for a law, and what a slider does not have costs it nothing: one with the
friction of eq. 1 and without damping is that of the law of state alone.
"""

import functools

from ..errors import ParameterError
from . import damping
from .forms import FORMS, form_name
from .law import LOG
from .laws import friction_law
from .normal_stress import varying_at

#: symbol -> what it is, of parameters that every slider has, and needs only where it is not 0
EXTRAS = damping.OWN
#: between the name of a law and of what it is composed with
JOINT = "+"
DAMPED = "damping"
VARYING = "varying-sigma"


def composed_law(name):
    """The law of this name, or of a name as `composed` gives it, such as "slip+damping".

    ParameterError for an unknown one.
    """
    own, *parts = name.split(JOINT) if isinstance(name, str) else (name,)
    form = parts[0] if parts and parts[0] in FORMS else None
    return composed(friction_law(own), form, DAMPED in parts)


def form_of(law, friction=None):
    """The name of this form of friction, in any capitals; by default that which the law is for.

    ParameterError for an unknown one.
    """
    return law.form if friction is None else form_name(friction)


def composed(law, form=None, damped=False):
    """A law of `laws.LAWS` with a form of friction, by name, and damping; the law if with none.

    ParameterError for a form that the law does not take.  None is that which the law is for.
    """
    form = law.form if form is None else form
    if form != law.form:
        if law.form != LOG:
            raise ParameterError(
                f"friction = {form!r} does not go with law = {law.name!r}, which is for friction = "
                f"{law.form!r}; leave friction out, or choose another law"
            )
        if not takes_forms(law):
            raise ParameterError(
                f"friction = {form!r} does not go with law = {law.name!r}, which has a friction of "
                f"its own; leave friction out, or choose another law"
            )
    if form != LOG:
        law = _with(law, form)
    return _with(law, DAMPED) if damped else law


def under_varying_stress(law):
    """The law, with all that it is made of, as the engine needs it where sigma varies."""
    return _with(law, VARYING)


def takes_forms(law):
    """Whether friction under a law of `laws.LAWS` is that of eq. 1 in the states themselves."""
    return not law.gives("friction") and not law.gives("log_theta")


def forms_of(law):
    """Names of the forms of friction that a law of `laws.LAWS` takes, its own first, a list."""
    return [law.form, *(FORMS if law.form == LOG and takes_forms(law) else ())]


@functools.cache
def _with(law, part):
    """A law of another name, to which a part of the force balance is added; else as the law."""
    kind, changes = type(law), _changes(law, part)
    own = {"__module__": kind.__module__, "__doc__": kind.__doc__, "__reduce__": _made_again}
    made = type(f"{changes.__name__}{kind.__name__}", (changes, kind), own)()
    made.name, made.label = f"{law.name}{JOINT}{part}", law.label
    made.parameters = {**law.parameters, **changes.own}
    made.inner, made.part = law, part
    return made


def _changes(law, part):
    """The class that adds this part."""
    if part == DAMPED:
        return damping.damped_at(law.n_coefficients)
    if part == VARYING:
        return varying_at(law.n_coefficients, len(law.states))
    return FORMS[part].FORM


def _made_again(law):
    """For pickle: its class is found nowhere."""
    return _with, (law.inner, law.part)
