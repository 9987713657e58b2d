"""The instructions of a function as LLVM text, and what they work on."""

import ast
import itertools
import operator
from dataclasses import dataclass
from typing import Any

import numpy as np

from .code import double
from .rows import FOUND

TYPES = {"float": "double", "int": "i64", "bool": "i1"}
#: of an array's items: their kind, and their type in memory
ITEMS = {
    np.dtype(np.float64): ("float", "double"),
    np.dtype(np.int64): ("int", "i64"),
    np.dtype(np.int8): ("int", "i8"),
}
#: what an operator does to numbers that are known, and its instructions of floats and of ints
OPERATORS = {
    ast.Add: (operator.add, "fadd", "add"),
    ast.Sub: (operator.sub, "fsub", "sub"),
    ast.Mult: (operator.mul, "fmul", "mul"),
    ast.Div: (operator.truediv, "fdiv", "fdiv"),
    ast.FloorDiv: (operator.floordiv, None, "sdiv"),
    ast.Mod: (operator.mod, None, "srem"),
    ast.BitAnd: (operator.and_, None, "and"),
    ast.Lt: (operator.lt, "fcmp olt", "icmp slt"),
    ast.LtE: (operator.le, "fcmp ole", "icmp sle"),
    ast.Gt: (operator.gt, "fcmp ogt", "icmp sgt"),
    ast.GtE: (operator.ge, "fcmp oge", "icmp sge"),
    ast.Eq: (operator.eq, "fcmp oeq", "icmp eq"),
    ast.NotEq: (operator.ne, "fcmp une", "icmp ne"),
}


@dataclass(frozen=True)
class Value:
    """A number that is known when the code runs: its kind, of `TYPES`, and its name."""

    kind: str
    text: str


@dataclass(frozen=True)
class Slot:
    """A variable, or an item of an array: its kind, where it stands, and its type there."""

    kind: str
    place: str
    type: str


@dataclass(frozen=True)
class Word:
    """An int of the record, by its place among the record's words."""

    at: int


@dataclass(frozen=True)
class Array:
    """An array: the place of its address among the words, before its shape; or its LLVM name."""

    at: Any
    dimensions: int
    dtype: np.dtype


def as_value(x):
    if isinstance(x, Value):
        return x
    if isinstance(x, bool):
        return Value("bool", str(x).lower())
    if isinstance(x, (int, float)):
        return Value("int", str(x)) if isinstance(x, int) else Value("float", double(x))
    raise TypeError(f"{x!r} is not a number")


def type_of(kinds):
    """The type of what a function returns."""
    types = ", ".join(TYPES[kind] for kind in kinds)
    return f"{{ {types} }}" if len(kinds) > 1 else types or "void"


