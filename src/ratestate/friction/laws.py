"""Friction laws by name: the built-in laws, and the laws that users register."""

from ..errors import ParameterError
from .built_in_laws import BUILT_IN
from .law_formula import HASH_MARK

#: name of the default law
DEFAULT = BUILT_IN[0].name
#: name -> law
LAWS = {law.name: law for law in BUILT_IN}
#: name or synonym -> name
LAW_NAMES = {name: law.name for law in LAWS.values() for name in (law.name, *law.synonyms)}


def add(law, base_name):
    """Add a law; `base_name`, its name without the hash, and its synonyms then select it."""
    LAWS[law.name] = law
    LAW_NAMES.update(dict.fromkeys((law.name, base_name, *law.synonyms), law.name))


def one_length_laws():
    """Return the names of the laws of one length (law.py), a list."""
    return [name for name, law in LAWS.items() if law.one_length]


def own_parameters(laws):
    """Return the symbols of the own parameters of these laws, a tuple, each once."""
    return tuple(dict.fromkeys(symbol for law in laws for symbol in law.parameters))


def laws_with(symbol):
    """Return the names of the laws that have this own parameter, a list."""
    return [law.name for law in LAWS.values() if symbol in law.parameters]


def friction_law(law):
    """Return the law with this name or synonym; ParameterError if it is unknown."""
    return LAWS[law_name(law)]


def find_law_name(law):
    """Return a law's name in `LAWS` from a name or synonym in any case, or None."""
    return LAW_NAMES.get(law.lower()) if isinstance(law, str) else None


def law_name(law):
    """Return the name as `find_law_name` does; ParameterError if it is unknown."""
    if name := find_law_name(law):
        return name
    if isinstance(law, str) and HASH_MARK in law:
        base_name = law.partition(HASH_MARK)[0]
        raise ParameterError(
            "is a user's law that is not registered",
            (
                f"Register its file, ratestate.register('{base_name}.py'). The part after "
                f"{HASH_MARK} is a hash of its formula."
            ),
            symbol="law",
            value=repr(law),
        )
    names, others = " or ".join(map(repr, LAWS)), ", ".join(sorted(LAW_NAMES.keys() - LAWS.keys()))
    raise ParameterError(
        "is unknown", f"Choose {names} (or {others}).", symbol="law", value=repr(law)
    )
