"""Sentences kept in a TOML file beside the code that chooses among them."""

import functools
import string
import tomllib
from pathlib import Path

from ..errors import ParameterError
from .quantities import readable


class Sentences(string.Formatter):
    """The sentences of a TOML file, by name; what stands in braces is filled in.

    Besides the formats of `str.format`, ``{V_max:as V}`` shows a value in SI as a quantity, in a
    unit that fits, and ``{V_max:as V 3}`` does so in three digits.

    Parameters
    ----------
    path : str or Path
        The file: tables of strings.
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
