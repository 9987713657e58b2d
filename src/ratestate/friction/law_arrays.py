"""A user's law for arrays: its methods element by element, where they take numbers alone.

The engine compiles a law's methods for numbers, so that they may hold functions of `math` and
branches, which no array passes.  Python calls them with arrays, of all sliders of a sweep.
"""

import functools
import inspect
from types import SimpleNamespace

import numpy as np

from .law import FrictionLaw
from .law_properties import LawProperties

#: methods that Python calls with arrays
METHODS = [
    name
    for name, method in (vars(FrictionLaw) | vars(LawProperties)).items()
    if inspect.isfunction(method)
    and {"p", "slider"} & {*inspect.signature(method).parameters}
    and name != "complaint"
]


def take_arrays(law, values):
    """Let all methods of a law, an instance, take arrays; the class, which is compiled, stays.

    values : symbol -> an example of each of its parameters [SI], a, b and Dc too
    """
    for name in METHODS:
        if law.gives(name) and not _takes_arrays(law, name, values):
            setattr(law, name, _elementwise(getattr(law, name)))


def _takes_arrays(law, name, values):
    """Whether a method gives of two sliders what it gives of each; True if it fails for these."""
    method = getattr(law, name)
    try:
        named = [*inspect.signature(getattr(FrictionLaw, name)).parameters][1:]
        arguments = [_example(law, key, values) for key in named]
        each = _elementwise(method)(*arguments)
    except Exception:  # a mistake, which `law_check` tells
        return True
    try:
        together = method(*arguments)
        pairs = zip(_leaves(together), _leaves(each), strict=True)
        return all(bool(np.all(one == other)) for one, other in pairs)
    except Exception:  # as of math.log, or of a branch by an array
        return False


def _example(law, key, values):
    """Values of a method's argument, by its name, for two sliders."""
    if key == "slider":
        return SimpleNamespace(
            **{symbol: value * np.array([1, 1.1]) for symbol, value in values.items()}
        )
    if key == "p":
        slider = _example(law, "slider", values)
        return _elementwise(law.coefficients)(np.ones(2), slider)
    n = {"psi": len(law.states), "log_states": len(law.states), "e": law.n_exponents}.get(key)
    some = np.array([-0.3, 0.4]) if key in ("v", "psi", "log_states") else np.array([0.7, 1.3])
    return some if n is None else (some,) * n


def _elementwise(method):
    """A method of numbers as one of arrays."""

    @functools.wraps(method)
    def of_arrays(*arguments):
        shape = np.broadcast_shapes(*(np.shape(leaf) for leaf in _leaves(arguments)))
        if shape == ():
            return method(*arguments)
        columns = _each(lambda leaf: np.broadcast_to(leaf, shape).ravel(), arguments)
        found = [
            method(*_each(lambda column, i=i: column[i], columns)) for i in range(np.prod(shape))
        ]
        return _stacked(found, shape)

    return of_arrays


def _leaves(nested):
    """The numbers or arrays in nested tuples and namespaces."""
    if isinstance(nested, SimpleNamespace):
        nested = tuple(vars(nested).values())
    if not isinstance(nested, tuple | list):
        return [nested]
    return [leaf for part in nested for leaf in _leaves(part)]


def _each(function, nested):
    """The same nested, with a function of each number or array."""
    if isinstance(nested, SimpleNamespace):
        return SimpleNamespace(**{key: function(leaf) for key, leaf in vars(nested).items()})
    if isinstance(nested, tuple | list):
        return tuple(_each(function, part) for part in nested)
    return function(nested)


def _stacked(results, shape):
    """Nested arrays of this shape from the nested numbers of each element."""
    if isinstance(results[0], tuple):
        return tuple(_stacked(part, shape) for part in zip(*results, strict=True))
    return np.array(results).reshape(shape)
