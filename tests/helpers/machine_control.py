"""Machine code of functions: of those that the control is written like, and of formulas."""

import ctypes

import numpy as np

from ratestate.engine.code import Code
from ratestate.engine.compiler import kernel_text
from ratestate.engine.machine_code import compile_object, load_functions
from ratestate.engine.programs import Context


class Machine:
    """A `programs.Program` that is not kept on disk: the sources of tests are not in its name."""

    def __init__(self, function, record, level=0):
        self.context, name = Context(record), function.__name__
        code = compile_object(kernel_text(function, self.context.layout()), level=level)
        kind = ctypes.CFUNCTYPE(ctypes.c_bool, ctypes.c_void_p, ctypes.c_int64)
        self.run = kind(load_functions(code, [name])[name])

    def __call__(self, number=0):
        """What the function returns for the record and an int."""
        return self.run(self.context.words.ctypes.data, number)


def each(function, x):
    """A function of all numbers in tuples of tuples."""
    return tuple(each(function, one) for one in x) if isinstance(x, tuple) else function(x)


def flat(x):
    return [one for part in x for one in flat(part)] if isinstance(x, tuple) else [x]


class Formula:
    """A function of numbers, and of tuples of them, which was run once with numbers of code.

    like : arguments of the same lengths
    """

    def __init__(self, function, *like):
        code, count = Code(1), iter(range(10_000))
        found = function(*each(lambda _: code.load("%given", next(count)), like))
        for k, one in enumerate(flat(found)):
            code.store(one, "%found", k)
        head = "define void @f(ptr %given, ptr %found) {"
        text = "\n".join([head, *code.lines, "ret void", "}"])
        kind = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)
        self.code = kind(load_functions(compile_object(text), ["f"])["f"])
        self.found, self.out = each(lambda _: None, found), np.empty(len(flat(found)))

    def __call__(self, *given):
        """What the function gives, of floats."""
        given = np.array(flat(each(float, given)))
        self.code(given.ctypes.data, self.out.ctypes.data)
        values = iter(self.out.tolist())
        return each(lambda _: next(values), self.found)
