"""Choose the columns of a file for a record, or refuse if two fit; titles.py ranks their names."""

import contextlib
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ...errors import ParameterError
from ...model.names import nearest
from ...model.quantities import QUANTITIES
from ...model.units import OF_WHOLE_CONTACT, to_si, unit_factor
from ..messages import reading as sentences
from .titles import (
    CERTAIN,
    EXAMPLE_UNIT,
    PATTERNS,
    TABLE,
    WEIGHTS,
    WORDS,
    letters,
    match_rank,
    plain_unit,
    spaced,
)

#: most characters of a text, and most names in a list, in a message
MAX_TEXT, MAX_NAMES = 60, 20
#: required quantity -> symbols of columns that provide it; a message suggests the first
REQUIRED = {
    "time": ["time"],
    "delta_lp or V_load (of the load point)": ["delta_lp", "V_load"],
    "friction, or tau and sigma": ["tau", "friction"],
    "sigma, to go with tau": ["sigma", "friction"],
}
#: symbol -> symbols that replace it together
REPLACED_BY = {"delta_lp": {"V_load"}, "V_load": {"delta_lp"}, "friction": {"tau", "sigma"}}


class Column(NamedTuple):
    """A column of a file, before it is interpreted."""

    title: str  # full title in the file; "column 3" in a file without header
    name: str  # the title without unit and group; "" if missing
    unit: str  # the unit in the header, as written; "" if missing
    values: np.ndarray  # of float, NaN if a cell is not a number
    other_unit: str = ""  # a unit elsewhere in the header that contradicts `unit`

    def rank(self, symbol):
        """Return the `match_rank` of its name for a quantity."""
        return match_rank(self.name, symbol)

    def has_word(self, word):
        """Return whether a pattern of `WORDS` matches its name."""
        return bool(WORDS[word].search(spaced(self.name)))


class Table(NamedTuple):
    """The contents of a file before they are interpreted."""

    columns: list[Column]  # their lengths may differ
    lines: np.ndarray | None = None  # line number of each row of a text file, from 1
    unread: tuple[str, ...] = ()  # titles of arrays that do not hold real numbers
    cell_text: Callable[[int, int], str] | None = None  # (line number, column index) -> cell
    name: str = ""  # of the file

    @property
    def titles(self):
        """Titles of the columns (list); they may repeat."""
        return [column.title for column in self.columns]

    def unread_text(self):
        """Return the end of a sentence that lists arrays without numbers; "" if none."""
        return f" (no real numbers, so not read: {name_list(self.unread)})" if self.unread else ""

    def row_label(self, row):
        """Return the label of a row (counted from 0) for a message: "line 17" or "row 18"."""
        return f"row {row + 1}" if self.lines is None else f"line {self.lines[row]}"

    def cell(self, row, column):
        """Return a cell that is not a number for a message: in quotes, or "nothing" if empty."""
        index = next((i for i, x in enumerate(self.columns) if x.values is column.values), None)
        if self.cell_text is None or self.lines is None or index is None:
            return quoted(str(column.values[row]))
        text = self.cell_text(int(self.lines[row]), index)
        return quoted(text) if text else "nothing"


def quoted(text):
    """Return a text from a file for a message: in quotes, on one line, `MAX_TEXT` at most."""
    return repr(text if len(text) <= MAX_TEXT else text[: MAX_TEXT - 3] + "...")


def name_list(names):
    """List names for a message: the first `MAX_NAMES`, quoted, and the number of others."""
    more = [f"{len(names) - MAX_NAMES} more"] if len(names) > MAX_NAMES else []
    return ", ".join([*map(quoted, names[:MAX_NAMES]), *more])


def check_requests(columns, units):
    """Raise ParameterError unless columns and units are dicts by symbol; do not parse units."""
    symbols = ", ".join(PATTERNS)
    if not isinstance(columns, dict) or not columns.keys() <= PATTERNS.keys():
        given = f" (given {name_list([*map(str, columns)])})" if isinstance(columns, dict) else ""
        raise sentences.refusal("columns.symbols", symbols=symbols, given=given)
    is_valid = isinstance(units, dict) and all(isinstance(unit, str) for unit in units.values())
    if not is_valid or not units.keys() <= PATTERNS.keys():
        raise sentences.refusal("units.type", units=units, symbols=symbols)


def choose_columns(table, columns, constants=()):
    """Return dict symbol -> index of its column, from 0: as requested, or found by its name.

    columns : dict symbol -> title or number from 1; a column may be requested for two symbols
    constants : symbols that need no column

    Optional symbols of `PATTERNS` may be absent.  ParameterError if a request fits no column or
    several, or if a required column is missing or ambiguous.
    """
    chosen = {s: requested_column(table, s, request) for s, request in columns.items()}
    for symbol in PATTERNS:
        replaced = symbol in REPLACED_BY and REPLACED_BY[symbol] <= chosen.keys()
        if replaced or symbol in chosen or symbol in constants:
            continue
        pore_pressure = symbol == "pore_pressure"
        # it is only subtracted from a total stress whose column was not requested
        is_total = "sigma" in chosen and "sigma" not in columns and not _is_effective(table, chosen)
        if pore_pressure and not is_total:
            continue
        # stresses are optional if friction is recorded
        needed = symbol not in ("tau", "sigma") or "friction" not in chosen
        index = column_by_name(table, symbol, chosen.values(), needed)
        if index is not None and not (pore_pressure and table.columns[index].has_word("excess")):
            chosen[symbol] = index
    for need, ways in REQUIRED.items():
        if not {*chosen, *constants} & set(ways):
            values = {"need": need, "symbol": ways[0]}
            values["columns"] = name_list(table.titles) + table.unread_text()
            column = _column_by_unit(table, ways[0], chosen.values())
            such = "such as" if column else "in"
            sentence = "no_sigma" if ways[0] == "sigma" else "missing"
            values |= {"such": such, "column": column or "..."}
            raise sentences.refusal(f"columns.{sentence}", **values)
    return chosen


