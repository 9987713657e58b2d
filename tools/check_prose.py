"""Ends with an error where a message or a docstring breaks a rule of plain English.

Messages are the strings of the message tables (TOML) and of calls that raise or warn.  The rules
are those that a program can check; CONTRIBUTING.md names the main ones.
"""

import ast
import re
import sys
import tomllib
from pathlib import Path

SOURCES = Path(__file__).resolve().parents[1] / "src"
#: tables that hold no messages
NOT_PROSE = "templates", "quantities.toml", "column_names.toml", "run_fit.toml"
RAISING = "ParameterError", "SolverError", "NotConverged", "StoreError", "Refused", "warn"
LONGEST = 40  # words of a sentence in a message
IN_BOTH = {
    r"\b(that|those) of\b": "name the noun again instead of 'that of'",
    r"(?<!here)\s(is|are) no (?!longer|more|less)": "'is not a', never 'is no'",
}
IN_MESSAGES = IN_BOTH | {r"; (?!\{)|;$": "two sentences instead of a semicolon"}


def strings(table):
    """Yield all strings of a TOML table."""
    if isinstance(table, str):
        yield table
    elif isinstance(table, dict | list):
        for value in table.values() if isinstance(table, dict) else table:
            yield from strings(value)


def text(node):
    """Return the text of a string or an f-string; its values are {}."""
    if isinstance(node, ast.JoinedStr):
        return "".join(text(part) or "{}" for part in node.values)
    constant = isinstance(node, ast.Constant) and isinstance(node.value, str)
    return node.value if constant else ""


def called(node):
    return getattr(node.func, "attr", getattr(node.func, "id", ""))


def messages(tree):
    """Yield (line, text) of the strings in a module's calls that raise or warn."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and called(node) in RAISING:
            for argument in (*node.args, *(keyword.value for keyword in node.keywords)):
                if " " in text(argument):
                    yield argument.lineno, text(argument)


def docstrings(tree):
    """Yield (line, text) of a module's docstrings."""
    for node in ast.walk(tree):
        documented = isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
        if documented and (docstring := ast.get_docstring(node)):
            yield getattr(node, "lineno", 1), docstring


def faults(message, rules):
    """Yield the rules that a text breaks."""
    for pattern, rule in rules.items():
        if match := re.search(pattern, message):
            yield f"{rule}: ...{message[max(0, match.start() - 30) : match.end() + 20]!r}"


def long_sentences(message):
    for sentence in re.split(r"[.?!:] ", message):
        if len(sentence.split()) > LONGEST:
            yield f"a sentence of more than {LONGEST} words: {sentence[:60]!r}"


def main():
    found = []
    for path in sorted(SOURCES.rglob("*.toml")):
        if not set(NOT_PROSE) & {*path.parts}:
            for message in strings(tomllib.loads(path.read_text("utf-8"))):
                wrong = *faults(message, IN_MESSAGES), *long_sentences(message)
                found += [f"{path.relative_to(SOURCES)}: {fault}" for fault in wrong]
    for path in sorted(SOURCES.rglob("*.py")):
        tree = ast.parse(path.read_text("utf-8"))
        checks = (messages(tree), IN_MESSAGES), (docstrings(tree), IN_BOTH)
        for texts, rules in checks:
            for line, one in texts:
                found += [f"{path.relative_to(SOURCES)}:{line}: {x}" for x in faults(one, rules)]
    if found:
        sys.exit("\n".join([*found, f"error: {len(found)} texts break a rule of plain English"]))


if __name__ == "__main__":
    main()
