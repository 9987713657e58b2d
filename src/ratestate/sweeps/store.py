"""A store of a sweep on disk: a Zarr group, filled by chunks, that any interruption leaves intact.

The group holds the result as xarray reads it.  Its subgroup ``sweep`` has the rest: ``inputs``, the
shape of chunks, versions, ``done``, one flag a chunk, and ``manifest``, the checksum and origin of
each file.  A chunk has one file for each variable, written by one task.  These files, and the
chunk's entry in the manifest, reach the disk before its flag does.  zarr writes a temporary file
and renames it, so that a file is complete or absent.
"""

import contextlib
import os
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray
import zarr

from ..errors import RateStateError, StoreError
from . import sentence
from .chunks import Chunks, chunks_of
from .inputs import checksum, input_differences, inputs_of
from .legacy import DAMAGE, SWEEP_GROUP
from .manifest import (
    MANIFEST,
    Checked,
    Record,
    as_lines,
    damage_message,
    manifest_entry,
)
from .origin import origin

# A file of numbers that is absent is read as this, netCDF's fill value, which no result has.
# Readers shall see it, so it is not declared as a missing value.
NO_RESULT = 9.969209968386869e36
# By kind of number; that of integers is the status of a case that has not been done.
FILL_VALUES = {"f": NO_RESULT, "c": complex(NO_RESULT, NO_RESULT), "i": -1}
# Up to so many cases all messages are read at once.
MOST_MESSAGES = 10**7


class Store(NamedTuple):
    """An open store."""

    path: Path
    chunks: Chunks
    done: np.ndarray  # (chunks,) bool, when it was opened
    checksum: str  # of its inputs
    variables: frozenset  # names of those that it has arrays for


@contextlib.contextmanager
def as_store_error(path):
    """Turn an error from reading a damaged store, or something that is none, into a StoreError.

    Other errors go on as they are: those of this package, and those of stores whose files are all
    as they were written.
    """
    try:
        yield
    except RateStateError:
        raise
    except PermissionError as error:
        raise StoreError(sentence("store.unreadable", path=path, error=error.strerror)) from error
    except DAMAGE as error:
        if message := _damage(path, error):
            raise StoreError(message) from error
        raise


def _damage(path, error):
    """The message about an error from reading a store; "" if no file of it is to blame."""
    if not path.exists():
        return sentence("store.nothing", path=path)
    if not (path / SWEEP_GROUP).is_dir():
        return sentence("store.none", path=path, error=error)
    try:
        flaws = Record(path).flaws
    except DAMAGE:
        return sentence("damage.inputs", path=path, why=f"{SWEEP_GROUP}: {error}")
    inputs = f"{SWEEP_GROUP}/inputs/"
    if lost := [file for file in flaws if file.key.startswith(inputs)]:
        return sentence("damage.inputs", path=path, why=lost[0])
    if flaws:
        return damage_message(path, flaws)
    of_system = isinstance(error, OSError)
    return sentence("store.unreadable", path=path, error=error) if of_system else ""


def read_record(path):
    """The `Record` of a store, and the inputs of its sweep; StoreError if these are damaged."""
    with as_store_error(path):
        record = Record(path)
        with xarray.open_zarr(
            path, group=f"{SWEEP_GROUP}/inputs", chunks=None, consolidated=False, decode_cf=False
        ) as data:
            inputs = data.load()
    needed = {"verb", "sizes", "chunk", "device", "checksum", "versions"}
    if not needed <= {*record.attrs} or checksum(inputs) != record.attrs["checksum"]:
        raise StoreError(sentence("damage.inputs", path=path, why="its checksum is another"))
    return record, inputs


def matching_record(path, request):
    """The `Record` of a store; StoreError, with the differences, if it is of another sweep."""
    record, inputs = read_record(path)
    lines = input_differences(inputs, inputs_of(request.name, request.call))
    chunks, device, chunk = record.chunks, record.attrs["device"], request.chunk
    if request.device != device:
        lines.append(f"device: {device} in the store, {request.device} now")
    if chunk is not None and chunks_of(chunks.sizes, chunk).shape != chunks.shape:
        lines.append(f"chunk: blocks of {chunks.shape} cases in the store, chunk={chunk} now")
    if lines:
        raise StoreError(sentence("store.other_sweep", path=path, lines=as_lines(lines)))
    return record


def device_attrs(device):
    """Attributes of a result that name its device: a GPU and a CPU differ in last digits."""
    return {} if device == "cpu" else {"device": device}


@contextlib.contextmanager
def _as_write_error(path):
    """Turn any error from writing into a StoreError."""
    try:
        yield
    except StoreError:
        raise
    except (OSError, KeyError) as error:
        raise StoreError(sentence("store.full", path=path, error=error)) from error


def write(store, i, variables):
    """Write the variables of chunk i into an open store, and set its flag.

    If that fails (StoreError) the store lacks this chunk, and nothing else.
    """
    path, slices = store.path, store.chunks.slices(i)
    dims = {name: v.dims for name, v in variables.items() if name in store.variables}
    keys = store.chunks.file_keys(i, dims)
    with _as_write_error(path):
        group: Any = zarr.open_group(path, mode="r+", zarr_format=3, use_consolidated=False)
        attrs = group[SWEEP_GROUP].attrs
        if attrs["checksum"] != store.checksum:  # a worker may not have noticed
            raise StoreError(sentence("store.replaced", path=path))
        for name in keys:
            where = tuple(slices.get(dim, slice(None)) for dim in dims[name])
            # (zarr omits files that hold only fill values; here a missing file must mean a loss)
            group[name].with_config({"write_empty_chunks": True})[where] = variables[name].values
        group[MANIFEST][i] = manifest_entry(path, keys.values(), i, origin(attrs["device"]))
        to_disk([path / key for key in (*keys.values(), f"{MANIFEST}/c/{i}")], path)
        group[f"{SWEEP_GROUP}/done"][i] = True
        to_disk([path / SWEEP_GROUP / "done" / "c" / str(i)], path)


def mark_undone(store, numbers):
    """Clear the flags of these chunks, so that they are computed again; return the store."""
    done = store.done.copy()
    done[numbers] = False
    with _as_write_error(store.path):
        flags: Any = zarr.open_array(store.path / SWEEP_GROUP / "done", mode="r+")
        for i in numbers:  # (zarr removes the files)
            flags[i] = False
        to_disk([store.path / SWEEP_GROUP / "done" / "c"], store.path)
    return store._replace(done=done)


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
        record = Record(path)
        checked = Checked(path, files=record.files)
        data = xarray.open_zarr(checked, chunks=None, decode_cf=False)
        if not record.done.all():
            for variable in data.data_vars.values():
                if variable.dtype.kind in "fc":
                    variable.attrs["_FillValue"] = FILL_VALUES[variable.dtype.kind]
        data = xarray.decode_cf(data)
        if data["message"].size > MOST_MESSAGES:
            return data
        return data.assign(message=data["message"].astype(object))  # see `python_text`


def load_result(path):
    """Read the result in a store into memory; StoreError if a file is damaged or missing."""
    with as_store_error(path):
        return open_result(path).load()


def python_text(data):
    """The same with text as Python has it: Zarr 3 specifies no other, and xarray masks no other."""
    texts = {k: v.astype(object) for k, v in data.variables.items() if v.dtype.kind in "UT"}
    return data.assign(texts)


@contextlib.contextmanager
def zarr_3_warnings_ignored():
    """Allow text and consolidated metadata: zarr warns, but all readers of Zarr 3 know them."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        yield
