"""Build a record, with the load point's history, from the tables of one or several files."""

import itertools
import json

import numpy as np

from ...errors import ParameterError
from ...model.quantities import attrs, readable
from ...model.units import is_integer
from ..load_point.segments import segments_from
from ..load_point.stress_steps import stress_steps
from ..messages import reading as sentences
from .columns import (
    REQUIRED,
    Column,
    choose_columns,
    column_by_name,
    newtons,
    quoted,
    title_warnings,
    unit_of,
)
from .rows import (
    MAX_ROWS,
    MIN_LIMIT,
    Rows,
    block_means,
    block_starts,
    downsample,
    parse_window,
)
from .sizes import check_sizes, constant_in_si, in_si, size_warnings
from .values import (
    coarse_resolution,
    contradictions,
    drop_codes,
    drop_dropouts,
    drop_impossible,
    flip_signs,
)

#: options of `join`: how the times of files follow each other
JOINS = ("auto", "absolute", "restart")
#: latest first time, in time steps, of a clock that restarts at 0
NEAR_ZERO = 1.5
#: least backward move of a displacement that was set to 0 again, as a multiple of the largest step
ZEROED = 3.0


def build_record(tables, lab, *, time=None, displacement=None, max_rows=MAX_ROWS, join="auto"):
    """Build the Dataset that `read_lab` returns from tables; return it and warnings (list).

    tables : list of `Table`
    lab : `LabFormat`, combined with the arguments of the call

    Other arguments and errors are as for `read_lab`.
    """
    if max_rows is not None and not (is_integer(max_rows) and max_rows >= MIN_LIMIT):
        raise sentences.refusal("rows.most", rows=max_rows, fewest=MIN_LIMIT, most=MAX_ROWS)
    if join not in JOINS:
        raise sentences.refusal("join.unknown", join=join, ways=", ".join(map(repr, JOINS)))
    constants = {s: constant_in_si(s, value) for s, value in lab.constants.items()}
    given = {"time": (time, "time"), "delta_lp": (displacement, "displacement")}
    windows = {s: parse_window(s, *window) for s, window in given.items() if window[0] is not None}
    parts = [_read_rows(table, lab, constants) for table in tables]
    rows, join_notes = _join_files([part for part, _ in parts], join, constants)
    file_notes = [note for _, notes in parts for note in notes] + join_notes
    sources = {s: {"title": rows.columns[s].title, "unit": rows.units[s]} for s in rows.record}
    flipped, minor = _prepare(rows, windows, lab, constants)
    downsample(rows, max_rows)
    record = rows.record
    segments = _find_segments(record, rows.gaps)
    coarse = coarse_resolution(record, segments)
    is_fine = "sigma" in record and not coarse
    stress = stress_steps(record["time"], record["sigma"]) if is_fine else []
    if segments.V.size == 1 and not stress:
        minor.append(sentences("notes.no_step"))
    messages = rows.warnings + file_notes + size_warnings(record, segments.V)
    messages += contradictions(rows, coarse)
    data = _dataset(record, segments)
    data.attrs = {
        "title": "ratestate read_lab",
        "found": coarse or segments.describe(record["time"], record.get("delta_lp"), stress),
        "source": ", ".join(table.name for table in tables),
        "columns": json.dumps(
            {
                s: source | ({"sign": -1} if s in flipped else {})
                for s, source in sources.items()
                if s in record or s == "pore_pressure"
            }
        ),
        "notes": json.dumps([*messages, *minor, *segments.notes]),
    }
    if lab.machine:
        data.attrs["machine"] = json.dumps(lab.machine)
    return data, messages


