"""Straight lines of arithmetic for compiled code, by running them once as Python.

Given numbers whose arithmetic writes LLVM instructions, a Python function of tuples of numbers
leaves behind the straight line of code that it stands for, which loops over lanes can vectorise.
That takes a fraction of the time in which numba would read, and type, the same function.
"""

import functools
import inspect

from llvmlite import ir
from numba import types
from numba.core.cgutils import unpack_tuple
from numba.core.typing.templates import infer, infer_global, make_intrinsic_template

DOUBLE, BITS = ir.DoubleType(), ir.IntType(64)


def traced(function):
    """A function of numbers, and tuples of numbers or of tuples, without conditions on numbers.

    Compiled code may call it, with a law among the arguments too; so may Python, with any numbers.
    """

    def definition(typing_context, *given):
        result = _type_of(function(*(_stand_in(kind) for kind in given)))

        def generate(context, builder, signature, arguments):
            values = map(functools.partial(_traced, builder), signature.args, arguments)
            return _value(context, builder, result, function(*values))

        return result(*given), generate

    parameters = inspect.signature(function).parameters.values()
    context = inspect.Parameter("typing_context", inspect.Parameter.POSITIONAL_OR_KEYWORD)
    # numba binds arguments by it; a function's attributes are not declared
    definition.__signature__ = inspect.Signature([context, *parameters])  # type: ignore[attr-defined]
    template = make_intrinsic_template(function, definition, function.__name__)
    infer(template)
    infer_global(function, types.Function(template))
    return function


class Number:
    """A double of code that is being written, with contraction (jit.py); a stand-in without any."""

    def __init__(self, builder=None, value=None):
        self.builder, self.value = builder, value

    def _write(self, instruction, x, y):
        if self.builder is None:
            return self
        values = (_double(self.builder, one) for one in (x, y))
        write = getattr(self.builder, instruction)
        return Number(self.builder, write(*values, flags=("contract",)))

    def __add__(self, other):
        return self._write("fadd", self, other)

    def __radd__(self, other):
        return self._write("fadd", other, self)

    def __sub__(self, other):
        return self._write("fsub", self, other)

    def __rsub__(self, other):
        return self._write("fsub", other, self)

    def __mul__(self, other):
        return self._write("fmul", self, other)

    def __rmul__(self, other):
        return self._write("fmul", other, self)

    def __truediv__(self, other):
        return self._write("fdiv", self, other)

    def __rtruediv__(self, other):
        return self._write("fdiv", other, self)

    def __neg__(self):
        return self._write("fsub", -0.0, self)

    def __abs__(self):
        if self.builder is None:
            return self
        # without the bit of the sign: CUDA's compiler knows no llvm.fabs
        bits = self.builder.bitcast(self.value, BITS)
        bits = self.builder.and_(bits, ir.Constant(BITS, 2**63 - 1))
        return Number(self.builder, self.builder.bitcast(bits, DOUBLE))

    def __bool__(self):
        raise TypeError("a condition on a number of code that is only being written")

    def __eq__(self, other):
        return bool(self)

    __lt__ = __gt__ = __le__ = __ge__ = __eq__
    __hash__ = object.__hash__


def _double(builder, x):
    """The value in LLVM of a `Number` or a float."""
    return x.value if isinstance(x, Number) else ir.Constant(DOUBLE, float(x))


def _stand_in(kind):
    """What the function is given to see what it returns for arguments of a type."""
    return _traced(None, kind, None)


def _traced(builder, kind, value):
    """An argument as the function gets it."""
    if isinstance(kind, types.BaseTuple):
        # (that numba's tuple types can be gone through is not declared)
        kinds: list = list(kind)  # type: ignore[call-overload]
        values = [None] * len(kinds) if builder is None else unpack_tuple(builder, value)
        items = map(functools.partial(_traced, builder), kinds, values)
        return getattr(kind, "instance_class", _tuple)(*items)
    if kind != types.float64 and not hasattr(kind, "law"):
        raise TypeError(f"a traced function takes numbers, tuples of them and laws, not {kind}")
    return Number(builder, value) if kind == types.float64 else kind.law


def _tuple(*items):
    return items


def _type_of(result):
    """The type of what the function returns."""
    if not isinstance(result, tuple):
        return types.float64
    kinds = [_type_of(one) for one in result]
    if hasattr(result, "_fields"):
        return types.NamedTuple(kinds, type(result))
    return types.BaseTuple.from_types(kinds)


def _value(context, builder, kind, result):
    """The value in LLVM of what the function returns."""
    if not isinstance(result, tuple):
        return _double(builder, result)
    values = list(map(functools.partial(_value, context, builder), kind, result))
    return context.make_tuple(builder, kind, values)
