"""Straight lines of SIMD code as LLVM text, by running Python once with numbers that write it.

A `Number` stands for as many doubles as the code's width, one a lane.  Its arithmetic appends
instructions to the `Code` that it belongs to, each of them once; conditions become bits by which
`where` selects.  Contraction (a*b + c in one rounding) is the only liberty taken.
"""

import functools
import operator
import struct

from ..friction.functions import CODE


def double(x):
    """A double as LLVM text, to its last digit."""
    return f"0x{struct.pack('>d', float(x)).hex().upper()}"


class Code:
    """Instructions that are being written, in their order.

    width : doubles that go together; letter : with which names begin
    """

    def __init__(self, width, letter="v"):
        self.lines, self.declarations = [], {}
        self._known, self._width, self._letter = {}, width, letter

    def _vector(self, item):
        return item if self._width == 1 else f"<{self._width} x {item}>"

    def write(self, instruction, kind):
        """What an instruction gives, an instance of a kind of `Value`."""
        if instruction not in self._known:
            name = f"%{self._letter}{len(self._known)}"
            self.lines.append(f"{name} = {instruction}")
            self._known[instruction] = kind(self, name)
        return self._known[instruction]

    def call(self, function, *numbers):
        """What a function of LLVM gives for numbers, such as "sqrt"."""
        name = f"@llvm.{function}.{f'v{self._width}' if self._width > 1 else ''}f64"
        double = self.type(Number)
        kinds = ", ".join([double] * len(numbers))
        self.declarations[name] = f"declare {double} {name}({kinds})"
        given = ", ".join(f"{double} {self.text(Number, one)}" for one in numbers)
        return self.write(f"call {double} {name}({given})", Number)

    def number(self, x):
        """A number as a `Number` of this code."""
        return x if isinstance(x, Number) else Number(self, self.text(Number, x))

    def place(self, start, at):
        """Where, behind a place, the double of this number stands."""
        return self.write(f"getelementptr double, ptr {start}, i64 {at}", Value).name

    def load(self, start, at):
        """The double, or the doubles from there on, that stand behind a place."""
        place = self.place(start, at)
        return self.write(f"load {self.type(Number)}, ptr {place}, align 8", Number)

    def store(self, value, start, at):
        """Put a `Number` there."""
        place = self.place(start, at)
        self.lines.append(f"store {self.type(Number)} {value.name}, ptr {place}, align 8")

    def type(self, kind):
        """The type of a kind of `Value`."""
        return self._vector(kind.item)

    def text(self, kind, x):
        """The text of a `Value` of this kind, or of a number."""
        return x.name if isinstance(x, Value) else self._constant(kind.item, x)

    def _constant(self, item, x):
        if item == "double":
            x = double(x)
        elif item == "i1":
            x = str(bool(x)).lower()
        return f"{x}" if self._width == 1 else f"splat ({item} {x})"


class Value:
    """What an instruction of some code gives, by its name there."""

    __slots__ = ("code", "name")
    functions = CODE
    item: str  # type of an element

    def __init__(self, code, name):
        self.code, self.name = code, name

    def __bool__(self):
        raise TypeError("a condition on numbers of code that is only being written")

    __hash__ = object.__hash__


def _operator(instruction, result=None, is_from_the_right=False):
    """An operator of two values of one kind, which gives that kind or another."""

    def applied(self, other):
        code, kind = self.code, type(self)
        pair = (other, self) if is_from_the_right else (self, other)
        values = ", ".join(code.text(kind, one) for one in pair)
        return code.write(f"{instruction} {code.type(kind)} {values}", result or kind)

    return applied


def _arithmetic(instruction):
    """An operator of numbers, and the same from the right."""
    contracted = f"{instruction} contract"
    return _operator(contracted), _operator(contracted, is_from_the_right=True)


def _same_bits(value, kind):
    """The bits of a value as another kind of value."""
    code = value.code
    given = f"{code.type(type(value))} {value.name}"
    return code.write(f"bitcast {given} to {code.type(kind)}", kind)


class Condition(Value):
    """Bits that are 1 where a condition holds."""

    __slots__ = ()
    item = "i1"

    __and__ = __rand__ = _operator("and")
    __or__ = __ror__ = _operator("or")
    __xor__ = _operator("xor")

    def __invert__(self):
        return self ^ True

    def select(self, x, y):
        """x where the condition holds, else y."""
        code = self.code
        sides = ", ".join(f"{code.type(Number)} {code.text(Number, one)}" for one in (x, y))
        return code.write(f"select {code.type(Condition)} {self.name}, {sides}", Number)


class Bits(Value):
    """64-bit integers."""

    __slots__ = ()
    item = "i64"

    __add__, __sub__, __and__ = map(_operator, ("add", "sub", "and"))
    __rsub__ = _operator("sub", is_from_the_right=True)
    __lshift__, __rshift__ = map(_operator, ("shl", "ashr"))

    def number(self):
        """The same bits as doubles."""
        return _same_bits(self, Number)


class Number(Value):
    """Doubles."""

    __slots__ = ()
    item = "double"

    __add__, __radd__ = _arithmetic("fadd")
    __sub__, __rsub__ = _arithmetic("fsub")
    __mul__, __rmul__ = _arithmetic("fmul")
    __truediv__, __rtruediv__ = _arithmetic("fdiv")
    __lt__, __le__ = _operator("fcmp olt", Condition), _operator("fcmp ole", Condition)
    __gt__, __ge__ = _operator("fcmp ogt", Condition), _operator("fcmp oge", Condition)
    __eq__, __ne__ = _operator("fcmp oeq", Condition), _operator("fcmp une", Condition)
    __hash__ = Value.__hash__

    def __pow__(self, n):
        return functools.reduce(operator.mul, (self,) * n)  # of a whole n > 0

    def __neg__(self):
        return self.code.write(f"fneg {self.code.type(Number)} {self.name}", Number)

    def __abs__(self):
        return self.code.call("fabs", self)

    def bits(self):
        """The same bits as integers."""
        return _same_bits(self, Bits)