def _prepare(rows, windows, lab, constants):
    """Leave out unusable `Rows`, and turn signs; return the turned symbols and notes (lists)."""
    rows.apply_windows(windows)
    rows.drop_unreadable()
    drop_codes(rows)
    rows.check_order()
    rows.check_enough()
    for symbol in rows.record:
        check_sizes(symbol, rows.record[symbol], rows.columns[symbol], rows.units[symbol])
    drop_dropouts(rows, "delta_lp", "V_load")  # else zeros at the end look like a backward motion
    flipped, notes = flip_signs(rows.record, lab.signs)
    for symbol, value in constants.items():
        rows.record[symbol] = np.full(rows.kept.size, value)
    pore_pressure = rows.record.pop("pore_pressure", 0.0)
    if "sigma" in rows.record:
        rows.record["sigma"] = rows.record["sigma"] - pore_pressure
    notes += drop_impossible(rows)
    rows.find_gaps()
    return flipped, notes


def _read_rows(table, lab, constants):
    """Return all `Rows` of the chosen columns of a table, in SI, and notes (list of str).

    constants : symbol -> constant [SI] that replaces a column
    """
    places = choose_columns(table, lab.columns, constants)
    chosen, units = {symbol: table.columns[i] for symbol, i in places.items()}, lab.units
    notes = title_warnings(table, places, lab.columns, constants)
    if ratio := _ratio_of_forces(chosen, units):
        notes.append(sentences("notes.forces", title=ratio.title))
        chosen, units = (
            {s: x for s, x in part.items() if s not in ("tau", "sigma")} for part in (chosen, units)
        )
        chosen["friction"] = ratio
    if unused := units.keys() - chosen.keys():
        symbols = ", ".join(sorted(unused))
        raise sentences.refusal("units.unused", symbols=symbols, chosen=", ".join(chosen))
    rows = Rows([(0, table, chosen)], {symbol: c.values for symbol, c in chosen.items()})
    rows.check_numbers()
    for symbol, column in chosen.items():
        stress = symbol in ("tau", "sigma")
        optional = stress and "friction" in chosen and symbol not in lab.columns
        try:
            rows.units[symbol] = unit_of(column, symbol, units)
        except ParameterError as error:
            if not optional:
                raise
            notes.append(f"{symbol} is left out: {error}")
            del rows.record[symbol]
    if len({values.size for values in rows.record.values()}) > 1:
        sizes = ", ".join(f"{quoted(chosen[s].title)} has {x.size}" for s, x in rows.record.items())
        raise sentences.refusal("column.lengths", sizes=sizes)
    rows.record = {s: in_si(s, values, rows.units[s]) for s, values in rows.record.items()}
    for symbol, value in constants.items():
        if (index := column_by_name(table, symbol, ())) is not None:
            values = {"sigma": readable(symbol, value), "title": quoted(table.titles[index])}
            notes.append(sentences("notes.constant_sigma", **values))
    return rows, notes


def _ratio_of_forces(chosen, units):
    """Return friction as a `Column` if it is missing and both stresses are forces; else None."""
    if "friction" in chosen or not {"tau", "sigma"} <= chosen.keys() or "pore_pressure" in chosen:
        return None
    shear, normal = chosen["tau"], chosen["sigma"]
    in_newtons = newtons(shear, "tau", units), newtons(normal, "sigma", units)
    if None in in_newtons or shear.values.size != normal.values.size:
        return None
    with np.errstate(divide="ignore", invalid="ignore"):
        values = shear.values * in_newtons[0] / (normal.values * in_newtons[1])
    title = f"{shear.title} / {normal.title}"
    return Column(title, title, "1", values)


def _find_segments(record, gaps):
    """Return the `Segments` of a record, from block means if the record is very long."""
    columns = {s: record[s] for s in ("time", "delta_lp", "V_load") if s in record}
    if columns["time"].size > MAX_ROWS:
        starts, _ = block_starts(columns["time"].size, gaps, MAX_ROWS)
        columns = {s: block_means(values, starts) for s, values in columns.items()}
    return segments_from(columns["time"], columns)._replace(end=float(record["time"][-1]))


