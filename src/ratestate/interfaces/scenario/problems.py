"""The problems of a scenario file, which are reported together: one line for each problem."""

import difflib
import functools
import re
from collections.abc import Iterable
from types import TracebackType
from typing import Any, NamedTuple

from ...errors import ParameterError
from ...model.quantities import KINDS
from ...model.quantities import expected as _expected

LONGEST_SHOWN = 60  # characters
MOST_LINES = 100  # problems
NEAR = 0.7  # from 0 to 1, how similar a name must be to be suggested
#: the end of a line; since brackets mean tables and keys there, units appear in examples only
expected = functools.partial(_expected, unit=False)


class Problems(list[str]):
    """Lines such as ``[loading] V_lp: '3.2 mm' is a length, expected a speed such as ...``.

    No more than `MOST_LINES`; ``omitted`` counts the others.
    """

    omitted = 0

    def add(self, place: str, what: str) -> None:
        """Note a problem of a key such as ``[sweep] M.from``."""
        if len(self) < MOST_LINES:
            self.append(f"{place}: {what}")
        else:
            self.omitted += 1

    def at(
        self, place: str, symbol: str = "", expected: str = "", like: str = ""
    ) -> "_NotingProblem":
        """Context that notes a ParameterError as a problem of a key, and continues after it.

        symbol : start of the message, which is removed
        expected : the end of the line, if the message does not say what is expected
        like : an example for the expected value
        """
        return _NotingProblem(self, place, symbol, expected, like)

    def message(self, tables: Iterable[str]) -> str:
        """All lines, joined in the order of the tables."""
        order = {f"[{table}]": i for i, table in enumerate(tables)}
        lines = sorted(self, key=lambda line: order.get(line.split("]")[0] + "]", -1))
        more = [f"and {self.omitted} problems more"] if self.omitted else []
        return "\n".join([*lines, *more])


class _NotingProblem(NamedTuple):
    problems: Problems
    place: str
    symbol: str
    expected: str
    like: str

    def __enter__(self) -> None:
        pass

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        at: TracebackType | None,
    ) -> bool:
        if not isinstance(error, ParameterError):
            return False
        what = error_line(error).removeprefix(f"{self.symbol} = ").removeprefix(f"{self.symbol} ")
        self.problems.add(self.place, self._line(what.removeprefix("[s] ")))  # (of times)
        return True

    def _line(self, what: str) -> str:
        """The message, and what is expected if it does not say so itself."""
        if ", expected " in what:
            return what
        wrong, own, remedy = what.rpartition("; give ")
        if own and self.like:
            return f"{wrong}, expected {remedy} such as {self.like}"
        return f"{what}, {self.expected}" + (f" such as {self.like}" if self.like else "")


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
    """A value of a TOML file as messages show it: on one line, and short."""
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


def nearest(given: Any, names: Iterable[str]) -> str | None:
    """The most similar of these names; None if none is similar."""
    lower = {name.lower(): name for name in names}
    text = given.lower()[:60] if isinstance(given, str) else ""
    near = difflib.get_close_matches(text, lower, n=1, cutoff=NEAR)
    return lower[near[0]] if near else None


def one_of(names: Iterable[str], given: Any = None, like: str = "") -> str:
    """The end of a message: the valid names, and the one that was perhaps meant.

    like : an example, such as ``a = 0.003``
    """
    names = list(names)
    near = nearest(given, names)
    meant = f"; did you mean {near}?" if near else ""
    such = f" such as {like}" if like else ""
    return f"expected {'one of ' if len(names) > 1 else ''}{', '.join(names)}{such}{meant}"


def choice(given: Any, names: Iterable[str]) -> str:
    """One of these names; ParameterError for anything else."""
    names = list(names)
    if isinstance(given, str) and given in names:
        return given
    raise ParameterError(f"{shown(given)} is unknown, {one_of(names, given)}")
