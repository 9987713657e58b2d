"""Chunks written into a store, so that any interruption leaves it intact.

A chunk has one file for each variable, written by one task.  These files, and the chunk's entry in
the manifest, reach the disk before its flag does.  A temporary file is written and renamed, so that
a file is complete or absent.
"""

import contextlib
import os
import uuid
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import zarr
from zarr.storage import LocalStore

from ..errors import StoreError
from . import sentence
from .chunks import Chunks
from .legacy import SWEEP_GROUP, array_and_block
from .manifest import MANIFEST, manifest_entry
from .origin import origin

# A file of numbers that is absent is read as this, netCDF's fill value, which no result has.
# Readers shall see it, so it is not declared as a missing value.
NO_RESULT = 9.969209968386869e36
# By kind of number; that of integers is the status of a case that has not been done.
FILL_VALUES = {"f": NO_RESULT, "c": complex(NO_RESULT, NO_RESULT), "i": -1}


class Store(NamedTuple):
    """An open store."""

    path: Path
    chunks: Chunks
    done: np.ndarray  # (chunks,) bool, when it was opened
    checksum: str  # of its inputs, SHA-256
    variables: frozenset  # names of those that it has arrays for


class _Present(LocalStore):
    """A store that is there, whose folder and arrays are not made again if they have vanished."""

    def __init__(self, root, *, read_only=False):
        super().__init__(root, read_only=read_only)
        self._is_open = True  # (opening it would make its folder)

    async def set(self, key, value):
        """Write a file, as a whole; FileNotFoundError if the array that it is part of is gone."""
        self.set_sync(key, value)

    def set_sync(self, key, value):
        """As `set`."""
        path, array = self.root / key, self.root / array_and_block(key)[0]
        for folder in reversed(path.parents):
            if array in folder.parents:
                folder.mkdir(exist_ok=True)
        partial = path.with_suffix(f".{uuid.uuid4().hex}.partial")
        try:
            partial.write_bytes(value.as_buffer_like())
            partial.replace(path)
        finally:
            partial.unlink(missing_ok=True)


@contextlib.contextmanager
def _as_write_error(path):
    """Turn any error from writing into a StoreError."""
    try:
        yield
    except StoreError:
        raise
    except (FileNotFoundError, KeyError) as error:
        raise StoreError(sentence("store.vanished", path=path)) from error
    except OSError as error:
        raise StoreError(sentence("store.full", path=path, error=error)) from error


def write(store, i, variables):
    """Write the variables of chunk i into an open store, and set its flag.

    If that fails (StoreError) the store lacks this chunk, and nothing else.
    """
    path, slices = store.path, store.chunks.slices(i)
    dims = {name: v.dims for name, v in variables.items() if name in store.variables}
    keys = store.chunks.file_keys(i, dims)
    with _as_write_error(path):
        path.stat()  # raises, if it is gone, what a worker can send; zarr's own error it cannot
        present = _Present(path)
        group: Any = zarr.open_group(present, mode="r+", zarr_format=3, use_consolidated=False)
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
    """Clear the flags of these chunks (list of int), so that they are computed again.

    Returns the `Store` without them; StoreError if it cannot be written to.
    """
    done = store.done.copy()
    done[numbers] = False
    with _as_write_error(store.path):
        group: Any = zarr.open_group(_Present(store.path), mode="r+", zarr_format=3)
        flags = group[f"{SWEEP_GROUP}/done"]
        for i in numbers:  # (zarr removes the files)
            flags[i] = False
        to_disk([store.path / SWEEP_GROUP / "done" / "c"], store.path)
    return store._replace(done=done)


def to_disk(files, top):
    """Have the system write files, and their folders up to `top`, to the disk; OSError if it fails.

    files : list of paths within `top`, all there
    """
    folders = {one for file in files for one in file.parents if one.is_relative_to(top)}
    for file in {*files, *folders}:
        handle = os.open(file, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
