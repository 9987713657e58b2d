"""What a store says of itself in its group ``sweep``, and which of its files have a flaw."""

import contextlib
import functools
import json
from typing import Any

import numpy as np
import zarr

from ..errors import StoreError
from . import legacy, sentence
from .chunks import Chunks
from .legacy import DAMAGE, METADATA, SWEEP_GROUP
from .manifest import MANIFEST, RECORDS, File, damage_message, flaws_among

RECORD = f"{SWEEP_GROUP}/zarr.json"


def refuse_zarr_2(path):
    """Raise StoreError if a Zarr folder, or an array that it lists, is in format 2.

    A codec of that format, pickle, runs whatever code a file holds.  Format 3 has no such codec.
    """
    formats = [2] if (path / ".zgroup").exists() or (path / ".zarray").exists() else []
    with contextlib.suppress(OSError, ValueError):  # it is not there, or damaged
        text = (path / METADATA).read_text()
        json.loads(text, object_hook=lambda node: formats.append(node.get("zarr_format", 3)))
    if any(one != 3 for one in formats):
        raise StoreError(sentence("store.zarr_2", path=path))


class Record:
    """What the store at a path says of itself; each part is read once, when it is first used.

    Damaged metadata of the group, or of its arrays, raise StoreError, or one of `DAMAGE`, as does a
    path without a store (see `as_store_error`).
    """

    def __init__(self, path):
        refuse_zarr_2(path)
        self.path = path
        self.group: Any = zarr.open_group(
            path / SWEEP_GROUP, mode="r", zarr_format=3, use_consolidated=False
        )
        self.attrs: dict = self.group.attrs.asdict()

    @functools.cached_property
    def chunks(self):
        """`Chunks` of the sweep; StoreError if there are not as many as flags."""
        chunks = Chunks(self.attrs["sizes"], tuple(self.attrs["chunk"]))
        if self.metadata_flaws:
            return chunks
        flags = self.group.get("done")
        possible = min(chunks.shape, default=1) > 0 and len(chunks.sizes) == len(chunks.shape)
        if flags is None or not possible or chunks.number != flags.size:
            damaged = File(RECORD, None, None, "damaged")
            raise StoreError(sentence("damage.inputs", path=self.path, why=damaged))
        return chunks

    @functools.cached_property
    def done(self):
        """Which chunks are done; (chunks,) bool, False where the flag is damaged."""
        return np.array(self._flags, bool)

    @property
    def entries(self):
        """Entries of the manifest: chunk, or None for what was made with the store -> dict.

        Of chunks that are done; those that are missing or damaged are left out.
        """
        return self._manifest[0]

    @functools.cached_property
    def _flags(self):
        """The flag of each chunk; None for those that are damaged."""
        return self._values("done")

    @functools.cached_property
    def _manifest(self):
        """`entries`, and the list of files of entries that are missing or damaged."""
        number = self.chunks.number
        texts = self._values("manifest") if "manifest" in self.group else [""] * (number + 1)
        entries, flaws = {}, []
        for i in [*np.flatnonzero(self.done).tolist(), None]:
            index = number if i is None else i
            entry = json.loads(texts[index] or "{}")
            if entry.get("chunk", -1) == i:  # and not that of another chunk
                entries[i] = entry
            elif RECORDS in self.attrs:  # older stores lack it, all or in part
                how = "missing" if texts[index] == "" else "damaged"
                flaws.append(File(f"{MANIFEST}/c/{index}", i, None, how))
        return entries, flaws

    @functools.cached_property
    def files(self):
        """Key -> `File`, for all files that the store must have, not checked.

        But StoreError if the record of the sweep's inputs itself, ``sweep/zarr.json``, has a flaw.
        """
        files = [
            File(key, i, digest)
            for i, entry in self.entries.items()
            for key, digest in entry["sha256"].items()
        ]
        if RECORDS not in self.attrs:
            unrecorded = {*np.flatnonzero(self.done).tolist()} - self.entries.keys()
            files += [File(*pair) for pair in legacy.files(self.path, self.chunks, unrecorded)]
        if damaged := flaws_among(self.path, [file for file in files if file.key == RECORD]):
            raise StoreError(sentence("damage.inputs", path=self.path, why=damaged[0]))
        return {file.key: file for file in files}

    @functools.cached_property
    def metadata_flaws(self):
        """List of `File`: flawed metadata without which flags and manifest are lost; [] if none."""
        digests = self.attrs.get(RECORDS, {})
        return flaws_among(self.path, [File(key, digest=digest) for key, digest in digests.items()])

    @functools.cached_property
    def flaws(self):
        """List of `File`: all in which flaws can be seen, [] if none; reads every file.

        Only `metadata_flaws` where there are any.
        """
        if self.metadata_flaws:
            return self.metadata_flaws
        damaged = [i for i, flag in enumerate(self._flags) if flag is None]
        flags = [File(f"{SWEEP_GROUP}/done/c/{i}", i, None, "damaged") for i in damaged]
        return flags + self._manifest[1] + flaws_among(self.path, self.files.values())

    def intact(self, flaws):
        """Which chunks are done and have no file among these `File`s; (chunks,) bool."""
        done = self.done.copy()
        done[[file.chunk for file in flaws if file.chunk is not None]] = False
        return done

    def _values(self, name):
        """Values of an array with a file for each value; None for those that are damaged."""
        if self.metadata_flaws:
            raise StoreError(damage_message(self.path, self.metadata_flaws))
        array = self.group[name]
        try:
            return array[:].tolist()
        except DAMAGE:
            return [_value(array, i) for i in range(array.size)]


def _value(array, i):
    try:
        return array[i].item()
    except DAMAGE:
        return None
