"""Functions of a small part of Python as LLVM text: the control, which is the same for all laws.

A function holds numbers (floats, ints of 64 bits and bools), whose kinds are those of their first
assignments, tuples of numbers, and what is known as it is compiled: numbers, functions, modules,
and the layout of the record that a kernel works on.  Statements are assignments, also of a tuple to
a row of an array, `if`, `while`, `for` over a range that rises, `break`, `return` and calls.  All
else is refused.

The answers are Python's, to the last bit, if

- ints stay within 64 bits, and those of // and % are not negative;
- `and` and `or` are of bools, and comparisons in a row all need be made;
- each index is one of the array's, from 0 on: none is checked;
- nothing raises: x/0 is infinite or NaN, and log and sqrt of negative numbers are NaN.

Functions of friction/functions.py are the engine's own (code.py), not NumPy's.
"""

import ast
import builtins
import functools
import inspect
import itertools
import operator
import textwrap
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..friction import functions as F
from .code import Bits, Code, Condition, Number, Value
from .rows import FOUND, add, call_lanes, call_point

#: the kinds of an array's items
KINDS = {np.dtype(np.float64): Number, np.dtype(np.int64): Bits}
OPERATORS: dict[type, Any] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.BitAnd: operator.and_,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.USub: operator.neg,
}
#: how a loop over a range is written; the body follows
FOR = """
{i}, {end} = {start}, {stop}
while {i} < {end}:
    {target}, {i} = {i}, {i} + {step}
"""


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


class Slot(NamedTuple):
    """A variable, or an item of an array: its kind, and where it stands."""

    kind: type
    place: str


def kernel_text(function, layout, pointer="ptr", own=""):
    """LLVM text of ``{ i1 } function(words, ...)``, and of all that it calls.

    An error, with notes that say where, for what is refused.

    function : of a record and ints; it returns a bool
    layout : the record, with a `Word` for each int and an `Array` for each array
    pointer : LLVM's type of a pointer to words and arrays
    own : further LLVM parameters of all functions, such as ", ptr %work"
    """
    program = _Program(pointer, own)
    ints = [Bits(None, "")] * (len(inspect.signature(function).parameters) - 1)
    _, returns = program.add(function, (layout, *ints), function.__name__)
    if returns != (Condition,):
        raise TypeError(f"{function.__qualname__} must return a bool")
    return "\n".join([*sorted(program.declarations.values()), *program.texts, "!0 = !{}", ""])


def _in_tuples(function, x):
    """A function of x, or of all that stands in the tuple x."""
    return tuple(_in_tuples(function, one) for one in x) if type(x) is tuple else function(x)


def _flat(x):
    return [one for part in x for one in _flat(part)] if type(x) is tuple else [x]


def _type_of(kinds):
    """The type of what a function returns."""
    return f"{{ {', '.join(kind.item for kind in kinds)} }}" if kinds else "void"


def _kind_of(x):
    kind = Condition if isinstance(x, bool) else Bits if isinstance(x, int) else Number
    return type(x) if isinstance(x, Value) else kind


class _Program:
    """Functions, each of them once for arguments of the same kinds."""

    def __init__(self, pointer, own):
        self.pointer, self.words = pointer, f"{pointer} %words{own}"
        self.texts, self.declarations = [], {}
        self._known, self._count = {}, itertools.count()

    def add(self, function, arguments, name=None):
        """The name of a function for arguments like these, and the kinds that it returns."""
        signature = [type(x) if isinstance(x, Value) else id(x) for x in _flat(arguments)]
        key = function, *signature
        if key not in self._known:
            own = name or f"{function.__name__}.{next(self._count)}"
            written = _Function(self, function, arguments)
            self._known[key] = own, written.returns
            self.texts.append(written.whole(f"{'' if name else 'internal '}{{}} @{own}"))
        return self._known[key]


