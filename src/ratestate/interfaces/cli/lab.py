"""``ratestate lab``: the formats of laboratories' files."""

from pathlib import Path

from .command import columns_of, pairs_of, window_of
from .output import print_line


def describe(
    file: Path,
    *,
    columns: list[str] | None = None,
    units: list[str] | None = None,
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

    text = described(
        file,
        columns_of(columns),
        pairs_of(units, "--units", separator=","),
        sigma=sigma,
        K=K,
        M=M,
        time=window_of(time, "--time"),
        displacement=window_of(displacement, "--displacement"),
        format=format_,
    )
    print_line(text.rstrip("\n"))
