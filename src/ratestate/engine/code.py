"""Straight lines of SIMD code as LLVM text, by running Python once with numbers that write it.

A `Number` stands for as many doubles as the code's width, one a lane.  Its arithmetic appends
instructions to the `Code` that it belongs to, each of them once; conditions become bits by which
`where` selects.  Contraction (a*b + c in one rounding) is the only liberty taken.
"""

import struct


class Code:
    """Instructions that are being written, in their order.

    width : doubles that go together
    """

    def __init__(self, width):
        self.lines, self.declarations = [], {}
        self._known, self._width = {}, width
        self.double, self.bits, self.bit = map(self._vector, ("double", "i64", "i1"))

    def _vector(self, item):
        return item if self._width == 1 else f"<{self._width} x {item}>"

    def constant(self, kind, value):
        """The text of a constant; kind : of its elements."""
        if kind == "double":
            value = f"0x{struct.pack('>d', value).hex().upper()}"
        return f"{value}" if self._width == 1 else f"splat ({kind} {value})"

    def write(self, instruction, kind):
        """What an instruction gives, an instance of a kind of `Value`."""
        if instruction not in self._known:
            name = f"%v{len(self._known)}"
            self.lines.append(f"{name} = {instruction}")
            self._known[instruction] = kind(self, name)
        return self._known[instruction]

    def call(self, function, *numbers):
        """What a function of LLVM gives for numbers, such as "sqrt"."""
        name = f"@llvm.{function}.{f'v{self._width}' if self._width > 1 else ''}f64"
        kinds = ", ".join([self.double] * len(numbers))
        self.declarations[name] = f"declare {self.double} {name}({kinds})"
        given = ", ".join(f"{self.double} {self.number(one)}" for one in numbers)
        return self.write(f"call {self.double} {name}({given})", Number)

    def number(self, x):
        """The text of a `Number` or a float."""
        return x.name if isinstance(x, Number) else self.constant("double", float(x))

    def integer(self, x):
        """The text of `Bits` or an int."""
        return x.name if isinstance(x, Bits) else self.constant("i64", x)

    def condition(self, x):
        """The text of a `Condition` or a bool."""
        return x.name if isinstance(x, Condition) else self.constant("i1", str(bool(x)).lower())


class Value:
    """What an instruction of some code gives, by its name there."""

    __slots__ = ("code", "name")

    def __init__(self, code, name):
        self.code, self.name = code, name

    def __bool__(self):
        raise TypeError("a condition on numbers of code that is only being written")

    __hash__ = object.__hash__


def _arithmetic(instruction):
    """An operator of numbers, and the same from the right."""

    def applied(code, x, y):
        values = f"{code.number(x)}, {code.number(y)}"
        return code.write(f"{instruction} contract {code.double} {values}", Number)

    def left(self, other):
        return applied(self.code, self, other)

    def right(self, other):
        return applied(self.code, other, self)

    return left, right


def _comparison(relation):
    def compared(self, other):
        code = self.code
        values = f"{code.number(self)}, {code.number(other)}"
        return code.write(f"fcmp {relation} {code.double} {values}", Condition)

    return compared


class Number(Value):
    """Doubles."""

    __slots__ = ()

    __add__, __radd__ = _arithmetic("fadd")
    __sub__, __rsub__ = _arithmetic("fsub")
    __mul__, __rmul__ = _arithmetic("fmul")
    __truediv__, __rtruediv__ = _arithmetic("fdiv")
    __lt__, __le__, __gt__, __ge__ = map(_comparison, ("olt", "ole", "ogt", "oge"))

    def __neg__(self):
        return self.code.write(f"fneg {self.code.double} {self.name}", Number)

    def __abs__(self):
        return self.code.call("fabs", self)

    def bits(self):
        """The same bits as integers."""
        code = self.code
        return code.write(f"bitcast {code.double} {self.name} to {code.bits}", Bits)


def _of_integers(instruction):
    def applied(self, other):
        code = self.code
        values = f"{code.integer(self)}, {code.integer(other)}"
        return code.write(f"{instruction} {code.bits} {values}", Bits)

    return applied


class Bits(Value):
    """64-bit integers."""

    __slots__ = ()

    __add__, __sub__, __and__ = map(_of_integers, ("add", "sub", "and"))
    __lshift__, __rshift__ = map(_of_integers, ("shl", "ashr"))

    def number(self):
        """The same bits as doubles."""
        code = self.code
        return code.write(f"bitcast {code.bits} {self.name} to {code.double}", Number)


def _of_conditions(instruction):
    def applied(self, other):
        code = self.code
        values = f"{code.condition(self)}, {code.condition(other)}"
        return code.write(f"{instruction} {code.bit} {values}", Condition)

    return applied


class Condition(Value):
    """Bits that are 1 where a condition holds."""

    __slots__ = ()

    __and__ = __rand__ = _of_conditions("and")
    __or__ = __ror__ = _of_conditions("or")
    __xor__ = _of_conditions("xor")

    def __invert__(self):
        return self ^ True


def where(condition, x, y):
    """x where a condition holds, else y."""
    if not isinstance(condition, Condition):
        return x if condition else y
    code = condition.code
    values = f"{code.double} {code.number(x)}, {code.double} {code.number(y)}"
    return code.write(f"select {code.bit} {condition.name}, {values}", Number)