class Instructions:
    """The text of one function.  Numbers may be known ones, or `Value`s.

    pointer : LLVM's type of a pointer to words and arrays
    own : further LLVM parameters of all functions, such as ", ptr %work"
    """

    def __init__(self, pointer, own):
        self._pointer, self._first = pointer, f"{pointer} %words{own}"
        self._lines, self._slots, self._parameters = [], [], [self._first]
        self._count, self.returns = itertools.count(), None

    def text(self, head):
        """The whole; head : in which {} stands for the type of what the function returns."""
        body = "\n  ".join(["entry:", *self._slots, *self._lines])
        head = head.format(type_of(self.returns))
        return f"define {head}({', '.join(self._parameters)}) {{\n  {body}\n}}"

    def _parameter(self, given):
        if not isinstance(given, Value):
            return given
        self._parameters.append(f"{TYPES[given.kind]} %a{len(self._parameters)}")
        return Value(given.kind, self._parameters[-1].split()[1])

    def _line(self, text):
        self._lines.append(text)

    def _let(self, instruction, kind=None):
        """What an instruction gives: a `Value` of a kind, else its name."""
        name = f"%t{next(self._count)}"
        self._line(f"{name} = {instruction}")
        return Value(kind, name) if kind else name

    def _label(self):
        return f"b{next(self._count)}"

    def _jump(self, label):
        self._line(f"br label %{label}")

    def _branch(self, test, yes, no):
        self._line(f"br i1 {self._truth(test)}, label %{yes}, label %{no}")

    def _variable(self, kind):
        name = f"%x{next(self._count)}"
        self._slots.append(f"{name} = alloca {TYPES[kind]}")
        return Slot(kind, name, TYPES[kind])

    def _load(self, slot):
        found = self._let(f"load {slot.type}, ptr {slot.place}")
        if slot.type != TYPES[slot.kind]:
            found = self._let(f"sext {slot.type} {found} to {TYPES[slot.kind]}")
        return Value(slot.kind, found)

    def _store(self, x, slot):
        text = self._cast(x, slot.kind)
        if slot.type != TYPES[slot.kind]:
            text = self._let(f"trunc {TYPES[slot.kind]} {text} to {slot.type}")
        self._line(f"store {slot.type} {text}, ptr {slot.place}")

    def _word(self, at, kind="i64"):
        place = self._let(f"getelementptr i64, {self._pointer} %words, i64 {at}")
        return self._let(f"load {kind}, {self._pointer} {place}, !invariant.load !0", "int")

    def _address(self, array):
        if isinstance(array.at, str):
            return array.at
        start = self._word(array.at, self._pointer).text
        if self._pointer == "ptr":
            return start
        return self._let(f"addrspacecast {self._pointer} {start} to ptr")

    def _item(self, array, index):
        """The `Slot` of an item of an array."""
        at, *others = index if type(index) is tuple else (index,)
        if len(others) + 1 != array.dimensions:
            raise IndexError(f"an index of {len(others) + 1} numbers")
        for k, one in enumerate(others, 2):
            at = self._two(ast.Mult, at, self._word(array.at + k))
            at = self._two(ast.Add, at, one)
        kind, item = ITEMS[array.dtype]
        start, at = self._address(array), self._cast(at, "int")
        return Slot(kind, self._let(f"getelementptr {item}, ptr {start}, i64 {at}"), item)

    def _cast(self, x, kind):
        """The text of a number as one of a kind."""
        x = as_value(x)
        if x.kind == kind:
            return x.text
        if (x.kind, kind) == ("bool", "int"):
            return self._let(f"zext i1 {x.text} to i64")
        if kind == "float":
            cast = "sitofp" if x.kind == "int" else "uitofp"
            return self._let(f"{cast} {TYPES[x.kind]} {x.text} to double")
        raise TypeError(f"{x.kind} where {kind} is needed")

    def _truth(self, x):
        """The text of whether a number is not 0."""
        x = as_value(x)
        return x.text if x.kind == "bool" else self._two(ast.NotEq, x, 0).text

    def _two(self, op, x, y):
        known, of_floats, of_ints = OPERATORS[op]
        if not isinstance(x, Value) and not isinstance(y, Value):
            return known(x, y)
        is_float = op is ast.Div or "float" in (as_value(x).kind, as_value(y).kind)
        instruction, kind = (of_floats, "float") if is_float else (of_ints, "int")
        if not instruction:
            raise TypeError("this operator is of ints")
        text = f"{instruction} {TYPES[kind]} {self._cast(x, kind)}, {self._cast(y, kind)}"
        return self._let(text, "bool" if issubclass(op, ast.cmpop) else kind)

    def _argument(self, kind, x):
        return f"{TYPES[kind]} {self._cast(x, kind)}"

    def _further(self, function, x, y):
        """The larger of two numbers, or the smaller."""
        test = self._two(ast.Gt if function is max else ast.Lt, y, x)
        if not isinstance(test, Value):
            return function(x, y)
        kind = "float" if "float" in (as_value(x).kind, as_value(y).kind) else "int"
        sides = f"{self._argument(kind, y)}, {self._argument(kind, x)}"
        return self._let(f"select i1 {test.text}, {sides}", kind)

    def _converted(self, kind, x):
        if (x.kind, kind) == ("float", "int"):
            return self._let(f"fptosi double {x.text} to i64", "int")
        return Value(kind, self._cast(x, kind))

    def _call(self, name, returns, *arguments):
        """What a function returns, a number or a tuple; arguments : texts."""
        kind = type_of(returns)
        call = f"call {kind} @{name}({', '.join(arguments)})"
        if len(returns) < 2:
            return self._let(call, *returns) if returns else self._line(call)
        whole = self._let(call)
        each = enumerate(returns)
        return tuple(self._let(f"extractvalue {kind} {whole}, {i}", one) for i, one in each)

    def _call_unit(self, unit, buffer, first, last):
        """Call a unit, by its name or its address, of a column; last : a number, or `work`."""
        first = self._cast(first, "int")
        start = self._let(f"getelementptr double, ptr {self._address(buffer)}, i64 {first}")
        if isinstance(last, Array):
            work = self._address(last)
            found = self._let(f"getelementptr double, ptr {work}, i64 {FOUND}")
            given = f"ptr {start}, ptr {work}, ptr {found}"
        else:
            given = f"ptr {start}, {self._argument('int', last)}"
        if isinstance(unit, Value):
            unit = self._let(f"inttoptr i64 {unit.text} to ptr")
        self._line(f"call void {unit}({given})")

    def _added(self, array, index, x):
        """Add to an item of an array, atomically; the number before."""
        slot = self._item(array, index)
        name = "fadd" if slot.kind == "float" else "add"
        given = f"ptr {slot.place}, {self._argument(slot.kind, x)}"
        return self._let(f"atomicrmw {name} {given} monotonic", slot.kind)
