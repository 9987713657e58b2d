"""Columns of a file, and which quantity each is, by its name."""

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
    LIKE,
    PATTERNS,
    TABLE,
    WEIGHTS,
    WORDS,
    letters,
    match_rank,
    plain,
    spaced,
)

#: characters of a text, and names of a list, in a message
LONGEST, MOST = 60, 20
#: what a record needs -> columns one of which gives it; a message suggests the first
NEEDS = {
    "time": ["time"],
    "delta_lp or V_load (of the load point)": ["delta_lp", "V_load"],
    "friction, or tau and sigma": ["tau", "friction"],
    "sigma, to go with tau": ["sigma", "friction"],
}
#: symbol -> what replaces it
INSTEAD = {"delta_lp": {"V_load"}, "V_load": {"delta_lp"}, "friction": {"tau", "sigma"}}


class Column(NamedTuple):
    """A column as it stands in a file."""

    title: str  # its whole name in the file; "column 3" in a file without header
    name: str  # the title without unit and group; "" if there is none
    unit: str  # the unit beside it in the file, as written; "" if there is none
    values: np.ndarray  # of float, NaN if a cell is not a number
    other_unit: str = ""  # one elsewhere in the header that contradicts it

    def rank(self, symbol):
        """How surely it is one of a quantity, as of `match_rank`."""
        return match_rank(self.name, symbol)

    def has(self, word):
        """Whether its name has one of the `WORDS`."""
        return bool(WORDS[word].search(spaced(self.name)))


class Table(NamedTuple):
    """The contents of a file before they are interpreted: columns, maybe of different lengths."""

    columns: list[Column]
    lines: np.ndarray | None = None  # number of the line of each row of a text, from 1 on
    unread: tuple[str, ...] = ()  # titles of arrays that hold no real numbers
    text_of: Callable[[int, int], str] | None = None  # of a cell, by the numbers of line and column
    name: str = ""  # of the file

    @property
    def titles(self):
        """list of the columns' titles, which may repeat."""
        return [column.title for column in self.columns]

    def unread_text(self):
        """The end of a sentence on what the file has beside columns of numbers; "" for nothing."""
        return f" (no real numbers, so not read: {name_list(self.unread)})" if self.unread else ""

    def row_label(self, row):
        """How a person finds a row (counted from 0 on) in the file: "line 17"."""
        return f"row {row + 1}" if self.lines is None else f"line {self.lines[row]}"

    def cell(self, row, column):
        """A cell that is not a number as a message shows it, in quotes; "nothing" if empty."""
        place = next((i for i, one in enumerate(self.columns) if one.values is column.values), None)
        if self.text_of is None or self.lines is None or place is None:
            return quoted(str(column.values[row]))
        text = self.text_of(int(self.lines[row]), place)
        return quoted(text) if text else "nothing"


def quoted(text):
    """A text out of a file, as a message shows it: in quotes, on one line, `LONGEST` at most."""
    return repr(text if len(text) <= LONGEST else text[: LONGEST - 3] + "...")


def name_list(names):
    """Names, quoted, as a message lists them: the first `MOST`, and how many more there are."""
    more = [f"{len(names) - MOST} more"] if len(names) > MOST else []
    return ", ".join([*map(quoted, names[:MOST]), *more])


def check_requests(columns, units):
    """ParameterError unless these are dicts of columns and of units (not read yet) by symbol."""
    symbols = ", ".join(PATTERNS)
    if not isinstance(columns, dict) or not columns.keys() <= PATTERNS.keys():
        given = f" (given {name_list([*map(str, columns)])})" if isinstance(columns, dict) else ""
        raise sentences.refusal("columns.symbols", symbols=symbols, given=given)
    sound = isinstance(units, dict) and all(isinstance(unit, str) for unit in units.values())
    if not sound or not units.keys() <= PATTERNS.keys():
        raise sentences.refusal("units.type", units=units, symbols=symbols)


def choose_columns(table, columns, constants=()):
    """dict symbol -> index of its column, from 0: as requested, and of others by their names.

    columns : dict symbol -> title or number from 1 on; one column may be requested twice
    constants : symbols for which no column is looked for

    A symbol of `PATTERNS` that is not needed may be absent.  ParameterError: a request that fits no
    column or several, a needed column that is missing or ambiguous.
    """
    chosen = {
        symbol: requested_column(table, symbol, request) for symbol, request in columns.items()
    }
    for symbol in PATTERNS:
        replaced = symbol in INSTEAD and INSTEAD[symbol] <= chosen.keys()
        if replaced or symbol in chosen or symbol in constants:
            continue
        pore_pressure = symbol == "pore_pressure"
        # it is to be subtracted from a total stress whose column was not requested
        of_total = "sigma" in chosen and "sigma" not in columns and not _is_effective(table, chosen)
        if pore_pressure and not of_total:
            continue
        # stresses are optional where friction is recorded
        needed = symbol not in ("tau", "sigma") or "friction" not in chosen
        index = column_by_name(table, symbol, chosen.values(), needed)
        if index is not None and not (pore_pressure and table.columns[index].has("excess")):
            chosen[symbol] = index
    for need, ways in NEEDS.items():
        if not {*chosen, *constants} & set(ways):
            values = {"need": need, "symbol": ways[0]}
            values["columns"] = name_list(table.titles) + table.unread_text()
            column = _column_of_unit(table, ways[0], chosen.values())
            such = "such as" if column else "in"
            raise sentences.refusal("columns.missing", such=such, column=column or "...", **values)
    return chosen


