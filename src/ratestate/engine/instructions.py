"""The instructions of a function as LLVM text, and what they work on.

Numbers are floats, ints of 64 bits and bools.  Arrays and ints stand in a record, whose words the
function reads (`Context`).
"""

import ctypes
import itertools
import operator
from dataclasses import dataclass
from typing import Any

import numpy as np

from .calls import FOUND
from .code import double

TYPES = {"float": "double", "int": "i64", "bool": "i1"}
#: of an array's items: their kind, and their type in memory
ITEMS = {
    np.dtype(np.float64): ("float", "double"),
    np.dtype(np.int64): ("int", "i64"),
    np.dtype(np.int8): ("int", "i8"),
}
OF_FLOATS, OF_INTS = ("add", "sub", "mul", "div"), ("add", "sub", "mul", "sdiv", "srem", "and")


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
    """An int of the context, by its place there."""

    at: int


@dataclass(frozen=True)
class Array:
    """An array: the place of its address in the context, before its shape; or its LLVM name."""

    at: Any
    dimensions: int
    dtype: np.dtype


@dataclass(frozen=True)
class Record:
    """A named tuple: name -> `Word`, `Array`, `Record`, or the LLVM name of a unit."""

    fields: dict


class Context:
    """The words of a record: ints, and of arrays their addresses and shapes.

    place : array -> its address, if the kernel does not run on this machine's memory
    """

    def __init__(self, record, place=None):
        self._record = record  # (it keeps the arrays)
        self._place = place or _own_address
        #: of each array its dimensions and type: a kernel is compiled for these
        self.kinds = []
        words: list[int] = []
        self._add(record, words)
        self.words = np.array(words, np.int64)

    def _add(self, record, words):
        for x in record:
            if type(x) is np.ndarray:
                words.append(self._address(x))
                words.extend(x.shape)
                self.kinds.append((x.ndim, x.dtype))
            elif isinstance(x, tuple):
                self._add(x, words)
            elif not isinstance(x, (str, Array)):
                words.append(operator.index(x))

    def _address(self, x):
        if not x.flags.c_contiguous or x.dtype not in ITEMS:
            names = ", ".join(map(str, ITEMS))
            raise TypeError(f"an array of a kernel must be contiguous, of {names}")
        return self._place(x)

    def layout(self):
        """The record as it is compiled for: `Record`."""
        return _layout(self._record, itertools.count())


def _own_address(x):
    try:  # a third of the time that `ctypes.data` takes
        return ctypes.addressof(ctypes.c_char.from_buffer(x))
    except (TypeError, ValueError):  # it cannot be written to, or is empty
        return x.ctypes.data


def _layout(x: Any, places: Any) -> Any:
    if isinstance(x, (str, Array)):
        return x
    if hasattr(x, "_fields"):
        return Record({name: _layout(one, places) for name, one in zip(x._fields, x, strict=True)})
    at = next(places)
    if not isinstance(x, np.ndarray):
        return Word(at)
    for _ in x.shape:
        next(places)
    return Array(at, x.ndim, x.dtype)


def as_value(x):
    """A number that is known, as a `Value`; a `Value` as it is."""
    if isinstance(x, Value):
        return x
    if isinstance(x, bool):
        return Value("bool", str(x).lower())
    if isinstance(x, int):
        return Value("int", str(x))
    if isinstance(x, float):
        return Value("float", double(x))
    raise TypeError(f"{x!r} is not a number")


def type_of(kinds):
    """The type of some values, which a function returns."""
    if len(kinds) < 2:
        return TYPES[kinds[0]] if kinds else "void"
    return f"{{ {', '.join(TYPES[kind] for kind in kinds)} }}"


