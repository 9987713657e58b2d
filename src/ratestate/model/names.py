"""Wording of messages: sentences kept in TOML files, names that were perhaps meant."""

import difflib
import functools
import inspect
import string
import tomllib
from pathlib import Path

from ..errors import ParameterError
from .quantities import readable

#: a method or argument of `simulate` that is gone -> the call in its place
REPLACEMENTS = dict.fromkeys(
    ("im2017", "im2017_euler", "dt"), "ratestate.paper.im2017(slider, loading, t_end, dt)"
)
MIN_SIMILARITY = 0.7  # from 0 to 1, how similar a name must be to be suggested


def nearest(given, names):
    """The most similar of these names, capitals aside; None if none is, or `given` is no string.

    Similar: a difflib ratio of at least `MIN_SIMILARITY`, of the first 60 characters.
    """
    lower = {name.lower(): name for name in names}
    text = given.lower()[:60] if isinstance(given, str) else ""
    near = difflib.get_close_matches(text, lower, n=1, cutoff=MIN_SIMILARITY)
    return lower[near[0]] if near else None


def one_of(names, given=None, like=""):
    """The end of a message: the valid names, and the one that was perhaps meant.

    like : an example, such as ``a = 0.003``
    """
    if isinstance(given, str) and given in REPLACEMENTS:
        return f"expected a call such as {REPLACEMENTS[given]}"
    names = list(names)
    near = nearest(given, names)
    meant = f"; did you mean {near}?" if near else ""
    such = f" such as {like}" if like else ""
    return f"expected {'one of ' if len(names) > 1 else ''}{', '.join(names)}{such}{meant}"


def check_keywords(caller, given, names):
    """Raise ParameterError, in the name of `caller`, for the first name that is no parameter.

    given, names : names given as keywords, and those of its parameters
    """
    for name in given:
        if name not in names:
            raise ParameterError(f"{caller} has no parameter {name}; {one_of(names, name)}")


def keywords_checked(function):
    """The function, which now raises a ParameterError, and no TypeError, for a mistyped keyword."""
    names = inspect.signature(function).parameters

    @functools.wraps(function)
    def checked(*args, **keywords):
        check_keywords(function.__name__, keywords, names)
        return function(*args, **keywords)

    return checked


class Sentences(string.Formatter):
    """The sentences of a TOML file, by name; what stands in braces is filled in.

    Besides the formats of `str.format`, ``{V_max:as V}`` shows a value in SI as a quantity, in a
    unit that fits, and ``{V_max:as V 3}`` does so in three digits.

    path : the file, with tables of strings
    """

    def __init__(self, path):
        self.path = Path(path)

    @functools.cached_property
    def tables(self):
        """The file's tables."""
        return tomllib.loads(self.path.read_text("utf-8"))

    def __call__(self, name, /, **values):
        """The sentence of this name, ``table.sentence``, with these values.

        KeyError where there is none, or a value for it is missing.
        """
        table, sentence = name.split(".")
        return self.vformat(self.tables[table][sentence], (), values)

    def refusal(self, name, /, **values):
        """The `ParameterError`, to be raised by the caller, of the sentence of this name."""
        error = ParameterError(self(name, **values))
        error.sentence = name
        return error

    def format_field(self, value, spec):
        """A value as text in this format."""
        kind, *symbol_and_digits = spec.split() or [""]
        if kind != "as":
            return super().format_field(value, spec)
        symbol, *digits = symbol_and_digits
        return readable(symbol, value, *map(int, digits))
