"""Functions of a small part of Python as LLVM text: the control, which is the same for all laws.

A function holds numbers (instructions.py), whose kinds are those of their first assignments, tuples
of numbers, and what is known as it is compiled: numbers, functions, modules, and the record that a
kernel works on.  Statements are assignments, `if`, `while`, `for` over a range or a tuple, `break`,
`continue`, `return` and calls.  All else is refused.

The answers are Python's, to the last bit, if

- ints stay within 64 bits, and those of // and % are not negative;
- each index is one of the array's, from 0 on: none is checked;
- nothing raises: x/0 is infinite or NaN, and log and sqrt of negative numbers are NaN.
"""

import ast
import builtins
import inspect
import operator
import textwrap

from ..friction import functions
from .calls import add, call_lanes, call_point
from .code import Code, Number
from .instructions import Array, Instructions, Record, Slot, Value, Word, as_value

#: operator -> instruction, and what it does to numbers that are known
OPERATORS = {
    ast.Add: ("add", operator.add),
    ast.Sub: ("sub", operator.sub),
    ast.Mult: ("mul", operator.mul),
    ast.Div: ("div", operator.truediv),
    ast.FloorDiv: ("sdiv", operator.floordiv),
    ast.Mod: ("srem", operator.mod),
    ast.BitAnd: ("and", operator.and_),
}
COMPARISONS = {
    ast.Lt: "lt", ast.LtE: "le", ast.Gt: "gt", ast.GtE: "ge", ast.Eq: "eq", ast.NotEq: "ne",
}  # fmt: skip
#: functions of LLVM's own, or traced (friction/functions.py)
INTRINSICS = {abs: "fabs", functions.sqrt: "sqrt"}
TRACED = (functions.log, functions.exp, functions.expm1, functions.log1p)


def kernel_text(function, record, pointer="ptr", own=""):
    """LLVM text of ``i1 function(words, ...)``, and of all that it calls.

    SyntaxError, which says where and why, for what is refused.

    function : of a record and ints; it returns a bool
    record : its layout, of `instructions.Context`
    pointer, own : as of `Instructions`
    """
    program = _Program(pointer, own)
    ints = [Value("int", "")] * (len(inspect.signature(function).parameters) - 1)
    _, returns = program.add(function, (record, *ints), function.__name__)
    if returns != ("bool",):
        raise SyntaxError(f"{_name_of(function)} must return a bool")
    return "\n".join([*sorted(program.declarations), *program.texts, "!0 = !{}", ""])


def _name_of(function):
    return f"{function.__module__}.{function.__qualname__}"


def _signature(x):
    """What code depends on of an argument."""
    if type(x) is tuple:
        return tuple(map(_signature, x))
    return x.kind if isinstance(x, Value) else id(x)


def _in_tuples(function, x):
    """A function of x, or of all that stands in the tuple x."""
    return tuple(_in_tuples(function, one) for one in x) if type(x) is tuple else function(x)


def _flat(x):
    """All that stands in x and its tuples, a list."""
    return [one for part in x for one in _flat(part)] if type(x) is tuple else [x]


class _Program:
    """Functions, each of them once for arguments of the same kinds."""

    def __init__(self, pointer, own):
        self.texts, self.declarations, self._known = [], set(), {}
        self._of_all = pointer, own

    def add(self, function, arguments, name=None):
        """The name of a function for arguments like these, and what it returns: kinds, a tuple."""
        key = function, tuple(map(_signature, arguments))
        if key not in self._known:
            own = name or f"{function.__name__}.{len(self._known)}"
            self._known[key] = None
            written = _Function(self, function, arguments)
            self._known[key] = own, written.returns
            self.texts.append(written.text(f"{'' if name else 'internal '}{{}} @{own}"))
        if self._known[key] is None:
            raise TypeError("a function cannot call itself")
        return self._known[key]

    def instructions(self):
        """The instructions of a new function, none as yet."""
        return Instructions(*self._of_all)

    def traced(self, function):
        """The name of a function of one number that is arithmetic alone."""
        name = f"traced.{function.__name__}"
        if function not in self._known:
            self._known[function] = name
            code = Code(1)
            found = function(Number(code, "%x"))
            self.declarations |= set(code.declarations.values())
            lines = "\n  ".join([*code.lines, f"ret double {code.text(Number, found)}"])
            self.texts.append(f"define internal double @{name}(double %x) {{\n  {lines}\n}}")
        return name


