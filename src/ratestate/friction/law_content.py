"""Everything that the methods of a user's law take their numbers from, for the hash in its name.

A law's source is not all of it: a method may use a constant of its module, a function imported from
another file, a base class or a variable of the function around it.  Compiled code holds their
values, so two laws are the same only if all of these are the same.  A function counts by its
bytecode, which is what runs, whatever has happened to its file since it was read.  Functions of a
law file count by its text, which every version of Python compiles to the same numbers.
"""

import dis
import functools
import inspect
import sys
import types
from collections.abc import Iterator

from ..errors import ParameterError

#: packages whose functions and classes count by name alone
INSTALLED = sys.stdlib_module_names | {"llvmlite", "numba", "numpy", "ratestate", "scipy"}
#: values that `repr` shows in full
PLAIN = {bool, int, float, complex, str, bytes, type(...), type(None)}
#: what the module of a law file is called, before a hash of its text
LAW_FILE = "ratestate_law_"
#: entries of a class that are not its author's: of `user_law.py`, and of Python
NOT_OWN = {"file", "source", "_abc_impl", "__annotate_func__"}


def content_of(kind):
    """Return a text that differs if the numbers of a class of laws may differ.

    ParameterError for a value that has no such text, such as an open file.
    """
    reader = _Reader()
    texts = [*reader.texts(kind, kind.__name__), *reader.of_modules()]
    return "\n".join(texts)


class _Reader:
    """Reads each function and class once: they may refer to each other."""

    def __init__(self):
        self._numbers = {}  # function or class -> its place in the order of reading
        self._open = []  # containers and objects that are being read
        self._modules = {}  # name -> module of the user's
        self._names = set()  # that functions use, among them attributes of modules

    def texts(self, value, name):
        """Yield the texts of a value and of everything that it refers to; name: for messages."""
        if type(value) in PLAIN:
            yield f"{type(value).__name__} {value!r}"
        elif isinstance(value, types.ModuleType):
            yield value.__name__
            if not _is_installed_name(value.__name__):
                self._modules[value.__name__] = value
        elif by_name := _installed(value):
            yield by_name
        elif isinstance(value, type | types.FunctionType):
            known = value in self._numbers
            yield f"number {self._numbers.setdefault(value, len(self._numbers))}"
            if not known:
                is_class = isinstance(value, type)
                yield from (self._of_class if is_class else self._of_function)(value, name)
        elif any(value is one for one in self._open):
            yield "itself"
        else:
            self._open.append(value)
            yield from self._of_container(value, name)
            self._open.pop()

    def of_modules(self):
        """Yield the texts of what functions use of the modules that have been met."""
        done = set()
        while pending := sorted(
            (m, k)
            for m, module in self._modules.items()
            for k in self._names & vars(module).keys()
            if (m, k) not in done
        ):
            done.update(pending)
            for m, k in pending:
                yield from self._of_items([(k, vars(self._modules[m])[k])], m)

    def _of_container(self, value, name):
        if type(value) in (tuple, list):
            yield f"{type(value).__name__} of {len(value)}"
            yield from self._of_items(enumerate(value), name)
        elif type(value) in (dict, types.MappingProxyType):
            yield f"dict of {len(value)}"
            yield from self._of_items(enumerate(value), name)
            yield from self._of_items(value.items(), name)
        elif type(value) in (set, frozenset):
            yield f"set of {sorted(' '.join(self.texts(one, name)) for one in value)}"
        elif isinstance(value, property):
            yield from self.texts(value.fget, name)
        elif isinstance(value, functools.cached_property):
            yield from self.texts(value.func, name)
        elif isinstance(value, staticmethod | classmethod):
            yield from self.texts(value.__func__, name)
        elif hasattr(value, "py_func"):  # compiled by numba
            yield from self.texts(value.py_func, name)
        elif hasattr(value, "__wrapped__"):  # a cache around a function
            yield from self.texts(value.__wrapped__, name)
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
        known = function.__globals__
        home = known.get("__name__") or ""
        read = set()
        for code in _codes(function.__code__):
            self._names.update(code.co_names)
            loads = dis.get_instructions(code)
            read |= {one.argval for one in loads if one.opname in ("LOAD_GLOBAL", "LOAD_NAME")}
            if home.startswith(LAW_FILE):
                yield home
                continue
            yield f"code {code.co_code.hex()} {code.co_names} {code.co_varnames}"
            constants = [x for x in code.co_consts if not isinstance(x, types.CodeType)]
            yield from self.texts(constants, name)
        yield from self.texts((function.__defaults__, function.__kwdefaults__), name)
        enclosing = inspect.getclosurevars(function).nonlocals
        yield from self._of_items(sorted(enclosing.items()), name)
        yield from self._of_items(((k, known[k]) for k in sorted(read & known.keys())), name)

    def _of_object(self, value, name):
        """Yield the texts of what `pickle` would make any other object again from."""
        try:
            parts = value.__reduce_ex__(2)
            if isinstance(parts, str):  # a name
                raise TypeError(parts)
            parts = [[*part] if isinstance(part, Iterator) else part for part in parts]
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


def _is_installed_name(name):
    """Whether a module belongs to a package that users do not edit."""
    return name.partition(".")[0] in INSTALLED


def _installed(value):
    """Return the full name of an object of an installed package, "" of any other.

    `functools.wraps` gives other functions such names: only the object that has the name counts.
    """
    module = getattr(value, "__module__", None) or "builtins"
    names = getattr(value, "__qualname__", None) or getattr(value, "__name__", None)
    if not (isinstance(module, str) and isinstance(names, str) and _is_installed_name(module)):
        return ""
    for home in (module, "numpy"):  # NumPy's ufuncs do not say where they are from
        found = sys.modules.get(home)
        for one in names.split("."):
            found = getattr(found, one, None)
        if found is value:
            return f"{home}.{names}"
    return ""
