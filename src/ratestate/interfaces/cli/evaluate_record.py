"""What commands that evaluate a laboratory's record do: read it, and write the result's files."""

import contextlib
import warnings
from collections.abc import Iterator
from pathlib import Path

import xarray

from ...errors import RecordWarning
from ...files import laboratory_csv, replace, write
from ...records.reading import read_lab
from .output import folder, names_of, reporting_files
from .reading import Reading
from .summary_csv import summary_csv


@contextlib.contextmanager
def reported(
    what: str, files: list[Path], reading: Reading, out: Path | None
) -> Iterator[tuple[xarray.Dataset, list[Path]]]:
    """The record in these files, and a list that takes the files made; both reported on stderr."""
    keywords = reading.keywords()
    with folder(out), reporting_files(f"{what} of {names_of(files)}") as made:
        with warnings.catch_warnings():
            warnings.simplefilter("always", RecordWarning)
            record = read_lab(files if len(files) > 1 else files[0], **keywords)
        yield record, made


def write_all(result: xarray.Dataset, out: Path | None, name: str, dim: str) -> list[Path]:
    """Write a result as NAME.nc and NAME.png, and its tables; the paths.

    NAME.csv has a row for each value along a dimension, NAME_summary.csv one for each quantity of
    the whole record.
    """
    if not out:
        return []
    from ... import plot

    table = laboratory_csv(_by_law(result, dim), dim)
    return [
        write(result, out / f"{name}.nc"),
        plot.save(plot.page(result), out / f"{name}.png"),
        write_text(out / f"{name}.csv", table),
        write_text(out / f"{name}_summary.csv", summary_csv(result)),
    ]


def write_text(path: Path, text: str) -> Path:
    """Write a text to a file, whole or not at all; the file."""
    return replace(path, lambda partial: partial.write_text(text, "utf-8"))


def _by_law(result: xarray.Dataset, dim: str) -> xarray.Dataset:
    """A result with a variable along the dimension alone for each law, where it has several."""
    table = result.copy()
    for name, variable in result.data_vars.items():
        if set(variable.dims) == {"law", dim}:
            for law in result["law"].values.tolist():
                table[f"{name}_{law}"] = variable.sel(law=law, drop=True)
    return table
