"""``ratestate stiffness``: stiffness, mass and damping of the machine that made a record."""

from pathlib import Path

from .reading import Join, reading_options

#: the files' name
NAME = "stiffness"


def stiffness(
    file: list[Path],
    *,
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
    """Find stiffness, mass and damping of a machine in its record: slopes of loading, ring-downs.

    Example: ratestate stiffness holds.txt --sigma '10 MPa'
    """
    reading = reading_options(columns, column_units, time, displacement, format_, rows, join)
    from ...records.machine import summary
    from ...records.machine.machine_stiffness import machine_stiffness
    from .document import document
    from .evaluate_record import reported, write_all
    from .output import print_json, print_line

    with reported(NAME, file, reading, out) as (record, made):
        result = machine_stiffness(record, sigma)
        made += write_all(result, out, NAME, "slope")
    if json:
        print_json(document(result, None))
    else:
        print_line(summary(result))
