"""Which column of a file is which quantity, by its name."""

import re

from ...errors import ParameterError
from .suggested import OTHERS, likely, named
from .table import listed, nearest, shown
from .titles import letters

_POINT = r"(?:lp|loadpoint|loadingpoint|loadpt|ram|loading|load|actuator|piston|drive|driver)"
_MOVED = r"(?:disp|displ|displacement|position|pos|dist|distance)"

#: symbol -> patterns of the letters of a name, the surest first
PATTERNS = {
    "time": (
        r"(?:t|time|times)",
        r"(?:elapsed|test|exp|experiment|run|rec|record|sample|lab|total|rel|relative)time"
        r"|time(?:stamp|elapsed|column)?|secs?|seconds?|tsec",
    ),
    "delta_lp": (
        rf"{OTHERS}.*{_POINT}.*{_MOVED}.*|{OTHERS}.*{_MOVED}.*(?:lp|loadpoint)"
        rf"|deltalp|ulp|xlp|dlp|lp|loadpoint",
        rf"{OTHERS}(?:shear|total|cumulative|cum)?{_MOVED}s?(?:shear|mm|um)?",
        rf"{OTHERS}.*{_MOVED}.*",
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


def found(table, columns):
    """Symbol -> index of its column, for those that were asked for and those that names tell.

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
        given = "" if not isinstance(columns, dict) else f" (given {listed(map(str, columns))})"
        raise ParameterError(
            f"columns must name some of {', '.join(PATTERNS)}{given}, such as "
            f"columns={{'time': 'Time(s)', 'delta_lp': 2}}"
        )
    chosen = {symbol: _asked(table, symbol, asked) for symbol, asked in columns.items()}
    taken = set(chosen.values())
    for symbol in PATTERNS:
        if symbol in chosen or _spared(symbol, chosen):
            continue
        # beside friction, stresses are welcome but not needed
        needed = symbol not in ("tau", "sigma") or "friction" not in chosen
        index = _recognised(table, symbol, taken, needed)
        if index is not None:
            chosen[symbol] = index
            taken.add(index)
    return _complete(table, chosen)


def _spared(symbol, chosen):
    """Whether other columns stand for this one."""
    instead = {"delta_lp": {"V_load"}, "V_load": {"delta_lp"}, "friction": {"tau", "sigma"}}
    return symbol in instead and instead[symbol] <= set(chosen)


def _complete(table, chosen):
    """The columns, if they are all that a record needs."""
    needs = {
        "time": ["time"],
        "delta_lp or V_load (of the load point)": ["delta_lp", "V_load"],
        "friction, or tau and sigma": ["friction", "tau"],
        "sigma, to go with tau": ["friction", "sigma"],
    }
    for need, ways in needs.items():
        if not set(ways) & set(chosen):
            symbol = ways[-1 if "tau" in need else 0]
            like = likely(table, symbol, set(chosen.values()))
            such = f", such as columns={{'{symbol}': {like}}}"
            such = such if like else f", in columns={{'{symbol}': ...}}"
            raise ParameterError(
                f"no column is known as {need}; the file has {listed(table.titles)}"
                f"{table.not_read()}: say which by title or number{such}"
            )
    return chosen


def beside(table, chosen, symbol):
    """The column of a quantity that was not chosen, by its name; None if there is none."""
    own = [id(column) for column in chosen.values()]
    taken = {i for i, column in enumerate(table.columns) if id(column) in own}
    index = _recognised(table, symbol, taken, needed=False)
    return None if index is None else table.columns[index]


def _asked(table, symbol, asked):
    """Index of the column that was asked for by title or number."""
    titles = table.titles
    if isinstance(asked, int) and not isinstance(asked, bool):
        if 1 <= asked <= len(titles):
            return asked - 1
        raise ParameterError(
            f"columns: {symbol} = {asked} is no column; give a number from 1 to {len(titles)}"
        )
    if not isinstance(asked, str):
        raise ParameterError(
            f"columns: {symbol} = {asked!r} is neither a title nor a number; give one of "
            f"{listed(titles)}"
        )
    ways = [titles, [column.name for column in table.columns]]
    ways += [[letters(name) for name in way] for way in ways]
    for way, wanted in zip(ways, [asked] * 2 + [letters(asked)] * 2, strict=True):
        same = [i for i, name in enumerate(way) if name == wanted]
        if len(same) == 1:
            return same[0]
        if same:
            raise ParameterError(
                f"columns: {symbol} = {shown(asked)} is the name of {len(same)} columns, numbers "
                f"{', '.join(str(i + 1) for i in same)}; give the number"
            )
    raise ParameterError(
        f"columns: {symbol} = {shown(asked)} is no column; expected one of {listed(titles)}"
        f"{nearest(asked, titles)}"
    )


def known(name, patterns):
    """Which of the patterns fits the letters of a name first, None if none does."""
    fits = (rank for rank, pattern in enumerate(patterns) if re.fullmatch(pattern, name))
    return next(fits, None)


def _recognised(table, symbol, taken, needed):
    """Index of the one column that has such a name, None if there is none.

    Several as sure as each other are an error where the column is needed, else left out.
    """
    sure = {
        i: known(letters(column.name), PATTERNS[symbol])
        for i, column in enumerate(table.columns)
        if i not in taken
    }
    for rank in range(len(PATTERNS[symbol])):
        same = [i for i, own in sure.items() if own == rank]
        if len(same) == 1:
            return same[0]
        if same and needed:
            told = listed([table.titles[i] for i in same])
            raise ParameterError(
                f"{symbol} may be any of the columns {told}; say which, such as "
                f"columns={{'{symbol}': {named(table, same[0])}}}"
            )
        if same:
            return None
    return None