def _is_effective(table, chosen):
    return "sigma" in chosen and table.columns[chosen["sigma"]].rank("sigma") == 0


def title_warnings(table, chosen, requested, constants=()):
    """Return notes (list of str) on columns with ambiguous titles, and on pore pressures.

    chosen : dict symbol -> index, from `choose_columns`
    requested : symbols of the columns that the caller named
    constants : symbols that need no column
    """
    notes = []
    for symbol, index in chosen.items():
        column = table.columns[index]
        title = quoted(column.title)
        if symbol in requested:
            continue
        if column.rank(symbol) >= CERTAIN[symbol]:
            notes.append(sentences("notes.perhaps", symbol=symbol, title=title))
        if symbol == "pore_pressure":
            sigma = quoted(table.titles[chosen["sigma"]])
            notes.append(sentences("notes.effective", title=title, sigma=sigma))
    total = "sigma" in {*chosen, *constants} and not _is_effective(table, chosen)
    if total and "pore_pressure" not in chosen:
        for i, column in enumerate(table.columns):
            pressure = column.rank("pore_pressure") is not None or column.has_word("pressure")
            if pressure and i not in chosen.values():
                excess = column.has_word("excess")
                name = "notes.excess_pressure" if excess else "notes.pore_pressure"
                notes.append(sentences(name, title=quoted(column.title)))
    return notes


def requested_column(table, symbol, request):
    """Return the index of the column that was requested by title or number."""
    titles = table.titles
    values = {"symbol": symbol, "request": request, "titles": name_list(titles)}
    if isinstance(request, int) and not isinstance(request, bool):
        if 1 <= request <= len(titles):
            return request - 1
        raise sentences.refusal("columns.number", count=len(titles), **values)
    if not isinstance(request, str):
        raise sentences.refusal("columns.type", **values)
    values["request"] = quoted(request)
    for spelling in (str, letters):
        for names in (titles, [column.name for column in table.columns]):
            matches = [i for i, name in enumerate(names) if spelling(name) == spelling(request)]
            if len(matches) == 1:
                return matches[0]
            if matches:
                numbers = ", ".join(str(i + 1) for i in matches)
                raise sentences.refusal(
                    "columns.several", count=len(matches), numbers=numbers, **values
                )
    near = nearest(request, titles) or nearest(request, [column.name for column in table.columns])
    meant = f" Did you mean {quoted(near)}?" if near else ""
    raise sentences.refusal("columns.unknown", meant=meant, **values)


def column_by_name(table, symbol, taken, needed=False):
    """Return the index of the column, not in `taken`, whose name fits best; None if none fits.

    If several fit equally well, return None, or raise ParameterError if the column is needed.
    """
    ranks = {
        i: rank
        for i, column in enumerate(table.columns)
        if i not in taken and (rank := column.rank(symbol)) is not None
    }
    best = [i for i, rank in ranks.items() if rank == min(ranks.values())]
    if len(best) > 1 and needed:
        values = {"symbol": symbol, "column": _reference(table, best[0])}
        titles = name_list([table.titles[i] for i in best])
        raise sentences.refusal("columns.ambiguous", titles=titles, **values)
    return best[0] if len(best) == 1 else None


def _column_by_unit(table, symbol, taken):
    """Return a reference to the only free column with a unit of this quantity; else ""."""
    matches = []
    for i, column in enumerate(table.columns):
        other = TABLE["quantities"][symbol].get("moves") and column.has_word("elsewhere")
        if i not in taken and not other:
            with contextlib.suppress(ParameterError):
                unit_of(column, symbol, {})
                matches.append(i)
    return _reference(table, matches[0]) if len(matches) == 1 else ""


def _reference(table, index):
    title = table.titles[index]
    return quoted(title) if table.titles.count(title) == 1 else str(index + 1)


def unit_of(column, symbol, units):
    """Return the unit of a column for `to_si`: from `units`, or else from the file.

    Friction without a unit has "1".  ParameterError if the unit is missing, if it is not a unit of
    the symbol, or if the header contradicts it.
    """
    unit = plain_unit(units.get(symbol, column.unit))
    if not unit and symbol == "friction" and symbol not in units:
        return "1"
    names = {"title": quoted(column.title), "symbol": symbol, "like": EXAMPLE_UNIT[symbol]}
    if not unit:
        raise sentences.refusal("units.none", **names)
    if column.other_unit and symbol not in units and not _is_same(unit, column.other_unit, symbol):
        raise sentences.refusal(
            "units.contradiction", unit=unit, other=plain_unit(column.other_unit), **names
        )
    try:
        to_si(symbol, f"1 {unit}", bound="")
    except ParameterError as error:
        where = f"units: {symbol} =" if symbol in units else "the unit"
        other = "" if error.problem == OF_WHOLE_CONTACT else ", or name another column in columns"
        names |= {"unit": unit, "what": error.problem}
        raise sentences.refusal("units.kind", where=where, other=other, **names) from None
    return unit


def _is_same(unit, other, symbol):
    si = QUANTITIES[symbol].unit
    with contextlib.suppress(ValueError):
        return unit_factor(si, unit) == unit_factor(si, plain_unit(other))
    return False


def newtons(column, symbol, units):
    """Return the unit of a column in newtons; None if it is not a unit of force."""
    with contextlib.suppress(ValueError):
        unit = plain_unit(units.get(symbol, column.unit))
        return float(unit_factor("N", WEIGHTS.get(unit, unit)))
    return None
