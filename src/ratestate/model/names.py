"""Messages from TOML files, and suggestions for mistyped names."""

import difflib
import functools
import inspect
import string
import tomllib
from pathlib import Path

from ..errors import ParameterError
from .quantities import readable

#: removed method or argument of `simulate` -> the call that replaces it
REPLACEMENTS = dict.fromkeys(
    ("im2017", "im2017_euler", "dt"), "ratestate.paper.im2017(slider, loading, t_end, dt)"
)
#: earlier name of an argument, or of a key of scenario files -> its name
RENAMED = {
    "each": "per_step",
    "format": "lab_format",
    "friction": "friction_form",
    "rows": "max_rows",
    "verb": "function",
}
MIN_SIMILARITY = 0.7  # smallest difflib ratio, from 0 to 1, of a name that is suggested


def nearest(given, names):
    """Return the new name of an earlier one, or the most similar name; None if none is similar.

    Case is ignored, and only the first 60 characters of `given` count.  If `given` is not a string,
    return None.
    """
    lower = {name.lower(): name for name in names}
    text = given.lower()[:60] if isinstance(given, str) else ""
    near = difflib.get_close_matches(text, lower, n=1, cutoff=MIN_SIMILARITY)
    return lower.get(RENAMED.get(text, "")) or (lower[near[0]] if near else None)


def one_of(names, given=None, like=""):
    """Return the remedy for an unknown name: the valid names, and the one probably meant.

    like : an example, such as ``a = 0.003``
    """
    if isinstance(given, str) and given in REPLACEMENTS:
        return f"Call {REPLACEMENTS[given]}."
    names = list(names)
    near = nearest(given, names)
    meant = f" Did you mean {near}?" if near else ""
    example = f", such as {like}" if like else ""
    return f"Give {'one of ' if len(names) > 1 else ''}{', '.join(names)}{example}.{meant}"


def check_keywords(caller, given, names):
    """Raise ParameterError for the first keyword that is not a parameter of `caller`.

    given, names : the given keywords, and the names of the parameters
    """
    for name in given:
        if name not in names:
            raise ParameterError(f"{caller} has no parameter {name}", one_of(names, name))


def check_required(caller, given, required, form="{}"):
    """Raise ParameterError if a required argument of `caller` is not given.

    given, required : names of arguments
    form : how a call shows an argument, "{}=..." if it must be named
    """
    if missing := [name for name in required if name not in given]:
        values = {"missing": ", ".join(missing), "required": ", ".join(map(form.format, required))}
        raise refusal("call.missing", function=caller, **values)


def keywords_checked(function):
    """Wrap a function: mistyped and missing arguments raise ParameterError, not TypeError."""
    names = inspect.signature(function).parameters
    required = [name for name, parameter in names.items() if parameter.default is parameter.empty]

    @functools.wraps(function)
    def checked(*args, **keywords):
        check_keywords(function.__name__, keywords, names)
        check_required(function.__name__, {*[*names][: len(args)], *keywords}, required)
        return function(*args, **keywords)

    return checked


class Sentences(string.Formatter):
    """The sentences of a TOML file, by name; values replace the fields in braces.

    Besides the formats of `str.format`, ``{V_max:as V}`` shows a value in SI as a quantity with a
    suitable unit, and ``{V_max:as V 3}`` does so with three digits.  A pair is another quantity and
    its value, as from `of_contact`.

    path : a TOML file with tables of strings
    """

    def __init__(self, path):
        self.path = Path(path)

    @functools.cached_property
    def tables(self):
        return tomllib.loads(self.path.read_text("utf-8"))

    def __call__(self, name, /, **values):
        """Return the sentence with this name, ``table.sentence``, and these values.

        Raises KeyError if the sentence does not exist or a value is missing.
        """
        table, sentence = name.split(".")
        return self.vformat(self.tables[table][sentence], (), values)

    def refusal(self, name, kind=ParameterError, /, **values):
        """Return the error of this name, to be raised.

        In the file it is a string, the problem; or a list of problem and remedy; or a table of
        the fields of `ParameterError`.
        """
        table, sentence = name.split(".")
        entry = self.tables[table][sentence]
        if isinstance(entry, str):
            entry = [entry]
        if isinstance(entry, list):
            entry = dict(zip(("problem", "remedy"), entry, strict=False))
        error = kind(**{key: self.vformat(text, (), values) for key, text in entry.items()})
        error.sentence = name
        return error

    def format_field(self, value, spec):
        """Return a value as text in this format; called by `string.Formatter`."""
        kind, *symbol_and_digits = spec.split() or [""]
        if kind != "as":
            return super().format_field(value, spec)
        symbol, *digits = symbol_and_digits
        if isinstance(value, tuple):
            symbol, value = value
        return readable(symbol, value, *map(int, digits))


#: the name of a sentence in refusals.toml, and its values -> the ParameterError to raise
refusal = Sentences(Path(__file__).with_name("refusals.toml")).refusal
