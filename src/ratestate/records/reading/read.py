"""Files of a laboratory as a record: `read_lab`, and an attempt at one for a page."""

import warnings
from typing import Any, NamedTuple

from ...errors import ParameterError, RecordWarning
from ...model.names import keywords_checked
from ..kit.processes import read_isolated
from ..messages import reading as sentences
from .columns import choose_columns
from .lab_format import LabFormat, lab_format
from .open_table import as_file, open_table
from .record import build_record
from .rows import MAX_ROWS


@keywords_checked
def read_lab(
    path,
    columns=None,
    units=None,
    *,
    time=None,
    displacement=None,
    sigma=None,
    rows=MAX_ROWS,
    join="auto",
    format=None,  # noqa: A002 (as --format is called)
):
    """Read a record of a friction experiment, and find the steps and holds in it.

    Parameters
    ----------
    path : str, pathlib.Path or binary file, or a list of these
        A file, or one that is open for reading, such as an `io.BytesIO`, which is read to its end:
        text with columns between tabs, commas, semicolons or spaces, with a header or without;
        HDF5 (NetCDF 4 as well); or MAT.  The latter two are read by a process of their own (some
        0.3 s), for damaged ones may end the process that reads them, or fill the memory.
        Several files of one experiment, in the order of their times, are joined: the columns that
        all have, in whatever units.
    columns : dict, optional
        Which column is which, where their names do not decide: some of ``time``, ``delta_lp``
        (displacement of the load point), ``V_load`` (its velocity), ``friction``, ``tau``,
        ``sigma`` and ``pore_pressure``, each with a title of the file or a number from 1 on, as in
        ``{"time": "Time(s)", "delta_lp": 2}``.  The pore pressure is subtracted from ``sigma``.  If
        its column is found by its title, it is not if that of ``sigma`` is given here, or titled
        as effective.
    units : dict, optional
        Units in place of those in the file, as in ``{"delta_lp": "um"}``.
    time, displacement : pair, optional
        Window, as in ``time=("11640 s", "11720 s")`` or ``displacement=("8600 um", None)``; plain
        numbers are SI, and the file's own values are meant.
    sigma : float, str or pint.Quantity, optional
        Normal stress [Pa] where it was constant and not recorded, as in ``"20 MPa"``.
    rows : int, default 1_000_000
        Most rows that are kept (and about as many if there are many gaps).  Of more, means over
        blocks of neighbours are taken, which a warning reports.  None keeps all.
    join : {"auto", "absolute", "restart"}, default "auto"
        Of several files: whether times go on from file to file, or begin anew in each, which then
        follows the one before it by one step of time.  "auto": the latter if all begin at 0.
    format : str or pathlib.Path, optional
        A description of the laboratory's files, as `ratestate.lab.describe` writes it.  What is
        given here goes first.

    Returns
    -------
    xarray.Dataset
        Along ``time`` [s]: ``friction`` (tau/sigma where only these were recorded), ``delta_lp``
        [m] or ``V_load`` [m/s], and ``tau`` and ``sigma`` [Pa] if they were recorded.  Along
        ``segment`` the load point's constant speeds: ``segment_t`` [s], when each begins (the first
        with the record, the others at steps), ``segment_V`` [m/s] (0 in a hold), and their standard
        errors ``segment_t_error`` and ``segment_V_error``.  The
        attribute ``found`` is a text on steps and holds, ``notes`` (a JSON list) has what was left
        out or looks odd, by row, ``columns`` (JSON) the source of each variable, and ``machine``
        (JSON) the stiffness K and the mass M of the format, if it has them.

    Raises
    ------
    ParameterError
        A file that cannot be read; a second header with other columns; a column that is missing,
        ambiguous, dead, mostly empty, without a unit, with two units that contradict each other,
        or of a size that its unit makes impossible; times that run backwards, or overlap between
        files; too few rows; a format with keys or values that mean nothing.

    Warns
    -----
    RecordWarning
        Rows were left out (no number, or one that nobody can have measured), there is a gap, or
        columns do not agree; the message names the rows.  Rows were averaged.  A title leaves open
        what it means; a pore pressure was subtracted, or was not; friction is a ratio of forces;
        values have a size that few experiments have.

    Examples
    --------
    >>> data = read_lab("p1234.txt", time=("11640 s", "11720 s"))  # doctest: +SKIP
    >>> data.attrs["found"]  # doctest: +SKIP
    'velocity step 3.00 -> 10.0 um/s at 11676.4 s (8710 um)'
    """
    lab = lab_format(format).with_arguments(columns, units, sigma)
    paths = path if isinstance(path, list | tuple) else [path]
    if not paths:
        raise sentences.refusal("join.none")
    tables = [lab.open(as_file(one)) for one in paths]
    windows = {"time": time, "displacement": displacement}
    data, messages = build_record(tables, lab, **windows, rows=rows, join=join)
    for text in messages:
        warnings.warn(f"{data.attrs['source']}: {text}", RecordWarning, stacklevel=3)
    return data


class Attempt(NamedTuple):
    """What a file has, and the record in it or why there is none."""

    columns: list[tuple[str, str]]  # title and unit of each, "" for none; [] if it has no table
    chosen: dict[str, int]  # symbol -> number of its column, from 1; {} if that is not clear
    record: Any  # the Dataset of `read_lab`, or None
    error: ParameterError | None  # why there is no record


def try_reading(file, choices, seconds, stop):
    """The `Attempt` at a `MemoryFile`, in a process of its own, of which no file is written.

    choices : dict, keyword arguments of `read_lab`
    seconds, stop : as of `read_isolated`
    """
    try:
        return read_isolated(_try_reading, file, "a record", choices, seconds=seconds, stop=stop)
    except ParameterError as error:
        return Attempt([], {}, None, error)


def _try_reading(file, choices):
    columns, chosen = [], {}
    try:
        table = open_table(file)
        columns = [(column.title, column.unit) for column in table.columns]
        lab = LabFormat().with_arguments(choices.pop("columns", None), choices.pop("units", None))
        chosen = {s: i + 1 for s, i in choose_columns(table, lab.columns).items()}
        record, _ = build_record([table], lab, **choices)
    except ParameterError as error:
        return Attempt(columns, chosen, None, error)
    return Attempt(columns, chosen, record, None)
