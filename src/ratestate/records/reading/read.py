"""`read_lab`: a laboratory's file as a record."""

import json
import warnings

import numpy as np

from ...errors import ParameterError, RecordWarning
from ...model.quantities import attrs
from .agreement import coarse_resolution, disagreements
from .columns import choose_columns
from .history_text import describe_history
from .open_table import open_table
from .rows import Rows, check_alive, check_numbers
from .segments import segments_from_displacement
from .sizes import check_sizes, checked_units, in_si, unit_of
from .table import quoted
from .values import drop_codes, drop_impossible, flip_negative
from .velocity import segments_from_velocity
from .window import rows_inside, window_ends


def read_lab(path, columns=None, units=None, *, time=None, displacement=None):
    """Read a record of a friction experiment, and find the steps and holds in it.

    Parameters
    ----------
    path : str or pathlib.Path
        Text with columns between tabs, commas, semicolons or spaces, with a header or without;
        HDF5 (NetCDF 4 as well); or MAT.  The latter two are read by a process of their own (some
        0.3 s), for damaged ones may end the process that reads them, or fill the memory.
    columns : dict, optional
        Which column is which, where their names do not decide: some of ``time``, ``delta_lp``
        (displacement of the load point), ``V_load`` (its velocity), ``friction``, ``tau`` and
        ``sigma``, each with a title of the file or a number from 1 on, as in
        ``{"time": "Time(s)", "delta_lp": 2}``.
    units : dict, optional
        Units in place of those in the file, as in ``{"delta_lp": "um"}``.
    time, displacement : pair, optional
        Window, as in ``time=("11640 s", "11720 s")`` or ``displacement=("8600 um", None)``; plain
        numbers are SI, and the file's own values are meant.

    Returns
    -------
    xarray.Dataset
        Along ``time`` [s]: ``friction`` (tau/sigma where only these were recorded), ``delta_lp``
        [m] or ``V_load`` [m/s], and ``tau`` and ``sigma`` [Pa] if they were recorded.  Along
        ``segment``: ``segment_t`` [s], ``segment_V`` [m/s] (0 in a hold) and their standard errors
        ``segment_t_error`` and ``segment_V_error``: the load point's constant speeds.  The
        attribute ``found`` is a text on steps and holds, ``notes`` (a JSON list) has what was left
        out or looks odd, by row, and ``columns`` (JSON) the source of each variable.

    Raises
    ------
    ParameterError
        A file that cannot be read; a column that is missing, ambiguous, dead, without a unit, or of
        a size that its unit makes impossible; times that run backwards; too few rows.

    Warns
    -----
    RecordWarning
        Rows were left out (no number, or one that nobody can have measured), there is a gap, or
        columns do not agree; the message names the rows.

    Examples
    --------
    >>> data = read_lab("p1234.txt", time=("11640 s", "11720 s"))  # doctest: +SKIP
    >>> data.attrs["found"]  # doctest: +SKIP
    'velocity step 3.00 -> 10.0 um/s at 11676.4 s (8710 um)'
    """
    units, windows = checked_units(units), _windows(time, displacement)
    path, table = open_table(path)
    indices = choose_columns(table, columns)
    chosen = {symbol: table.columns[index] for symbol, index in indices.items()}
    if unused := set(units) - set(chosen):
        raise ParameterError(
            f"units: {', '.join(sorted(unused))} is none of the columns that are read "
            f"({', '.join(chosen)}); name it in columns as well"
        )
    for symbol, column in chosen.items():
        check_numbers(table, symbol, column)
    chosen, unit, notes = _with_units(chosen, columns or {}, units)
    _check_lengths(chosen)
    times = in_si("time", chosen["time"].values, unit["time"])
    rows = Rows(table, chosen, times)
    _cut(rows, chosen, unit, windows)
    rows.drop_unreadable()
    drop_codes(rows)
    rows.order()
    rows.check_enough()
    record = {s: in_si(s, c.values[rows.kept], unit[s]) for s, c in chosen.items()}
    for symbol, values in record.items():
        check_alive(symbol, values, chosen[symbol])
        check_sizes(symbol, values, chosen[symbol], unit[symbol])
    flips = flip_negative(record) + _flip_downward(record)
    record = drop_impossible(rows, record)
    rows.find_gaps()
    segments = _history(record)
    messages = rows.warnings + notes + disagreements(table, chosen, rows, record, segments)
    for text in messages:
        warnings.warn(f"{path.name}: {text}", RecordWarning, stacklevel=2)
    data = _dataset(record, segments)
    data.attrs["source"] = path.name
    data.attrs["columns"] = json.dumps(
        {s: {"title": c.title, "unit": unit[s]} for s, c in chosen.items()}
    )
    data.attrs["notes"] = json.dumps(messages + flips + segments.notes)
    return data


