"""Generate LLVM text of a law's units: run Python functions on numbers that record operations.

A `Number` stands for as many doubles as the code's width, one for each lane.  Its arithmetic
appends instructions to its `Code`, each of them once.  Conditions become bits by which `where`
selects.  A sum with a product, a*b + c, is rounded once if the processor can do so.  The text
contains this contraction, the only liberty, so that vectors of any width give the same bits.

The units of a law (units.py) have no branches.  Their functions have these signatures:

===========================  =======================================================
``void f(s, n)``             works on n lanes, whole vectors, from the column s on
``void f(s, in, out)``       works on the lane at s: input and output numbers
===========================  =======================================================
"""

import functools
import operator
import struct

from ..friction.functions import CODE
from .rows import OUTPUT, WORK_SIZE
from .units import lane_units, point_units

VECTOR = 8  # doubles of a `Vector`


def double(x):
    """Return a double as LLVM text, exact to the last bit."""
    return f"0x{struct.pack('>d', float(x)).hex().upper()}"


class Code:
    """Instructions in their order.

    width : number of doubles in a vector; letter : first letter of all names
    """

    contracts = True  # whether a sum with a product is rounded once

    def __init__(self, width, letter="v"):
        self.lines = []
        self._written, self._width, self._letter = {}, width, letter

    def type(self, kind):
        """Return the LLVM type of a kind of `Value`."""
        return kind.item if self._width == 1 else f"<{self._width} x {kind.item}>"

    def text(self, kind, x):
        """Return the text of a number or `Value`, converted to this kind."""
        if type(x) is kind:
            return x.name
        if kind is Vector:
            empty, first = f"{kind.item} poison", f"<{VECTOR} x i32> zeroinitializer"
            x = self.write(f"insertelement {empty}, double {self.text(Number, x)}, i64 0", kind)
            x = f"shufflevector {kind.item} {x.name}, {empty}, {first}"
            return self.write(x, kind).name
        if isinstance(x, Value):
            cast = f"{x.casts[kind.item]} {self.type(type(x))} {x.name}"
            return self.write(f"{cast} to {self.type(kind)}", kind).name
        text = double(x) if kind is Number else f"{x:d}"
        return text if self._width == 1 else f"splat ({kind.item} {text})"

    def write(self, instruction, kind):
        """Append an instruction if it is new; return its result, of a kind of `Value`."""
        if instruction not in self._written:
            name = f"%{self._letter}{len(self._written)}"
            self.lines.append(f"{name} = {instruction}")
            self._written[instruction] = kind(self, name)
        return self._written[instruction]

    def call(self, function, *arguments):
        """Return the result of an LLVM function, such as "sqrt", for some numbers."""
        name = f"@llvm.{function}.{f'v{self._width}' if self._width > 1 else ''}f64"
        double = self.type(Number)
        texts = ", ".join(f"{double} {self.text(Number, x)}" for x in arguments)
        return self.write(f"call {double} {name}({texts})", Number)

    def as_value(self, x, kind):
        """Return a number or `Value` as a `Value` of this kind."""
        return x if type(x) is kind else kind(self, self.text(kind, x))

    def _pointer(self, start, at):
        return self.write(f"getelementptr double, ptr {start}, i64 {at}", Value).name

    def load(self, start, at):
        """Return the `Number` stored at an index after a pointer."""
        place = self._pointer(start, at)
        return self.write(f"load {self.type(Number)}, ptr {place}, align 8", Number)

    def store(self, value, start, at):
        """Store a number at an index after a pointer."""
        text, place = self.text(Number, value), self._pointer(start, at)
        self.lines.append(f"store {self.type(Number)} {text}, ptr {place}, align 8")


def result_kind(x, y):
    """Return the kind of the result of arithmetic on two values or numbers."""
    kinds = type(x), type(y)
    if Vector in kinds:
        return Vector
    if Number in kinds or isinstance(x, float) or isinstance(y, float):
        return Number
    return Bits if Bits in kinds or int in kinds else Condition


def _contract(code, instruction, x, y):
    """Return a sum or difference that contains a product, in one rounding; else None."""
    if factors := getattr(y, "factors", None):
        first, second = factors
        return code.call("fmuladd", first if instruction == "fadd" else -first, second, x)
    if factors := getattr(x, "factors", None):
        return code.call("fmuladd", *factors, y if instruction == "fadd" else -y)
    return None


def _operators(of_doubles, of_ints=None, is_test=False):
    """Return an operator and its mirror image; is_test : it gives a `Condition`."""

    def written(code, x, y):
        kind = result_kind(x, y) if of_ints else Number
        if kind is Condition and of_doubles:
            kind = Bits
        instruction = of_doubles if kind in (Number, Vector) else of_ints
        if instruction is None:
            raise TypeError("an operator of integers")
        if instruction in ("fadd", "fsub"):
            if (result := _contract(code, instruction, x, y)) is not None:
                return result
        values = f"{code.type(kind)} {code.text(kind, x)}, {code.text(kind, y)}"
        result = code.write(f"{instruction} {values}", Condition if is_test else kind)
        if code.contracts and instruction == "fmul":
            result.factors = code.as_value(x, Number), code.as_value(y, Number)
        return result

    def applied(self, other):
        return written(self.code, self, other)

    def reflected(self, other):
        return written(self.code, other, self)

    return applied, reflected


