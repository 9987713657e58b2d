"""``ratestate lab``: the formats of laboratories' files."""

from pathlib import Path

from .output import print_line
from .reading import reading_options


def describe(
    file: Path,
    *,
    columns: list[str] | None = None,
    column_units: list[str] | None = None,
    sigma: str | None = None,
    K: str | None = None,
    M: str | None = None,
    time: str | None = None,
    displacement: str | None = None,
    format_: Path | None = None,
) -> None:
    """Print how a laboratory's files are read, as a file for --format of other commands.

    Example: ratestate lab describe record.txt
    """
    from ...records.reading import describe as described

    reading = reading_options(columns, column_units, time, displacement, format_)
    print_line(described(file, sigma=sigma, K=K, M=M, **reading).rstrip("\n"))