def _dataset(record, segments):
    import xarray

    order = [s for s in ("friction", "delta_lp", "V_load", "tau", "sigma") if s in record]
    variables = {s: ("time", record[s], attrs(s)) for s in order}
    for name in ("t", "V", "t_error", "V_error"):
        label = f"segment_{name}"
        variables[label] = ("segment", getattr(segments, name), attrs(label))
    return xarray.Dataset(variables, coords={"time": ("time", record["time"], attrs("time"))})


def _join_files(parts, join, constants):
    """Join the `Rows` of all files; return them and notes (list of str).

    parts : list of the complete `Rows` of each file
    join : as for `read_lab`
    constants : symbols that need no column

    ParameterError if a file lacks a required column, or if times overlap.
    """
    if len(parts) == 1:
        return parts[0], []
    symbols, notes = _common_symbols(parts, constants)
    pieces = {s: [part.record[s] for part in parts] for s in symbols}
    times = pieces["time"]
    from_zero = all(0.0 <= _end_values(t)[0] <= NEAR_ZERO * _typical_step(t) for t in times)
    for i, (before, after) in enumerate(itertools.pairwise(parts)):
        end, begin = _end_values(times[i])[1], _end_values(times[i + 1])[0]
        names = {"before": before.name, "after": after.name}
        if join == "restart" or (join == "auto" and from_zero):
            added = end + _typical_step(times[i + 1]) - begin
            times[i + 1] = times[i + 1] + added
            notes.append(sentences("notes.restart", added=added, **names))
            if "delta_lp" in pieces and (added := _zeroing_offset(*pieces["delta_lp"][i : i + 2])):
                pieces["delta_lp"][i + 1] = pieces["delta_lp"][i + 1] + added
                notes.append(sentences("notes.zeroed", added=added, **names))
        elif begin < end:
            places = {
                "last_row": before.row_label(np.flatnonzero(np.isfinite(times[i]))[-1]),
                "first_row": after.row_label(np.flatnonzero(np.isfinite(times[i + 1]))[0]),
            }
            raise sentences.refusal("join.overlap", end=end, begin=begin, **names, **places)
    starts = np.cumsum([0, *(t.size for t in times)]).tolist()
    files = [(start, *part.files[0][1:]) for start, part in zip(starts, parts, strict=False)]
    rows = Rows(files, {s: np.concatenate(piece) for s, piece in pieces.items()})
    rows.units = parts[0].units
    return rows, notes


def _common_symbols(parts, constants):
    """Return the symbols of all files, and notes on others; ParameterError if one is required."""
    present = dict.fromkeys(symbol for part in parts for symbol in part.record)
    symbols = [s for s in present if all(s in part.record for part in parts)]
    notes = []
    for symbol in [s for s in present if s not in symbols]:
        name = next(part.name for part in parts if symbol in part.record)
        name_without = next(part.name for part in parts if symbol not in part.record)
        values = {"symbol": symbol, "name": name, "lacking": name_without}
        if not all({*ways} & {*symbols, *constants} for ways in REQUIRED.values()):
            raise sentences.refusal("join.columns", **values)
        notes.append(sentences("notes.not_in_all", **values))
    return symbols, notes


def _end_values(values):
    finite = values[np.isfinite(values)]
    return float(finite[0]), float(finite[-1])


def _typical_step(t):
    """Return the median of the positive time steps; 0 if there is none."""
    steps = np.diff(t[np.isfinite(t)])
    return float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0


def _zeroing_offset(before, after):
    """Return the offset of a displacement that was set to 0 between files; 0 if it was not."""
    (begin, end), (next_, last) = _end_values(before), _end_values(after)
    steps = np.concatenate([np.abs(np.diff(x[np.isfinite(x)])) for x in (before, after)])
    reversal = (end - next_) * np.sign(end - begin + last - next_)
    return end - next_ if reversal > ZEROED * steps.max(initial=0.0) else 0.0
