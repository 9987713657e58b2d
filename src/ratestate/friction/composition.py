"""A friction law with what else stands in the balance of forces, as one law.

Kernels are compiled for a law, and what a slider does not have costs it nothing: a slider without
damping is that of the law alone.
"""

import functools

from .damping import DAMPING, Damped
from .laws import friction_law

#: symbol -> what it is, of parameters that every slider has, and needs only where it is not 0
EXTRAS = {"damping": DAMPING}
#: between the name of a law and what it is composed with
JOINT = "+"


def composed_law(name):
    """The law of this name, or of a name as `with_damping` gives it, such as "slip+damping".

    ParameterError for an unknown one.
    """
    own, joint, _ = name.partition(JOINT) if isinstance(name, str) else (name, "", "")
    return with_damping(friction_law(own)) if joint else friction_law(own)


def own_name(name):
    """The name of the law in `laws.LAWS` that a composed law has, from its name."""
    return name.partition(JOINT)[0]


@functools.cache
def with_damping(law):
    """The law of a slider with damping: a `Damped` one of another name, else as this law."""
    kind = type(law)
    own = {"__module__": kind.__module__, "__doc__": kind.__doc__, "__reduce__": _made_again}
    damped = type(f"Damped{kind.__name__}", (Damped, kind), own)()
    vars(damped).update(vars(law))  # of a user's law there are functions of arrays among them
    for name in vars(law).keys() & vars(Damped).keys():
        delattr(damped, name)
    damped.name = f"{law.name}{JOINT}damping"
    damped.parameters = {**law.parameters, "damping": DAMPING}
    damped.undamped = law
    return damped


def _made_again(damped):
    """For pickle: its class is found nowhere."""
    return with_damping, (damped.undamped,)
