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

    def type(self, kind):
        """The type of a kind of `Value`."""
        return kind.item if self._width == 1 else f"<{self._width} x {kind.item}>"

    def text(self, kind, x):
        """The text of a `Value` of this kind, or of a number."""
        if isinstance(x, Value):
            return x.name
        text = double(x) if kind is Number else str(x).lower()
        return text if self._width == 1 else f"splat ({kind.item} {text})"

    def write(self, instruction, kind):
        """What an instruction gives, an instance of a kind of `Value`."""
        if instruction not in self._known:
            name = f"%{self._letter}{len(self._known)}"
            self.lines.append(f"{name} = {instruction}")
            self._known[instruction] = kind(self, name)
        return self._known[instruction]

    def call(self, function, x):
        """What a function of LLVM gives for a `Number`, such as "sqrt"."""
        name = f"@llvm.{function}.{f'v{self._width}' if self._width > 1 else ''}f64"
        double = self.type(Number)
        self.declarations[name] = f"declare {double} {name}({double})"
        return self.write(f"call {double} {name}({double} {x.name})", Number)

    def number(self, x):
        """A number as a `Number` of this code."""
        return x if isinstance(x, Number) else Number(self, self.text(Number, x))

    def _place(self, start, at):
        return self.write(f"getelementptr double, ptr {start}, i64 {at}", Value).name

    def load(self, start, at):
        """The double, or the doubles from there on, that stand behind a place."""
        place = self._place(start, at)
        return self.write(f"load {self.type(Number)}, ptr {place}, align 8", Number)

    def store(self, value, start, at):
        """Put a `Number` there."""
        place = self._place(start, at)
        self.lines.append(f"store {self.type(Number)} {value.name}, ptr {place}, align 8")


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


def _operators(instruction, result=None):
    """An operator of two values of one kind, which gives that kind or another; and its mirror."""

    def written(self, *pair):
        code, kind = self.code, type(self)
        values = ", ".join(code.text(kind, one) for one in pair)
        return code.write(f"{instruction} {code.type(kind)} {values}", result or kind)

    def applied(self, other):
        return written(self, self, other)

    def from_the_right(self, other):
        return written(self, other, self)

    return applied, from_the_right


def _same_bits(value, kind):
    """The bits of a value as another kind of value."""
    code = value.code
    given = f"{code.type(type(value))} {value.name}"
    return code.write(f"bitcast {given} to {code.type(kind)}", kind)


class Condition(Value):
    """Bits that are 1 where a condition holds."""

    __slots__ = ()
    item = "i1"

    __and__, __rand__ = _operators("and")
    __or__, __ror__ = _operators("or")
    __xor__, __rxor__ = _operators("xor")

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

    __add__, __radd__ = _operators("add")
    __sub__, __rsub__ = _operators("sub")
    __and__, __rand__ = _operators("and")
    __lshift__, __rlshift__ = _operators("shl")
    __rshift__, __rrshift__ = _operators("ashr")

    def number(self):
        """The same bits as doubles."""
        return _same_bits(self, Number)


class Number(Value):
    """Doubles."""

    __slots__ = ()
    item = "double"

    __add__, __radd__ = _operators("fadd contract")
    __sub__, __rsub__ = _operators("fsub contract")
    __mul__, __rmul__ = _operators("fmul contract")
    __truediv__, __rtruediv__ = _operators("fdiv contract")
    __lt__, __gt__ = _operators("fcmp olt", Condition)
    __le__, __ge__ = _operators("fcmp ole", Condition)
    __eq__, __ne__ = (_operators(f"fcmp {test}", Condition)[0] for test in ("oeq", "une"))
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
