"""``ratestate lab``: the formats of laboratories' files."""

from pathlib import Path

from .output import print_line
from .reading import FileReading


def describe(
    file: Path,
    *,
    sigma: str | None = None,
    K: str | None = None,
    M: str | None = None,
    reading: FileReading,
) -> None:
    """Print how a laboratory's files are read, as a file for --format of other commands.

    Example: ratestate lab describe record.txt
    """
    from ...records.reading import describe as described

    print_line(described(file, sigma=sigma, K=K, M=M, **reading.keywords()).rstrip("\n"))
