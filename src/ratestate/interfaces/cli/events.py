"""``ratestate events``: the stick-slip events of a laboratory record, as a table."""

from json import loads
from pathlib import Path

from .reading import Reading

#: the files' name
NAME = "events"


def events(
    files: list[Path],
    *,
    K: str | None = None,
    M: str | None = None,
    sigma: str | None = None,
    reading: Reading,
    out: Path | None = None,
    json: bool = False,
) -> None:
    """Find the stick-slip events of a laboratory record: stress drops, recurrence, slip, errors.

    Example: ratestate events record.txt --out catalogue
    """
    from ...records.stick_slip import events as find_events
    from ...report import summary
    from .document import document
    from .evaluate_record import reported, write_all
    from .output import print_json, print_rich

    given = {"K": K, "M": M, "sigma": sigma}
    given = {name: value for name, value in given.items() if value is not None}
    with reported(NAME, files, reading, out) as (record, made):
        # what the format says of the machine holds where nothing else is given
        catalogue = find_events(record, **loads(record.attrs.get("machine", "{}")) | given)
        made += write_all(catalogue, out, NAME, "event")
    if json:
        print_json(document(catalogue, None))
    else:
        print_rich(*summary(catalogue))
