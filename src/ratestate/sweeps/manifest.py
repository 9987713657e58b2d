"""The manifest of a store: checksum and origin of each of its files.

``sweep/manifest`` is an array of strings, one for each chunk, and a last one for the files that
were made with the store.  Each is JSON: the number of the chunk, the SHA-256 of each of its files
by its path within the store, and the versions and the processor that made them.  A chunk's entry
reaches the disk before its flag does.  Stores of older versions have no manifest (see `legacy`).
"""

import hashlib
import json
from pathlib import Path
from typing import NamedTuple

import numpy as np
from zarr.storage import LocalStore

from ..errors import StoreError
from . import legacy
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

    def __str__(self):
        variable, block = legacy.array_and_block(self.key)
        if block is None:
            return f"metadata ({self.key})"
        chunk = block if self.chunk is None else self.chunk
        return f"variable {variable}, chunk {chunk} ({self.key})"


class Flaw(NamedTuple):
    """A file that is missing or damaged."""

    file: File
    how: str

    def __str__(self):
        return f"{self.file} is {self.how}"


class StoreContents(NamedTuple):
    """The files that a store must have, according to its flags and manifest."""

    path: Path
    done: np.ndarray  # (chunks,) bool
    entries: dict  # chunk, or None for what was made with the store -> its entry in the manifest
    files: dict  # key -> `File`, for all that the store must have
    flaws: list  # of flags and entries themselves


def sha256(content):
    """SHA-256 of bytes, as text."""
    return hashlib.sha256(content).hexdigest()


def manifest_entry(path, keys, chunk, origin):
    """The entry for some files, as JSON: their checksums and origin.

    path : of the store
    keys : of existing files
    chunk : int, or None for what is made with the store
    origin : dict, see `ratestate.sweeps.origin`
    """
    digests = {key: sha256((path / key).read_bytes()) for key in sorted(keys)}
    return json.dumps({"chunk": chunk, "sha256": digests, **origin}, sort_keys=True)


def flawed_metadata(path, sweep_group):
    """`Flaw`s of the metadata of flags and manifest."""
    digests = sweep_group.attrs.get(RECORDS, {})
    return list(_flaws_in([File(key, digest=digest) for key, digest in digests.items()], path))


def read_contents(path, sweep_group):
    """`StoreContents` of a store, of which `sweep_group` is the group ``sweep``.

    Raises
    ------
    StoreError
        The metadata of flags and manifest, or of the group, are damaged.
    """
    if damaged := flawed_metadata(path, sweep_group):
        raise StoreError(damage_message(path, damaged))
    chunks = Chunks(sweep_group.attrs["sizes"], tuple(sweep_group.attrs["chunk"]))
    flags = _values(sweep_group["done"])
    flaws = [
        Flaw(File(f"{SWEEP_GROUP}/done/c/{i}", i), "damaged")
        for i, flag in enumerate(flags)
        if flag is None
    ]
    done = np.array([bool(flag) for flag in flags])
    entries, lost = _entries(sweep_group, [*np.flatnonzero(done).tolist(), None], chunks.number)
    files = [
        File(key, i, digest)
        for i, made in entries.items()
        for key, digest in made["sha256"].items()
    ]
    if RECORDS not in sweep_group.attrs:
        unrecorded = set(np.flatnonzero(done).tolist()) - entries.keys()
        files += [File(*pair) for pair in legacy.files(path, chunks, unrecorded)]
    if damaged := list(_flaws_in([file for file in files if file.key == RECORD], path)):
        raise StoreError(inputs_damaged_message(path, damaged[0]))
    return StoreContents(path, done, entries, {file.key: file for file in files}, flaws + lost)


def inputs_damaged_message(path, why):
    """The message about a store whose record of the sweep's inputs is damaged."""
    return (
        f"{path}: its record of the parameters is damaged ({why}); put it back from a copy, or "
        f"give another path; xarray.open_zarr still reads the results"
    )


def _entries(sweep_group, wanted, number):
    """Chunk -> its entry, for those wanted that have one, and `Flaw`s of the others.

    wanted : chunks, and None for what was made with the store
    number : of all chunks
    """
    texts = _values(sweep_group["manifest"]) if "manifest" in sweep_group else [""] * (number + 1)
    entries, flaws = {}, []
    for i in wanted:
        index = number if i is None else i
        text = texts[index]
        made = json.loads(text or "{}")
        if made.get("chunk", -1) == i:  # and not that of another chunk
            entries[i] = made
        elif RECORDS in sweep_group.attrs:  # older stores lack it, all or in part
            how = "missing" if text == "" else "damaged"
            flaws.append(Flaw(File(f"{MANIFEST}/c/{index}", i), how))
    return entries, flaws


def _values(array):
    """Values of a 1-D array with a file for each value; None for those that are damaged."""
    try:
        return array[:].tolist()
    except DAMAGE:
        return [_value(array, i) for i in range(array.size)]


def _value(array, i):
    try:
        return array[i].item()
    except DAMAGE:
        return None


def find_flaws(contents):
    """All `Flaw`s of a store with these `StoreContents`; reads every file."""
    return contents.flaws + list(_flaws_in(contents.files.values(), contents.path))


def intact_chunks(contents, flaws):
    """Which chunks are done and have none of these `Flaw`s; (chunks,) bool."""
    done = contents.done.copy()
    done[[flaw.file.chunk for flaw in flaws if flaw.file.chunk is not None]] = False
    return done


def _flaws_in(files, path):
    for file in files:
        try:
            content = (path / file.key).read_bytes()
        except FileNotFoundError:
            content = None
        how = flaw_in(file, content)
        if not how and file.digest is None and not legacy.is_whole(path, file.key):
            how = "damaged"
        if how:
            yield Flaw(file, how)


def flaw_in(file, content):
    """The flaw of a `File` with this content: "missing" (None), "damaged", or "" for none."""
    if content is None:
        return "missing"
    return "damaged" if file.digest not in (None, sha256(content)) else ""


def damage_message(path, flaws):
    """The message about `Flaw`s of a store."""
    return (
        f"{path} is damaged; run the same sweep again, which makes anew what is damaged or "
        f"missing, and keeps the rest:{as_lines(flaws)}"
    )


def as_lines(lines, most=20):
    """Lines to append to a message: the first ones, and the number of the others."""
    more = [f"and {len(lines) - most} more"] if len(lines) > most else []
    return "".join(f"\n  {line}" for line in [*lines[:most], *more])


class Checked(LocalStore):
    """A store that checks each file when zarr reads it.

    Parameters
    ----------
    root : Path
    contents : StoreContents
    """

    def __init__(self, root, *, read_only=True, contents=None):
        super().__init__(root, read_only=read_only)
        self.contents = contents

    def with_read_only(self, read_only=False):
        return type(self)(self.root, read_only=read_only, contents=self.contents)

    async def get(self, key, prototype=None, byte_range=None):
        content = await super().get(key, prototype, byte_range)
        return content if byte_range else self._checked(key, content)

    def get_sync(self, key, *, prototype=None, byte_range=None):
        content = super().get_sync(key, prototype=prototype, byte_range=byte_range)
        return content if byte_range else self._checked(key, content)

    def _checked(self, key, content):
        """Return the content of a file if it is as recorded; else raise StoreError."""
        file = self.contents.files.get(key)
        if file is not None and (how := flaw_in(file, content and content.to_bytes())):
            raise StoreError(damage_message(self.root, [Flaw(file, how)]))
        return content
