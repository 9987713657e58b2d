"""A store of a sweep: a Zarr group on disk, which holds the result as xarray reads it.

=================  ================================================================================
``zarr.json``      metadata; a sweep that writes to the store holds the lock of this file
``NAME/c/...``     a variable of the result, with one file for each chunk
``sweep/``         record: arguments, sizes, shape of chunks, versions, processor, variables
=================  ================================================================================

States of a store, and what a kill leaves:

1. The store is being made in the hidden folder ``.NAME.partial`` beside it.  It is renamed when all
   metadata and coordinates are on the disk.  They are never written again.  A kill leaves the
   hidden folder, which the next sweep takes over.
2. A chunk is not done: it has no file of ``status``.  A kill may leave some of its other files,
   which are written again.
3. A chunk is done: its file of ``status``, which is written last, exists.

A file exists only as a whole: zarr writes ``*.partial`` and renames it.  Damage that happens later
shows when a file is missing, or does not agree with the checksum of its codec.  The chunk is then
computed again.
"""

import contextlib
import dataclasses
import functools
import json
import warnings
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray
import zarr

from ..errors import RateStateError, StoreError
from . import sentence
from .chunks import Chunks

SWEEP_GROUP, METADATA = "sweep", "zarr.json"
#: errors that zarr, its codecs and xarray raise for damaged files
DAMAGE = (OSError, KeyError, TypeError, ValueError, RuntimeError)
# A file of numbers that is absent is read as this, netCDF's fill value, which no result has.
# Readers shall see it, so it is not declared as a missing value.
NO_RESULT = 9.969209968386869e36
# The same by kind of number; for integers it is the status of a case that has not been done.
FILL_VALUES = {"f": NO_RESULT, "c": complex(NO_RESULT, NO_RESULT), "i": -1}
# Up to so many cases all messages are read at once; lines of a message about many files.
MOST_MESSAGES, MOST_LINES = 10**7, 20


class Flaw(NamedTuple):
    """A file of a store that is missing or damaged."""

    key: str  # its path within the store
    chunk: int | None  # None: it was made with the store
    how: str  # "missing" or "damaged"

    def __str__(self):
        chunk = "" if self.chunk is None else f", chunk {self.chunk}"
        return f"variable {self.key.partition('/c')[0]}{chunk} ({self.key}) is {self.how}"


@dataclasses.dataclass(frozen=True)
class Store:
    """The store at a path; `record` is the content of ``sweep/zarr.json``."""

    path: Path
    record: dict

    @classmethod
    def open(cls, path):
        """Return the `Store` at a path; raise one of `DAMAGE` if there is none (see `reading`)."""
        refuse_zarr_2(path)
        return cls(path, json.loads((path / SWEEP_GROUP / METADATA).read_text())["attributes"])

    @property
    def arguments(self):
        """Arguments of the sweep; StoreError if an earlier version, which records none, made it."""
        if "arguments" not in self.record:
            raise StoreError(sentence("store.old", path=self.path))
        return self.record["arguments"]

    @functools.cached_property
    def chunks(self):
        """`Chunks` of the sweep; StoreError if the variables have others."""
        chunks = Chunks(self.record["sizes"], tuple(self.record["chunk"]))
        status = self.arrays["status"]
        if (status.shape, status.chunks) != (tuple(chunks.sizes.values()), chunks.shape):
            raise StoreError(sentence("damage.record", path=self.path, why="sizes do not agree"))
        return chunks

    @functools.cached_property
    def group(self) -> Any:
        """The zarr group, whose metadata include the metadata of all arrays."""
        return zarr.open_group(self.path, mode="r", zarr_format=3, use_consolidated=True)

    @functools.cached_property
    def arrays(self):
        """Name -> zarr array, for all variables and coordinates."""
        return dict(self.group.arrays())

    @functools.cached_property
    def dims(self):
        """Name -> dimensions, for the variables that chunks write."""
        # the time of a run is a coordinate, but also a result
        coordinates = {*self.record["sizes"], *self.group.attrs["coordinates"].split()} - {"t"}
        # other variables have values of the scenario; stores of earlier versions have none
        names = self.record.get("variables", self.arrays).keys() - coordinates
        dims = {name: self.arrays[name].metadata.dimension_names for name in names}
        sizes = self.record["sizes"].keys()
        return {name: own_dims for name, own_dims in dims.items() if sizes & {*(own_dims or ())}}

    def done(self):
        """Return which chunks are done: (chunks,) bool."""
        marks = (key_of("status", self.chunks.index(i)) for i in range(self.chunks.number))
        return np.array([(self.path / mark).exists() for mark in marks])

    def flaws(self, contents=True):
        """Return a list of `Flaw`: missing files and, if contents are read, damaged ones."""
        flaws = []
        for name, block, chunk in self._blocks():
            key = key_of(name, block)
            if not (self.path / key).exists():
                flaws.append(Flaw(key, chunk, "missing"))
            elif contents:
                try:
                    self.arrays[name].blocks[block] if block else self.arrays[name][...]
                except DAMAGE:
                    flaws.append(Flaw(key, chunk, "damaged"))
        return flaws

    def _blocks(self):
        """Yield name of the variable, index of the block, and chunk, for each file."""
        for name in self.arrays.keys() - self.dims.keys():
            for block in np.ndindex(self.arrays[name].cdata_shape):
                yield name, block, None
        for i in np.flatnonzero(self.done()).tolist():
            for name, block in self.chunks.blocks(i, self.dims).items():
                yield name, block, i

    def statuses(self, done):
        """Return a `Counter` of the statuses of cases in the chunks `done`, (chunks,) bool."""
        blocks, counts = self.arrays["status"].blocks, Counter[int]()
        for i in np.flatnonzero(done).tolist():
            counts.update(blocks[self.chunks.index(i)].ravel().tolist())
        return counts


