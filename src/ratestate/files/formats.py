"""Results as NetCDF, CSV or Zarr, by the ending of the name."""

import warnings
from pathlib import Path

from ..errors import ParameterError, RateStateError
from .netcdf import read_netcdf, write_netcdf
from .parts import joined
from .place import NUMBERS, checked, replace
from .table import write_csv


def write(data, path):
    """Write a result into a file, all of it or nothing; a file of that name is replaced.

    Parameters
    ----------
    data : xarray.Dataset
    path : str or pathlib.Path
        Ends in .nc (NetCDF 4; complex variables as two, NAME_real and NAME_imag), .csv (see
        `csv_text`) or .zarr (a folder; one that holds anything but a result is not replaced).

    Returns
    -------
    pathlib.Path

    Raises
    ------
    ParameterError
        Another ending; a folder in its place that is no result.
    OSError
        It cannot be written.
    """
    path = checked(path, NUMBERS)
    writers = {".nc": write_netcdf, ".csv": write_csv, ".zarr": _write_zarr}
    return replace(path, lambda partial: writers[path.suffix.lower()](data, partial))


def read(path):
    """A result from a .nc or .zarr file, in memory, as it was before `write`.

    Raises
    ------
    ParameterError
        It is missing, of another kind, or damaged.
    StoreError
        It is a sweep's store, and damaged.
    """
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in (".nc", ".zarr"):
        raise ParameterError(
            f"{path}: a result is read from a name that ends in .nc or .zarr"
            + (" (a .csv file lacks the parameters)" if ending == ".csv" else "")
        )
    try:
        if not path.exists():
            raise ParameterError(f"{path} does not exist")
        return _read_zarr(path) if ending == ".zarr" else joined(read_netcdf(path))
    except RateStateError:
        raise
    except Exception as error:
        # what is in a file may make any part of the libraries that read it stumble
        what = f"{type(error).__name__}: {error}"
        raise ParameterError(f"{path} cannot be read as a result: {what[:300]}") from None


def _read_zarr(path):
    """A result from a Zarr folder; a sweep's store knows what must be in it, and checks that."""
    if (path / "sweep").is_dir():
        from ..sweeps.store import load_result

        return _plain_text(load_result(path))
    import xarray

    with xarray.open_zarr(path, chunks=None) as opened:
        return _plain_text(opened.load())


def _write_zarr(data, path):
    # Of the kinds of text, Zarr 3 has settled the one of any length.
    texts = [name for name, variable in data.variables.items() if variable.dtype.kind == "U"]
    data = data.assign({name: data[name].astype(object) for name in texts}).drop_encoding()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # that joined metadata are no standard yet
        data.to_zarr(path, mode="w-", zarr_format=3)


def _plain_text(data):
    """The same with text as Python has it, not of a kind that xarray cannot mask."""
    texts = {name: v.astype(object) for name, v in data.variables.items() if v.dtype.kind == "T"}
    return data.assign(texts)
