"""Everything that is wrong with a scenario file, told at once: one line a problem."""

import difflib
import re
from collections.abc import Iterable
from types import TracebackType
from typing import Any, NamedTuple

from ..errors import ParameterError
from ..quantities import KINDS

LONGEST_SHOWN = 60  # characters
MOST_TOLD = 100  # problems
_UNITS = re.compile("|".join(re.escape(f" [{unit}]") for unit in KINDS))


class Problems(list[str]):
    """Lines such as ``[loading] V_lp: '3.2 mm' is a length, expected a speed such as ...``.

    No more than `MOST_TOLD`; ``untold`` counts the others.
    """

    untold = 0

    def add(self, place: str, what: str) -> None:
        """Note what is wrong at a place such as ``[sweep] M.from``."""
        if len(self) < MOST_TOLD:
            self.append(f"{place}: {_UNITS.sub('', what)}")
        else:
            self.untold += 1

    def at(self, place: str, symbol: str = "", expected: str = "") -> "_Noted":
        """Note a ParameterError of a block and go on.

        symbol : what its message may begin with
        expected : the end of its line, if its message does not say what was expected
        """
        return _Noted(self, place, symbol, expected)

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
        what = str(error).removeprefix(f"{self.symbol} = ").removeprefix(f"{self.symbol} ")
        what = what.removeprefix("[s] ").replace("\n", " ")  # (of times)
        what = ", expected".join(what.rsplit("; expected", 1))
        if ", expected " not in what:
            what += f", {self.expected}"
        self.problems.add(self.place, what)
        return True


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
    near = difflib.get_close_matches(text, lower, n=1)
    return lower[near[0]] if near else None


def one_of(names: Iterable[str], given: Any = None) -> str:
    """The end of a message: which names there are, and which of them was perhaps meant."""
    names = list(names)
    near = nearest(given, names)
    meant = f"; did you mean {near}?" if near else ""
    return f"expected {'one of ' if len(names) > 1 else ''}{', '.join(names)}{meant}"


def choice(given: Any, names: Iterable[str]) -> str:
    """One of these names; ParameterError for anything else."""
    names = list(names)
    if isinstance(given, str) and given in names:
        return given
    raise ParameterError(f"{shown(given)} is unknown, {one_of(names, given)}")
