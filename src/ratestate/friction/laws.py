"""Friction laws by their names: the built-in ones, and those that users register."""

from ..errors import ParameterError
from .built_in_laws import BUILT_IN
from .law_formula import MARK

#: the law of a slider that names none
DEFAULT = BUILT_IN[0].name
#: name of a friction law -> the law
LAWS = {law.name: law for law in BUILT_IN}
#: name or synonym -> name of the law
LAW_OF = {known: law.name for law in LAWS.values() for known in (law.name, *law.synonyms)}


def add(law, own):
    """Add a law by its name; its `own` name, without the hash, and synonyms then mean it."""
    LAWS[law.name] = law
    LAW_OF.update(dict.fromkeys((law.name, own, *law.synonyms), law.name))


def of_one_length():
    """Names of the laws of one length (law.py), a list."""
    return [name for name, law in LAWS.items() if law.one_length]


def own_parameters(laws):
    """Symbols of the own parameters of these laws, a tuple, each once."""
    return tuple(dict.fromkeys(symbol for law in laws for symbol in law.parameters))


def owners(symbol):
    """Names of the laws that have a parameter of their own with this symbol, a list."""
    return [law.name for law in LAWS.values() if symbol in law.parameters]


def friction_law(law):
    """The law of `LAWS` with this name or synonym; ParameterError for an unknown one."""
    return LAWS[law_name(law)]


def known_law(law):
    """A law's name in `LAWS`, from that name or a synonym, in any capitals; None if unknown."""
    return LAW_OF.get(law.lower()) if isinstance(law, str) else None


def law_name(law):
    """A law's name as by `known_law`; ParameterError if it is unknown."""
    if name := known_law(law):
        return name
    if isinstance(law, str) and MARK in law:
        own = law.partition(MARK)[0]
        raise ParameterError(
            f"law = {law!r} is a user's own, and not known here: register the file that has it, "
            f"ratestate.register('{own}.py'); after {MARK} is the hash of its source"
        )
    names, others = " or ".join(map(repr, LAWS)), ", ".join(sorted(LAW_OF.keys() - LAWS.keys()))
    raise ParameterError(f"law = {law!r} is unknown; choose {names} (or {others})")
