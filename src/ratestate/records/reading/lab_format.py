"""A laboratory's format, saved as TOML: what `read_lab` cannot know of its files by itself."""

import dataclasses
import json
import tomllib
from pathlib import Path
from typing import Any

from ...errors import ParameterError
from ...model.names import one_of
from ...model.parameters import WHOLE_CONTACT, quantity_of
from ...model.quantities import QUANTITIES
from ...model.units import has_unit, to_si
from ..messages import reading as sentences
from .text import DELIMITERS
from .titles import LIKE, plain

LARGEST = 100_000  # bytes
#: as the file has it -> as the reader of text takes it
DELIMITER_NAMES = {"tab": "\t", ";": ";", ",": ",", "space": None}
DECIMALS = (".", ",")
#: table -> keys it may have
TABLES: dict[str, tuple[str, ...]] = {
    "text": ("delimiter", "decimal"),
    "columns": tuple(LIKE),
    "units": tuple(LIKE),
    "constants": ("sigma",),
    "signs": tuple(symbol for symbol in LIKE if symbol != "time"),
    "machine": ("K", "M"),
}


@dataclasses.dataclass(frozen=True)
class LabFormat:
    """What the files of a laboratory have in common."""

    delimiters: tuple[str | None, ...] = DELIMITERS
    decimal: str | None = None
    columns: dict[str, Any] = dataclasses.field(default_factory=dict)
    units: dict[str, str] = dataclasses.field(default_factory=dict)
    constants: dict[str, Any] = dataclasses.field(default_factory=dict)
    signs: dict[str, int] = dataclasses.field(default_factory=dict)
    machine: dict[str, Any] = dataclasses.field(default_factory=dict)

    def merged_columns(self, columns, sigma=None):
        """The columns of a call, and for other symbols those of the format.

        sigma : a constant that stands for that column, or None
        """
        if not isinstance(columns, dict | None):
            return columns  # refused where it is used
        own = {s: c for s, c in self.columns.items() if s != "sigma" or sigma is None}
        return own | (columns or {})

    def merged_units(self, units, sigma=None):
        """The same of units."""
        if not isinstance(units, dict | None):
            return units
        own = {s: unit for s, unit in self.units.items() if s != "sigma" or sigma is None}
        return own | (units or {})

    def text_table(self):
        """What the format says of text: key -> value."""
        names = [name for name, one in DELIMITER_NAMES.items() if self.delimiters == (one,)]
        found = {"delimiter": names[0]} if names else {}
        return found | ({"decimal": self.decimal} if self.decimal else {})


def lab_format(path):
    """The `LabFormat` in a file; all that is wrong with it is one ParameterError."""
    path = _path(path)
    try:
        if path.stat().st_size > LARGEST:
            raise sentences.refusal("format.large", name=path.name, most=LARGEST)
        tables = tomllib.loads(path.read_bytes().decode("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise sentences.refusal("format.toml", name=path.name, error=error) from None
    except (OSError, ValueError) as error:  # (ValueError: a null character in the path)
        what = getattr(error, "strerror", None) or error
        raise sentences.refusal("format.unreadable", path=path, error=what) from None
    problems = [problem for name, table in tables.items() for problem in _problems(name, table)]
    if (
        not problems
        and "sigma" in tables.get("columns", ())
        and "sigma" in tables.get("constants", ())
    ):
        problems.append(sentences("format.sigma_twice"))
    if problems:
        raise ParameterError("\n".join(f"{path.name}: {problem}" for problem in problems))
    text = tables.pop("text", {})
    delimiters = [DELIMITER_NAMES[text["delimiter"]]] if "delimiter" in text else DELIMITERS
    return LabFormat(tuple(delimiters), text.get("decimal"), **tables)


def _path(path):
    try:
        return Path(path).expanduser()
    except TypeError:
        raise sentences.refusal("format.path", path=path) from None


def _problems(name, table):
    """What is wrong with a table: texts that name key, value and remedy."""
    if name not in TABLES:
        yield sentences("format.table", table=name, wanted=one_of(TABLES, name))
    elif not isinstance(table, dict):
        yield sentences("format.no_table", table=name, key=TABLES[name][0])
    else:
        for key, value in table.items():
            where = {"table": name, "key": key, "value": value}
            if key not in TABLES[name]:
                yield sentences("format.key", wanted=one_of(TABLES[name], key), **where)
            elif (wanted := _wanted(name, key, value)) is not None:
                yield sentences("format.value", wanted=wanted, **where)


def _wanted(table, key, value):
    """What is expected in place of a value; None if it is right."""
    if table == "text":
        known = [*DELIMITER_NAMES] if key == "delimiter" else [*DECIMALS]
        return None if value in known else f"one of {', '.join(map(repr, known))}"
    if table == "columns":
        sound = isinstance(value, str) or (type(value) is int and value > 0)
        return None if sound else "the title of a column, or its number from 1 on"
    if table == "signs":
        sound = type(value) is int and abs(value) == 1
        return None if sound else "1, as in the file, or -1, the opposite"
    if table == "units":
        sound = isinstance(value, str) and has_unit(key, plain(value))
        return None if sound else f"a unit such as {LIKE[key]!r}"
    quantity = quantity_of(key, value)
    try:
        to_si(key if quantity in WHOLE_CONTACT else quantity, value)
    except ParameterError as error:
        return str(error).rpartition("; expected ")[2]
    return None


def checked_machine(values):
    """What is given of a machine, as a format has it; ParameterError for another quantity.

    values : symbol -> value, or None
    """
    given = {symbol: value for symbol, value in values.items() if value is not None}
    for symbol, value in given.items():
        if (wanted := _wanted("machine", symbol, value)) is not None:
            raise sentences.refusal("format.machine", symbol=symbol, value=value, wanted=wanted)
    return {symbol: as_text(symbol, value) for symbol, value in given.items()}


def as_text(symbol, value):
    """A value of a quantity as text with its unit."""
    if isinstance(value, str):
        return value
    quantity = quantity_of(symbol, value)
    return f"{to_si(quantity, value)!r} {QUANTITIES[quantity].unit}"


def toml_text(text):
    """A text as a string of TOML."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
