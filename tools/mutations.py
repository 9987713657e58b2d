"""Small changes of a source: one operator, constant, comparison or condition at a time.

Texts, docstrings, annotations and what only type checkers read are left alone, and lines keep
their numbers.
"""

import ast
import itertools
import re
from typing import NamedTuple

OPERATORS = {
    ast.Add: ("+", ["-"]),
    ast.Sub: ("-", ["+"]),
    ast.Mult: ("*", ["/"]),
    ast.Div: ("/", ["*"]),
    ast.FloorDiv: ("//", ["/"]),
    ast.Mod: ("%", ["*"]),
    ast.Pow: ("**", ["*"]),
    ast.BitOr: ("|", ["&"]),
    ast.BitAnd: ("&", ["|"]),
    ast.LShift: ("<<", [">>"]),
    ast.RShift: (">>", ["<<"]),
    ast.And: ("and", ["or"]),
    ast.Or: ("or", ["and"]),
    ast.Lt: ("<", ["<=", ">"]),
    ast.LtE: ("<=", ["<", ">="]),
    ast.Gt: (">", [">=", "<"]),
    ast.GtE: (">=", [">", "<="]),
    ast.Eq: ("==", ["!="]),
    ast.NotEq: ("!=", ["=="]),
    ast.Is: ("is", ["is not"]),
    ast.IsNot: ("is not", ["is"]),
    ast.In: ("in", ["not in"]),
    ast.NotIn: ("not in", ["in"]),
    ast.USub: ("-", [""]),
    ast.Not: ("not", [""]),
}


class Site(NamedTuple):
    """Where a source can be changed: bytes start to end, and what may stand there instead."""

    line: int
    start: int
    end: int
    options: tuple[str, ...]


def sites(source):
    """All sites of a source, given in bytes, in the order of the text."""
    ends = [0]
    for line in source.splitlines(keepends=True):
        ends.append(ends[-1] + len(line))

    def span(node):
        return (
            ends[node.lineno - 1] + node.col_offset,
            ends[node.end_lineno - 1] + node.end_col_offset,
        )

    def operator(kind, start, end):
        """The operator that stands somewhere between these bytes."""
        word, options = OPERATORS[type(kind)]
        pattern = rb"\s+".join(re.escape(part) for part in word.encode().split())
        text = re.sub(rb"#.*", lambda comment: b" " * len(comment[0]), source[start:end])
        found = re.search(pattern, text)
        return start + found.start(), start + found.end(), options

    def changes(node):
        match node:
            case ast.Constant(value=bool() | int() | float() as value):
                yield *span(node), other_constants(value)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
                yield operator(op, span(left)[1], span(right)[0])
            case ast.AugAssign(target=left, op=op, value=right) if type(op) in OPERATORS:
                yield operator(op, span(left)[1], span(right)[0])
            case ast.BoolOp(op=op, values=values):
                for left, right in itertools.pairwise(values):
                    yield operator(op, span(left)[1], span(right)[0])
            case ast.Compare(left=left, ops=ops, comparators=others):
                for before, op, after in zip([left, *others], ops, others, strict=False):
                    yield operator(op, span(before)[1], span(after)[0])
            case ast.UnaryOp(op=ast.USub() | ast.Not() as op, operand=operand):
                yield operator(op, span(node)[0], span(operand)[0])
            case ast.If(test=test) | ast.While(test=test) | ast.IfExp(test=test):
                yield negated(test)
            case ast.comprehension(ifs=tests):
                yield from map(negated, tests)

    def negated(test):
        start, end = span(test)
        return start, end, [f"(not ({source[start:end].decode()}))"]

    found = []
    for node in run(ast.parse(source)):
        for start, end, options in changes(node):
            line = source.count(b"\n", 0, start) + 1
            found.append(Site(line, start, end, tuple(options)))
    return sorted(found)


def other_constants(value):
    if isinstance(value, bool):
        return [str(not value)]
    if isinstance(value, int):
        return [str(value + 1), str(value - 1)]
    return ["1.0"] if value == 0 else [repr(2 * value), repr(value / 2)]


def run(node):
    """A node and all below it, without annotations and what only type checkers read."""
    yield node
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns"):
            continue
        for child in value if isinstance(value, list) else [value]:
            only_typing = isinstance(child, ast.If) and "TYPE_CHECKING" in ast.dump(child.test)
            if isinstance(child, ast.AST) and not only_typing:
                yield from run(child)
