"""Functions of a small part of Python as LLVM text: the control, which is the same for all laws.

A function holds numbers (floats, ints of 64 bits and bools), whose kinds are those of their first
assignments, tuples of numbers, and what is known as it is compiled: numbers, functions, modules,
and the layout of the record that a kernel works on.  Statements are assignments, `if`, `while`,
`for` over a range or a tuple, `break`, `return` and calls.  All else is refused.

The answers are Python's, to the last bit, if

- ints stay within 64 bits, and those of // and % are not negative;
- each index is one of the array's, from 0 on: none is checked;
- nothing raises: x/0 is infinite or NaN, and log and sqrt of negative numbers are NaN.
"""

import ast
import builtins
import functools
import inspect
import itertools
import textwrap

from ..friction import functions as F
from .code import Code, Number
from .instructions import Array, Instructions, Slot, Value, Word, as_value, type_of
from .rows import add, call_lanes, call_point

#: functions of LLVM's own, or traced (friction/functions.py)
INTRINSICS = {abs: "fabs", F.sqrt: "sqrt"}
TRACED = (F.log, F.exp, F.expm1, F.log1p)


def kernel_text(function, layout, pointer="ptr", own=""):
    """LLVM text of ``i1 function(words, ...)``, and of all that it calls.

    SyntaxError, which says where and why, for what is refused.

    function : of a record and ints; it returns a bool
    layout : the record, with a `Word` for each int and an `Array` for each array
    pointer : LLVM's type of a pointer to words and arrays
    own : further LLVM parameters of all functions, such as ", ptr %work"
    """
    program = _Program(pointer, own)
    ints = [Value("int", "")] * (len(inspect.signature(function).parameters) - 1)
    _, returns = program.add(function, (layout, *ints), function.__name__)
    if returns != ("bool",):
        raise SyntaxError(f"{_name_of(function)} must return a bool")
    return "\n".join([*sorted(program.declarations), *program.texts, "!0 = !{}", ""])


def _name_of(function):
    return f"{function.__module__}.{function.__qualname__}"


def _in_tuples(function, x):
    """A function of x, or of all that stands in the tuple x."""
    return tuple(_in_tuples(function, one) for one in x) if type(x) is tuple else function(x)


def _flat(x):
    return [one for part in x for one in _flat(part)] if type(x) is tuple else [x]


class _Program:
    """Functions, each of them once for arguments of the same kinds."""

    def __init__(self, pointer, own):
        self.of_all = pointer, own
        self.texts, self.declarations = [], set()
        self._known, self._count = {}, itertools.count()

    def add(self, function, arguments, name=None):
        """The name of a function for arguments like these, and the kinds that it returns."""
        signature = [x.kind if isinstance(x, Value) else id(x) for x in _flat(arguments)]
        key = function, *signature
        if key not in self._known:
            own = name or f"{function.__name__}.{next(self._count)}"
            written = _Function(self, function, arguments)
            self._known[key] = own, written.returns
            self.texts.append(written.text(f"{'' if name else 'internal '}{{}} @{own}"))
        return self._known[key]

    def of_one_number(self, function):
        """The name of a function of `INTRINSICS` or `TRACED`."""
        if function in INTRINSICS:
            name = f"llvm.{INTRINSICS[function]}.f64"
            self.declarations.add(f"declare double @{name}(double)")
            return name
        name = f"traced.{function.__name__}"
        if function not in self._known:
            self._known[function] = name
            code = Code(1)
            found = function(Number(code, "%x"))
            self.declarations |= set(code.declarations.values())
            lines = "\n  ".join([*code.lines, f"ret double {code.text(Number, found)}"])
            self.texts.append(f"define internal double @{name}(double %x) {{\n  {lines}\n}}")
        return name


