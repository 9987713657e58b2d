"""Kernels run from Python: machine code of a control (compiler.py) and of a law's units (code.py).

Each object is made when it is first needed, and kept on disk (machine_code.py).
"""

import ctypes
import functools
import inspect
import itertools
import operator
from pathlib import Path

import numpy as np

from ..errors import CompilationError
from . import machine_code
from .code import unit_text
from .compiler import KINDS, Array, Word, kernel_text
from .machine_code import compiled
from .units import unit_names

#: the level of optimisation of a control: its code is no faster at 2, which takes 0.2 s more
LEVEL = 1


class Context:
    """A record as machine code sees it: words, which are ints, and of arrays address and shape.

    record : named tuple of ints, arrays, functions, and such tuples
    place : array -> its address, if the kernel does not run on this machine's memory
    """

    def __init__(self, record, place=None):
        self._record = record  # (it keeps the arrays)
        self._place = place or _own_address
        #: what the code of a kernel depends on: types of arrays, and names of functions
        self.kinds = []
        words: list[int] = []
        self._add(record, words)
        self.words = np.array(words, np.int64)

    def _add(self, record, words):
        for x in record:
            if type(x) is int:
                words.append(x)
            elif isinstance(x, tuple):
                self._add(x, words)
            elif type(x) is np.ndarray:
                if not x.flags.c_contiguous or x.dtype not in KINDS:
                    names = ", ".join(map(str, KINDS))
                    raise TypeError(f"an array of a kernel must be contiguous, of {names}")
                words += self._place(x), *x.shape
                self.kinds.append((x.ndim, x.dtype))
            elif inspect.isfunction(x):
                self.kinds.append((x.__module__, x.__name__))
            elif not _is_known(x):
                words.append(operator.index(x))

    def layout(self):
        """The record, with a `Word` for each int and an `Array` for each array."""
        return _layout(self._record, itertools.count())


def _is_known(x):
    return isinstance(x, (str, Array)) or callable(x)


def _layout(x, places):
    if isinstance(x, tuple):
        return type(x)(*(_layout(one, places) for one in x))
    if _is_known(x):
        return x
    at, *_ = itertools.islice(places, 1 + np.ndim(x))
    return Array(at, x.ndim, x.dtype) if isinstance(x, np.ndarray) else Word(at)


def _own_address(x):
    try:  # a third of the time that `ctypes.data` takes
        return ctypes.addressof(ctypes.c_char.from_buffer(x))
    except (TypeError, ValueError):  # it cannot be written to, or is empty
        return x.ctypes.data


_functions: dict = {}  # (function, kinds of arrays) -> function of ctypes


class Program:
    """A function of a small part of Python that is run on a record as machine code.

    Parameters
    ----------
    function : of a record and an int, which returns a bool
    record : as of `Context`; arrays are used as they are
    """

    def __init__(self, function, record):
        self._context = Context(record)
        self._words = self._context.words.ctypes.data
        key = function, tuple(self._context.kinds)
        if key not in _functions:
            _functions[key] = self._loaded(function, key[1])
        self._run = _functions[key]

    def _loaded(self, function, kinds):
        name, layout = function.__name__, self._context.layout()
        file = Path(inspect.getfile(function))  # it may be in another package
        version = machine_code.short_hash((kinds, file.read_bytes()))
        found = machine_code.addresses(
            f"{name}-{version}",
            lambda: compiled(kernel_text(function, layout), level=LEVEL),
            [name],
        )
        return ctypes.CFUNCTYPE(ctypes.c_bool, ctypes.c_void_p, ctypes.c_int64)(found[name])

    def __call__(self, budget):
        """What the function returns; other threads of Python may run meanwhile."""
        return self._run(self._words, budget)


@functools.cache
def units_of(law, kind, width):
    """The units of a law, loaded; kind : their class (units.py); width : lanes of a vector."""
    name, names = f"{law.name}-{kind.__name__}-{width}", unit_names(law, kind)
    found = machine_code.addresses(name, lambda: compiled(_text(law, kind, width)), names)
    return kind(**dict.fromkeys(kind._fields, 0) | found)


def _text(law, kind, width):
    try:
        return unit_text(law, kind, width)
    except Exception as error:  # a law's methods are a user's, and may raise anything
        raise CompilationError(
            f"the law {law.name} cannot be compiled ({machine_code.reason(error)}). Its methods "
            f"may hold arithmetic, and functions that ratestate has for laws."
        ) from error
