"""Everything that is wrong with a scenario file, told at once: one line a problem."""

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
MOST_TOLD = 100  # problems
NEAR = 0.7  # from 0 to 1, how alike names are of which one was perhaps meant
#: the end of a line; brackets in it are for tables and keys, so units stand in examples only
expected = functools.partial(_expected, unit=False)


class Problems(list[str]):
    """Lines such as ``[loading] V_lp: '3.2 mm' is a length, expected a speed such as ...``.

    No more than `MOST_TOLD`; ``untold`` counts the others.
    """

    untold = 0

    def add(self, place: str, what: str) -> None:
        """Note what is wrong at a place such as ``[sweep] M.from``."""
        if len(self) < MOST_TOLD:
            self.append(f"{place}: {what}")
        else:
            self.untold += 1

    def at(self, place: str, symbol: str = "", expected: str = "", like: str = "") -> "_Noted":
        """Note a ParameterError of a block and go on.

        symbol : what its message may begin with
        expected : the end of its line, if its message does not say what was expected
        like : an example for it, and for what the message says to give
        """
        return _Noted(self, place, symbol, expected, like)

    def told(self, tables: Iterable[str]) -> str:
        """All lines, as one text, in the order of the tables."""
        order = {f"[{table}]": i for i, table in enumerate(tables)}
        lines = sorted(self, key=lambda line: order.get(line.split("]")[0] + "]", -1))
        more = [f"and {self.untold} problems more"] if self.untold else []
        return "\n".join([*lines, *more])


class _Noted(NamedTuple):
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
        what = plain(error).removeprefix(f"{self.symbol} = ").removeprefix(f"{self.symbol} ")
        self.problems.add(self.place, self._line(what.removeprefix("[s] ")))  # (of times)
        return True

    def _line(self, what: str) -> str:
        """The message, and what was expected if it does not say so itself."""
        if ", expected " in what:
            return what
        wrong, own, remedy = what.rpartition("; give ")
        if own and self.like:
            return f"{wrong}, expected {remedy} such as {self.like}"
        return f"{what}, {self.expected}" + (f" such as {self.like}" if self.like else "")


def plain(error: ParameterError) -> str:
    """The message of an error as a line has it: "..., expected ...", and no units in brackets.

    Only what ratestate itself says is changed, and nothing that it quotes.
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
    """A value out of a TOML file, as a message shows it: on one line, and short."""
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


def bare(key: str) -> str:
    """A key as TOML writes it: in quotes if it needs them."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]{1,60}", key) else shown(key)


def nearest(given: Any, names: Iterable[str]) -> str | None:
    """Which of these names was perhaps meant."""
    lower = {name.lower(): name for name in names}
    text = given.lower()[:60] if isinstance(given, str) else ""
    near = difflib.get_close_matches(text, lower, n=1, cutoff=NEAR)
    return lower[near[0]] if near else None


def one_of(names: Iterable[str], given: Any = None, like: str = "") -> str:
    """The end of a message: which names there are, and which of them was perhaps meant.

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