class _Function:
    """A function's statements and expressions, written as instructions."""

    def __init__(self, program, function, arguments):
        self._program, self._function = program, function
        self._code = program.instructions()
        self._variables, self._loops, self.returns = {}, [], None
        (tree,) = ast.parse(textwrap.dedent(inspect.getsource(function))).body
        self._visit(self._whole, tree, arguments)

    def text(self, head):
        """The whole, from its head (`Instructions.text`)."""
        return self._code.text(head, self.returns)

    def _whole(self, tree, arguments):
        if not isinstance(tree, ast.FunctionDef) or tree.decorator_list:
            raise TypeError("it is not a plain function")
        for one, given in zip(tree.args.args, arguments, strict=True):
            self._assign_name(one.arg, _in_tuples(self._parameter, given))
        if not self._block(tree.body):
            if self.returns:
                raise TypeError("it may end without a return")
            self._do_Return(ast.Return())

    def _parameter(self, given):
        return self._code.parameter(given.kind) if isinstance(given, Value) else given

    def _visit(self, method, node, *more):
        """What a method gives for a part of the source; SyntaxError, with its text, if it fails."""
        try:
            return method(node, *more)
        except SyntaxError:
            raise
        except Exception as error:  # tracing runs any method of the source's values
            text = ast.unparse(node).partition("\n")[0]
            reason = f"{type(error).__name__}: {error}"
            raise SyntaxError(
                f"{_name_of(self._function)} cannot be compiled: {text} ({reason})"
            ) from error

    # Statements: True of those after which none is reached

    def _block(self, statements):
        return any(self._statement(one) for one in statements)

    def _statement(self, node):
        return bool(self._visit(getattr(self, f"_do_{type(node).__name__}", self._refuse), node))

    def _refuse(self, node):
        raise TypeError(f"{type(node).__name__} is not known")

    def _do_Pass(self, node):
        pass

    def _do_Expr(self, node):
        if not isinstance(node.value, ast.Constant):
            self._value(node.value)

    def _do_Assign(self, node):
        value = self._value(node.value)
        for target in node.targets:
            self._assign(target, value)

    def _do_AugAssign(self, node):
        if isinstance(node.target, ast.Subscript):
            slot = self._item(node.target)
            old = self._code.load(slot)
            self._code.store(self._arithmetic(node.op, old, self._value(node.value)), slot)
        else:
            old = self._of_Name(node.target)
            self._assign(node.target, self._arithmetic(node.op, old, self._value(node.value)))

    def _assign(self, target, value):
        if isinstance(target, ast.Tuple):
            for one, part in zip(target.elts, value, strict=True):
                self._assign(one, part)
        elif isinstance(target, ast.Subscript):
            self._code.store(value, self._item(target))
        else:
            self._assign_name(target.id, value)

    def _assign_name(self, name, value):
        self._variables[name] = self._assigned(self._variables.get(name), value)

    def _assigned(self, known, value):
        """What a name that stood for `known` stands for: variables if it is for numbers."""
        if type(value) is tuple:
            known = (None,) * len(value) if known is None else known
            return tuple(self._assigned(*both) for both in zip(known, value, strict=True))
        if known is None and not isinstance(value, (Value, int, float)):
            return value
        if known is None:
            known = self._code.variable(as_value(value).kind)
        if isinstance(known, Slot):
            self._code.store(value, known)
        elif known != value:
            raise TypeError("the name stands for something else")
        return known

    def _do_Return(self, node):
        found = () if node.value is None else self._value(node.value)
        found = found if type(found) is tuple else (found,)
        if self.returns is None:
            self.returns = tuple(as_value(one).kind for one in found)
        self._code.give(found, self.returns)
        return True

    def _do_If(self, node):
        code, test = self._code, self._value(node.test)
        if not isinstance(test, Value):
            return self._block(node.body if test else node.orelse)
        yes, no, end = (code.new_label() for _ in range(3))
        code.branch(test, yes, no)
        ended = []
        for label, body in (yes, node.body), (no, node.orelse):
            code.label(label)
            ended.append(self._block(body))
            if not ended[-1]:
                code.jump(end)
        if not all(ended):
            code.label(end)
        return all(ended)

    def _do_While(self, node):
        code = self._code
        start, body, end = (code.new_label() for _ in range(3))
        code.jump(start)
        code.label(start)
        code.branch(self._value(node.test), body, end)
        code.label(body)
        self._body(node, start, end)
        code.label(end)

    def _body(self, node, again, end):
        """The body of a loop, whose next round begins at a label, and its end."""
        if node.orelse:
            raise TypeError("a loop has no else")
        self._loops.append((again, end))
        if not self._block(node.body):
            self._code.jump(again)
        self._loops.pop()

    def _do_For(self, node):
        is_call = isinstance(node.iter, ast.Call)
        if is_call and self._value(node.iter.func) is range:
            self._for_range(node, *map(self._value, node.iter.args))
        else:
            self._for_each(node, self._value(node.iter))

    def _for_each(self, node, values):
        """Over a tuple: the body is written once for each."""
        end = self._code.new_label()
        for one in values:
            again = self._code.new_label()
            self._assign(node.target, one)
            self._body(node, again, end)
            self._code.label(again)
        self._code.jump(end)
        self._code.label(end)

    def _for_range(self, node, *given):
        code, (begin, stop, *steps) = self._code, given if len(given) > 1 else (0, *given)
        (step,) = steps or (1,)
        if not isinstance(step, int) or step < 1:
            raise TypeError("the step of a range is a number above 0")
        stop, i = Value("int", code.cast(stop, "int")), code.variable("int")
        code.store(code.arithmetic("sub", begin, step), i)
        start, body, end = (code.new_label() for _ in range(3))
        code.jump(start)
        code.label(start)
        now = code.arithmetic("add", code.load(i), step)
        code.store(now, i)
        code.branch(code.compare("lt", now, stop), body, end)
        code.label(body)
        self._assign(node.target, now)
        self._body(node, start, end)
        code.label(end)

    def _do_Break(self, node):
        self._code.jump(self._loops[-1][1])
        return True

    def _do_Continue(self, node):
        self._code.jump(self._loops[-1][0])
        return True

    # Expressions: a `Value`, a tuple, or what is known

    def _value(self, node):
        return self._visit(getattr(self, f"_of_{type(node).__name__}", self._refuse), node)

    def _of_Constant(self, node):
        return node.value

    def _of_Tuple(self, node):
        return tuple(map(self._value, node.elts))

    def _of_Name(self, node):
        if node.id in self._variables:
            return _in_tuples(self._loaded, self._variables[node.id])
        known = self._function.__globals__
        return known[node.id] if node.id in known else getattr(builtins, node.id)

    def _loaded(self, x):
        return self._code.load(x) if isinstance(x, Slot) else x

    def _of_Attribute(self, node):
        of = self._value(node.value)
        if isinstance(of, Record):
            field = of.fields[node.attr]
            return self._code.word(field.at) if isinstance(field, Word) else field
        if isinstance(of, Array) and node.attr == "shape":
            return self._code.shape(of)
        if isinstance(of, (Array, Value)):
            raise TypeError(f"{node.attr} is not known")
        return getattr(of, node.attr)

    def _of_Subscript(self, node):
        of = self._value(node.value)
        if type(of) is tuple:
            return of[self._value(node.slice)]
        return self._code.load(self._item(node))

    def _item(self, node):
        array, index = self._value(node.value), self._value(node.slice)
        return self._code.item(array, index if type(index) is tuple else (index,))

    def _of_BinOp(self, node):
        return self._arithmetic(node.op, self._value(node.left), self._value(node.right))

    def _arithmetic(self, op, x, y):
        instruction, known = OPERATORS[type(op)]
        if not isinstance(x, Value) and not isinstance(y, Value):
            return known(x, y)
        return self._code.arithmetic(instruction, x, y)

    def _of_UnaryOp(self, node):
        x = self._value(node.operand)
        if isinstance(node.op, ast.Not):
            return self._code.opposite(x) if isinstance(x, Value) else not x
        if isinstance(node.op, ast.USub):
            return self._code.negative(x) if isinstance(x, Value) else -x
        return self._refuse(node.op)

    def _of_Compare(self, node):
        left, found = self._value(node.left), True
        for op, right in zip(node.ops, map(self._value, node.comparators), strict=True):
            one = self._code.compare(COMPARISONS[type(op)], left, right)
            found, left = one if found is True else self._code.both(found, one), right
        return found

    def _of_BoolOp(self, node):
        code, end = self._code, self._code.new_label()
        first, *others = node.values
        found = code.variable(as_value(value := self._value(first)).kind)
        code.store(value, found)
        for one in others:
            more = code.new_label()
            ways = (more, end) if isinstance(node.op, ast.And) else (end, more)
            code.branch(code.load(found), *ways)
            code.label(more)
            code.store(self._value(one), found)
        code.jump(end)
        code.label(end)
        return code.load(found)

    def _of_IfExp(self, node):
        code, test = self._code, self._value(node.test)
        if not isinstance(test, Value):
            return self._value(node.body if test else node.orelse)
        yes, no, end = (code.new_label() for _ in range(3))
        code.branch(test, yes, no)
        found = None
        for label, side in (yes, node.body), (no, node.orelse):
            code.label(label)
            found = self._assigned(found, self._value(side))
            code.jump(end)
        code.label(end)
        return _in_tuples(self._loaded, found)

    def _of_Call(self, node):
        code, function = self._code, self._value(node.func)
        arguments = tuple(map(self._value, node.args))
        if inspect.isclass(function) and issubclass(function, tuple):
            named = {one.arg: self._value(one.value) for one in node.keywords}
            return tuple(function(*arguments, **named))
        if node.keywords:
            raise TypeError("arguments are given by their place")
        if not any(isinstance(one, (Value, Record, Array)) for one in _flat(arguments)):
            return function(*arguments)
        if function in (max, min):
            return code.extreme("gt" if function is max else "lt", *arguments)
        if function in (int, float):
            return code.converted(function.__name__, *arguments)
        if function in INTRINSICS:
            name = f"llvm.{INTRINSICS[function]}.f64"
            self._program.declarations.add(f"declare double @{name}(double)")
            return self._of_one_float(name, *arguments)
        if function in TRACED:
            return self._of_one_float(self._program.traced(function), *arguments)
        if function in (call_lanes, call_point):
            return code.call_unit(*arguments)
        if function is add:
            array, index, x = arguments
            return code.add(x, code.item(array, (index,)))
        known = tuple(_in_tuples(self._argument, one) for one in arguments)
        name, returns = self._program.add(function, known)
        given = [one for one in _flat(known) if isinstance(one, Value)]
        return code.call(name, returns, [code.first, *given])

    def _argument(self, x):
        return as_value(x) if isinstance(x, (int, float)) else x

    def _of_one_float(self, name, x):
        return self._code.call(name, ("float",), [Value("float", self._code.cast(x, "float"))])
