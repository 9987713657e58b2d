"""Assigns quantities to the columns of a file, by the names of these."""

import re

from ...errors import ParameterError
from .suggestions import NOT_OTHERS, column_reference, suggested_column
from .table import name_list, quoted, suggest_name
from .titles import letters

_POINT = r"(?:lp|loadpoint|loadingpoint|loadpt|ram|loading|load|actuator|piston|drive|driver)"
_MOVED = r"(?:disp|displ|displacement|position|pos|dist|distance)"

#: symbol -> patterns of the letters of a name, the most certain first
PATTERNS = {
    "time": (
        r"(?:t|time|times)",
        r"(?:elapsed|test|exp|experiment|run|rec|record|sample|lab|total|rel|relative)time"
        r"|time(?:stamp|elapsed|column)?|secs?|seconds?|tsec",
    ),
    "delta_lp": (
        rf"{NOT_OTHERS}.*{_POINT}.*{_MOVED}.*|{NOT_OTHERS}.*{_MOVED}.*(?:lp|loadpoint)"
        rf"|deltalp|ulp|xlp|dlp|lp|loadpoint",
        rf"{NOT_OTHERS}(?:shear|total|cumulative|cum)?{_MOVED}s?(?:shear|mm|um)?",
        rf"{NOT_OTHERS}.*{_MOVED}.*",
    ),
    "V_load": (
        rf"vlp|vload|v0?lp|lpv|{_POINT}(?:point)?(?:vel|velocity|speed|rate)"
        r"|(?:vel|velocity|speed)(?:lp|loadpoint)",
        r"(?!.*(?:slip|sample|fault|norm))(?:shear|sliding|imposed|drive|driving|commanded|set)?"
        r"(?:vel|velocity|speed|displacementrate|disprate)s?|v",
    ),
    "friction": (
        r"mu|cof|friction|frictioncoeff?|frictioncoefficient|coefficientoffriction|coeffriction"
        r"|coeffoffriction|frictionalstrength|coefffriction",
        r"(?:apparent|app|meas|measured|corr|corrected|nominal)(?:mu|friction)\w*"
        r"|(?:mu|friction)(?:app|apparent|meas|measured|corr|corrected)?\d?",
        r".*friction.*|mu\w{0,4}",
    ),
    "tau": (
        r"tau|shearstress",
        r"(?!.*(?:strain|disp|vel|rate|modul|stiff)).*shear.*(?:stress|str|trac|traction).*"
        r"|shear|sstress|taus?\w{0,3}|shr?stress",
        r"(?:shear|shr)(?:force|load)",
    ),
    "sigma": (
        r"(?:effective|eff|e)norm(?:al)?(?:stress|str)\w*|sigma(?:n)?eff|effsigman?"
        r"|norm(?:al)?(?:effective|eff)stress|effectivestress",
        r"sigma|sigman|norm(?:al)?stress|nstress|nstr|sn|normalstr|stressnormal",
        r"(?!.*(?:disp|vel|strain)).*norm(?:al)?.*(?:stress|str|trac).*",
        r"(?:normal|norm|n)(?:force|load)",
    ),
}


def choose_columns(table, columns):
    """Symbol -> index of its column: those that were requested, and others by their names.

    Parameters
    ----------
    table : Table
    columns : dict or None
        Symbol -> title (whole, or the name in it), or number from 1 on.

    Raises
    ------
    ParameterError
        An unknown symbol; a column that is not there or is not the only one of its name.
    """
    columns = {} if columns is None else columns
    if not isinstance(columns, dict) or any(symbol not in PATTERNS for symbol in columns):
        given = "" if not isinstance(columns, dict) else f" (given {name_list(map(str, columns))})"
        raise ParameterError(
            f"columns must name some of {', '.join(PATTERNS)}{given}, such as "
            f"columns={{'time': 'Time(s)', 'delta_lp': 2}}"
        )
    chosen = {
        symbol: _requested_column(table, symbol, request) for symbol, request in columns.items()
    }
    taken = set(chosen.values())
    for symbol in PATTERNS:
        if symbol in chosen or _is_replaced(symbol, chosen):
            continue
        # stresses are optional where friction is recorded
        needed = symbol not in ("tau", "sigma") or "friction" not in chosen
        index = _column_by_name(table, symbol, taken, needed)
        if index is not None:
            chosen[symbol] = index
            taken.add(index)
    _check_complete(table, chosen)
    return chosen


