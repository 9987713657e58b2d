"""``ratestate stiffness``: stiffness, mass and damping of the machine that made a record."""

from pathlib import Path

from .reading import Reading

#: the files' name
NAME = "stiffness"


def stiffness(
    files: list[Path],
    *,
    sigma: str | None = None,
    reading: Reading,
    out: Path | None = None,
    json: bool = False,
) -> None:
    """Find stiffness, mass and damping of a machine in its record: slopes of loading, ring-downs.

    Example: ratestate stiffness holds.txt --sigma '10 MPa'
    """
    from ...records.machine.machine_stiffness import machine_stiffness
    from ...report import summary
    from .document import document
    from .evaluate_record import reported, write_all
    from .output import print_json, print_rich

    with reported(NAME, files, reading, out) as (record, made):
        result = machine_stiffness(record, sigma)
        made += write_all(result, out, NAME, "slope")
    if json:
        print_json(document(result, None))
    else:
        print_rich(*summary(result))
