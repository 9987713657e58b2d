"""The problems of a scenario file, which are reported together: one line for each problem."""

import functools
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from ...errors import ParameterError
from ...model.names import Sentences, one_of
from ...model.quantities import KINDS
from ...model.quantities import expected as _expected

LONGEST_SHOWN = 60  # characters
MOST_LINES = 100  # problems
#: the end of a line; since brackets mean tables and keys there, units appear in examples only
expected = functools.partial(_expected, unit=False)
T = TypeVar("T")


class _Messages(Sentences):
    """Sentences in which ``{given:toml}`` shows a value as `shown` does."""

    def format_field(self, value: Any, spec: str) -> str:
        return shown(value) if spec == "toml" else super().format_field(value, spec)


message = _Messages(Path(__file__).with_name("messages.toml"))
refusal = message.refusal


class Place(NamedTuple):
    """A table or key of the file, such as ``[sweep] M.from``; the problems of all of the file."""

    name: str
    problems: list[str]

    def at(self, part: str | int) -> "Place":
        """A key of this table, or an element of this list."""
        joint = "." if " " in self.name else " "
        inner = f"[{part}]" if isinstance(part, int) else joint + toml_key(part)
        return Place(self.name + inner, self.problems)

    def add(self, name: str, /, **values: Any) -> None:
        """Note a problem, by the name of its message."""
        self.problems.append(f"{self.name}: {message(name, **values)}")

    def missing(self, key: str, wanted: str = "") -> None:
        """Note that a key of this table is missing, and what is expected if not its quantity."""
        self.at(key).add("key.missing", wanted=wanted or expected(key))

    def noting(
        self, make: Callable[[], T], symbol: str = "", wanted: str = "", like: str = ""
    ) -> T | None:
        """What `make` returns; None where it raises a ParameterError, noted as by `note`."""
        try:
            return make()
        except ParameterError as error:
            self.note(error, symbol, wanted, like)
            return None

    def note(
        self, error: ParameterError, symbol: str = "", wanted: str = "", like: str = ""
    ) -> None:
        """Note an error, without its start `symbol`; `wanted` and `like` say what is expected.

        Where no symbol is given, or an example, what the error itself says to give goes first.  A
        message in sentences has its own remedy.
        """
        what = error_line(error).removeprefix(f"{symbol} = ").removeprefix(f"{symbol} ")
        what = what.removeprefix("[s] ")  # (of times)
        if ", expected " not in what and not what.endswith("."):
            wrong, own, remedy = what.rpartition("; give ")
            if own and (like or not symbol):
                what, wanted = wrong, f"expected {remedy}"
            what = f"{what}, {wanted}" + (f" such as {like}" if like else "")
        self.problems.append(f"{self.name}: {what}")


def report(problems: list[str], tables: Iterable[str]) -> str:
    """Lines of the first `MOST_LINES` problems, in the order of the tables; how many more."""
    order = {f"[{table}]": i for i, table in enumerate(tables)}
    lines = sorted(problems[:MOST_LINES], key=lambda line: order.get(line.split("]")[0] + "]", -1))
    omitted = len(problems) - MOST_LINES
    return "\n".join([*lines, f"and {omitted} problems more"] if omitted > 0 else lines)


def error_line(error: ParameterError) -> str:
    """The message of an error in the form of a line: "..., expected ...", no units in brackets.

    Only the words of ratestate itself are changed, and nothing that the message quotes.
    """
    what = str(error).replace("\n", " ")
    wrong, own, wanted = what.rpartition("; expected ")
    if not own or ", expected " in wanted:
        return what
    for unit, (kind, _) in KINDS.items():
        if wrong.endswith(f" is {kind} [{unit}]"):
            wrong = wrong.removesuffix(f" [{unit}]")
        if wanted.startswith(f"{kind} [{unit}]"):
            wanted = kind + wanted.removeprefix(f"{kind} [{unit}]")
    return f"{wrong}, expected {wanted}"


def shown(value: Any) -> str:
    """A value of a TOML file as messages show it: a string quoted and cut, "a table" and so on."""
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
    """A key as TOML writes it: in quotes if it needs them."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]{1,60}", key) else shown(key)


def choice(given: Any, names: Iterable[str]) -> str:
    """One of these names; ParameterError for anything else."""
    names = list(names)
    if isinstance(given, str) and given in names:
        return given
    raise refusal("value.unknown", given=given, wanted=one_of(names, given))
