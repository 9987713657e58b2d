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

INSIDE = "sweep"
# Cases of which all messages are read at once.
MANY = 10**7


class Store(NamedTuple):
    """An open store."""

    path: Path
    chunks: Chunks
    done: np.ndarray  # (chunks,) bool, when it was opened
    checksum: str  # of its inputs


def examined(path, form, verb, call, chunk, device):
    """The `Store` at a path, if it is this sweep's.

    Raises
    ------
    StoreError
        It was made by another version or from other parameters, listed; it is no store of a
        sweep, or cannot be read.
    """
    inside, inputs = read(path)
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
    with damage_told(path):
        done = inside["done"][:]
    store = Store(path, chunks, done, inside.attrs["checksum"])
    for i in np.flatnonzero(done):  # what has been lost is done again
        done[i] = all(file.exists() for file in _files(store, i, form.kinds).values())
    return store


def sweep_up(path):
    """Remove what killed writers left in a store."""
    for partial in path.rglob("*.partial"):
        partial.unlink(missing_ok=True)


def noted(device):
    """Attributes of a result that say where it comes from: the GPU's bits are not the CPU's."""
    return {} if device == "cpu" else {"device": device}


def _files(store, i, variables):
    """Variable -> the file in which chunk i has it, for those that it has.

    What does not depend on some dimensions is written by the first chunk along them.
    """
    index = dict(zip(store.chunks.sizes, store.chunks.index(i), strict=True))
    files = {}
    for name, variable in variables.items():
        own = index.keys() & {*variable.dims}
        if own and not any(index[dim] for dim in index.keys() - own):
            key = [str(index.get(dim, 0)) for dim in variable.dims]
            files[name] = store.path.joinpath(name, "c", *key)
    return files


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
    with _writing(store.path):
        _write(store, i, variables)


def undone(store, numbers):
    """The store with these chunks to be done again; errors as for `write`."""
    done = store.done.copy()
    done[numbers] = False
    with _writing(store.path):
        flags: Any = zarr.open_array(store.path / INSIDE / "done", mode="r+")
        for i in numbers:  # (zarr removes the files)
            flags[i] = False
        to_disk([store.path / INSIDE / "done" / "c"], store.path)
    return store._replace(done=done)


@contextlib.contextmanager
def _writing(path):
    """Make a StoreError of all that writing may raise."""
    try:
        yield
    except StoreError:
        raise
    except (OSError, KeyError) as error:
        raise StoreError(
            f"{path} cannot be written to ({error}); what it holds is whole: make room, or "
            f"mend what is wrong, and run the same sweep again"
        ) from error


def _write(store, i, variables):
    path, chunks = store.path, store.chunks
    group: Any = zarr.open_group(path, mode="r+", zarr_format=3, use_consolidated=False)
    if group[INSIDE].attrs["checksum"] != store.checksum:  # a worker may be the last to know
        raise StoreError(f"{path} has been replaced by the store of another sweep")
    files = _files(store, i, variables)
    places = chunks.places(i)
    for name in files:
        where = tuple(places.get(dim, slice(None)) for dim in variables[name].dims)
        # (zarr leaves out files of fill values alone; here a missing one shall be a loss, and seen)
        group[name].with_config({"write_empty_chunks": True})[where] = variables[name].values
    to_disk(files.values(), path)
    group[f"{INSIDE}/done"][i] = True
    to_disk([path / INSIDE / "done" / "c" / str(i)], path)


def to_disk(files, top):
    """Have the system write files, and the folders below `top` that name them, to the disk."""
    folders = {one for file in files for one in file.parents if one.is_relative_to(top)}
    for file in {*files, *folders}:
        handle = os.open(file, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def result_of(path):
    """The result in a store, read where it is used; cases not done have the status -1."""
    data = xarray.open_zarr(path, chunks=None)
    if data["message"].size > MANY:
        return data
    # xarray cannot mask zarr's own type for text
    return data.assign(message=data["message"].astype(object))
