"""Results in NetCDF 4 files and in Zarr folders, with checksums.

A NetCDF file has the SHA-256 of each variable, and of its own attributes, in an attribute; a folder
has the SHA-256 of each file in a group.  Results without checksums are read unchecked.
"""

import hashlib
import json
from typing import Any

import numpy as np

from ..errors import ParameterError
from ..records.kit.processes import read_isolated
from ..records.reading.open_table import refuse_other_files
from .place import CHECKSUMS, DIGESTS

#: name of a NetCDF file's own attributes among its digests
OWN = ""
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
    if recorded is not None:
        _check_digests(path, recorded, {name: _digest(*part) for name, part in parts.items()})
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
                f"{path} is damaged: variable {name} cannot be read ({error})",
                "Put it back from a copy.",
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


def _check_digests(path, recorded, found):
    """Raise ParameterError if digests differ from the recorded ones, JSON text."""
    try:
        recorded = dict(json.loads(recorded))
    except (ValueError, TypeError):
        recorded = {}
    names = sorted(name for name in {*recorded, *found} if recorded.get(name) != found.get(name))
    if names:
        where = ", ".join(f"variable {name}" if name else "its attributes" for name in names)
        raise ParameterError(
            f"{path} is damaged, or another program has changed it, in {where}",
            (
                "Put it back from a copy. If the change is meant, delete the attribute "
                f"{DIGESTS} of the file."
            ),
        )


def _attributes(of):
    texts = {name: value for name, value in of.attrs.items() if isinstance(value, bytes)}
    return {**of.attrs, **{name: value.decode() for name, value in texts.items()}}


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


def write_zarr(data, path):
    """Write a Dataset as a Zarr group, and in it a group with the SHA-256 of each file."""
    import zarr

    from ..sweeps.store import python_text, zarr_3_warnings_ignored

    if CHECKSUMS in data.variables:
        raise ParameterError(
            f"a variable called {CHECKSUMS!r} clashes with those of the files", "Rename it."
        )
    with zarr_3_warnings_ignored():
        data = python_text(data).drop_encoding()
        data.to_zarr(path, mode="w-", zarr_format=3, consolidated=False)
        checksums = zarr.open_group(path, mode="r+", zarr_format=3).create_group(CHECKSUMS)
        zarr.consolidate_metadata(path)  # which names the group too: it cannot be lost unnoticed
        files = [one for one in path.rglob("*") if one.is_file()]
        keys = sorted(one.relative_to(path).as_posix() for one in files)
        checksums.attrs[DIGESTS] = {
            key: _file_digest(path / key) for key in keys if not key.startswith(f"{CHECKSUMS}/")
        }


def _file_digest(file):
    """Return the SHA-256 of a file; "" if there is none."""
    return hashlib.sha256(file.read_bytes()).hexdigest() if file.is_file() else ""


def read_zarr(path):
    """The Dataset in a Zarr folder; ParameterError, or a sweep's StoreError, if it is damaged.

    StoreError if it is in Zarr format 2.
    """
    import xarray
    import zarr

    from ..sweeps.store import as_lines, open_result, python_text, reading, refuse_zarr_2

    refuse_zarr_2(path)
    if (path / "sweep").is_dir():  # such a store knows itself what must be in it
        with reading(path):
            return python_text(open_result(path).load())
    # a damaged list of the groups may lack this one, and it may be lost itself: either is enough
    how: Any = {"mode": "r", "zarr_format": 3}
    if (path / CHECKSUMS).exists() or CHECKSUMS in zarr.open_group(path, **how):
        digests: Any = zarr.open_group(path / CHECKSUMS, **how).attrs[DIGESTS]
        found = {key: _file_digest(path / key) for key in digests}
        if flaws := [
            f"{key} is {'damaged' if found[key] else 'missing'}"
            for key, digest in digests.items()
            if found[key] != digest
        ]:
            raise ParameterError(
                f"{path} is damaged. Put these files back from a copy:{as_lines(flaws)}"
            )
    with xarray.open_zarr(path, chunks=None, zarr_format=3) as opened:
        return python_text(opened.load())


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
                f"{name} lies along {real.dims}, but {whole}_imag along {imag.dims}: they are "
                "not the parts of one variable"
            )
        values = np.empty(real.shape, complex)
        values.real, values.imag = real.values, imag.values  # infinite parts stay what they are
        attrs = {key: text for key, text in real.attrs.items() if key != "part"}
        attrs["long_name"] = attrs["long_name"].removesuffix(", real part")
        data = data.drop_vars([name, f"{whole}_imag"]).assign({whole: (real.dims, values, attrs)})
    return data
