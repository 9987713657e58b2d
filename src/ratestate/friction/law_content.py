"""Everything that the methods of a user's law take their numbers from, for the hash in its name.

A law's source is not all of it: a method may use a constant of its module, a function imported from
another file, a base class or a variable of the function around it.  Compiled code holds their
values, so two laws are the same only if all of these are the same.  A function counts by its
bytecode, which is what runs, whatever has happened to its file since it was read.  Functions of a
law file count by its text, which every version of Python compiles to the same numbers.
"""

import inspect
import sys
import types

from ..errors import ParameterError

#: packages whose functions and classes count by name alone
INSTALLED = sys.stdlib_module_names | {"llvmlite", "numba", "numpy", "ratestate", "scipy"}
#: values that `repr` shows in full
PLAIN = bool | int | float | complex | str | bytes | types.EllipsisType | None
FUNCTIONS = type | types.FunctionType | types.BuiltinFunctionType
#: what the module of a law file is called, before a hash of its text
LAW_FILE = "ratestate_law_"
#: entries of a class that are not its author's: of `user_law.py`, and of Python
NOT_OWN = {"file", "source", "_abc_impl", "__annotate_func__"}


def content_of(kind):
    """Return a text that differs if the numbers of a class of laws may differ.

    ParameterError for a value that has no such text, such as an open file.
    """
    return "\n".join(_Reader().texts(kind, kind.__name__))


class _Reader:
    """Reads each function and class once: they may refer to each other."""

    def __init__(self):
        self._read = set()

    def texts(self, value, name):
        """Yield the texts of a value and of everything that it refers to; name: for messages."""
        if isinstance(value, PLAIN):
            yield f"{type(value).__name__} {value!r}"
        elif isinstance(value, FUNCTIONS) or type(value).__name__ == "ufunc":
            if _is_installed(value):
                yield f"{value.__module__}.{value.__name__}"
            elif value not in self._read:
                self._read.add(value)
                is_class = isinstance(value, type)
                yield from (self._of_class if is_class else self._of_function)(value, name)
        elif isinstance(value, types.ModuleType):
            yield value.__name__
        elif isinstance(value, tuple | list):
            yield f"{type(value).__name__} of {len(value)}"
            yield from self._of_items(enumerate(value), name)
        elif isinstance(value, dict | types.MappingProxyType):
            yield f"dict of {len(value)}"
            yield from self._of_items(enumerate(value), name)
            yield from self._of_items(value.items(), name)
        elif isinstance(value, set | frozenset):
            yield f"set of {sorted(map(repr, value))}"
        elif isinstance(value, property):
            yield from self.texts(value.fget, name)
        elif isinstance(value, staticmethod | classmethod):
            yield from self.texts(value.__func__, name)
        elif hasattr(value, "py_func"):  # compiled by numba
            yield from self.texts(value.py_func, name)
        else:
            yield from self._of_object(value, name)

    def _of_items(self, items, name):
        for key, value in items:
            yield f"{key}:"
            yield from self.texts(value, f"{name}.{key}" if isinstance(key, str) else name)

    def _of_class(self, kind, name):
        yield f"class {kind.__qualname__}"
        own = [(key, value) for key, value in sorted(vars(kind).items()) if _is_own(key, value)]
        yield from self._of_items(own, name)
        yield from self._of_items(enumerate(kind.__bases__), name)

    def _of_function(self, function, name):
        names = []
        for code in _codes(function.__code__):
            names += code.co_names
            if function.__module__.startswith(LAW_FILE):
                yield function.__module__
                continue
            yield f"code {code.co_code.hex()} {code.co_names} {code.co_varnames}"
            constants = [x for x in code.co_consts if not isinstance(x, types.CodeType)]
            yield from self.texts(constants, name)
        yield from self.texts((function.__defaults__, function.__kwdefaults__), name)
        enclosing = inspect.getclosurevars(function).nonlocals
        yield from self._of_items(sorted(enclosing.items()), name)
        for key in sorted(set(names) & function.__globals__.keys()):
            value = function.__globals__[key]
            yield from self._of_items([(key, value)], name)
            if isinstance(value, types.ModuleType) and not _is_installed(value):
                used = sorted(set(names) & vars(value).keys())
                yield from self._of_items(((k, vars(value)[k]) for k in used), key)

    def _of_object(self, value, name):
        """Yield the texts of what `pickle` would make any other object again from."""
        try:
            parts = value.__reduce_ex__(2)
        except Exception as error:  # a user's object may raise anything from `__reduce_ex__`
            raise ParameterError(
                f"the law refers to {name}, a {type(value).__name__}, which cannot be recorded "
                f"with the results; refer to numbers, tuples, arrays and functions only"
            ) from error
        yield from self.texts(parts, name)


def _is_own(key, value):
    """Whether an entry of a class is its author's; Python adds others, some of them late."""
    is_method = isinstance(value, types.FunctionType)
    return key not in NOT_OWN and (is_method or not key.startswith("__"))


def _codes(code):
    """Yield the code of a function and of each function inside it."""
    yield code
    for inner in code.co_consts:
        if isinstance(inner, types.CodeType):
            yield from _codes(inner)


def _is_installed(value):
    """Whether a module, class or function belongs to a package that users do not edit."""
    name = value.__name__ if isinstance(value, types.ModuleType) else value.__module__
    return (name or "builtins").partition(".")[0] in INSTALLED
