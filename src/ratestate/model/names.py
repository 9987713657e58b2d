"""Names that a user gives: the valid one that was perhaps meant, and mistyped keywords refused."""

import difflib
import functools
import inspect

from ..errors import ParameterError

#: a method or argument of `simulate` that is gone -> the call in its place
MOVED = dict.fromkeys(
    ("im2017", "im2017_euler", "dt"), "ratestate.paper.im2017(slider, loading, t_end, dt)"
)
NEAR = 0.7  # from 0 to 1, how similar a name must be to be suggested


def nearest(given, names):
    """The most similar of these names, capitals aside; None if none is, or `given` is no string.

    Similar: a difflib ratio of at least `NEAR`, of the first 60 characters.
    """
    lower = {name.lower(): name for name in names}
    text = given.lower()[:60] if isinstance(given, str) else ""
    near = difflib.get_close_matches(text, lower, n=1, cutoff=NEAR)
    return lower[near[0]] if near else None


def one_of(names, given=None, like=""):
    """The end of a message: the valid names, and the one that was perhaps meant.

    like : an example, such as ``a = 0.003``
    """
    if isinstance(given, str) and given in MOVED:
        return f"expected a call such as {MOVED[given]}"
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
    caller = function.__qualname__.removesuffix(".__init__")
    names = [name for name in inspect.signature(function).parameters if name != "self"]

    @functools.wraps(function)
    def checked(*args, **keywords):
        check_keywords(caller, keywords, names)
        return function(*args, **keywords)

    return checked