class _Function(Instructions):
    """A function's statements and expressions, written as instructions."""

    def __init__(self, program, function, arguments):
        super().__init__(*program.of_all)
        self._program, self._function = program, function
        self._variables, self._ends = {}, []
        (tree,) = ast.parse(textwrap.dedent(inspect.getsource(function))).body
        self._checked(tree, lambda _: self._whole(tree, arguments))

    def _whole(self, tree, arguments):
        if not isinstance(tree, ast.FunctionDef) or tree.decorator_list:
            raise TypeError("it is not a plain function")
        for one, given in zip(tree.args.args, arguments, strict=True):
            self._assign(ast.Name(one.arg), _in_tuples(self._parameter, given))
        if not self._block(tree.body):
            if self.returns:
                raise TypeError("it may end without a return")
            self._do_Return(ast.Return())

    # Statements: True of those after which none is reached

    def _block(self, statements):
        return any(self._statement(one) for one in statements)

    def _statement(self, node):
        return self._checked(node, getattr(self, f"_do_{type(node).__name__}", self._refuse))

    def _checked(self, node, write):
        try:
            return bool(write(node))
        except SyntaxError:
            raise
        except Exception as error:  # tracing runs any method of the source's values
            text = ast.unparse(node).partition("\n")[0]
            reason = f"{text} ({type(error).__name__}: {error})"
            raise SyntaxError(f"{_name_of(self._function)} cannot be compiled: {reason}") from error

    def _refuse(self, node):
        raise TypeError(f"{type(node).__name__} is not known")

    def _do_Expr(self, node):
        self._value(node.value)

    def _do_Assign(self, node):
        value = self._value(node.value)
        for target in node.targets:
            self._assign(target, value)

    def _do_AugAssign(self, node):
        slot = self._place(node.target)
        self._store(self._two(type(node.op), self._load(slot), self._value(node.value)), slot)

    def _place(self, node):
        if isinstance(node, ast.Name):
            return self._variables[node.id]
        return self._item(self._value(node.value), self._value(node.slice))

    def _assign(self, target, value):
        if isinstance(target, ast.Tuple):
            for one, part in zip(target.elts, value, strict=True):
                self._assign(one, part)
        elif isinstance(target, ast.Subscript):
            self._store(value, self._place(target))
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
            known = self._variable(as_value(value).kind)
        if isinstance(known, Slot):
            self._store(value, known)
        elif known != value:
            raise TypeError("the name stands for something else")
        return known

    def _do_Return(self, node):
        found = () if node.value is None else self._value(node.value)
        found = found if type(found) is tuple else (found,)
        if self.returns is None:
            self.returns = tuple(as_value(one).kind for one in found)
        kind, pairs = type_of(self.returns), zip(self.returns, found, strict=True)
        texts = [self._argument(*pair) for pair in pairs]
        if len(texts) > 1:
            whole = "poison"
            for i, text in enumerate(texts):
                whole = self._let(f"insertvalue {kind} {whole}, {text}, {i}")
            texts = [f"{kind} {whole}"]
        self._line(f"ret {texts[0] if texts else 'void'}")
        return True

    def _do_If(self, node):
        test = self._value(node.test)
        if not isinstance(test, Value):
            return self._block(node.body if test else node.orelse)
        return self._branches(test, self._block, node.body, node.orelse)

    def _branches(self, test, write, *sides):
        """Write both sides of a condition; whether both end in a jump."""
        labels, end = [self._label() for _ in sides], self._label()
        self._branch(test, *labels)
        ended = []
        for label, side in zip(labels, sides, strict=True):
            self._line(f"{label}:")
            ended.append(write(side))
            if not ended[-1]:
                self._jump(end)
        if not all(ended):
            self._line(f"{end}:")
        return all(ended)

    def _do_While(self, node):
        self._loop(node, lambda: self._value(node.test), lambda: None)

    def _loop(self, node, test, begin):
        """Write a loop; test : writes the condition; begin : the body's beginning."""
        again, body, end = (self._label() for _ in range(3))
        self._jump(again)
        self._line(f"{again}:")
        self._branch(test(), body, end)
        self._line(f"{body}:")
        begin()
        if not self._body(node, end):
            self._jump(again)
        self._line(f"{end}:")

    def _body(self, node, end):
        if node.orelse:
            raise TypeError("a loop has no else")
        self._ends.append(end)
        ended = self._block(node.body)
        self._ends.pop()
        return ended

    def _do_For(self, node):
        if isinstance(node.iter, ast.Call) and self._value(node.iter.func) is range:
            return self._for_range(node, *map(self._value, node.iter.args))
        end = self._label()
        for one in self._value(node.iter):  # the body is written once for each
            self._assign(node.target, one)
            self._body(node, end)
        self._jump(end)
        self._line(f"{end}:")

    def _for_range(self, node, *given):
        begin, stop, step = (0, *given, 1)[-3:] if len(given) < 3 else given
        if not isinstance(step, int) or step < 1:
            raise TypeError("the step of a range is a number above 0")
        stop, i = Value("int", self._cast(stop, "int")), self._variable("int")
        self._store(self._two(ast.Sub, begin, step), i)

        def test():
            now = self._two(ast.Add, self._load(i), step)
            self._store(now, i)
            return self._two(ast.Lt, now, stop)

        self._loop(node, test, lambda: self._assign(node.target, self._load(i)))

    def _do_Break(self, node):
        self._jump(self._ends[-1])
        return True

    # Expressions: a `Value`, a tuple, or what is known

    def _value(self, node):
        return getattr(self, f"_of_{type(node).__name__}", self._refuse)(node)

    def _of_Constant(self, node):
        return node.value

    def _of_Tuple(self, node):
        return tuple(map(self._value, node.elts))

    def _of_Name(self, node):
        if node.id in self._variables:
            return self._loaded(self._variables[node.id])
        known = self._function.__globals__
        return known[node.id] if node.id in known else getattr(builtins, node.id)

    def _loaded(self, x):
        return _in_tuples(lambda one: self._load(one) if isinstance(one, Slot) else one, x)

    def _of_Attribute(self, node):
        of = self._value(node.value)
        if isinstance(of, Array) and node.attr == "shape":
            return tuple(self._word(of.at + 1 + k) for k in range(of.dimensions))
        found = getattr(of, node.attr)
        return self._word(found.at) if isinstance(found, Word) else found

    def _of_Subscript(self, node):
        of = self._value(node.value)
        if type(of) is tuple:
            return of[self._value(node.slice)]
        return self._load(self._item(of, self._value(node.slice)))

    def _of_BinOp(self, node):
        return self._two(type(node.op), self._value(node.left), self._value(node.right))

    def _of_UnaryOp(self, node):
        x = self._value(node.operand)
        if isinstance(node.op, ast.Not):
            return self._let(f"xor i1 {self._truth(x)}, true", "bool")
        if not isinstance(node.op, ast.USub):
            self._refuse(node.op)
        if isinstance(x, Value) and x.kind == "float":
            return self._let(f"fneg double {x.text}", "float")
        return self._two(ast.Sub, 0, x) if isinstance(x, Value) else -x

    def _of_Compare(self, node):
        values = [self._value(one) for one in (node.left, *node.comparators)]
        each = zip(node.ops, values, values[1:], strict=False)
        found = [self._two(type(op), x, y) for op, x, y in each]
        return functools.reduce(self._both, found)

    def _both(self, x, y):
        return self._let(f"and i1 {self._truth(x)}, {self._truth(y)}", "bool")

    def _of_BoolOp(self, node):
        found, end = self._variable("bool"), self._label()
        for one in node.values:
            self._store(self._value(one), found)
            more = self._label()
            ways = (more, end) if isinstance(node.op, ast.And) else (end, more)
            self._branch(self._load(found), *ways)
            self._line(f"{more}:")
        self._jump(end)
        self._line(f"{end}:")
        return self._load(found)

    def _of_IfExp(self, node):
        test, found = self._value(node.test), None  # what it stands for: `_assigned`
        if not isinstance(test, Value):
            return self._value(node.body if test else node.orelse)

        def write(side):
            nonlocal found
            found = self._assigned(found, self._value(side))

        self._branches(test, write, node.body, node.orelse)
        return self._loaded(found)

    def _of_Call(self, node):
        function, arguments = self._value(node.func), tuple(map(self._value, node.args))
        if inspect.isclass(function) and issubclass(function, tuple):
            named = {one.arg: self._value(one.value) for one in node.keywords}
            return tuple(function(*arguments, **named))
        if node.keywords:
            raise TypeError("arguments are given by their place")
        flat = _flat(arguments)
        if not any(isinstance(x, (Value, Array)) or hasattr(x, "_fields") for x in flat):
            return function(*arguments)
        if function in (max, min):
            return functools.reduce(lambda x, y: self._further(function, x, y), arguments)
        if function in (int, float):
            return self._converted(function.__name__, *arguments)
        if function in INTRINSICS or function in TRACED:
            name = self._program.of_one_number(function)
            return self._call(name, ("float",), self._argument("float", *arguments))
        if function in (call_lanes, call_point):
            return self._call_unit(*arguments)
        if function is add:
            return self._added(*arguments)
        numbers = bool, int, float
        known = _in_tuples(lambda x: as_value(x) if isinstance(x, numbers) else x, arguments)
        name, returns = self._program.add(function, known)
        given = [self._argument(x.kind, x) for x in _flat(known) if isinstance(x, Value)]
        return self._call(name, returns, self._first, *given)