class Value:
    """The result of an instruction, known by its name in the code."""

    __slots__ = ("code", "name")
    functions = CODE
    item: str  # type of an element
    align = ""  # of an element in memory, if it is not the usual
    casts: dict  # item of another kind -> instruction that converts to it

    def __init__(self, code, name):
        self.code, self.name = code, name

    def __bool__(self):
        raise TypeError("a condition on numbers of code that is only being written")

    __add__, __radd__ = _operators("fadd", "add")
    __sub__, __rsub__ = _operators("fsub", "sub")
    __mul__, __rmul__ = _operators("fmul", "mul")
    __truediv__, __rtruediv__ = _operators("fdiv")
    __floordiv__, __rfloordiv__ = _operators(None, "sdiv")
    __mod__, __rmod__ = _operators(None, "srem")
    __lshift__, __rlshift__ = _operators(None, "shl")
    __rshift__, __rrshift__ = _operators(None, "ashr")
    __and__, __rand__ = _operators(None, "and")
    __or__, __ror__ = _operators(None, "or")
    __xor__, __rxor__ = _operators(None, "xor")
    __lt__, __gt__ = _operators("fcmp olt", "icmp slt", is_test=True)
    __le__, __ge__ = _operators("fcmp ole", "icmp sle", is_test=True)
    __eq__, _ = _operators("fcmp oeq", "icmp eq", is_test=True)
    __ne__, _ = _operators("fcmp une", "icmp ne", is_test=True)
    __hash__ = object.__hash__

    def __neg__(self):
        return 0 - self

    def _same_bits(self, kind):
        code = self.code
        operand = f"{code.type(type(self))} {self.name}"
        return code.write(f"bitcast {operand} to {code.type(kind)}", kind)


class Condition(Value):
    """Bits that are 1 if a condition holds."""

    __slots__ = ()
    item, casts = "i1", {"i64": "zext", "double": "uitofp"}

    def __invert__(self):
        return self ^ True

    def select(self, x, y):
        """Return x if the condition holds, else y."""
        code, kind = self.code, result_kind(x, y)
        sides = ", ".join(f"{code.type(kind)} {code.text(kind, side)}" for side in (x, y))
        return code.write(f"select {code.type(Condition)} {self.name}, {sides}", kind)


class Bits(Value):
    """64-bit integers."""

    __slots__ = ()
    item, casts = "i64", {"double": "sitofp"}

    def number(self):
        """Return the same bits as doubles."""
        return self._same_bits(Number)


class Number(Value):
    """Doubles."""

    __slots__ = ("factors",)  # set only for a product
    item, casts = "double", {}

    def __pow__(self, n):
        return functools.reduce(operator.mul, (self,) * n)  # n is an integer > 0

    def __neg__(self):
        result = self.code.write(f"fneg {self.code.type(Number)} {self.name}", Number)
        if hasattr(self, "factors"):
            result.factors = -self.factors[0], self.factors[1]
        return result

    def __abs__(self):
        return self.code.call("fabs", self)

    def bits(self):
        """Return the same bits as integers."""
        return self._same_bits(Bits)


class Vector(Value):
    """Neighbouring doubles of an array, in code of width 1."""

    __slots__ = ()
    item, casts, align = f"<{VECTOR} x double>", {}, ", align 8"


# The units of a law


class _Lane:
    """The lane buffer for units: a row is loaded once, and stored once at the end."""

    def __init__(self, code, start):
        self._code, self._start, self._rows, self._stored = code, start, {}, {}

    def __getitem__(self, row):
        if row not in self._rows:
            self._rows[row] = self._code.load(self._start, row)
        return self._rows[row]

    def __setitem__(self, row, value):
        self._rows[row] = self._stored[row] = self._code.as_value(value, Number)

    def store(self):
        """Write the code that stores all rows that were set."""
        for row, value in self._stored.items():
            self._code.store(value, self._start, row)


def unit_text(law, kind, width):
    """Return the LLVM text of all units of a law.

    kind : class of the units (units.py); width : doubles of a vector
    """
    texts: list[str] = []
    for name, bodies in lane_units(law, kind).items():
        loops = []
        for k, body in enumerate(bodies):
            code = Code(width, f"v{k}.")
            lane = _Lane(code, f"%lane{k}")
            body(lane, 0, law)
            lane.store()
            loops.append(code.lines)
        texts.append(_loops(name, loops, width))
    for name, (body, count) in point_units(law, kind).items():
        code = Code(1)
        lane = _Lane(code, "%s")
        results = body(lane, 0, law, *(code.load("%in", k) for k in range(count)))
        lane.store()
        if len(results) > WORK_SIZE - OUTPUT:
            raise ValueError(f"law = {law.name!r} has too many states: {len(law.states)}")
        for k, value in enumerate(results):
            code.store(value, "%out", k)
        lines = "\n  ".join([*code.lines, "ret void"])
        texts.append(f"define void @{name}(ptr %s, ptr %in, ptr %out) {{\n  {lines}\n}}")
    return "\n".join([*texts, ""])


def _loops(name, loops, width):
    """Return a function of n lanes with a loop over vectors for each list of lines."""
    head = f"define void @{name}(ptr %s, i64 %n) {{\n"
    text = ["%some = icmp sgt i64 %n, 0", "br i1 %some, label %enter0, label %done"]
    for k, lines in enumerate(loops):
        after = "done" if k + 1 == len(loops) else f"enter{k + 1}"
        text += [
            f"enter{k}:",
            f"br label %loop{k}",
            f"loop{k}:",
            f"%i{k} = phi i64 [ 0, %enter{k} ], [ %next{k}, %loop{k} ]",
            f"%lane{k} = getelementptr double, ptr %s, i64 %i{k}",
            *lines,
            f"%next{k} = add i64 %i{k}, {width}",
            f"%more{k} = icmp slt i64 %next{k}, %n",
            f"br i1 %more{k}, label %loop{k}, label %{after}",
        ]
    return head + "\n".join([*text, "done:", "ret void", "}"])
