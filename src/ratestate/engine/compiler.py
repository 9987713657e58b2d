"""Compile functions in a small part of Python into LLVM text, such as the loops in control.py.

The control is the same for all laws.  A function holds numbers (floats, 64-bit ints and bools),
tuples of numbers, and values that are known when it is compiled: numbers, functions, modules, and
the layout of the record that a kernel works on.  The first assignment to a variable sets its kind.
Statements are assignments, also of a tuple to a row of an array, `if`, `while`, `for` over a rising
range, `break`, `return` and calls.  A slice such as ``array[i, j : j + VECTOR]`` is a `Vector`.
Anything else is refused.

The results equal Python's to the last bit, if

- ints stay within 64 bits, and the operands of // and % are not negative;
- `and` and `or` join bools, and every comparison in a chain may be evaluated;
- indices are within the array and not negative: they are not checked;
- nothing raises: x/0 is infinite or NaN, and log and sqrt of negative numbers are NaN.

exp, log and the other functions of friction/functions.py are the engine's (code.py), not NumPy's.
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
from .code import Bits, Code, Condition, Number, Value, Vector
from .rows import OUTPUT, add, call_lanes, call_point

#: dtype of an array -> kind of its items
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
#: a loop over a range as a while loop, to which the body is added
FOR = """
{i}, {end} = {start}, {stop}
while {i} < {end}:
    {target}, {i} = {i}, {i} + {step}
"""


@dataclass(frozen=True)
class Word:
    """An int of the record; at : its index among the record's words."""

    at: int


@dataclass(frozen=True)
class Array:
    """An array; at : index of its address and shape among the words, or an LLVM name."""

    at: Any
    dimensions: int
    dtype: np.dtype


class Slot(NamedTuple):
    """A variable or an item of an array; place : LLVM name of its address."""

    kind: type
    place: str


def kernel_text(function, layout, pointer="ptr", extra=""):
    """Return the LLVM text of ``{ i1 } function(words, ...)`` and of all it calls.

    For code that is refused, an error is raised with notes that locate it.

    function : takes a record and ints, and returns a bool
    layout : the record, with a `Word` for each int and an `Array` for each array
    pointer : LLVM type of a pointer to words and arrays
    extra : further LLVM parameters of all functions, such as ", ptr %work"
    """
    program = _Program(pointer, extra)
    ints = [Bits(None, "")] * (len(inspect.signature(function).parameters) - 1)
    _, returns = program.add(function, (layout, *ints), function.__name__)
    if returns != (Condition,):
        raise TypeError(f"{function.__qualname__} must return a bool")
    return "\n".join([*program.texts, "!0 = !{}", ""])


def _map_tuples(function, x):
    """Apply a function to x, or to each item of a tuple, at any depth."""
    return tuple(_map_tuples(function, part) for part in x) if type(x) is tuple else function(x)


def _flat(x):
    return [leaf for part in x for leaf in _flat(part)] if type(x) is tuple else [x]


def _type_of(kinds):
    """Return the LLVM type of a result with items of these kinds."""
    return f"{{ {', '.join(kind.item for kind in kinds)} }}" if kinds else "void"


def _kind_of(x):
    kind = Condition if isinstance(x, bool) else Bits if isinstance(x, int) else Number
    return type(x) if isinstance(x, Value) else kind


class _Program:
    """Compiled functions, each of them once for arguments of the same kinds."""

    def __init__(self, pointer, extra):
        self.pointer, self.words = pointer, f"{pointer} %words{extra}"
        self.texts, self._compiled, self._count = [], {}, itertools.count()

    def add(self, function, arguments, name=None):
        """Return the name of a function for such arguments, and the kinds of its results."""
        signature = [type(x) if isinstance(x, Value) else id(x) for x in _flat(arguments)]
        key = function, *signature
        if key not in self._compiled:
            label = name or f"{function.__name__}.{next(self._count)}"
            written = _Function(self, function, arguments)
            self._compiled[key] = label, written.returns
            self.texts.append(written.definition(f"{'' if name else 'internal '}{{}} @{label}"))
        return self._compiled[key]