class Instructions:
    """The text of one function.  Numbers may be known ones, or `Value`s.

    pointer : LLVM's type of a pointer to words and arrays
    own : further LLVM parameters of all functions, such as ", ptr %work"
    """

    def __init__(self, pointer, own):
        self._pointer, self.first = pointer, f"{pointer} %context{own}"
        self._lines, self._slots, self._parameters, self._count = [], [], [self.first], 0

    def text(self, head, returns):
        """The whole, from its head, in which {} stands for the type of what it returns: kinds."""
        body = "\n  ".join(["entry:", *self._slots, *self._lines])
        head = head.format(type_of(returns))
        return f"define {head}({', '.join(self._parameters)}) {{\n  {body}\n}}"

    def parameter(self, kind):
        """One more number that the function is given."""
        name = f"%a{len(self._parameters)}"
        self._parameters.append(f"{TYPES[kind]} {name}")
        return Value(kind, name)

    def line(self, text):
        """Add an instruction that gives nothing."""
        self._lines.append(text)

    def _name(self, letter):
        self._count += 1
        return f"{letter}{self._count}"

    def let(self, instruction, kind=None):
        """What an instruction gives: a `Value` of a kind, else its name."""
        name = f"%{self._name('t')}"
        self.line(f"{name} = {instruction}")
        return Value(kind, name) if kind else name

    # Memory

    def variable(self, kind):
        """A new variable."""
        name = f"%{self._name('x')}"
        self._slots.append(f"{name} = alloca {TYPES[kind]}")
        return Slot(kind, name, TYPES[kind])

    def load(self, slot):
        """The number that stands there."""
        found = self.let(f"load {slot.type}, ptr {slot.place}")
        if slot.type != TYPES[slot.kind]:
            found = self.let(f"sext {slot.type} {found} to {TYPES[slot.kind]}")
        return Value(slot.kind, found)

    def store(self, x, slot):
        """Put a number there."""
        text = self.cast(x, slot.kind)
        if slot.type != TYPES[slot.kind]:
            text = self.let(f"trunc {TYPES[slot.kind]} {text} to {slot.type}")
        self.line(f"store {slot.type} {text}, ptr {slot.place}")

    def add(self, x, slot):
        """Add a number to the one that stands there, atomically; the number before."""
        name = "fadd" if slot.kind == "float" else "add"
        given = f"ptr {slot.place}, {slot.type} {self.cast(x, slot.kind)}"
        return self.let(f"atomicrmw {name} {given} monotonic", slot.kind)

    def word(self, at):
        """An int of the context."""
        return self.let(self._read("i64", at), "int")

    def _read(self, kind, at):
        place = self.let(f"getelementptr i64, {self._pointer} %context, i64 {at}")
        return f"load {kind}, {self._pointer} {place}, !invariant.load !0"

    def shape(self, array):
        """An array's shape."""
        return tuple(self.word(array.at + 1 + k) for k in range(array.dimensions))

    def _address(self, array):
        if isinstance(array.at, str):
            return array.at
        start = self.let(self._read(self._pointer, array.at))
        if self._pointer == "ptr":
            return start
        return self.let(f"addrspacecast {self._pointer} {start} to ptr")

    def item(self, array, index):
        """An item of an array, as a `Slot`; index : a tuple."""
        if len(index) != array.dimensions:
            raise IndexError(f"an index of {len(index)} numbers")
        at, *others = index
        for k, one in enumerate(others, 2):
            at = self.arithmetic("mul", at, self.word(array.at + k))
            at = self.arithmetic("add", at, one)
        kind, item = ITEMS[array.dtype]
        start = self._address(array)
        place = self.let(f"getelementptr {item}, ptr {start}, i64 {self.cast(at, 'int')}")
        return Slot(kind, place, item)

    # Arithmetic

    def cast(self, x, kind):
        """The text of a number as one of a kind."""
        x = as_value(x)
        if x.kind == kind:
            return x.text
        if (x.kind, kind) == ("bool", "int"):
            return self.let(f"zext i1 {x.text} to i64")
        if kind == "float":
            cast = "sitofp" if x.kind == "int" else "uitofp"
            return self.let(f"{cast} {TYPES[x.kind]} {x.text} to double")
        raise TypeError(f"{x.kind} where {kind} is needed")

    def _two(self, instruction, kind, x, y, result=None):
        x, y = self.cast(x, kind), self.cast(y, kind)
        return self.let(f"{instruction} {TYPES[kind]} {x}, {y}", result or kind)

    def arithmetic(self, name, x, y):
        """Of two numbers; name : of `OF_FLOATS` or `OF_INTS`."""
        is_float = name == "div" or "float" in (as_value(x).kind, as_value(y).kind)
        if name not in (OF_FLOATS if is_float else OF_INTS):
            raise TypeError("this operator is of ints")
        return self._two(f"f{name}" if is_float else name, "float" if is_float else "int", x, y)

    def negative(self, x):
        """-x."""
        if x.kind == "float":
            return self.let(f"fneg double {x.text}", "float")
        return self._two("sub", "int", 0, x)

    def compare(self, name, x, y):
        """Whether x and y compare so; name : lt, le, gt, ge, eq or ne."""
        if "float" in (as_value(x).kind, as_value(y).kind):
            instruction = "fcmp une" if name == "ne" else f"fcmp o{name}"
            return self._two(instruction, "float", x, y, "bool")
        instruction = f"icmp {name}" if name in ("eq", "ne") else f"icmp s{name}"
        return self._two(instruction, "int", x, y, "bool")

    def both(self, x, y):
        """Whether two bools hold."""
        return self._two("and", "bool", x, y)

    def truth(self, x):
        """Whether a number is not 0."""
        x = as_value(x)
        return x if x.kind == "bool" else self.compare("ne", x, 0)

    def opposite(self, x):
        """Not x."""
        return self._two("xor", "bool", self.truth(x), True)

    def extreme(self, name, x, *others):
        """x, or the last of the others that is, by `compare`, further out than all before."""
        for y in others:
            kind = "float" if "float" in (as_value(x).kind, as_value(y).kind) else "int"
            test = self.compare(name, y, x)
            sides = ", ".join(f"{TYPES[kind]} {self.cast(one, kind)}" for one in (y, x))
            x = self.let(f"select i1 {test.text}, {sides}", kind)
        return x

    def converted(self, kind, x):
        """A number as a float or an int."""
        if (x.kind, kind) == ("float", "int"):
            return self.let(f"fptosi double {x.text} to i64", "int")
        return Value(kind, self.cast(x, kind))

    # Branches and calls

    def new_label(self):
        """A label of no place as yet."""
        return self._name("b")

    def label(self, label):
        """Let a label stand here."""
        self.line(f"{label}:")

    def jump(self, label):
        """Go on at a label."""
        self.line(f"br label %{label}")

    def branch(self, test, yes, no):
        """Go on at one of two labels."""
        self.line(f"br i1 {self.truth(test).text}, label %{yes}, label %{no}")

    def give(self, values, kinds):
        """Return numbers, as these kinds."""
        texts = [self.cast(one, kind) for one, kind in zip(values, kinds, strict=True)]
        whole, kind = texts[0] if texts else "", type_of(kinds)
        if len(texts) > 1:
            whole = "poison"
            for i, (one, text) in enumerate(zip(kinds, texts, strict=True)):
                whole = self.let(f"insertvalue {kind} {whole}, {TYPES[one]} {text}, {i}")
        self.line(f"ret {kind} {whole}".rstrip())

    def call(self, name, returns, given):
        """What a function returns, a number or a tuple; given : `Value`s, and texts."""
        texts = (one if isinstance(one, str) else f"{TYPES[one.kind]} {one.text}" for one in given)
        call = f"call {type_of(returns)} @{name}({', '.join(texts)})"
        if len(returns) < 2:
            return self.let(call, *returns) if returns else self.line(call)
        whole, kind = self.let(call), type_of(returns)
        each = enumerate(returns)
        return tuple(self.let(f"extractvalue {kind} {whole}, {i}", one) for i, one in each)

    def call_unit(self, unit, buffer, first, last):
        """Call a unit of a column.

        unit : its name, or its address; last : a number, or the array `work`
        """
        start = self._address(buffer)
        given = [self.let(f"getelementptr double, ptr {start}, i64 {self.cast(first, 'int')}")]
        if isinstance(last, Array):
            given.append(self._address(last))
            given.append(self.let(f"getelementptr double, ptr {given[-1]}, i64 {FOUND}"))
        texts = [f"ptr {one}" for one in given]
        if not isinstance(last, Array):
            texts.append(f"i64 {self.cast(last, 'int')}")
        if not isinstance(unit, str):
            unit = self.let(f"inttoptr i64 {unit.text} to ptr")
        self.line(f"call void {unit}({', '.join(texts)})")
