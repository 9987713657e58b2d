"""A store of a sweep on disk: a Zarr group, filled by chunks, that any interruption leaves whole.

The group holds the result as xarray reads it.  Its subgroup ``sweep`` knows the rest: ``inputs``,
the shape of chunks, versions, ``done``, one flag a chunk, and ``manifest``, what each file must
hold and what made it.  A chunk is one file a variable, written by one task, and reaches the disk,
its entry in the manifest with it, before its flag does.  zarr writes a file beside its
place and renames it, so that a file is whole or absent.
"""

import contextlib
import os
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray
import zarr

from ..errors import StoreError
from .chunks import Chunks, chunks_of
from .inputs import checksum, differences, inputs_of
from .manifest import (
    MANIFEST,
    Checked,
    contents,
    entry,
    flawed_records,
    flaws,
    listed,
    lost_record,
    told,
)
from .older import DAMAGE, INSIDE
from .origin import origin

# What stands in a file of numbers that is not there: the value that netCDF has for it.  No result
# has it, and readers shall see it, so it is not declared as missing.
NO_RESULT = 9.969209968386869e36
# Cases of which all messages are read at once.
MANY = 10**7


class Store(NamedTuple):
    """An open store."""

    path: Path
    chunks: Chunks
    done: np.ndarray  # (chunks,) bool, when it was opened
    checksum: str  # of its inputs
    variables: frozenset  # names of those that it has room for


def examined(path, verb, call, chunk, device):
    """The group with what is known of a sweep in the store at a path, if it is this sweep's.

    Raises
    ------
    StoreError
        It was made from other parameters, listed; it is no store of a sweep, or cannot be read.
    """
    inside, inputs = read(path)
    chunks = chunks_in(inside)
    lines = differences(inputs, inputs_of(verb, call))
    if device != inside.attrs["device"]:
        lines.append(f"device: {inside.attrs['device']} in the store, {device} now")
    if chunk is not None and chunks_of(chunks.sizes, chunk).shape != chunks.shape:
        lines.append(f"chunk: blocks of {chunks.shape} cases in the store, chunk={chunk} now")
    if lines:
        raise StoreError(
            f"{path} holds another sweep; give this one a store of its own, or make it the "
            f"same:{listed(lines)}"
        )
    return inside


def is_complete(path, inside):
    """Whether all chunks are in a store, and nothing of it is damaged; reads every file."""
    with damage_told(path):
        if flawed_records(path, inside):
            return False
        held = contents(path, inside)
        return bool(held.done.all()) and not flaws(held)


def chunks_in(inside):
    """`Chunks` of a store, of which this is the group ``sweep``."""
    return Chunks(inside.attrs["sizes"], tuple(inside.attrs["chunk"]))


def sweep_up(path):
    """Remove what killed writers left in a store."""
    for partial in path.rglob("*.partial"):
        partial.unlink(missing_ok=True)


def noted(device):
    """Attributes of a result that say where it comes from: the GPU's bits are not the CPU's."""
    return {} if device == "cpu" else {"device": device}


@contextlib.contextmanager
def damage_told(path):
    """Make a StoreError of all that reading a store that is none, or damaged, may raise."""
    try:
        yield
    except StoreError:
        raise
    except PermissionError as error:
        raise StoreError(f"{path} cannot be read ({error.strerror})") from error
    except DAMAGE as error:
        found = _flaws_at(path)
        if lost := [flaw for flaw in found if flaw.file.key.startswith(f"{INSIDE}/inputs/")]:
            raise StoreError(lost_record(path, lost[0])) from error
        if found:
            raise StoreError(told(path, found)) from error
        if not path.exists():
            raise StoreError(
                f"there is nothing at {path}: no sweep has stored a chunk yet, or it "
                "was another path"
            ) from error
        if (path / INSIDE).is_dir():
            raise StoreError(lost_record(path, f"{INSIDE}: {error}")) from error
        raise StoreError(f"{path} is no store of a sweep ({error}); give another path") from error


def _flaws_at(path):
    """All `Flaw`s of the store at a path; none if it cannot be told."""
    try:
        inside: Any = zarr.open_group(path / INSIDE, mode="r", use_consolidated=False)
        return flawed_records(path, inside) or flaws(contents(path, inside))
    except DAMAGE:
        return []


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
        raise StoreError(lost_record(path, "its checksum is another"))
    return inside, inputs


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
    inside = group[INSIDE]
    if inside.attrs["checksum"] != store.checksum:  # a worker may be the last to know
        raise StoreError(f"{path} has been replaced by the store of another sweep")
    room = {name: variable for name, variable in variables.items() if name in store.variables}
    keys, places = chunks.keys(i, room), chunks.places(i)
    for name in keys:
        where = tuple(places.get(dim, slice(None)) for dim in variables[name].dims)
        # (zarr leaves out files of fill values alone; here a missing one shall be a loss, and seen)
        group[name].with_config({"write_empty_chunks": True})[where] = variables[name].values
    group[MANIFEST][i] = entry(path, keys.values(), i, origin(inside.attrs["device"]))
    to_disk([path / key for key in (*keys.values(), f"{MANIFEST}/c/{i}")], path)
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
    """The result in a store, read and checked where it is used; cases not done: status -1, NaN."""
    with damage_told(path):
        inside: Any = zarr.open_group(path / INSIDE, mode="r", use_consolidated=False)
        held = contents(path, inside)
        data = xarray.open_zarr(Checked(path, held=held), chunks=None, decode_cf=False)
        if not held.done.all():
            for variable in data.data_vars.values():
                if variable.dtype.kind in "fc":
                    fill = (
                        complex(NO_RESULT, NO_RESULT) if variable.dtype.kind == "c" else NO_RESULT
                    )
                    variable.attrs["_FillValue"] = fill
        data = xarray.decode_cf(data)
        if data["message"].size > MANY:
            return data
        # xarray cannot mask zarr's own type for text
        return data.assign(message=data["message"].astype(object))


def loaded(path):
    """The result in a store, in memory; StoreError if any of it is damaged or missing."""
    with damage_told(path):
        return result_of(path).load()
