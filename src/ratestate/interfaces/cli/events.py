"""``ratestate events``: the stick-slip events of a laboratory record, as a table."""

import warnings
from json import loads as json_of
from pathlib import Path
from typing import Any

from .reading import Join, reading_options

#: file names
TABLE, NUMBERS, PLOT = "events.csv", "events.nc", "events.png"


def events(
    file: list[Path],
    *,
    K: str | None = None,
    M: str | None = None,
    sigma: str | None = None,
    time: str | None = None,
    displacement: str | None = None,
    columns: list[str] | None = None,
    column_units: list[str] | None = None,
    rows: int | None = None,
    join: Join = "auto",
    format_: Path | None = None,
    out: Path | None = None,
    json: bool = False,
) -> None:
    """Find the stick-slip events of a laboratory record: stress drops, recurrence, slip, errors.

    Example: ratestate events record.txt --out catalogue
    """
    from ...errors import RecordWarning
    from ...records.reading import read_lab
    from ...records.stick_slip import events as find_events
    from .document import document
    from .output import make_writable, print_json, print_rich, reporting_files
    from .report.events import tables

    reading = reading_options(columns, column_units, time, displacement, format_, rows, join)
    given = {"K": K, "M": M, "sigma": sigma}
    given = {name: value for name, value in given.items() if value is not None}
    if out:
        make_writable(out)
    with reporting_files(f"events of {', '.join(one.name for one in file)}") as files:
        with warnings.catch_warnings():
            warnings.simplefilter("always", RecordWarning)
            record = read_lab(file if len(file) > 1 else file[0], **reading)
        # what the format says of the machine holds where nothing else is given
        catalogue = find_events(record, **json_of(record.attrs.get("machine", "{}")) | given)
        if out:
            files += _written(catalogue, out)
    if json:
        print_json(document(catalogue, None))
    else:
        print_rich(*tables(catalogue))


def _written(catalogue: Any, out: Path) -> list[Path]:
    """The files in the folder."""
    from ... import plot
    from ...files import laboratory_csv, replace, write

    text = laboratory_csv(catalogue, "event")
    return [
        replace(out / TABLE, lambda partial: partial.write_text(text, "utf-8")),
        write(catalogue, out / NUMBERS),
        plot.save(plot.page(catalogue), out / PLOT),
    ]