class _Function(Code):
    """A function's statements and expressions, written as instructions."""

    contracts = False

    def __init__(self, program, function, arguments):
        super().__init__(1)
        self.declarations, self.returns = program.declarations, None
        self._program, self._function = program, function
        self._parameters, self._slots = [program.words], []
        self._variables, self._ends, self._count = {}, [], itertools.count()
        tree: Any = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
        for one, given in zip(tree.args.args, arguments, strict=True):
            self._assign(ast.Name(one.arg), _in_tuples(self._parameter, given))
        if not self._block(tree.body):
            self._do_Return(ast.Return())

    def whole(self, head):
        """The text; head : in which {} stands for the type of what the function returns."""
        body = "\n  ".join(["entry:", *self._slots, *self.lines])
        head = head.format(_type_of(self.returns))
        return f"define {head}({', '.join(self._parameters)}) {{\n  {body}\n}}"

    def _parameter(self, given):
        if not isinstance(given, Value):
            return given
        name = f"%a{len(self._parameters)}"
        self._parameters.append(f"{given.item} {name}")
        return type(given)(self, name)

    # Instructions

    def write(self, instruction, kind):
        """What an instruction gives; each is written, as memory may have changed."""
        name = f"%t{next(self._count)}"
        self.lines.append(f"{name} = {instruction}")
        return kind(self, name)

    def _argument(self, kind, x):
        return f"{kind.item} {self.text(kind, x)}"

    def _label(self):
        return f"b{next(self._count)}"

    def _jump(self, label):
        self.lines.append(f"br label %{label}")

    def _branch(self, test, yes, no):
        test = self._argument(Condition, self._truth(test))
        self.lines.append(f"br {test}, label %{yes}, label %{no}")

    def _truth(self, x):
        return x if isinstance(x, (Condition, bool)) else x != 0

    def _get(self, slot):
        return self.write(f"load {slot.kind.item}, ptr {slot.place}", slot.kind)

    def _put(self, x, slot):
        self.lines.append(f"store {self._argument(slot.kind, x)}, ptr {slot.place}")

    def _word(self, at, item="i64"):
        pointer = self._program.pointer
        place = self.write(f"getelementptr i64, {pointer} %words, i64 {at}", Value).name
        return self.write(f"load {item}, {pointer} {place}, !invariant.load !0", Bits)

    def _address(self, array):
        if isinstance(array.at, str):
            return array.at
        pointer = self._program.pointer
        start = self._word(array.at, pointer).name
        if pointer == "ptr":
            return start
        return self.write(f"addrspacecast {pointer} {start} to ptr", Value).name

    def _item(self, array, index):
        at, *others = index if type(index) is tuple else (index,)
        if len(others) + 1 != array.dimensions:
            raise IndexError(f"an index of {len(others) + 1} numbers")
        for k, one in enumerate(others, 2):
            at = at * self._word(array.at + k) + one
        kind = KINDS[array.dtype]
        given = f"ptr {self._address(array)}, {self._argument(Bits, at)}"
        return Slot(kind, self.write(f"getelementptr {kind.item}, {given}", Value).name)

    # Statements: True of those after which none is reached

    def _block(self, statements):
        return any(self._statement(one) for one in statements)

    def _statement(self, node):
        try:
            return bool(getattr(self, f"_do_{type(node).__name__}")(node))
        except Exception as error:  # any: to say where, it gets a note, and goes on
            text = ast.unparse(node).partition("\n")[0]
            error.add_note(f"{self._function.__module__}.{self._function.__qualname__}: {text}")
            raise

    def _do_Expr(self, node):
        self._value(node.value)

    def _do_Assign(self, node):
        value = self._value(node.value)
        for target in node.targets:
            self._assign(target, value)

    def _do_AugAssign(self, node):
        self._assign(node.target, self._value(ast.BinOp(node.target, node.op, node.value)))

    def _assign(self, target, value):
        if isinstance(target, ast.Tuple):
            for one, part in zip(target.elts, value, strict=True):
                self._assign(one, part)
        elif isinstance(target, ast.Subscript):
            array, index = self._value(target.value), self._value(target.slice)
            if type(value) is not tuple:
                return self._put(value, self._item(array, index))
            row = index if type(index) is tuple else (index,)
            for k, one in enumerate(value):
                self._put(one, self._item(array, (*row, k)))
        else:
            self._variables[target.id] = self._assigned(self._variables.get(target.id), value)

    def _assigned(self, known, value):
        """What a name that stood for `known` stands for: variables if it is for numbers."""
        if type(value) is tuple:
            known = (None,) * len(value) if known is None else known
            return tuple(self._assigned(*both) for both in zip(known, value, strict=True))
        if known is None and not isinstance(value, (Value, int, float)):
            return value
        if known is None:
            known = Slot(_kind_of(value), f"%x{next(self._count)}")
            self._slots.append(f"{known.place} = alloca {known.kind.item}")
        if isinstance(known, Slot):
            self._put(value, known)
        elif known is not value:
            raise TypeError("the name stands for something else")
        return known

    def _do_Return(self, node):
        found = () if node.value is None else self._value(node.value)
        found = found if type(found) is tuple else (found,)
        if self.returns is None:
            self.returns = tuple(map(_kind_of, found))
        whole = f"{_type_of(self.returns)} poison"
        for i, (kind, x) in enumerate(zip(self.returns, found, strict=True)):
            one = self.write(f"insertvalue {whole}, {self._argument(kind, x)}, {i}", Value)
            whole = f"{_type_of(self.returns)} {one.name}"
        self.lines.append(f"ret {whole}" if self.returns else "ret void")
        return True

    def _do_If(self, node):
        return self._branches(node.test, self._block, node.body, node.orelse)

    def _branches(self, test, write, *sides):
        """Write both sides of a condition; whether both end in a jump."""
        labels, end = [self._label() for _ in sides], self._label()
        self._branch(self._value(test), *labels)
        ended = []
        for label, side in zip(labels, sides, strict=True):
            self.lines.append(f"{label}:")
            ended.append(write(side))
            if not ended[-1]:
                self._jump(end)
        if not all(ended):
            self.lines.append(f"{end}:")
        return all(ended)

    def _do_While(self, node):
        if node.orelse:
            raise TypeError("a loop has no else")
        again, body, end = (self._label() for _ in range(3))
        self._jump(again)
        self.lines.append(f"{again}:")
        self._branch(self._value(node.test), body, end)
        self.lines.append(f"{body}:")
        self._ends.append(end)
        if not self._block(node.body):
            self._jump(again)
        self._ends.pop()
        self.lines.append(f"{end}:")

    def _do_For(self, node):
        given = [ast.unparse(one) for one in node.iter.args]
        start, stop, step = ("0", *given, "1")[-3:] if len(given) < 3 else given
        i, end = (f"_{next(self._count)}" for _ in range(2))
        if node.orelse or ast.unparse(node.iter) != f"range({', '.join(given)})":
            raise TypeError("a loop is over a range, and has no else")
        names = {"i": i, "end": end, "target": ast.unparse(node.target)}
        tree: Any = ast.parse(FOR.format(**names, start=start, stop=stop, step=step))
        tree.body[-1].body += node.body
        return self._block(tree.body)

    def _do_Break(self, node):
        self._jump(self._ends[-1])
        return True

    # Expressions: a `Value`, a tuple, or what is known

    def _value(self, node):
        return getattr(self, f"_of_{type(node).__name__}")(node)

    def _of_Constant(self, node):
        return node.value

    def _of_Tuple(self, node):
        return tuple(map(self._value, node.elts))

    def _of_Name(self, node):
        if node.id in self._variables:
            found = self._variables[node.id]
            return _in_tuples(lambda x: self._get(x) if isinstance(x, Slot) else x, found)
        known = self._function.__globals__
        return known[node.id] if node.id in known else getattr(builtins, node.id)

    def _of_Attribute(self, node):
        of = self._value(node.value)
        if isinstance(of, Array) and node.attr == "shape":
            return tuple(self._word(of.at + 1 + k) for k in range(of.dimensions))
        found = getattr(of, node.attr)
        return self._word(found.at) if isinstance(found, Word) else found

    def _of_Subscript(self, node):
        of, index = self._value(node.value), self._value(node.slice)
        return self._get(self._item(of, index)) if isinstance(of, Array) else of[index]

    def _of_BinOp(self, node):
        return OPERATORS[type(node.op)](self._value(node.left), self._value(node.right))

    def _of_UnaryOp(self, node):
        x = self._value(node.operand)
        if isinstance(node.op, ast.Not):
            return ~self.as_value(self._truth(x), Condition)
        return OPERATORS[type(node.op)](x)

    def _of_Compare(self, node):
        values = [self._value(one) for one in (node.left, *node.comparators)]
        each = zip(node.ops, values, values[1:], strict=False)
        found = (OPERATORS[type(op)](x, y) for op, x, y in each)
        return functools.reduce(operator.and_, found)

    def _of_BoolOp(self, node):
        first, *others = node.values
        rest = ast.BoolOp(node.op, others) if len(others) > 1 else others[0]
        if isinstance(node.op, ast.And):
            return self._of_IfExp(ast.IfExp(first, rest, ast.Constant(False)))
        return self._of_IfExp(ast.IfExp(first, ast.Constant(True), rest))

    def _of_IfExp(self, node):
        found, sides = ast.Name(f"?{next(self._count)}"), (node.body, node.orelse)
        self._branches(node.test, lambda x: self._assign(found, self._value(x)), *sides)
        return self._value(found)

    def _of_Call(self, node):
        function, arguments = self._value(node.func), tuple(map(self._value, node.args))
        if inspect.isclass(function) and issubclass(function, tuple):
            named = {one.arg: self._value(one.value) for one in node.keywords}
            return tuple(function(*arguments, **named))
        if node.keywords:
            raise TypeError("arguments are given by their place")
        if function in (max, min):
            return functools.reduce(functools.partial(_further, function), arguments)
        if function is int and isinstance(arguments[0], Number):
            return self.write(f"fptosi double {arguments[0].name} to i64", Bits)
        if function in (int, float):
            return self.as_value(arguments[0], Number if function is float else Bits)
        if function is abs or function.__module__ == F.__name__:
            return function(self.as_value(arguments[0], Number))
        if function in (call_lanes, call_point):
            return self._call_unit(*arguments)
        if function is add:
            return self._added(*arguments)
        return self._call(function, arguments)

    def _call(self, function, arguments):
        numbers = bool, int, float
        kinds = _in_tuples(
            lambda x: self.as_value(x, _kind_of(x)) if isinstance(x, numbers) else x, arguments
        )
        name, returns = self._program.add(function, kinds)
        given = [f"{x.item} {x.name}" for x in _flat(kinds) if isinstance(x, Value)]
        of = _type_of(returns)
        call = f"call {of} @{name}({', '.join([self._program.words, *given])})"
        if not returns:
            return self.lines.append(call)
        whole, each = f"{of} {self.write(call, Value).name}", enumerate(returns)
        found = tuple(self.write(f"extractvalue {whole}, {i}", one) for i, one in each)
        return found[0] if len(found) == 1 else found

    def _call_unit(self, unit, buffer, first, last):
        """Call a unit, by its name or its address, of a column; last : a number, or `work`."""
        column = f"ptr {self._address(buffer)}, {self._argument(Bits, first)}"
        start = self.write(f"getelementptr double, {column}", Value).name
        if isinstance(last, Array):
            work = self._address(last)
            found = self.write(f"getelementptr double, ptr {work}, i64 {FOUND}", Value).name
            given = f"ptr {start}, ptr {work}, ptr {found}"
        else:
            given = f"ptr {start}, {self._argument(Bits, last)}"
        if isinstance(unit, Value):
            unit = self.write(f"inttoptr i64 {unit.name} to ptr", Value).name
        self.lines.append(f"call void {unit}({given})")

    def _added(self, array, index, x):
        """Add to an item of an array, atomically; the number before."""
        kind, place = self._item(array, index)
        name = "fadd" if kind is Number else "add"
        given = f"ptr {place}, {self._argument(kind, x)}"
        return self.write(f"atomicrmw {name} {given} monotonic", kind)


def _further(function, x, y):
    """The larger of two numbers, or the smaller."""
    test = y > x if function is max else y < x
    return test.select(y, x) if isinstance(test, Condition) else function(x, y)