def key_of(name, block):
    """Return the path within a store of the file with a block of a variable."""
    return "/".join([name, "c", *map(str, block)])


def refuse_zarr_2(path):
    """Raise StoreError if a Zarr folder, or an array that it lists, is in format 2.

    A codec of that format, pickle, runs whatever code a file holds.  Format 3 has no such codec.
    """
    formats = [2] if (path / ".zgroup").exists() or (path / ".zarray").exists() else []
    with contextlib.suppress(OSError, ValueError):  # it is not there, or damaged
        text = (path / METADATA).read_text()
        json.loads(text, object_hook=lambda node: formats.append(node.get("zarr_format", 3)))
    if any(number != 3 for number in formats):
        raise StoreError(sentence("store.zarr_2", path=path))


@contextlib.contextmanager
def reading(path):
    """Turn an error from reading a store that is damaged, or absent, into a StoreError."""
    try:
        yield
    except RateStateError:
        raise
    except DAMAGE as error:
        raise StoreError(_reason(path, error)) from error


def _reason(path, error):
    """Return why a store cannot be read, as text."""
    if isinstance(error, PermissionError):
        return sentence("store.unreadable", path=path, error=error.strerror)
    if not path.exists():
        return sentence("store.nothing", path=path)
    if not (path / SWEEP_GROUP).is_dir():
        return sentence("store.none", path=path)
    with contextlib.suppress(*DAMAGE):
        if flaws := Store.open(path).flaws():
            return damage_message(path, flaws)
    return sentence("damage.record", path=path, why=f"{type(error).__name__}: {error}")


def damage_message(path, flaws):
    """Return the message about flawed files of a store, a list of `Flaw`."""
    lasting = [flaw for flaw in flaws if flaw.chunk is None]
    name = "damage.lasting" if lasting else "damage.chunks"
    return sentence(name, path=path, lines=as_lines(lasting or flaws))


def as_lines(lines):
    """Return text to append to a message: the first of these lines, and how many more."""
    more = [f"and {len(lines) - MOST_LINES} more"] if len(lines) > MOST_LINES else []
    return "".join(f"\n  {line}" for line in [*lines[:MOST_LINES], *more])


def device_attrs(device):
    """Return attributes of a result that name its device, because a GPU gives other last digits."""
    return {} if device == "cpu" else {"device": device}


def open_result(path):
    """Return the result in a store, a Dataset that reads numbers when they are used.

    If cases are not done, their integers are -1, the status too, and all else NaN, False or "".
    StoreError if the store cannot be opened, or a file is missing.
    """
    with reading(path):
        store = Store.open(path)
        is_old = "arguments" not in store.record  # its chunks were done later than their status
        if missing := [] if is_old else store.flaws(contents=False):
            raise StoreError(damage_message(path, missing))
        data = xarray.open_zarr(path, chunks=None, decode_cf=False, zarr_format=3)
        if not store.done().all():
            for variable in data.data_vars.values():
                if variable.dtype.kind in "fc":
                    variable.attrs["_FillValue"] = FILL_VALUES[variable.dtype.kind]
        data = xarray.decode_cf(data)
        if data["message"].size > MOST_MESSAGES:
            return data
        return data.assign(message=data["message"].astype(object))  # see `python_text`


def python_text(data):
    """Return a Dataset with Python's text: Zarr 3 specifies no other, and xarray masks no other."""
    texts = {k: v.astype(object) for k, v in data.variables.items() if v.dtype.kind in "UT"}
    return data.assign(texts)


@contextlib.contextmanager
def zarr_3_warnings_ignored():
    """Ignore zarr's UserWarnings on text and consolidated metadata, which Zarr 3 readers know."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        yield