def _is_effective(table, chosen):
    return "sigma" in chosen and table.columns[chosen["sigma"]].rank("sigma") == 0


def title_warnings(table, chosen, requested, constants=()):
    """Notes (list of str) on columns whose titles leave open whether they are what was looked for.

    chosen, constants : as of `choose_columns`
    requested : symbols of the columns that the caller named
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
            known = column.rank("pore_pressure") is not None or column.has("pressure")
            if known and i not in chosen.values():
                excess = column.has("excess")
                name = "notes.excess_pressure" if excess else "notes.pore_pressure"
                notes.append(sentences(name, title=quoted(column.title)))
    return notes


def requested_column(table, symbol, request):
    """Index of the column that was requested by title or number."""
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
            same = [i for i, name in enumerate(names) if spelling(name) == spelling(request)]
            if len(same) == 1:
                return same[0]
            if same:
                numbers = ", ".join(str(i + 1) for i in same)
                raise sentences.refusal(
                    "columns.several", count=len(same), numbers=numbers, **values
                )
    near = nearest(request, titles) or nearest(request, [column.name for column in table.columns])
    meant = f"; did you mean {quoted(near)}?" if near else ""
    raise sentences.refusal("columns.unknown", meant=meant, **values)


def column_by_name(table, symbol, taken, needed=False):
    """Index of the one column, not in `taken`, whose name fits best; None if no name fits.

    Several that fit equally well: None, or a ParameterError if the column is needed.
    """
    ranks = {
        i: rank
        for i, column in enumerate(table.columns)
        if i not in taken and (rank := column.rank(symbol)) is not None
    }
    same = [i for i, rank in ranks.items() if rank == min(ranks.values())]
    if len(same) > 1 and needed:
        titles, first = name_list([table.titles[i] for i in same]), _reference(table, same[0])
        raise sentences.refusal("columns.ambiguous", symbol=symbol, titles=titles, column=first)
    return same[0] if len(same) == 1 else None


def _column_of_unit(table, symbol, taken):
    """The one free column with a unit of this quantity, as a call names it; else ""."""
    same = []
    for i, column in enumerate(table.columns):
        other = TABLE["quantities"][symbol].get("moves") and column.has("elsewhere")
        if i not in taken and not other:
            with contextlib.suppress(ParameterError):
                unit_of(column, symbol, {})
                same.append(i)
    return _reference(table, same[0]) if len(same) == 1 else ""


def _reference(table, index):
    """A column as a call names it: by its title, or by number if the title is not unique."""
    title = table.titles[index]
    return quoted(title) if table.titles.count(title) == 1 else str(index + 1)


def unit_of(column, symbol, units):
    """The unit of a column as `to_si` reads it: that in `units`, else that beside it in the file.

    Friction without any has "1".  ParameterError: there is none, or it is no unit of the symbol.
    """
    unit = plain(units.get(symbol, column.unit))
    if not unit and symbol == "friction" and symbol not in units:
        return "1"
    names = {"title": quoted(column.title), "symbol": symbol, "like": LIKE[symbol]}
    if not unit:
        raise sentences.refusal("units.none", **names)
    if column.other_unit and symbol not in units and not _is_same(unit, column.other_unit, symbol):
        raise sentences.refusal(
            "units.contradiction", unit=unit, other=plain(column.other_unit), **names
        )
    try:
        to_si(symbol, f"1 {unit}", bound="")
    except ParameterError as error:
        what = str(error).rpartition("; expected")[0] or str(error)
        what = what.removeprefix(f"{symbol} = {f'1 {unit}'!r} ")
        where = f"units: {symbol} =" if symbol in units else "the unit"
        other = "" if OF_WHOLE_CONTACT in what else ", or name another column in columns"
        names |= {"unit": unit, "what": what}
        raise sentences.refusal("units.kind", where=where, other=other, **names) from None
    return unit


def _is_same(unit, other, symbol):
    si = QUANTITIES[symbol].unit
    with contextlib.suppress(ValueError):
        return unit_factor(si, unit) == unit_factor(si, plain(other))
    return False


def newtons(column, symbol, units):
    """How many newtons the unit of a column is, None if it is not a unit of force."""
    with contextlib.suppress(ValueError):
        unit = plain(units.get(symbol, column.unit))
        return float(unit_factor("N", WEIGHTS.get(unit, unit)))
    return None
