"""NetCDF 4 files, read and written."""

from ..records.reading.isolated import read_isolated
from .parts import split


def read_netcdf(path):
    """The Dataset in a NetCDF file; ParameterError if there is none."""
    import xarray

    variables, attrs = read_isolated(raw_netcdf, path, "a result")
    plain = {name: xarray.Variable(*one) for name, one in variables.items()}
    return xarray.decode_cf(xarray.Dataset(plain, attrs=attrs)).load()


def raw_netcdf(path):
    """What is in the file: name -> (dimensions, values, attributes), and its own attributes."""
    import h5netcdf

    with h5netcdf.File(path, "r", decode_vlen_strings=True) as file:
        variables = {
            name: (variable.dimensions, variable[...], _attributes(variable))
            for name, variable in file.variables.items()
        }
        return variables, _attributes(file)


def _attributes(of):
    return {
        name: value.decode() if isinstance(value, bytes) else value
        for name, value in of.attrs.items()
    }


def write_netcdf(data, path):
    """Write a Dataset as compressed NetCDF."""
    data = split(data)
    packed = {"zlib": True, "complevel": 4, "shuffle": True}
    encoding = {name: packed for name, variable in data.variables.items() if variable.ndim}
    data.to_netcdf(path, engine="h5netcdf", encoding=encoding)
