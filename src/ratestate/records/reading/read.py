"""Read the files of a laboratory: `read_lab`, and `try_reading` for programs with a time limit."""

import warnings
from typing import Any, NamedTuple

from ...errors import ParameterError, RecordWarning
from ...model.names import keywords_checked
from ..kit.processes import read_isolated
from ..messages import reading as sentences
from .assembly import build_record
from .columns import choose_columns
from .lab_format import LabFormat, read_lab_format
from .open_table import as_file, open_table
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
    max_rows=MAX_ROWS,
    join="auto",
    lab_format=None,
):
    """Read a record of a friction experiment, and find its steps and holds.

    Parameters
    ----------
    path : str, pathlib.Path or binary file, or a list of these
        A file, or an open binary file such as an `io.BytesIO`, which is read to its end.  The file
        is text with tabs, commas, semicolons or spaces between columns, with or without a header;
        HDF5 (including NetCDF 4); or MAT.  HDF5 and MAT files are read in a separate process (about
        0.3 s), because a damaged file may crash that process or fill its memory.
        Several files of one experiment, in the order of their times, are joined.  The columns that
        all files have are kept; their units may differ.
    columns : dict, optional
        Columns that their titles do not identify, as in ``{"time": "Time(s)", "delta_lp": 2}``.  A
        column is given by its title or its number, counted from 1.  The keys may be ``time``,
        ``delta_lp`` (displacement of the load point), ``V_load`` (its velocity), ``friction``,
        ``tau``, ``sigma`` and ``pore_pressure``.  The pore pressure is subtracted from ``sigma``.
        A pore pressure that is found by its title is not subtracted if ``sigma`` is given here, or
        if the title of sigma says that it is effective.
    units : dict, optional
        Units that replace the units in the file, as in ``{"delta_lp": "um"}``.
    time, displacement : pair, optional
        Window, as in ``time=("11640 s", "11720 s")`` or ``displacement=("8600 um", None)``.  Plain
        numbers are SI.  The values refer to the columns as they are in the file.
    sigma : float, str or pint.Quantity, optional
        Normal stress [Pa] if it was constant and not recorded, as in ``"20 MPa"``.
    max_rows : int, default 1_000_000
        Approximate largest number of rows that are kept.  Longer records are averaged in blocks of
        neighbouring rows, and a warning reports it.  None keeps all rows.
    join : {"auto", "absolute", "restart"}, default "auto"
        How the times of several files follow each other.  "absolute": they continue from file to
        file.  "restart": they restart in each file, and each file follows the previous one after
        one time step.  "auto": "restart" if the times of all files begin at 0, else "absolute".
    lab_format : str or pathlib.Path, optional
        A description of the laboratory's files, as `ratestate.describe_lab` writes it.  Other
        arguments have precedence.

    Returns
    -------
    xarray.Dataset
        Along ``time`` [s]:

        - ``friction``: computed as tau/sigma if it was not recorded.
        - ``delta_lp`` [m], or ``V_load`` [m/s] if no displacement was recorded.
        - ``tau`` [Pa] if it was recorded, and ``sigma`` [Pa] if it was recorded or given.

        Along ``segment``, a span in which the load point has a constant speed, with standard errors
        ``NAME_error``:

        - ``segment_t`` [s]: its start; the first is the record's first time, with the error 0.
        - ``segment_V`` [m/s]: its speed, 0 in a hold.

        Attributes:

        - ``found``: steps and holds in words.
        - ``notes``: JSON list of rows that were left out or look odd.
        - ``source``: name of the file or files.
        - ``columns``: JSON with the source of each variable.  ``sign`` is -1 if its sign was
          changed, because friction or stress was negative or delta_lp fell throughout.
        - ``machine``: JSON with K and M of the format, if given.

    Raises
    ------
    MissingFileError
        If a file does not exist.  It is a ParameterError too.
    ParameterError
        If a file cannot be read or has a second header with other columns; if a column is missing,
        ambiguous, constant or mostly empty, has no unit or contradictory units, or has a size that
        is impossible in its unit; if times run backwards or overlap between files; if there are
        too few rows; if the format has unknown keys or invalid values.

    Warns
    -----
    RecordWarning
        If rows were left out (without a number, or with an impossible one), if there is a gap, or
        if columns contradict each other; the message names the rows.  Also if rows were averaged, a
        title is ambiguous, the file has a pore pressure, friction is a ratio of forces, or values
        have an unusual size.

    Examples
    --------
    >>> data = read_lab("p1234.txt", time=("11640 s", "11720 s"))  # doctest: +SKIP
    >>> data.attrs["found"]  # doctest: +SKIP
    'velocity step 3 -> 10 um/s at 11676.4 s (8710 um)'
    """
    lab = read_lab_format(lab_format).with_arguments(columns, units, sigma)
    paths = path if isinstance(path, list | tuple) else [path]
    if not paths:
        raise sentences.refusal("join.none")
    tables = [lab.open(as_file(file)) for file in paths]
    windows = {"time": time, "displacement": displacement}
    data, messages = build_record(tables, lab, **windows, max_rows=max_rows, join=join)
    for text in messages:
        warnings.warn(f"{data.attrs['source']}: {text}", RecordWarning, stacklevel=3)
    return data


class Attempt(NamedTuple):
    """Result of `try_reading`: the columns, and either the record or the error.

    Attributes
    ----------
    columns : list of pairs
        Title and unit of each column, "" if missing; empty if the file is not a table.
    chosen : dict
        Quantity -> number of its column, from 1; empty if the choice is ambiguous.
    record : xarray.Dataset or None
        The result of `read_lab`.
    error : ParameterError or None
        Why there is no record.
    """

    columns: list[tuple[str, str]]
    chosen: dict[str, int]
    record: Any
    error: ParameterError | None


def try_reading(file, choices, *, seconds, stop=None):
    """Try to read a record in a separate process, with a time limit; no file is written.

    Parameters
    ----------
    file : binary file
        An open file, such as an `io.BytesIO`, perhaps with a ``name``.  It is read to its end.
    choices : dict
        Any of the arguments ``columns``, ``units`` and ``time`` of `read_lab`.
    seconds : float
        Time limit [s].
    stop : threading.Event, optional
        Ends the reading when it is set.

    Returns
    -------
    Attempt
        The columns of the file, even if they cannot be read as a record, and the record or the
        error.
    """
    try:
        return read_isolated(
            _try_reading, as_file(file), "a record", choices, seconds=seconds, stop=stop
        )
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
