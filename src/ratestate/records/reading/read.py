"""`read_lab`: a laboratory's file as a record."""

import json
import warnings

from ...errors import ParameterError, RecordWarning
from ...model.quantities import attrs
from .agreement import coarse_resolution, disagreements
from .columns import choose_columns
from .messages import refusal
from .open_table import file_of, open_table
from .rows import Rows, window
from .segments import segments_from_displacement, segments_from_velocity
from .sizes import check_numbers, check_sizes, checked_units, unit_of
from .table import quoted
from .values import drop_codes, drop_impossible, flip_signs


def read_lab(path, columns=None, units=None, *, time=None, displacement=None):
    """Read a record of a friction experiment, and find the steps and holds in it.

    Parameters
    ----------
    path : str, pathlib.Path or binary file
        A file, or one that is open for reading, such as an `io.BytesIO`, which is read to its end:
        text with columns between tabs, commas, semicolons or spaces, with a header or without;
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
        ``segment`` the load point's constant speeds: ``segment_t`` [s], when each begins (the first
        with the record, the others at steps), ``segment_V`` [m/s] (0 in a hold), and their standard
        errors ``segment_t_error`` and ``segment_V_error``.  The
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
    file = file_of(path)
    data, messages = record_of(open_table(file), file.name, columns, units, time, displacement)
    for text in messages:
        warnings.warn(f"{file.name}: {text}", RecordWarning, stacklevel=2)
    return data


def record_of(table, source, columns=None, units=None, time=None, displacement=None):
    """The Dataset that `read_lab` makes of a `Table`, and a list of what it warns of.

    source : name of the file; the other arguments, and what is raised, are those of `read_lab`
    """
    units = checked_units(units)
    given = {"time": (time, "time"), "delta_lp": (displacement, "displacement")}
    windows = {s: window(s, *one) for s, one in given.items() if one[0] is not None}
    chosen = {s: table.columns[i] for s, i in choose_columns(table, columns).items()}
    unit, notes = _units(table, chosen, columns or {}, units)
    chosen = {symbol: chosen[symbol] for symbol in unit}
    if len({column.values.size for column in chosen.values()}) > 1:
        sizes = ", ".join(f"{quoted(c.title)} has {c.values.size}" for c in chosen.values())
        raise refusal("column.lengths", sizes=sizes)
    rows = Rows(table, chosen, unit)
    rows.cut(windows)
    rows.drop_unreadable()
    drop_codes(rows)
    rows.order()
    rows.check_enough()
    for symbol, column in chosen.items():
        check_sizes(symbol, rows.record[symbol], column, unit[symbol])
    flips = flip_signs(rows.record)
    drop_impossible(rows)
    rows.find_gaps()
    record = rows.record
    if "delta_lp" in record:
        segments = segments_from_displacement(record["time"], record["delta_lp"])
    else:
        segments = segments_from_velocity(record["time"], record["V_load"])
    coarse = coarse_resolution(record, segments)
    messages = rows.warnings + notes + disagreements(rows, coarse)
    data = _dataset(record, segments)
    data.attrs = {
        "title": "ratestate read_lab",
        "found": coarse or segments.history(record["time"], record.get("delta_lp")),
        "source": source,
        "columns": json.dumps({s: {"title": c.title, "unit": unit[s]} for s, c in chosen.items()}),
        "notes": json.dumps(messages + flips + segments.notes),
    }
    return data, messages


def _units(table, chosen, requested, units):
    """Units of columns, and notes on optional columns left out for want of one."""
    if unused := units.keys() - chosen.keys():
        raise refusal("units.unused", symbols=", ".join(sorted(unused)), chosen=", ".join(chosen))
    for symbol, column in chosen.items():
        check_numbers(table, symbol, column)
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
    return unit, notes


def _dataset(record, segments):
    """The variables, with the load point's history."""
    import xarray

    order = [s for s in ("friction", "delta_lp", "V_load", "tau", "sigma") if s in record]
    variables = {s: ("time", record[s], attrs(s)) for s in order}
    for name in ("t", "V", "t_error", "V_error"):
        label = f"segment_{name}"
        variables[label] = ("segment", getattr(segments, name), attrs(label))
    return xarray.Dataset(variables, coords={"time": ("time", record["time"], attrs("time"))})
