"""Files of one experiment, one after the other, as one table."""

import itertools

import numpy as np

from ..messages import reading as sentences
from .columns import NEEDS
from .rows import Rows

#: how the times of files may follow each other
JOINS = ("auto", "absolute", "restart")
#: steps of time from 0 within which a clock begins that starts anew
NEAR_ZERO = 1.5
#: least move against the load point's direction, over the largest step, of a sensor set to 0 again
ZEROED = 3.0


def check_join(join):
    """ParameterError for another way to join than those there are."""
    if join not in JOINS:
        raise sentences.refusal("join.unknown", join=join, ways=", ".join(map(repr, JOINS)))


def join_parts(parts, join, constants=()):
    """The `Rows` of all files, and notes (list of str).

    parts : list of the `Rows` of each file, with nothing left out
    join : "absolute", times go on from file to file; "restart", they begin anew in each; "auto",
    the latter if each file begins at 0, else the former
    constants : symbols that are given, and need no column

    ParameterError: a column that another file lacks, or times that overlap.
    """
    first = parts[0]
    if len(parts) == 1:
        return first, []
    symbols, notes = _common_symbols(parts, constants)
    pieces = {s: [part.record[s] for part in parts] for s in symbols}
    if join == "restart" or (join == "auto" and all(map(_begins_at_zero, pieces["time"]))):
        notes += _follow_on(parts, pieces)
    else:
        _check_order(parts, pieces["time"])
    starts = np.cumsum([0, *(t.size for t in pieces["time"])]).tolist()
    files = [(start, *part.files[0][1:]) for start, part in zip(starts, parts, strict=False)]
    rows = Rows(files, {s: np.concatenate(piece) for s, piece in pieces.items()})
    rows.units = first.units
    return rows, notes


def _common_symbols(parts, constants):
    """Symbols that all files have, and notes on others; ParameterError if these are needed."""
    known = dict.fromkeys(symbol for part in parts for symbol in part.record)
    symbols = [s for s in known if all(s in part.record for part in parts)]
    notes = []
    for symbol in [s for s in known if s not in symbols]:
        name = next(part.name for part in parts if symbol in part.record)
        lacking = next(part.name for part in parts if symbol not in part.record)
        values = {"symbol": symbol, "name": name, "lacking": lacking}
        if not all({*ways} & {*symbols, *constants} for ways in NEEDS.values()):
            raise sentences.refusal("join.columns", **values)
        notes.append(sentences("notes.not_in_all", **values))
    return symbols, notes


def _ends(values):
    """The first and the last finite value."""
    finite = values[np.isfinite(values)]
    return float(finite[0]), float(finite[-1])


def _usual_step(t):
    """The usual time between rows; 0 if there is none."""
    steps = np.diff(t[np.isfinite(t)])
    return float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0


def _begins_at_zero(t):
    return 0.0 <= _ends(t)[0] <= NEAR_ZERO * _usual_step(t)


def _check_order(parts, times):
    for (before, t), (after, u) in itertools.pairwise(zip(parts, times, strict=True)):
        end, begin = _ends(t)[1], _ends(u)[0]
        if begin < end:
            last, first = np.flatnonzero(np.isfinite(t))[-1], np.flatnonzero(np.isfinite(u))[0]
            raise sentences.refusal(
                "join.overlap",
                before=before.name,
                after=after.name,
                end=end,
                begin=begin,
                last_row=before.row_label(last),
                first_row=after.row_label(first),
            )


def _follow_on(parts, pieces):
    """Let times of files go on from one to the next, and displacements set to 0 again; notes."""
    notes = []
    for i, (before, after) in enumerate(itertools.pairwise(part.name for part in parts)):
        t, u = pieces["time"][i : i + 2]
        added = _ends(t)[1] + _usual_step(u) - _ends(u)[0]
        pieces["time"][i + 1] = u + added
        notes.append(sentences("notes.restart", added=added, before=before, after=after))
        if "delta_lp" in pieces and (added := _zeroed_by(*pieces["delta_lp"][i : i + 2])):
            pieces["delta_lp"][i + 1] = pieces["delta_lp"][i + 1] + added
            notes.append(sentences("notes.zeroed", added=added, before=before, after=after))
    return notes


def _zeroed_by(before, after):
    """What to add to a displacement that was set to 0 again; 0 if it was not."""
    (begin, end), (next_, last) = _ends(before), _ends(after)
    steps = np.concatenate([np.abs(np.diff(x[np.isfinite(x)])) for x in (before, after)])
    back = (end - next_) * np.sign(end - begin + last - next_)
    return end - next_ if back > ZEROED * steps.max(initial=0.0) else 0.0
