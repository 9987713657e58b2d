"""A store of a sweep on disk: a Zarr group, filled by chunks, that any interruption leaves whole.

The group holds the result as xarray reads it.  Its subgroup ``sweep`` knows the rest: ``inputs``,
the shape of chunks, versions, and ``done``, one flag a chunk.  A chunk is one file a variable,
written by one task, and reaches the disk before its flag does.  zarr writes a file beside its
place and renames it, so that a file is whole or absent.
"""

import contextlib
import json
import os
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray
import zarr

from ..dataset import versions
from ..errors import StoreError
from .chunks import Chunks, chunks_of
from .inputs import checksum, differences, inputs_of
from .lock import alone

INSIDE = "sweep"


class Store(NamedTuple):
    """An open store."""

    path: Path
    chunks: Chunks
    done: np.ndarray  # (chunks,) bool, when it was opened
    checksum: str  # of its inputs


@contextlib.contextmanager
def opened(path, verb, call, chunk, device):
    """The `Store` at a path, for this sweep and no other at a time.

    Raises
    ------
    StoreError
        It was made by another version or from other parameters, listed; it is no store of a
        sweep, cannot be written to, or is being written to.
    """
    inside, inputs = read(path)
    with alone(path / INSIDE / "zarr.json", path):
        chunks = Chunks(inside.attrs["sizes"], tuple(inside.attrs["chunk"]))
        lines = _versions_differ(inside.attrs["versions"])
        lines += differences(inputs, inputs_of(verb, call))
        if device != inside.attrs["device"]:
            lines.append(f"device: {inside.attrs['device']} in the store, {device} now")
        if chunk is not None and chunks_of(chunks.sizes, chunk).shape != chunks.shape:
            lines.append(f"chunk: blocks of {chunks.shape} cases in the store, chunk={chunk} now")
        if lines:
            listed = "".join(f"\n  {line}" for line in lines)
            raise StoreError(
                f"{path} holds another sweep; give this one a store of its own, or make it the "
                f"same:{listed}"
            )
        for partial in path.rglob("*.partial"):
            partial.unlink(missing_ok=True)
        with damage_told(path):
            done = inside["done"][:]
        yield Store(path, chunks, done, inside.attrs["checksum"])


@contextlib.contextmanager
def damage_told(path):
    """Make a StoreError of all that reading a store that is none, or damaged, may raise."""
    try:
        yield
    except StoreError:
        raise
    except PermissionError as error:
        raise StoreError(f"{path} cannot be read ({error.strerror})") from error
    except (OSError, KeyError, ValueError, RuntimeError) as error:
        raise StoreError(
            f"{path} is no store of a sweep, or a damaged one ({error}); give another path"
        ) from error


def read(path):
    """The group with what is known of a sweep, and its inputs; StoreError if that is damaged."""
    with damage_told(path):
        inside: Any = zarr.open_group(path / INSIDE, mode="r", use_consolidated=False)
        with xarray.open_zarr(
            path, group=f"{INSIDE}/inputs", chunks=None, consolidated=False, decode_cf=False
        ) as data:
            inputs = data.load()
        known = {"verb", "sizes", "chunk", "device", "checksum", "versions"} <= {*inside.attrs}
    if not known or checksum(inputs) != inside.attrs["checksum"]:
        raise StoreError(f"{path}: its record of the parameters is damaged; give another path")
    return inside, inputs


def _versions_differ(stored):
    """Lines for those versions that differ from this process's."""
    here = json.loads(versions())
    return [
        f"version of {name}: {stored.get(name)} made the store, {here.get(name)} is here"
        for name in sorted({*stored, *here})
        if stored.get(name) != here.get(name)
    ]


def write(store, i, variables):
    """Put the variables of chunk i into an open store, and say that they are there.

    Raises
    ------
    StoreError
        They cannot be written, or not whole; the store then lacks them, and nothing else.
    """
    try:
        _write(store, i, variables)
    except StoreError:
        raise
    except (OSError, KeyError) as error:
        raise StoreError(
            f"{store.path} cannot be written to ({error}); what it holds is whole: make room, or "
            f"mend what is wrong, and run the same sweep again"
        ) from error


def _write(store, i, variables):
    path, chunks = store.path, store.chunks
    group: Any = zarr.open_group(path, mode="r+", zarr_format=3, use_consolidated=False)
    if group[INSIDE].attrs["checksum"] != store.checksum:  # a worker may be the last to know
        raise StoreError(f"{path} has been replaced by the store of another sweep")
    places, index = chunks.places(i), dict(zip(chunks.sizes, chunks.index(i), strict=True))
    files = []
    for name, variable in variables.items():
        # What does not depend on some dimensions is written by the first chunk along them.
        own = [dim for dim in variable.dims if dim in places]
        if own and all(index[dim] == 0 for dim in places if dim not in own):
            array = group[name]
            array[tuple(places.get(dim, slice(None)) for dim in variable.dims)] = variable.values
            key = array.metadata.encode_chunk_key(tuple(index.get(dim, 0) for dim in variable.dims))
            files.append(path / name / key)
    to_disk(files, path)
    done = group[f"{INSIDE}/done"]
    done[i] = True
    to_disk([path / INSIDE / "done" / done.metadata.encode_chunk_key((i,))], path)


def to_disk(files, top=None):
    """Have the system write these files, and the folders that name them, to the disk itself."""
    files = [file for file in files if file.exists()]  # zarr leaves out files of fill values
    folders = {file.parent for file in files}
    if top:
        folders = {one for file in files for one in file.parents if top in one.parents}
    for file in {*files, *folders}:
        handle = os.open(file, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def result_of(path):
    """The result in a store, read where it is used; cases not done have the status -1."""
    data = xarray.open_zarr(path, chunks=None)
    # xarray cannot mask zarr's own type for text
    return data.assign(message=data["message"].astype(object))
