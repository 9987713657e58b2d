"""From tables to a record: which columns, which rows, and the load point's history in them."""

import json

import numpy as np

from ...errors import ParameterError
from ...model.quantities import attrs, readable
from ..load_point.segments import segments_from_displacement, segments_from_velocity
from ..load_point.stress_steps import stress_steps
from ..messages import reading as sentences
from .columns import (
    Column,
    choose_columns,
    column_by_name,
    newtons,
    quoted,
    title_warnings,
    unit_of,
)
from .joining import check_join, join_parts
from .rows import MOST, Rows, blocks, checked_most, downsample, means, window
from .sizes import check_sizes, constant_in_si, in_si, unusual
from .values import (
    coarse_resolution,
    disagreements,
    drop_codes,
    drop_dropouts,
    drop_impossible,
    flip_signs,
)


def record_of(tables, lab, *, time=None, displacement=None, rows=MOST, join="auto"):
    """The Dataset that `read_lab` makes of tables, and a list of what it warns of.

    tables : list of `Table`
    lab : `LabFormat`, with what a call gives; other arguments, and what is raised, as of `read_lab`
    """
    most = checked_most(rows)
    check_join(join)
    constants = {s: constant_in_si(s, value) for s, value in lab.constants.items()}
    given = {"time": (time, "time"), "delta_lp": (displacement, "displacement")}
    windows = {s: window(s, *one) for s, one in given.items() if one[0] is not None}
    parts = [_rows_of(table, lab, constants) for table in tables]
    kept, of_joining = join_parts([part for part, _ in parts], join, constants)
    of_files = [note for _, notes in parts for note in notes] + of_joining
    sources = {s: {"title": kept.columns[s].title, "unit": kept.units[s]} for s in kept.record}
    turned, minor = _prepare(kept, windows, lab, constants)
    downsample(kept, most)
    record = kept.record
    segments = _segments(record, kept.gaps)
    coarse = coarse_resolution(record, segments)
    is_fine = "sigma" in record and not coarse
    stress = stress_steps(record["time"], record["sigma"]) if is_fine else []
    if segments.V.size == 1 and not stress:
        minor.append(sentences("notes.no_step"))
    messages = kept.warnings + of_files + unusual(record, segments.V)
    messages += disagreements(kept, coarse)
    data = _dataset(record, segments)
    data.attrs = {
        "title": "ratestate read_lab",
        "found": coarse or segments.history(record["time"], record.get("delta_lp"), stress),
        "source": ", ".join(table.name for table in tables),
        "columns": json.dumps(
            {
                s: source | ({"sign": -1} if s in turned else {})
                for s, source in sources.items()
                if s in record or s == "pore_pressure"
            }
        ),
        "notes": json.dumps(messages + minor + segments.notes),
    }
    if lab.machine:
        data.attrs["machine"] = json.dumps(lab.machine)
    return data, messages


def _prepare(kept, windows, lab, constants):
    """Leave out `Rows` that cannot be used, and turn signs: the symbols turned, and notes."""
    kept.cut(windows)
    kept.drop_unreadable()
    drop_codes(kept)
    kept.order()
    kept.check_enough()
    for symbol, values in kept.record.items():
        check_sizes(symbol, values, kept.columns[symbol], kept.units[symbol])
    drop_dropouts(kept, "delta_lp", "V_load")  # else zeros at the end look like a way back
    turned, notes = flip_signs(kept.record, lab.signs)
    for symbol, value in constants.items():
        kept.record[symbol] = np.full(kept.kept.size, value)
    pore_pressure = kept.record.pop("pore_pressure", 0.0)
    if "sigma" in kept.record:
        kept.record["sigma"] = kept.record["sigma"] - pore_pressure
    notes += drop_impossible(kept)
    kept.find_gaps()
    return turned, notes


def _rows_of(table, lab, constants):
    """All `Rows` of the chosen columns of a table, in SI, and notes.

    constants : symbol -> constant [SI] in place of a column
    """
    places = choose_columns(table, lab.columns, constants)
    chosen, units = {symbol: table.columns[i] for symbol, i in places.items()}, lab.units
    notes = title_warnings(table, places, lab.columns, constants)
    if ratio := _ratio_of_forces(chosen, units):
        notes.append(sentences("notes.forces", title=ratio.title))
        chosen, units = (
            {s: x for s, x in one.items() if s not in ("tau", "sigma")} for one in (chosen, units)
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
    """Friction as a `Column`, if it is needed and both stresses are forces; else None."""
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


def _segments(record, gaps):
    """The `FoundSegments` of a record; of a very long one from means over blocks of rows."""
    symbol = "delta_lp" if "delta_lp" in record else "V_load"
    t, x = record["time"], record[symbol]
    if t.size > MOST:
        starts, _ = blocks(t.size, gaps, MOST)
        t, x = means(t, starts), means(x, starts)
    if symbol == "delta_lp":
        return segments_from_displacement(t, x)
    return segments_from_velocity(t, x)


def _dataset(record, segments):
    """The variables, with the load point's history."""
    import xarray

    order = [s for s in ("friction", "delta_lp", "V_load", "tau", "sigma") if s in record]
    variables = {s: ("time", record[s], attrs(s)) for s in order}
    for name in ("t", "V", "t_error", "V_error"):
        label = f"segment_{name}"
        variables[label] = ("segment", getattr(segments, name), attrs(label))
    return xarray.Dataset(variables, coords={"time": ("time", record["time"], attrs("time"))})
