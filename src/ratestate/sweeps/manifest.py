"""What a store must hold, by its group ``sweep``, and which files of it are missing or damaged.

``sweep/manifest`` is an array of strings, one for each chunk, and a last one for the files that
were made with the store.  Each is JSON: the number of the chunk, the SHA-256 of each of its files
by its path within the store, and the versions and the processor that made them.  A chunk's entry
reaches the disk before its flag does.  Stores of older versions have no manifest (see `legacy`).
"""

import functools
import hashlib
import json
from typing import Any, NamedTuple

import numpy as np
import zarr
from zarr.storage import LocalStore

from ..errors import StoreError
from . import legacy, sentence
from .chunks import Chunks
from .legacy import DAMAGE, SWEEP_GROUP

MANIFEST = f"{SWEEP_GROUP}/manifest"
RECORD = f"{SWEEP_GROUP}/zarr.json"
#: attribute of the group ``sweep``: SHA-256 of the metadata of the arrays of flags and manifest
RECORDS = "sha256"


class File(NamedTuple):
    """A file that a store must have."""

    key: str  # its path within the store
    chunk: int | None = None  # None: made with the store
    digest: str | None = None  # SHA-256; None: not recorded
    flaw: str = ""  # "missing" or "damaged"

    def __str__(self):
        variable, block = legacy.array_and_block(self.key)
        if block is None:
            return f"metadata ({self.key}) is {self.flaw}"
        chunk = block if self.chunk is None else self.chunk
        return f"variable {variable}, chunk {chunk} ({self.key}) is {self.flaw}"

    def holding(self, content):
        """The same with the flaw that it has with this content; None: there is no such file."""
        if content is None:
            return self._replace(flaw="missing")
        right = self.digest in (None, sha256(content))
        return self._replace(flaw="" if right else "damaged")


class Record:
    """What the store at a path says of itself; each part is read once, when it is first used.

    Damaged metadata of the group, or of its arrays, raise StoreError, or an error of zarr's.
    """

    def __init__(self, path):
        self.path = path
        self.group: Any = zarr.open_group(path / SWEEP_GROUP, mode="r", use_consolidated=False)
        self.attrs: dict = self.group.attrs.asdict()
        self.flawed: list[File] = []  # flags and entries that turned out to be damaged

    @functools.cached_property
    def chunks(self):
        """`Chunks` of the sweep."""
        return Chunks(self.attrs["sizes"], tuple(self.attrs["chunk"]))

    @functools.cached_property
    def done(self):
        """Which chunks are done; (chunks,) bool."""
        flags = self._values("done")
        damaged = [i for i, flag in enumerate(flags) if flag is None]
        self.flawed += [File(f"{SWEEP_GROUP}/done/c/{i}", i, None, "damaged") for i in damaged]
        return np.array(flags, bool)

    @functools.cached_property
    def entries(self):
        """Entries of the manifest: chunk, or None for what was made with the store -> dict."""
        number = self.chunks.number
        texts = self._values("manifest") if "manifest" in self.group else [""] * (number + 1)
        entries = {}
        for i in [*np.flatnonzero(self.done).tolist(), None]:
            index = number if i is None else i
            entry = json.loads(texts[index] or "{}")
            if entry.get("chunk", -1) == i:  # and not that of another chunk
                entries[i] = entry
            elif RECORDS in self.attrs:  # older stores lack it, all or in part
                how = "missing" if texts[index] == "" else "damaged"
                self.flawed.append(File(f"{MANIFEST}/c/{index}", i, None, how))
        return entries

    @functools.cached_property
    def files(self):
        """Key -> `File`, for all files that the store must have."""
        files = [
            File(key, i, digest)
            for i, entry in self.entries.items()
            for key, digest in entry["sha256"].items()
        ]
        if RECORDS not in self.attrs:
            unrecorded = {*np.flatnonzero(self.done).tolist()} - self.entries.keys()
            files += [File(*pair) for pair in legacy.files(self.path, self.chunks, unrecorded)]
        if damaged := self._flawed_of([file for file in files if file.key == RECORD]):
            raise StoreError(sentence("damage.inputs", path=self.path, why=damaged[0]))
        return {file.key: file for file in files}

    @functools.cached_property
    def flawed_metadata(self):
        """Files of metadata that have a flaw, and without which flags and manifest are lost."""
        digests = self.attrs.get(RECORDS, {})
        return self._flawed_of([File(key, digest=digest) for key, digest in digests.items()])

    @functools.cached_property
    def flaws(self):
        """All files in which flaws can be seen; reads every file."""
        if self.flawed_metadata:
            return self.flawed_metadata
        in_files = self._flawed_of(self.files.values())
        return self.flawed + in_files

    def intact(self, flaws):
        """Which chunks are done and have no file among these; (chunks,) bool."""
        done = self.done.copy()
        done[[file.chunk for file in flaws if file.chunk is not None]] = False
        return done

    def _values(self, name):
        """Values of an array with a file for each value; None for those that are damaged."""
        if self.flawed_metadata:
            raise StoreError(damage_message(self.path, self.flawed_metadata))
        array = self.group[name]
        try:
            return array[:].tolist()
        except DAMAGE:
            return [_value(array, i) for i in range(array.size)]

    def _flawed_of(self, files):
        """Those of these files that have a flaw."""
        flawed = []
        for file in files:
            found = file.holding(content_of(self.path / file.key))
            if not found.flaw and file.digest is None and not legacy.is_whole(self.path, file.key):
                found = file._replace(flaw="damaged")
            if found.flaw:
                flawed.append(found)
        return flawed


def _value(array, i):
    try:
        return array[i].item()
    except DAMAGE:
        return None


def content_of(path):
    """The bytes in a file; None if there is none."""
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return None


def sha256(content):
    """SHA-256 of bytes, as text."""
    return hashlib.sha256(content).hexdigest()


def manifest_entry(path, keys, chunk, origin):
    """The entry for the files with these keys in the store at a path; chunk None: made with it."""
    digests = {key: sha256((path / key).read_bytes()) for key in sorted(keys)}
    return json.dumps({"chunk": chunk, "sha256": digests, **origin}, sort_keys=True)


def damage_message(path, flaws):
    """The message about flawed files of a store."""
    return sentence("damage.files", path=path, lines=as_lines(flaws))


def as_lines(lines, most=20):
    """Lines to append to a message: the first ones, and the number of the others."""
    more = [f"and {len(lines) - most} more"] if len(lines) > most else []
    return "".join(f"\n  {line}" for line in [*lines[:most], *more])


class Checked(LocalStore):
    """A store that checks each file when zarr reads it; files: key -> `File`."""

    def __init__(self, root, *, read_only=True, files=None):
        super().__init__(root, read_only=read_only)
        self.files = files

    def with_read_only(self, read_only=False):
        return type(self)(self.root, read_only=read_only, files=self.files)

    async def get(self, key, prototype=None, byte_range=None):
        content = await super().get(key, prototype, byte_range)
        return content if byte_range else self._checked(key, content)

    def get_sync(self, key, *, prototype=None, byte_range=None):
        content = super().get_sync(key, prototype=prototype, byte_range=byte_range)
        return content if byte_range else self._checked(key, content)

    def _checked(self, key, content):
        """Return the content of a file if it is as recorded; else raise StoreError."""
        file = self.files.get(key)
        if file and (flawed := file.holding(None if content is None else content.to_bytes())).flaw:
            raise StoreError(damage_message(self.root, [flawed]))
        return content
