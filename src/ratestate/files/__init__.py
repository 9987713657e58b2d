"""Write and read results as NetCDF, CSV or Zarr, by the file's ending; no partial files.

`try_reading` reads a laboratory's file for a program that must not wait.
"""

from pathlib import Path

from ..errors import MissingFileError, ParameterError, RateStateError
from ..model.conversion import check_result
from ..records.reading.read import Attempt, try_reading
from ..records.reading.titles import EXAMPLE_UNIT
from .csv_tables import csv_text, laboratory_csv
from .place import checked_path, listed, replace
from .stored import read_netcdf, read_zarr, write_netcdf, write_zarr

__all__ = [
    "EXAMPLE_UNIT",
    "Attempt",
    "checked_path",
    "csv_text",
    "laboratory_csv",
    "read",
    "replace",
    "try_reading",
    "write",
]


def __dir__():
    return __all__


def write(data, path):
    """Write a result into a file, all of it or nothing.

    Parameters
    ----------
    data : xarray.Dataset
        A result of any function.
    path : str or Path
        File, whose name ends in .nc (NetCDF 4; complex variables as two, NAME_real and NAME_imag),
        .csv (see `csv_text`) or .zarr (a folder).  A .nc or .csv of this name is replaced, and so
        is a .zarr that `write` made, unless it has other files.  Permissions and links are kept.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    ParameterError
        If data is not a Dataset, the ending is none of these, the folder of the file does not
        exist, or `path` is a folder that `write` did not make, or a .zarr that is a file.
    OSError
        If the file cannot be written.  A previous file stays as it was.
    """
    check_result(data)
    path = checked_path(path, NUMBERS)
    writer, _ = FORMATS[path.suffix.lower()]
    return replace(path, lambda partial: writer(data, partial))


def read(path):
    """Return a result from a .nc or .zarr file, as it was before `write`.

    Parameters
    ----------
    path : str or Path
        File that `write` made, or store of a finished sweep.

    Returns
    -------
    xarray.Dataset
        The result, in memory.

    Raises
    ------
    ParameterError
        If the file is missing (then also a FileNotFoundError), of another kind, or damaged.  A
        .zarr without the attribute "sha256" is not checked: numbers of a lost chunk are NaN.
    StoreError
        If the store of a sweep is not finished or is damaged.  Also if a .zarr is in Zarr format 2,
        because such a file can run code of its author.
    """
    path = Path(path)
    ending = path.suffix.lower()
    _, reader = FORMATS.get(ending, (None, None))
    if reader is None:
        why = " (a .csv file lacks the parameters)" if ending == ".csv" else ""
        raise ParameterError(
            f"the name of the result {path} has an unsupported ending{why}",
            f"A result is read from a name that ends in {listed(READABLE)}.",
        )
    try:
        if not path.exists():
            raise MissingFileError(f"{path} does not exist", "Give the path of a result.")
        return reader(path)
    except RateStateError:
        raise
    except Exception as error:
        # the content of a file can make any library fail that reads it
        error_text = f"{type(error).__name__}: {error}"
        raise ParameterError(
            f"{path} cannot be read as a result: {error_text[:300]}",
            "It is damaged, or no result of ratestate. Compute the result again.",
        ) from None


#: ending of a name -> functions that write and read such a file
FORMATS: dict[str, tuple] = {
    ".nc": (write_netcdf, read_netcdf),
    ".csv": (lambda data, path: path.write_text(csv_text(data), "utf-8", newline="\n"), None),
    ".zarr": (write_zarr, read_zarr),
}
NUMBERS = tuple(FORMATS)
READABLE = tuple(ending for ending, (_, reader) in FORMATS.items() if reader)
