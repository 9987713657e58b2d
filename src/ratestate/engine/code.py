"""Code as LLVM text, by running Python once with numbers that write it; the units of a law so.

A `Number` stands for as many doubles as the code's width, one a lane.  Its arithmetic appends
instructions to the `Code` that it belongs to, each of them once; conditions become bits by which
`where` selects.  A sum with a product, a*b + c, has one rounding where the processor can do that:
the only liberty taken.  It is written as such, so that vectors of any width give the same bits.

The units of a law (units.py) are straight lines of such code, with these signatures:

===========================  =======================================================
``void f(s, n)``             of n lanes, whole vectors of them, from the column s on
``void f(s, given, found)``  of the lane at s: numbers that it is given, and finds
===========================  =======================================================
"""

import functools
import operator
import struct

from ..friction.functions import CODE
from .rows import FOUND, WORK
from .units import lane_units, point_units


def double(x):
    """A double as LLVM text, to its last digit."""
    return f"0x{struct.pack('>d', float(x)).hex().upper()}"


class Code:
    """Instructions that are being written, in their order.

    width : doubles that go together; letter : with which names begin
    """

    contracts = True  # whether a sum with a product has one rounding

    def __init__(self, width, letter="v"):
        self.lines, self.declarations = [], {}
        self._known, self._width, self._letter = {}, width, letter

    def type(self, kind):
        """The type of a kind of `Value`."""
        return kind.item if self._width == 1 else f"<{self._width} x {kind.item}>"

    def text(self, kind, x):
        """The text of a number, or of a `Value`, as one of this kind."""
        if type(x) is kind:
            return x.name
        if isinstance(x, Value):
            cast = f"{x.casts[kind.item]} {self.type(type(x))} {x.name}"
            return self.write(f"{cast} to {self.type(kind)}", kind).name
        text = double(x) if kind is Number else f"{x:d}"
        return text if self._width == 1 else f"splat ({kind.item} {text})"

    def write(self, instruction, kind):
        """What an instruction gives, an instance of a kind of `Value`."""
        if instruction not in self._known:
            name = f"%{self._letter}{len(self._known)}"
            self.lines.append(f"{name} = {instruction}")
            self._known[instruction] = kind(self, name)
        return self._known[instruction]

    def call(self, function, *given):
        """What a function of LLVM, such as "sqrt", gives for a `Number`, or for several numbers."""
        name = f"@llvm.{function}.{f'v{self._width}' if self._width > 1 else ''}f64"
        double = self.type(Number)
        kinds = ", ".join([double] * len(given))
        self.declarations[name] = f"declare {double} {name}({kinds})"
        texts = ", ".join(f"{double} {self.text(Number, x)}" for x in given)
        return self.write(f"call {double} {name}({texts})", Number)

    def as_value(self, x, kind):
        """A number, or a `Value`, as a `Value` of this kind."""
        return x if type(x) is kind else kind(self, self.text(kind, x))

    def _place(self, start, at):
        return self.write(f"getelementptr double, ptr {start}, i64 {at}", Value).name

    def load(self, start, at):
        """The double, or the doubles from there on, that stand behind a place."""
        place = self._place(start, at)
        return self.write(f"load {self.type(Number)}, ptr {place}, align 8", Number)

    def store(self, value, start, at):
        """Put a number there."""
        text, place = self.text(Number, value), self._place(start, at)
        self.lines.append(f"store {self.type(Number)} {text}, ptr {place}, align 8")


def kind_of_both(x, y):
    """The kind that arithmetic on two values, or numbers, gives."""
    kinds = type(x), type(y)
    if Number in kinds or isinstance(x, float) or isinstance(y, float):
        return Number
    return Bits if Bits in kinds or int in kinds else Condition


def _contracted(code, instruction, x, y):
    """A sum or difference of numbers with a product among them, in one rounding; None without."""
    if factors := getattr(y, "factors", None):
        first, second = factors
        return code.call("fmuladd", first if instruction == "fadd" else -first, second, x)
    if factors := getattr(x, "factors", None):
        return code.call("fmuladd", *factors, y if instruction == "fadd" else -y)
    return None


