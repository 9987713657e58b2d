"""Run compiled programs from Python: the control, and the units of a law.

Each object is compiled when it is first needed, and cached on disk (machine_code.py).
"""

import ctypes
import functools
import inspect
import itertools
import operator
from pathlib import Path

import numpy as np

from ..errors import CompilationError
from ..friction.user_law import reason_of
from . import machine_code
from .code import unit_text
from .compiler import KINDS, Array, Word, kernel_text
from .machine_code import compile_object
from .units import unit_names

#: level of optimisation of a control: level 2 takes 0.2 s more, and its code is not faster
LEVEL = 1


class Context:
    """A record as machine code reads it: ints, and addresses and shapes of arrays.

    record : named tuple of ints, arrays, functions, and such tuples
    place : array -> its address, if the kernel does not run in this machine's memory
    """

    def __init__(self, record, place=None):
        self._record = record  # keeps the arrays alive
        self._place = place or _host_address
        #: types of arrays and names of functions, on which the code of a kernel depends
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
            elif not _is_constant(x):
                words.append(operator.index(x))

    def layout(self):
        """Return the record with a `Word` for each int and an `Array` for each array."""
        return _layout(self._record, itertools.count())


def _is_constant(x):
    return isinstance(x, (str, Array)) or callable(x)


def _layout(x, places):
    if isinstance(x, tuple):
        return type(x)(*(_layout(part, places) for part in x))
    if _is_constant(x):
        return x
    at, *_ = itertools.islice(places, 1 + np.ndim(x))
    return Array(at, x.ndim, x.dtype) if isinstance(x, np.ndarray) else Word(at)


def _host_address(x):
    try:  # three times as fast as `ctypes.data`
        return ctypes.addressof(ctypes.c_char.from_buffer(x))
    except (TypeError, ValueError):  # the array is read-only or empty
        return x.ctypes.data


_functions: dict = {}  # (function, kinds of arrays) -> function of ctypes


class Program:
    """A compiled function in a small part of Python, and the record it works on.

    Parameters
    ----------
    function : a function of a record and an int that returns a bool
    record : as for `Context`; arrays are changed in place
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
        file = Path(inspect.getfile(function))  # which may be in another package
        version = machine_code.short_hash((kinds, file.read_bytes()))
        addresses = machine_code.addresses(
            f"{name}-{version}",
            lambda: compile_object(kernel_text(function, layout), level=LEVEL),
            [name],
        )
        return ctypes.CFUNCTYPE(ctypes.c_bool, ctypes.c_void_p, ctypes.c_int64)(addresses[name])

    def __call__(self, budget):
        """Return the function's result; other Python threads may run at the same time."""
        return self._run(self._words, budget)


@functools.cache
def units_of(law, kind, width):
    """Return a law's compiled units; kind : their class; width : lanes of a vector."""
    name, names = f"{law.name}-{kind.__name__}-{width}", unit_names(law, kind)
    units = machine_code.addresses(name, lambda: compile_object(_text(law, kind, width)), names)
    return kind(**dict.fromkeys(kind._fields, 0) | units)


def _text(law, kind, width):
    try:
        return unit_text(law, kind, width)
    except Exception as error:  # a user wrote the law's methods, and they may raise anything
        raise CompilationError(
            f"the law {law.name} cannot be compiled ({reason_of(error)}). Its methods "
            f"may hold arithmetic, and functions that ratestate has for laws."
        ) from error