class _Function(Code):
    """The statements and expressions of a function, written as instructions."""

    contracts = False

    def __init__(self, program, function, arguments):
        super().__init__(1)
        self._program, self._function, self.returns = program, function, None
        self._parameters, self._slots = [program.words], []
        self._variables, self._ends, self._count = {}, [], itertools.count()
        tree: Any = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
        for parameter, argument in zip(tree.args.args, arguments, strict=True):
            self._assign(ast.Name(parameter.arg), _map_tuples(self._parameter, argument))
        if not self._block(tree.body):
            self._exec_Return(ast.Return())

    def definition(self, head):
        """Return the text; head : contains {}, which the type of the result replaces."""
        body = "\n  ".join(["entry:", *self._slots, *self.lines])
        head = head.format(_type_of(self.returns))
        return f"define {head}({', '.join(self._parameters)}) {{\n  {body}\n}}"

    def _parameter(self, argument):
        if not isinstance(argument, Value):
            return argument
        name = f"%a{len(self._parameters)}"
        self._parameters.append(f"{argument.item} {name}")
        return type(argument)(self, name)

    # Instructions

    def write(self, instruction, kind):
        """Append an instruction and return its result, anew each time: memory may change."""
        name = f"%t{next(self._count)}"
        self.lines.append(f"{name} = {instruction}")
        return kind(self, name)

    def _argument(self, kind, x):
        return f"{kind.item} {self.text(kind, x)}"

    def _label(self):
        return f"b{next(self._count)}"

    def _jump(self, label):
        self.lines.append(f"br label %{label}")

    def _branch(self, test, if_true, if_false):
        test = self._argument(Condition, self._truth(test))
        self.lines.append(f"br {test}, label %{if_true}, label %{if_false}")

    def _truth(self, x):
        return x if isinstance(x, (Condition, bool)) else x != 0

    def _get(self, slot):
        return self.write(f"load {slot.kind.item}, ptr {slot.place}{slot.kind.align}", slot.kind)

    def _put(self, x, slot):
        self.lines.append(
            f"store {self._argument(slot.kind, x)}, ptr {slot.place}{slot.kind.align}"
        )

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
        index = index if type(index) is tuple else (index,)
        if len(index) != array.dimensions:
            raise IndexError(f"an index of {len(index)} numbers")
        kind = KINDS[array.dtype]
        of_slot = Vector if isinstance(index[-1], slice) else kind
        if any(isinstance(i, slice) for i in index[: None if kind is Bits else -1]):
            raise TypeError("a slice is the last index, of an array of doubles")
        at, *others = (i.start if isinstance(i, slice) else i for i in index)
        for k, following in enumerate(others, 2):
            at = at * self._word(array.at + k) + following
        operands = f"ptr {self._address(array)}, {self._argument(Bits, at)}"
        return Slot(of_slot, self.write(f"getelementptr {kind.item}, {operands}", Value).name)

    # Statements: each method returns True if control does not go on to the next statement

    def _block(self, statements):
        return any(self._statement(statement) for statement in statements)

    def _statement(self, node):
        try:
            return bool(getattr(self, f"_exec_{type(node).__name__}")(node))
        except Exception as error:  # of any kind: a note adds the place
            text = ast.unparse(node).partition("\n")[0]
            error.add_note(f"{self._function.__module__}.{self._function.__qualname__}: {text}")
            raise

    def _exec_Expr(self, node):
        self._value(node.value)

    def _exec_Assign(self, node):
        value = self._value(node.value)
        for target in node.targets:
            self._assign(target, value)

    def _exec_AugAssign(self, node):
        value = self._value(ast.BinOp(node.target, node.op, node.value))
        # (a slice is a copy here, but not in Python)
        if isinstance(value, Vector) and isinstance(node.target, ast.Name):
            raise TypeError("a vector is not changed in place")
        self._assign(node.target, value)

    def _assign(self, target, value):
        if isinstance(target, ast.Tuple):
            for name, part in zip(target.elts, value, strict=True):
                self._assign(name, part)
        elif isinstance(target, ast.Subscript):
            array, index = self._value(target.value), self._value(target.slice)
            if type(value) is not tuple:
                return self._put(value, self._item(array, index))
            row = index if type(index) is tuple else (index,)
            for k, element in enumerate(value):
                self._put(element, self._item(array, (*row, k)))
        else:
            self._variables[target.id] = self._assigned(self._variables.get(target.id), value)

    def _assigned(self, meaning, value):
        """Assign a value to a name, and return its meaning: a `Slot` for each number."""
        if type(value) is tuple:
            meaning = (None,) * len(value) if meaning is None else meaning
            return tuple(self._assigned(*both) for both in zip(meaning, value, strict=True))
        if meaning is None and not isinstance(value, (Value, int, float)):
            return value
        if meaning is None:
            meaning = Slot(_kind_of(value), f"%x{next(self._count)}")
            self._slots.append(f"{meaning.place} = alloca {meaning.kind.item}")
        if isinstance(meaning, Slot):
            self._put(value, meaning)
        elif meaning is not value:
            raise TypeError("the name stands for something else")
        return meaning

    def _exec_Return(self, node):
        values = () if node.value is None else self._value(node.value)
        values = values if type(values) is tuple else (values,)
        if self.returns is None:
            self.returns = tuple(map(_kind_of, values))
        returned = f"{_type_of(self.returns)} poison"
        for i, (kind, x) in enumerate(zip(self.returns, values, strict=True)):
            struct = self.write(f"insertvalue {returned}, {self._argument(kind, x)}, {i}", Value)
            returned = f"{_type_of(self.returns)} {struct.name}"
        self.lines.append(f"ret {returned}" if self.returns else "ret void")
        return True

    def _exec_If(self, node):
        return self._branches(node.test, self._block, node.body, node.orelse)

    def _branches(self, test, write, *sides):
        """Write both sides of a condition; return whether both end in a jump."""
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

    def _exec_While(self, node):
        if node.orelse:
            raise TypeError("a loop has no else")
        head, body, end = (self._label() for _ in range(3))
        self._jump(head)
        self.lines.append(f"{head}:")
        self._branch(self._value(node.test), body, end)
        self.lines.append(f"{body}:")
        self._ends.append(end)
        if not self._block(node.body):
            self._jump(head)
        self._ends.pop()
        self.lines.append(f"{end}:")

    def _exec_For(self, node):
        bounds = [ast.unparse(bound) for bound in node.iter.args]
        start, stop, step = ("0", *bounds, "1")[-3:] if len(bounds) < 3 else bounds
        i, end = (f"_{next(self._count)}" for _ in range(2))
        if node.orelse or ast.unparse(node.iter) != f"range({', '.join(bounds)})":
            raise TypeError("a loop is over a range, and has no else")
        names = {"i": i, "end": end, "target": ast.unparse(node.target)}
        tree: Any = ast.parse(FOR.format(**names, start=start, stop=stop, step=step))
        tree.body[-1].body += node.body
        return self._block(tree.body)

    def _exec_Break(self, node):
        self._jump(self._ends[-1])
        return True

    # Expressions: each method returns a `Value`, a tuple, or a value known at compile time

    def _value(self, node):
        return getattr(self, f"_eval_{type(node).__name__}")(node)

    def _eval_Constant(self, node):
        return node.value

    def _eval_Tuple(self, node):
        return tuple(map(self._value, node.elts))

    def _eval_Name(self, node):
        if node.id in self._variables:
            value = self._variables[node.id]
            return _map_tuples(lambda x: self._get(x) if isinstance(x, Slot) else x, value)
        constants = self._function.__globals__
        return constants[node.id] if node.id in constants else getattr(builtins, node.id)

    def _eval_Attribute(self, node):
        owner = self._value(node.value)
        if isinstance(owner, Array) and node.attr == "shape":
            return tuple(self._word(owner.at + 1 + k) for k in range(owner.dimensions))
        value = getattr(owner, node.attr)
        return self._word(value.at) if isinstance(value, Word) else value

    def _eval_Slice(self, node):
        start, stop = ast.unparse(node.lower), ast.unparse(node.upper)
        if stop != f"{start} + VECTOR" or node.step:
            raise TypeError("a slice is of as many items as a vector has")
        return slice(self._value(node.lower), None)

    def _eval_Subscript(self, node):
        array, index = self._value(node.value), self._value(node.slice)
        return self._get(self._item(array, index)) if isinstance(array, Array) else array[index]

    def _eval_BinOp(self, node):
        return OPERATORS[type(node.op)](self._value(node.left), self._value(node.right))

    def _eval_UnaryOp(self, node):
        x = self._value(node.operand)
        if isinstance(node.op, ast.Not):
            return ~self.as_value(self._truth(x), Condition)
        return OPERATORS[type(node.op)](x)

    def _eval_Compare(self, node):
        values = [self._value(operand) for operand in (node.left, *node.comparators)]
        comparisons = zip(node.ops, values, values[1:], strict=False)
        tests = (OPERATORS[type(op)](x, y) for op, x, y in comparisons)
        return functools.reduce(operator.and_, tests)

    def _eval_BoolOp(self, node):
        first, *others = node.values
        rest = ast.BoolOp(node.op, others) if len(others) > 1 else others[0]
        if isinstance(node.op, ast.And):
            return self._eval_IfExp(ast.IfExp(first, rest, ast.Constant(False)))
        return self._eval_IfExp(ast.IfExp(first, ast.Constant(True), rest))

    def _eval_IfExp(self, node):
        name, sides = ast.Name(f"?{next(self._count)}"), (node.body, node.orelse)
        self._branches(node.test, lambda x: self._assign(name, self._value(x)), *sides)
        return self._value(name)

    def _eval_Call(self, node):
        function, arguments = self._value(node.func), tuple(map(self._value, node.args))
        if inspect.isclass(function) and issubclass(function, tuple):
            named = {keyword.arg: self._value(keyword.value) for keyword in node.keywords}
            return tuple(function(*arguments, **named))
        if node.keywords:
            raise TypeError("arguments must be positional")
        if function in (max, min):
            return functools.reduce(functools.partial(_larger_or_smaller, function), arguments)
        if function is int and isinstance(arguments[0], Number):
            return self.write(f"fptosi double {arguments[0].name} to i64", Bits)
        if function in (int, float):
            return self.as_value(arguments[0], Number if function is float else Bits)
        if function is abs or function.__module__ == F.__name__:
            return function(self.as_value(arguments[0], Number))
        if function in (call_lanes, call_point):
            return self._call_unit(*arguments)
        if function is add:
            return self._atomic_add(*arguments)
        return self._call(function, arguments)

    def _call(self, function, arguments):
        numbers = bool, int, float
        kinds = _map_tuples(
            lambda x: self.as_value(x, _kind_of(x)) if isinstance(x, numbers) else x, arguments
        )
        name, returns = self._program.add(function, kinds)
        arguments_text = [f"{x.item} {x.name}" for x in _flat(kinds) if isinstance(x, Value)]
        type_ = _type_of(returns)
        call = f"call {type_} @{name}({', '.join([self._program.words, *arguments_text])})"
        if not returns:
            return self.lines.append(call)
        returned, numbered = f"{type_} {self.write(call, Value).name}", enumerate(returns)
        results = tuple(self.write(f"extractvalue {returned}, {i}", kind) for i, kind in numbered)
        return results[0] if len(results) == 1 else results

    def _call_unit(self, unit, buffer, first, last):
        """Call a unit, given by name or address, on a column; last : a number, or `work`."""
        column = f"ptr {self._address(buffer)}, {self._argument(Bits, first)}"
        start = self.write(f"getelementptr double, {column}", Value).name
        if isinstance(last, Array):
            work = self._address(last)
            output = self.write(f"getelementptr double, ptr {work}, i64 {OUTPUT}", Value).name
            arguments = f"ptr {start}, ptr {work}, ptr {output}"
        else:
            arguments = f"ptr {start}, {self._argument(Bits, last)}"
        if isinstance(unit, Value):
            unit = self.write(f"inttoptr i64 {unit.name} to ptr", Value).name
        self.lines.append(f"call void {unit}({arguments})")

    def _atomic_add(self, array, index, x):
        """Add to an item of an array, atomically; return the previous number."""
        kind, place = self._item(array, index)
        name = "fadd" if kind is Number else "add"
        operands = f"ptr {place}, {self._argument(kind, x)}"
        return self.write(f"atomicrmw {name} {operands} monotonic", kind)


def _larger_or_smaller(function, x, y):
    test = y > x if function is max else y < x
    return test.select(y, x) if isinstance(test, Condition) else function(x, y)
