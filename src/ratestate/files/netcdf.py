"""NetCDF 4 files, read and written; complex variables, which they lack, as two real ones.

A file has the SHA-256 of each variable, and of its own attributes, in an attribute.  Files of
others, and of older versions, lack it and are read unchecked.
"""

import hashlib
import json

import numpy as np

from ..errors import ParameterError
from ..records.reading.isolated import read_isolated
from ..records.reading.stored import refuse_other_files

#: attribute of a file with digests as JSON; the name there of the file's own attributes
DIGESTS, OWN = "sha256", ""
#: suffix -> what of a complex array it is
PARTS = {"real": ("real part", np.real), "imag": ("imaginary part", np.imag)}


def read_netcdf(path):
    """The Dataset in a NetCDF file, in memory; ParameterError if it cannot be read."""
    import xarray

    variables, attrs = read_isolated(raw_netcdf, path, "a result")
    plain = {name: xarray.Variable(*one) for name, one in variables.items()}
    return joined(xarray.decode_cf(xarray.Dataset(plain, attrs=attrs)).load())


def raw_netcdf(path):
    """What is in the file: name -> (dimensions, values, attributes), and its own attributes.

    ParameterError if it is not as it was written, or takes data from other files.
    """
    import h5netcdf
    import h5py

    with h5py.File(path, "r") as file:
        refuse_other_files(file, path.name)
    with h5netcdf.File(path, "r", decode_vlen_strings=True) as file:
        recorded, parts = file.attrs.get(DIGESTS), dict(_parts(file, path))
    found = {name: _digest(*part) for name, part in parts.items()}
    if recorded is not None and (differing := _differing(recorded, found)):
        where = ", ".join(f"variable {name}" if name else "its attributes" for name in differing)
        raise ParameterError(
            f"{path} is damaged, or another program has changed it, in {where}. Put it back from a "
            f"copy. If the change is meant, delete the attribute {DIGESTS} of the file."
        )
    *_, attrs = parts.pop(OWN)
    return parts, attrs


def _parts(file, path):
    """Yield name and (dimensions, values, attributes) of each variable; last the file's own, `OWN`.

    ParameterError if the bytes of a variable are not those that were written.
    """
    for name, variable in file.variables.items():
        try:
            yield name, (variable.dimensions, variable[...], _attributes(variable))
        except OSError as error:
            raise ParameterError(
                f"{path} is damaged: variable {name} cannot be read ({error}). Put it back from a "
                f"copy."
            ) from error
    own = _attributes(file)
    own.pop(DIGESTS, None)
    yield OWN, ((), np.empty(0), own)


def _digest(dims, values, attrs):
    numbers = values.dtype.kind in "biufc"
    known = {name: np.atleast_1d(value).tolist() for name, value in attrs.items()}
    form = [dims, values.shape, values.dtype.str if numbers else values.tolist(), known]
    digest = hashlib.sha256(json.dumps(form, sort_keys=True, default=str).encode())
    if numbers:
        digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()


def _differing(recorded, found):
    """Names under which digests differ, the recorded ones as JSON text."""
    try:
        recorded = dict(json.loads(recorded))
    except (ValueError, TypeError):
        recorded = {}
    return sorted(name for name in {*recorded, *found} if recorded.get(name) != found.get(name))


def _attributes(of):
    return {
        name: value.decode() if isinstance(value, bytes) else value
        for name, value in of.attrs.items()
    }


def write_netcdf(data, path):
    """Write a Dataset as compressed NetCDF with checksums; the path is not checked."""
    import h5netcdf

    data = split(data)
    encoding = {}
    for name, variable in data.variables.items():
        if variable.ndim:
            encoding[name] = {"zlib": True, "complevel": 4, "shuffle": True}
            encoding[name]["fletcher32"] = variable.dtype.kind not in "OTU"  # HDF5: not of texts
    data.to_netcdf(path, engine="h5netcdf", encoding=encoding)
    with h5netcdf.File(path, "a", decode_vlen_strings=True) as file:
        digests = {name: _digest(*part) for name, part in _parts(file, path)}
        file.attrs[DIGESTS] = json.dumps(digests)


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