def _operators(of_doubles, of_ints=None, is_test=False):
    """An operator of two values, and its mirror; is_test : it gives a `Condition`."""

    def written(code, x, y):
        kind = kind_of_both(x, y) if of_ints else Number
        if kind is Condition and of_doubles:
            kind = Bits
        instruction = of_doubles if kind is Number else of_ints
        if instruction is None:
            raise TypeError("an operator of integers")
        if instruction in ("fadd", "fsub"):
            if (found := _contracted(code, instruction, x, y)) is not None:
                return found
        values = f"{code.type(kind)} {code.text(kind, x)}, {code.text(kind, y)}"
        found = code.write(f"{instruction} {values}", Condition if is_test else kind)
        if code.contracts and instruction == "fmul":
            found.factors = code.as_value(x, Number), code.as_value(y, Number)
        return found

    def applied(self, other):
        return written(self.code, self, other)

    def from_the_right(self, other):
        return written(self.code, other, self)

    return applied, from_the_right


class Value:
    """What an instruction of some code gives, by its name there."""

    __slots__ = ("code", "name")
    functions = CODE
    item: str  # type of an element
    casts: dict  # item of a kind that it may serve as -> instruction

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
        given = f"{code.type(type(self))} {self.name}"
        return code.write(f"bitcast {given} to {code.type(kind)}", kind)


class Condition(Value):
    """Bits that are 1 where a condition holds."""

    __slots__ = ()
    item, casts = "i1", {"i64": "zext", "double": "uitofp"}

    def __invert__(self):
        return self ^ True

    def select(self, x, y):
        """x where the condition holds, else y."""
        code, kind = self.code, kind_of_both(x, y)
        sides = ", ".join(f"{code.type(kind)} {code.text(kind, one)}" for one in (x, y))
        return code.write(f"select {code.type(Condition)} {self.name}, {sides}", kind)


class Bits(Value):
    """64-bit integers."""

    __slots__ = ()
    item, casts = "i64", {"double": "sitofp"}

    def number(self):
        """The same bits as doubles."""
        return self._same_bits(Number)


class Number(Value):
    """Doubles."""

    __slots__ = ("factors",)  # of a product
    item, casts = "double", {}

    def __pow__(self, n):
        return functools.reduce(operator.mul, (self,) * n)  # of a whole n > 0

    def __neg__(self):
        found = self.code.write(f"fneg {self.code.type(Number)} {self.name}", Number)
        if hasattr(self, "factors"):
            found.factors = -self.factors[0], self.factors[1]
        return found

    def __abs__(self):
        return self.code.call("fabs", self)

    def bits(self):
        """The same bits as integers."""
        return self._same_bits(Bits)


# The units of a law


class _Lane:
    """The lane buffer as units see it: a row of it is loaded once, and stored at the end."""

    def __init__(self, code, start):
        self._code, self._start, self._rows, self._stored = code, start, {}, {}

    def __getitem__(self, row):
        if row not in self._rows:
            self._rows[row] = self._code.load(self._start, row)
        return self._rows[row]

    def __setitem__(self, row, value):
        self._rows[row] = self._stored[row] = self._code.as_value(value, Number)

    def store(self):
        """Write the code that stores what was set."""
        for row, value in self._stored.items():
            self._code.store(value, self._start, row)


def unit_text(law, kind, width):
    """LLVM text of all units of a law.

    kind : their class (units.py); width : doubles of a vector
    """
    texts: list[str] = []
    declarations: dict[str, str] = {}
    for name, bodies in lane_units(law, kind).items():
        loops = []
        for k, body in enumerate(bodies):
            code = Code(width, f"v{k}.")
            lane = _Lane(code, f"%lane{k}")
            body(lane, 0, law)
            lane.store()
            loops.append(code.lines)
            declarations |= code.declarations
        texts.append(_loops(name, loops, width))
    for name, (body, count) in point_units(law, kind).items():
        code = Code(1)
        lane = _Lane(code, "%s")
        found = body(lane, 0, law, *(code.load("%given", k) for k in range(count)))
        lane.store()
        if count > FOUND or len(found) > WORK - FOUND:
            raise ValueError(f"law = {law.name!r} has too many states: {len(law.states)}")
        for k, value in enumerate(found):
            code.store(value, "%found", k)
        lines = "\n  ".join([*code.lines, "ret void"])
        texts.append(f"define void @{name}(ptr %s, ptr %given, ptr %found) {{\n  {lines}\n}}")
        declarations |= code.declarations
    return "\n".join([*declarations.values(), *texts, ""])


def _loops(name, loops, width):
    """A function of n lanes whose loops over vectors of them have these lines."""
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
