"""NetCDF 4 files, read and written; complex variables, which they lack, as two real ones."""

import numpy as np

from ..errors import ParameterError
from ..records.reading.isolated import read_isolated

#: suffix -> what of a complex array it is
PARTS = {"real": ("real part", np.real), "imag": ("imaginary part", np.imag)}


def read_netcdf(path):
    """The Dataset in a NetCDF file, in memory; ParameterError if it cannot be read."""
    import xarray

    variables, attrs = read_isolated(raw_netcdf, path, "a result")
    plain = {name: xarray.Variable(*one) for name, one in variables.items()}
    return joined(xarray.decode_cf(xarray.Dataset(plain, attrs=attrs)).load())


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
    """Write a Dataset as compressed NetCDF; the path is not checked."""
    data = split(data)
    packed = {"zlib": True, "complevel": 4, "shuffle": True}
    encoding = {name: packed for name, variable in data.variables.items() if variable.ndim}
    data.to_netcdf(path, engine="h5netcdf", encoding=encoding)


def split(data):
    """The Dataset with each complex variable, coordinates too, as two real data variables.

    NAME_real and NAME_imag have its attributes, ``part`` (real or imag), and the part in its
    ``long_name``; KeyError where it has none.  `data` itself if none is complex.
    """
    for name, variable in data.variables.items():
        if variable.dtype.kind != "c":
            continue
        parts = {}
        for part, (words, of) in PARTS.items():
            attrs = {"long_name": f"{variable.attrs['long_name']}, {words}", "part": part}
            values = of(variable.values)
            parts[f"{name}_{part}"] = variable.dims, values, variable.attrs | attrs
        data = data.drop_vars(name).assign(parts)
    return data


def joined(data):
    """The Dataset with what `split` took apart put together; ParameterError where parts differ."""
    for name in [name for name, v in data.variables.items() if v.attrs.get("part") == "real"]:
        whole = name.removesuffix("_real")
        real, imag = data[name], data[f"{whole}_imag"]
        if real.dims != imag.dims:
            raise ParameterError(
                f"{name} lies along {real.dims}, but {whole}_imag along {imag.dims}: they are not "
                f"the parts of one variable"
            )
        values = np.empty(real.shape, complex)
        values.real, values.imag = real.values, imag.values  # infinite parts stay what they are
        attrs = {key: text for key, text in real.attrs.items() if key != "part"}
        attrs["long_name"] = attrs["long_name"].removesuffix(", real part")
        data = data.drop_vars([name, f"{whole}_imag"]).assign({whole: (real.dims, values, attrs)})
    return data