def _is_replaced(symbol, chosen):
    """Whether other columns replace this one."""
    instead = {"delta_lp": {"V_load"}, "V_load": {"delta_lp"}, "friction": {"tau", "sigma"}}
    return symbol in instead and instead[symbol] <= set(chosen)


def _check_complete(table, chosen):
    """Refuse columns that are not all that a record needs."""
    needs = {
        "time": ["time"],
        "delta_lp or V_load (of the load point)": ["delta_lp", "V_load"],
        "friction, or tau and sigma": ["friction", "tau"],
        "sigma, to go with tau": ["friction", "sigma"],
    }
    for need, ways in needs.items():
        if not set(ways) & set(chosen):
            symbol = ways[-1 if "tau" in need else 0]
            column = suggested_column(table, symbol, set(chosen.values()))
            example = f", such as columns={{'{symbol}': {column}}}"
            example = example if column else f", in columns={{'{symbol}': ...}}"
            raise ParameterError(
                f"no column is known as {need}; the file has {name_list(table.titles)}"
                f"{table.unread_text()}: say which by title or number{example}"
            )


def other_column(table, chosen, symbol):
    """A column with the name of a quantity that was not chosen; None if there is none."""
    own = [id(column) for column in chosen.values()]
    taken = {i for i, column in enumerate(table.columns) if id(column) in own}
    index = _column_by_name(table, symbol, taken, needed=False)
    return None if index is None else table.columns[index]


def _requested_column(table, symbol, request):
    """Index of the column that was requested by title or number."""
    titles = table.titles
    if isinstance(request, int) and not isinstance(request, bool):
        if 1 <= request <= len(titles):
            return request - 1
        raise ParameterError(
            f"columns: {symbol} = {request} is no column; give a number from 1 to {len(titles)}"
        )
    if not isinstance(request, str):
        raise ParameterError(
            f"columns: {symbol} = {request!r} is neither a title nor a number; give one of "
            f"{name_list(titles)}"
        )
    ways = [titles, [column.name for column in table.columns]]
    ways += [[letters(name) for name in way] for way in ways]
    for way, wanted in zip(ways, [request] * 2 + [letters(request)] * 2, strict=True):
        same = [i for i, name in enumerate(way) if name == wanted]
        if len(same) == 1:
            return same[0]
        if same:
            raise ParameterError(
                f"columns: {symbol} = {quoted(request)} is the name of {len(same)} columns, "
                f"numbers {', '.join(str(i + 1) for i in same)}; give the number"
            )
    raise ParameterError(
        f"columns: {symbol} = {quoted(request)} is no column; expected one of {name_list(titles)}"
        f"{suggest_name(request, titles)}"
    )


def match_rank(name, patterns):
    """Index of the first pattern that matches the letters of a name, None if none does."""
    ranks = (rank for rank, pattern in enumerate(patterns) if re.fullmatch(pattern, name))
    return next(ranks, None)


def _column_by_name(table, symbol, taken, needed):
    """Index of the one column that has such a name, None if there is none.

    Several that match equally well are an error where the column is needed, else left out.
    """
    ranks = {
        i: match_rank(letters(column.name), PATTERNS[symbol])
        for i, column in enumerate(table.columns)
        if i not in taken
    }
    for rank in range(len(PATTERNS[symbol])):
        same = [i for i, own in ranks.items() if own == rank]
        if len(same) == 1:
            return same[0]
        if same and needed:
            candidates = name_list([table.titles[i] for i in same])
            raise ParameterError(
                f"{symbol} may be any of the columns {candidates}; say which, such as "
                f"columns={{'{symbol}': {column_reference(table, same[0])}}}"
            )
        if same:
            return None
    return None