def _windows(time, displacement):
    """The windows that were given: symbol -> (from, to, name)."""
    given = {"time": (time, "time"), "delta_lp": (displacement, "displacement")}
    windows = {s: (window_ends(s, window, name), name) for s, (window, name) in given.items()}
    return {s: window for s, window in windows.items() if window[0] is not None}


def _with_units(chosen, requested, units):
    """Columns, their units, and notes on optional columns left out for want of a unit."""
    unit, notes = {}, []
    for symbol, column in chosen.items():
        stress = symbol in ("tau", "sigma")
        optional = stress and "friction" in chosen and symbol not in requested
        try:
            unit[symbol] = unit_of(column, symbol, units)
        except ParameterError as error:
            if not optional:
                raise
            notes.append(f"{symbol} is left out: {error}")
    return {symbol: chosen[symbol] for symbol in unit}, unit, notes


def _check_lengths(chosen):
    sizes = {column.values.size for column in chosen.values()}
    if len(sizes) > 1:
        listed = ", ".join(f"{quoted(c.title)} has {c.values.size}" for c in chosen.values())
        raise ParameterError(
            f"the columns have different numbers of rows: {listed}; name those of one record in "
            f"columns"
        )


def _cut(rows, chosen, unit, windows):
    """Keep only the rows in the windows."""
    for symbol, (window, name) in windows.items():
        if symbol not in chosen:
            raise ParameterError(
                "displacement: the record has no column of displacement to choose a window by; "
                "give time=... instead"
            )
        values = in_si(symbol, chosen[symbol].values[rows.kept], unit[symbol])
        first, last = rows_inside(symbol, values, window, name)
        rows.kept = rows.kept[first:last]
    rows.check_enough(" in the window" if windows else "")


def _flip_downward(record):
    """Flip the sign of a load point that moves downwards; notes (list of str) on it."""
    if "delta_lp" in record:
        symbol, x = "delta_lp", record["delta_lp"]
        part = max(1, x.size // 20)
        down = np.median(x[-part:]) < np.median(x[:part])
    else:
        symbol, down = "V_load", np.median(record["V_load"]) < 0.0
    if not down:
        return []
    record[symbol] = -record[symbol]
    return [f"{symbol} runs downwards; its sign is turned"]


def _history(record):
    """The load point's history: `Segments`."""
    if "delta_lp" in record:
        return segments_from_displacement(record["time"], record["delta_lp"])
    return segments_from_velocity(record["time"], record["V_load"])


def _dataset(record, segments):
    """The Dataset, with the load point's history."""
    import xarray

    t = record["time"]
    order = [s for s in ("friction", "delta_lp", "V_load", "tau", "sigma") if s in record]
    variables = {s: ("time", record[s], attrs(s)) for s in order}
    labels = {"segment_t": segments.t, "segment_V": segments.V}
    labels |= {"segment_t_error": segments.t_error, "segment_V_error": segments.V_error}
    variables |= {s: ("segment", values, attrs(s)) for s, values in labels.items()}
    history = coarse_resolution(record, segments) or describe_history(
        segments, t, record.get("delta_lp")
    )
    return xarray.Dataset(
        variables,
        coords={"time": ("time", t, attrs("time"))},
        attrs={"title": "ratestate read_lab", "found": history},
    )
