"""A store of a sweep on disk: a Zarr group, filled by chunks, that any interruption leaves intact.

The group holds the result as xarray reads it.  Its subgroup ``sweep`` has the rest: ``inputs``, the
shape of chunks, versions, ``done``, one flag a chunk, and ``manifest``, the checksum and origin of
each file.  A chunk has one file for each variable, written by one task.  These files, and the
chunk's entry in the manifest, reach the disk before its flag does.  zarr writes a temporary file
and renames it, so that a file is complete or absent.
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
from .inputs import checksum, input_differences, inputs_of
from .legacy import DAMAGE, SWEEP_GROUP
from .manifest import (
    MANIFEST,
    Checked,
    as_lines,
    damage_message,
    find_flaws,
    flawed_metadata,
    inputs_damaged_message,
    manifest_entry,
    read_contents,
)
from .origin import origin

# A file of numbers that is absent is read as this, netCDF's fill value, which no result has.
# Readers shall see it, so it is not declared as a missing value.
NO_RESULT = 9.969209968386869e36
# Up to so many cases all messages are read at once.
MOST_MESSAGES = 10**7


class Store(NamedTuple):
    """An open store."""

    path: Path
    chunks: Chunks
    done: np.ndarray  # (chunks,) bool, when it was opened
    checksum: str  # of its inputs
    variables: frozenset  # names of those that it has arrays for


def matching_group(path, request):
    """The group ``sweep`` of the store at a path, which must belong to the requested sweep.

    Raises
    ------
    StoreError
        It was made from other parameters, listed; it is no store of a sweep, or cannot be read.
    """
    sweep_group, inputs = read_group(path)
    chunks = stored_chunks(sweep_group)
    lines = input_differences(inputs, inputs_of(request.name, request.call))
    device, chunk = sweep_group.attrs["device"], request.chunk
    if request.device != device:
        lines.append(f"device: {device} in the store, {request.device} now")
    if chunk is not None and chunks_of(chunks.sizes, chunk).shape != chunks.shape:
        lines.append(f"chunk: blocks of {chunks.shape} cases in the store, chunk={chunk} now")
    if lines:
        raise StoreError(
            f"{path} holds another sweep; give this one a store of its own, or make it the "
            f"same:{as_lines(lines)}"
        )
    return sweep_group


def is_complete(path, sweep_group):
    """Whether a store has all chunks and no damaged file; reads every file."""
    with as_store_error(path):
        if flawed_metadata(path, sweep_group):
            return False
        contents = read_contents(path, sweep_group)
        return bool(contents.done.all()) and not find_flaws(contents)


def stored_chunks(sweep_group):
    """`Chunks` of the store with this group ``sweep``."""
    return Chunks(sweep_group.attrs["sizes"], tuple(sweep_group.attrs["chunk"]))


def remove_partials(path):
    """Remove temporary files that killed writers left in a store."""
    for partial in path.rglob("*.partial"):
        partial.unlink(missing_ok=True)


def device_attrs(device):
    """Attributes of a result that name its device: a GPU and a CPU differ in last digits."""
    return {} if device == "cpu" else {"device": device}


@contextlib.contextmanager
def as_store_error(path):
    """Turn any error from reading a damaged store, or something that is none, into a StoreError."""
    try:
        yield
    except StoreError:
        raise
    except PermissionError as error:
        raise StoreError(f"{path} cannot be read ({error.strerror})") from error
    except DAMAGE as error:
        flaws = _flaws_of_store(path)
        inputs = f"{SWEEP_GROUP}/inputs/"
        if lost := [flaw for flaw in flaws if flaw.file.key.startswith(inputs)]:
            raise StoreError(inputs_damaged_message(path, lost[0])) from error
        if flaws:
            raise StoreError(damage_message(path, flaws)) from error
        if not path.exists():
            raise StoreError(
                f"there is nothing at {path}: no sweep has stored a chunk yet, or it "
                "was another path"
            ) from error
        if (path / SWEEP_GROUP).is_dir():
            raise StoreError(inputs_damaged_message(path, f"{SWEEP_GROUP}: {error}")) from error
        raise StoreError(f"{path} is no store of a sweep ({error}); give another path") from error


def _flaws_of_store(path):
    """All `Flaw`s of the store at a path; none if they cannot be determined."""
    try:
        sweep_group: Any = zarr.open_group(path / SWEEP_GROUP, mode="r", use_consolidated=False)
        return flawed_metadata(path, sweep_group) or find_flaws(read_contents(path, sweep_group))
    except DAMAGE:
        return []


def read_group(path):
    """The group ``sweep`` of a store, and the inputs of the sweep; StoreError if damaged."""
    with as_store_error(path):
        sweep_group: Any = zarr.open_group(path / SWEEP_GROUP, mode="r", use_consolidated=False)
        with xarray.open_zarr(
            path, group=f"{SWEEP_GROUP}/inputs", chunks=None, consolidated=False, decode_cf=False
        ) as data:
            inputs = data.load()
        needed = {"verb", "sizes", "chunk", "device", "checksum", "versions"}
        complete = needed <= {*sweep_group.attrs}
    if not complete or checksum(inputs) != sweep_group.attrs["checksum"]:
        raise StoreError(inputs_damaged_message(path, "its checksum is another"))
    return sweep_group, inputs


def write(store, i, variables):
    """Write the variables of chunk i into an open store, and set its flag.

    Raises
    ------
    StoreError
        They cannot be written completely; the store then lacks this chunk, and nothing else.
    """
    with _as_write_error(store.path):
        _write(store, i, variables)


def mark_undone(store, numbers):
    """Clear the flags of these chunks, so that they are computed again; return the store.

    Raises what `write` does.
    """
    done = store.done.copy()
    done[numbers] = False
    with _as_write_error(store.path):
        flags: Any = zarr.open_array(store.path / SWEEP_GROUP / "done", mode="r+")
        for i in numbers:  # (zarr removes the files)
            flags[i] = False
        to_disk([store.path / SWEEP_GROUP / "done" / "c"], store.path)
    return store._replace(done=done)


@contextlib.contextmanager
def _as_write_error(path):
    """Turn any error from writing into a StoreError."""
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
    sweep_group = group[SWEEP_GROUP]
    if sweep_group.attrs["checksum"] != store.checksum:  # a worker may not have noticed
        raise StoreError(f"{path} has been replaced by the store of another sweep")
    stored = {name: variable for name, variable in variables.items() if name in store.variables}
    keys, slices = chunks.file_keys(i, stored), chunks.slices(i)
    for name in keys:
        where = tuple(slices.get(dim, slice(None)) for dim in variables[name].dims)
        # (zarr omits files that hold only fill values; here a missing file must mean a loss)
        group[name].with_config({"write_empty_chunks": True})[where] = variables[name].values
    group[MANIFEST][i] = manifest_entry(path, keys.values(), i, origin(sweep_group.attrs["device"]))
    to_disk([path / key for key in (*keys.values(), f"{MANIFEST}/c/{i}")], path)
    group[f"{SWEEP_GROUP}/done"][i] = True
    to_disk([path / SWEEP_GROUP / "done" / "c" / str(i)], path)


def to_disk(files, top):
    """Have the system write files, and their folders up to `top`, to the disk."""
    folders = {one for file in files for one in file.parents if one.is_relative_to(top)}
    for file in {*files, *folders}:
        handle = os.open(file, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def open_result(path):
    """The result in a store, read and checked when it is used; cases not done: status -1, NaN."""
    with as_store_error(path):
        sweep_group: Any = zarr.open_group(path / SWEEP_GROUP, mode="r", use_consolidated=False)
        contents = read_contents(path, sweep_group)
        data = xarray.open_zarr(Checked(path, contents=contents), chunks=None, decode_cf=False)
        if not contents.done.all():
            for variable in data.data_vars.values():
                if variable.dtype.kind in "fc":
                    fill = (
                        complex(NO_RESULT, NO_RESULT) if variable.dtype.kind == "c" else NO_RESULT
                    )
                    variable.attrs["_FillValue"] = fill
        data = xarray.decode_cf(data)
        if data["message"].size > MOST_MESSAGES:
            return data
        # xarray cannot mask zarr's own type for text
        return data.assign(message=data["message"].astype(object))


def load_result(path):
    """Read the result in a store into memory; StoreError if a file is damaged or missing."""
    with as_store_error(path):
        return open_result(path).load()
