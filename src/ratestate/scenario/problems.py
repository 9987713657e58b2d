"""The problems of a scenario file, which are reported together: one line for each problem."""

import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from ..errors import ParameterError
from ..model.names import Sentences, one_of
from ..model.quantities import QUANTITIES

LONGEST_SHOWN = 60  # characters
MOST_LINES = 100  # problems
#: a key of TOML, bare or in quotes
_KEY = r"""([A-Za-z0-9_-]+|"[^"]*"|'[^']*')"""
T = TypeVar("T")


class _Messages(Sentences):
    """Sentences in which ``{given:toml}`` shows a value as `shown` does."""

    def format_field(self, value: Any, spec: str) -> str:
        return shown(value) if spec == "toml" else super().format_field(value, spec)


message = _Messages(Path(__file__).with_name("messages.toml"))
refusal = message.refusal


class Problem(NamedTuple):
    """A problem of a scenario file: its table and key, and the text with its remedy."""

    path: tuple[str | int, ...]  # table, key, and what follows in an inline table or list
    text: str


class Place(NamedTuple):
    """A table or key of the file, such as ``[sweep] M.from``, and all problems of the file."""

    path: tuple[str | int, ...]
    problems: list[Problem]

    def at(self, part: str | int) -> "Place":
        """Return a key of this table, or an element of this list."""
        return Place((*self.path, part), self.problems)

    def add(self, name: str, /, **values: Any) -> None:
        """Note a problem, by the name of its message."""
        self.note(refusal(name, **values))

    def missing(self, key: str, wanted: str = "") -> None:
        """Note that a key of this table is missing, and what to give if not its quantity."""
        self.at(key).add("key.missing", wanted=wanted or QUANTITIES[key].remedy)

    def attempt(self, make: Callable[[], T], symbol: str = "") -> T | None:
        """Return what `make` returns; note a ParameterError, and return None."""
        try:
            return make()
        except ParameterError as error:
            self.note(error, symbol)
            return None

    def note(self, error: ParameterError, symbol: str = "") -> None:
        """Note an error, without its symbol if that is `symbol` or a key of this place."""
        text = error.text("" if error.symbol in (symbol, *self.path) else error.symbol)
        self.problems.append(Problem(self.path, text.replace("\n", " ")))


def report(problems: list[Problem], tables: Iterable[str], text: str) -> str:
    """Return lines of the first `MOST_LINES` problems, in the order of tables; how many more.

    text : the file, for the numbers of its lines
    """
    order = {table: i for i, table in enumerate(tables)}
    numbers = key_lines(text)
    lines = []
    for path, problem in problems[:MOST_LINES]:
        number = numbers.get(path[:2], numbers.get(path[:1], 0))
        line = f"line {number}, " if number else ""
        lines.append((order.get(str(path[0]), -1), number, f"{line}{written(path)}: {problem}"))
    omitted = len(problems) - MOST_LINES
    more = [f"and {omitted} problems more"] if omitted > 0 else []
    return "\n".join([*(line for *_, line in sorted(lines, key=lambda x: x[:2])), *more])


def written(path: tuple[str | int, ...]) -> str:
    """Return a table or key as messages name it: ``[loading] steps[0].V_lp``."""
    table, *parts = path
    name = f"[{toml_key(str(table))}]" if table else ""
    for i, part in enumerate(parts):
        joint = "." if i else " " if table else ""
        name += f"[{part}]" if isinstance(part, int) else joint + toml_key(part)
    return name or "the file"


def key_lines(text: str) -> dict[tuple[str | int, ...], int]:
    """Return the line, from 1 on, of each table (name,) and of its keys (name, key)."""
    numbers: dict[tuple[str | int, ...], int] = {}
    table = ""
    for number, line in enumerate(text.split("\n"), 1):
        if header := re.match(rf"\s*\[\s*{_KEY}\s*\]\s*(?:#.*)?$", line):
            table = header[1].strip("\"'")
            numbers.setdefault((table,), number)
        elif key := re.match(rf"\s*{_KEY}\s*[.=]", line):
            numbers.setdefault((table, key[1].strip("\"'")), number)
    return numbers


def shown(value: Any) -> str:
    """Return a value as messages show it: a string quoted and cut, "a table" and so on."""
    if isinstance(value, str):
        return repr(value if len(value) <= LONGEST_SHOWN else value[: LONGEST_SHOWN - 3] + "...")
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list):
        return f"a list of {len(value)}"
    if isinstance(value, int) and abs(value) > 2**63:
        return "a huge integer"  # maybe of more digits than Python writes out
    return str(value)


def toml_key(key: str) -> str:
    """Return a key as TOML writes it: in quotes if it needs them."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]{1,60}", key) else shown(key)


def choice(given: Any, names: Iterable[str]) -> str:
    """Return one of these names; ParameterError for anything else."""
    names = list(names)
    if isinstance(given, str) and given in names:
        return given
    raise refusal("value.unknown", given=given, wanted=one_of(names, given))
