"""Results in NetCDF 4 files and in Zarr folders, with checksums that are compared on reading.

An attribute has the SHA-256 of each variable and of the result's own attributes.  Results without
it are read unchecked.
"""

import hashlib
import json
from typing import Any

import numpy as np

from ..errors import ParameterError
from ..records.kit.processes import read_isolated
from ..records.reading.open_table import refuse_other_files
from .place import DIGESTS

#: name of a result's own attributes among its digests
OWN = ""
#: suffix -> name of this part of a complex array, and its function
PARTS = {"real": ("real part", np.real), "imag": ("imaginary part", np.imag)}


def read_netcdf(path):
    """Return the Dataset in a NetCDF file, in memory; ParameterError if it cannot be read."""
    import xarray

    variables, attrs = read_isolated(raw_netcdf, path, "a result")
    plain = {name: xarray.Variable(*parts) for name, parts in variables.items()}
    return joined(xarray.decode_cf(xarray.Dataset(plain, attrs=attrs)).load())


def raw_netcdf(path):
    """Return name -> (dimensions, values, attributes) in a file, and its own attributes.

    ParameterError if it is not as it was written, or takes data from other files.
    """
    import h5netcdf
    import h5py

    with h5py.File(path, "r") as file:
        refuse_other_files(file, path.name)
    with h5netcdf.File(path, "r", decode_vlen_strings=True) as file:
        parts = _parts_of_netcdf(file, path)
    return _checked(path, parts)


def _parts_of_netcdf(file, path):
    """Return name -> (dimensions, values, attributes) of each variable, and of the file, `OWN`."""
    parts = {OWN: ((), np.empty(0), _attributes(file))}
    for name, variable in file.variables.items():
        try:
            parts[name] = variable.dimensions, variable[...], _attributes(variable)
        except OSError as error:
            raise ParameterError(
                f"{path} is damaged: variable {name} cannot be read ({error})",
                "Put it back from a copy.",
            ) from error
    return parts


def _attributes(variable):
    texts = {name: value for name, value in variable.attrs.items() if isinstance(value, bytes)}
    return {**variable.attrs, **{name: value.decode() for name, value in texts.items()}}


def _checked(path, parts):
    """Return the variables and the own attributes; ParameterError if they were altered."""
    _, _, attrs = parts[OWN]
    recorded, found = attrs.pop(DIGESTS, None), _digests(parts)
    del parts[OWN]
    if recorded is None:
        return parts, attrs
    try:
        recorded = dict(json.loads(recorded))
    except (ValueError, TypeError):
        recorded = {}
    names = sorted(name for name in {*recorded, *found} if recorded.get(name) != found.get(name))
    if names:
        damaged = ", ".join(f"variable {name}" if name else "its attributes" for name in names)
        raise ParameterError(
            f"{path} is damaged, or another program has changed it, in {damaged}",
            "Put it back from a copy. If the change is meant, delete the attribute "
            f"{DIGESTS} of the file.",
        )
    return parts, attrs


def _digests(parts):
    return {name: _digest(*part) for name, part in parts.items()}


def _digest(dims, values, attrs):
    numbers = values.dtype.kind in "biufc"
    known = {name: np.atleast_1d(value).tolist() for name, value in attrs.items()}
    form = [dims, values.shape, values.dtype.str if numbers else values.tolist(), known]
    digest = hashlib.sha256(json.dumps(form, sort_keys=True, default=str).encode())
    if numbers:
        digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()


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
        file.attrs[DIGESTS] = json.dumps(_digests(_parts_of_netcdf(file, path)))


def write_zarr(data, path):
    """Write a Dataset as a Zarr group with checksums; the path is not checked."""
    import zarr

    from ..sweeps.store import python_text, zarr_3_warnings_ignored

    with zarr_3_warnings_ignored():
        data = python_text(data).drop_encoding()
        data.to_zarr(path, mode="w-", zarr_format=3, consolidated=False)
        digests = json.dumps(_digests(_parts_of_zarr(path)))
        zarr.open_group(path, mode="r+", zarr_format=3).attrs[DIGESTS] = digests


def _parts_of_zarr(path):
    """Return name -> (dimensions, values, attributes) of each variable, and of the group, `OWN`."""
    import xarray

    options: Any = {"chunks": None, "decode_cf": False, "consolidated": False, "zarr_format": 3}
    with xarray.open_zarr(path, **options) as raw:
        parts = {name: (v.dims, v.values, v.attrs) for name, v in raw.variables.items()}
        return parts | {OWN: ((), np.empty(0), raw.attrs)}


def read_zarr(path):
    """Return the Dataset in a Zarr folder; ParameterError, or a sweep's StoreError, if damaged.

    StoreError if it is in Zarr format 2.
    """
    import xarray

    from ..sweeps.store import open_result, python_text, reading, refuse_zarr_2

    refuse_zarr_2(path)
    if (path / "sweep").is_dir():  # such a store knows itself what must be in it
        with reading(path):
            return python_text(open_result(path).load())
    variables, attrs = _checked(path, _parts_of_zarr(path))
    plain = {name: xarray.Variable(*parts) for name, parts in variables.items()}
    return python_text(xarray.decode_cf(xarray.Dataset(plain, attrs=attrs)).load())


def split(data):
    """Return the Dataset with each complex variable as two real data variables.

    NAME_real and NAME_imag have its attributes, ``part`` (real or imag), and the part in their
    ``long_name``.  KeyError if it has none.  `data` itself if no variable is complex.
    """
    for name, variable in data.variables.items():
        if variable.dtype.kind != "c":
            continue
        parts = {}
        for part, (words, part_of) in PARTS.items():
            attrs = {"long_name": f"{variable.attrs['long_name']}, {words}", "part": part}
            values = part_of(variable.values)
            parts[f"{name}_{part}"] = variable.dims, values, variable.attrs | attrs
        data = data.drop_vars(name).assign(parts)
    return data


def joined(data):
    """Return the Dataset before `split`; ParameterError if the parts of a variable differ."""
    for name in [name for name, v in data.variables.items() if v.attrs.get("part") == "real"]:
        base = name.removesuffix("_real")
        real, imag = data[name], data[f"{base}_imag"]
        if real.dims != imag.dims:
            raise ParameterError(
                f"{name} lies along {real.dims}, but {base}_imag along {imag.dims}, so they "
                "cannot be joined into one complex variable"
            )
        values = np.empty(real.shape, complex)
        values.real, values.imag = real.values, imag.values  # infinite parts stay what they are
        attrs = {key: text for key, text in real.attrs.items() if key != "part"}
        attrs["long_name"] = attrs["long_name"].removesuffix(", real part")
        data = data.drop_vars([name, f"{base}_imag"]).assign({base: (real.dims, values, attrs)})
    return data
