"""Assigns quantities to the columns of a file, by the names of these."""

import contextlib

from ...errors import ParameterError
from ...model.names import nearest
from ..messages import reading as sentences
from .sizes import unit_of
from .table import name_list, quoted
from .titles import CERTAIN, PATTERNS, TABLE, WORDS, letters, match_rank, spaced

#: what a record needs -> columns one of which gives it; a message suggests the first
NEEDS = {
    "time": ["time"],
    "delta_lp or V_load (of the load point)": ["delta_lp", "V_load"],
    "friction, or tau and sigma": ["tau", "friction"],
    "sigma, to go with tau": ["sigma", "friction"],
}
#: symbol -> what replaces it
INSTEAD = {"delta_lp": {"V_load"}, "V_load": {"delta_lp"}, "friction": {"tau", "sigma"}}


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
        if symbol == "pore_pressure" and _is_effective(table, chosen, columns):
            continue
        # stresses are optional where friction is recorded
        needed = symbol not in ("tau", "sigma") or "friction" not in chosen
        index = column_by_name(table, symbol, chosen.values(), needed)
        if index is not None and not _is_excess(table, symbol, index):
            chosen[symbol] = index
    for need, ways in NEEDS.items():
        if not {*chosen, *constants} & set(ways):
            values = {"need": need, "symbol": ways[0]}
            values["columns"] = name_list(table.titles) + table.unread_text()
            column = _column_of_unit(table, ways[0], chosen.values())
            such = "such as" if column else "in"
            raise sentences.refusal("columns.missing", such=such, column=column or "...", **values)
    return chosen


def _is_effective(table, chosen, requested):
    """Whether no pore pressure is to be subtracted from sigma: it is effective, or requested."""
    if "sigma" not in chosen or "sigma" in requested:
        return True
    return _rank(table, chosen, "sigma") == 0


def _is_excess(table, symbol, index):
    """Whether a column of pore pressure is counted from an initial one."""
    name = spaced(table.columns[index].name)
    return symbol == "pore_pressure" and bool(WORDS["excess"].search(name))


def _rank(table, chosen, symbol):
    return match_rank(table.columns[chosen[symbol]].name, symbol)


def title_warnings(table, chosen, requested, constants=()):
    """Notes (list of str) on columns whose titles leave open whether they are what was looked for.

    chosen, constants : as of `choose_columns`
    requested : symbols of the columns that the caller named
    """
    notes = []
    for symbol, index in chosen.items():
        title = quoted(table.titles[index])
        if symbol in requested:
            continue
        if _rank(table, chosen, symbol) >= CERTAIN[symbol]:
            notes.append(sentences("notes.perhaps", symbol=symbol, title=title))
        if symbol == "pore_pressure":
            sigma = quoted(table.titles[chosen["sigma"]])
            notes.append(sentences("notes.effective", title=title, sigma=sigma))
    if "pore_pressure" not in chosen and {"sigma"} & {*chosen, *constants}:
        effective = "sigma" in chosen and _rank(table, chosen, "sigma") == 0
        for i, column in enumerate(table.columns):
            free = i not in chosen.values() and not effective
            known = match_rank(column.name, "pore_pressure") is not None
            if free and (known or WORDS["pressure"].search(spaced(column.name))):
                excess = _is_excess(table, "pore_pressure", i)
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
        if i not in taken and (rank := match_rank(column.name, symbol)) is not None
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
        moves = TABLE["quantities"][symbol].get("moves")
        others = moves and WORDS["elsewhere"].search(spaced(column.name))
        if i not in taken and not others:
            with contextlib.suppress(ParameterError):
                unit_of(column, symbol, {})
                same.append(i)
    return _reference(table, same[0]) if len(same) == 1 else ""


def _reference(table, index):
    """A column as a call names it: by its title, or by number if the title is not unique."""
    title = table.titles[index]
    return quoted(title) if table.titles.count(title) == 1 else str(index + 1)
