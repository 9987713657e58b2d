"""What each file of a store must hold, and what made it: the store's manifest.

``sweep/manifest`` is an array of texts, one a chunk, and a last one for all that was made with the
store.  Each is JSON: the number of the chunk, the SHA-256 of each of its files by its path within
the store, and the versions and the processor that made them.  A chunk's entry reaches the disk
before its flag does.  Stores of older versions have none; the files of their chunks carry the
checksum of their codec.
"""

import hashlib
import json
from pathlib import Path
from typing import NamedTuple

import numpy as np
from zarr.storage import LocalStore

from ..errors import StoreError
from . import older
from .chunks import Chunks
from .older import DAMAGE, INSIDE

MANIFEST = f"{INSIDE}/manifest"
RECORD = f"{INSIDE}/zarr.json"
#: attribute of the group ``sweep``: SHA-256 of the metadata of the arrays that tell the rest
RECORDS = "sha256"


class File(NamedTuple):
    """A file that a store must have."""

    key: str  # its path within the store
    chunk: int | None = None  # None: made with the store
    digest: str | None = None  # SHA-256; None: not recorded

    def __str__(self):
        variable, block = older.array_and_block(self.key)
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


class Contents(NamedTuple):
    """What a store holds, by its own account."""

    path: Path
    done: np.ndarray  # (chunks,) bool
    entries: dict  # chunk, or None for what was made with the store -> its entry in the manifest
    files: dict  # key -> `File`, of all that must be there
    flaws: list  # of flags and entries


def sha256(content):
    """SHA-256 of bytes, as text."""
    return hashlib.sha256(content).hexdigest()


def entry(path, keys, chunk, origin):
    """The text that says what files hold, and what made them.

    path : of the store
    keys : of files that are there
    chunk : int, or None for what is made with the store
    origin : dict, see `ratestate.sweeps.origin`
    """
    digests = {key: sha256((path / key).read_bytes()) for key in sorted(keys)}
    return json.dumps({"chunk": chunk, "sha256": digests, **origin}, sort_keys=True)


def flawed_records(path, inside):
    """`Flaw`s of the metadata of flags and manifest; inside: the group ``sweep`` of a store."""
    digests = inside.attrs.get(RECORDS, {})
    return list(_flaws_of([File(key, digest=digest) for key, digest in digests.items()], path))


def contents(path, inside):
    """`Contents` of a store; inside: its group ``sweep``.

    Raises
    ------
    StoreError
        What tells all the rest is damaged.
    """
    if found := flawed_records(path, inside):
        raise StoreError(told(path, found))
    chunks = Chunks(inside.attrs["sizes"], tuple(inside.attrs["chunk"]))
    flags = _values(inside["done"])
    flaws = [
        Flaw(File(f"{INSIDE}/done/c/{i}", i), "damaged")
        for i, flag in enumerate(flags)
        if flag is None
    ]
    done = np.array([bool(flag) for flag in flags])
    entries, lost = _entries(inside, [*np.flatnonzero(done).tolist(), None], chunks.number)
    files = [
        File(key, i, digest)
        for i, found in entries.items()
        for key, digest in found["sha256"].items()
    ]
    if RECORDS not in inside.attrs:
        unrecorded = set(np.flatnonzero(done).tolist()) - entries.keys()
        files += [File(*found) for found in older.files(path, chunks, unrecorded)]
    if found := list(_flaws_of([file for file in files if file.key == RECORD], path)):
        raise StoreError(lost_record(path, found[0]))
    return Contents(path, done, entries, {file.key: file for file in files}, flaws + lost)


def lost_record(path, why):
    """The message about a store whose record of what it was asked is damaged."""
    return (
        f"{path}: its record of the parameters is damaged ({why}); put it back from a copy, or "
        f"give another path; xarray.open_zarr still reads the results"
    )


def _entries(inside, asked, number):
    """Chunk -> its entry, for those asked that have one, and `Flaw`s of the others."""
    texts = _values(inside["manifest"]) if "manifest" in inside else [""] * (number + 1)
    entries, flaws = {}, []
    for i in asked:
        place = number if i is None else i
        text = texts[place]
        found = json.loads(text or "{}")
        if found.get("chunk", -1) == i:  # and not that of another chunk
            entries[i] = found
        elif RECORDS in inside.attrs:  # older stores lack it, all or in part
            how = "missing" if text == "" else "damaged"
            flaws.append(Flaw(File(f"{MANIFEST}/c/{place}", i), how))
    return entries, flaws


def _values(array):
    """Values of an array of one dimension, a chunk each; None for those that are damaged."""
    try:
        return array[:].tolist()
    except DAMAGE:
        return [_value(array, i) for i in range(array.size)]


def _value(array, i):
    try:
        return array[i].item()
    except DAMAGE:
        return None


def flaws(held):
    """All `Flaw`s of a store of which these are the `Contents`; reads every file."""
    return held.flaws + list(_flaws_of(held.files.values(), held.path))


def whole(held, flaws):
    """Which chunks are done, and have none of these `Flaw`s; (chunks,) bool."""
    done = held.done.copy()
    done[[flaw.file.chunk for flaw in flaws if flaw.file.chunk is not None]] = False
    return done


def _flaws_of(files, path):
    for file in files:
        try:
            content = (path / file.key).read_bytes()
        except FileNotFoundError:
            content = None
        how = flaw_of(file, content)
        if not how and file.digest is None and not older.is_whole(path, file.key):
            how = "damaged"
        if how:
            yield Flaw(file, how)


def flaw_of(file, content):
    """How a `File` with this content, None where there is none, is flawed; "" if it is not."""
    if content is None:
        return "missing"
    return "damaged" if file.digest not in (None, sha256(content)) else ""


def told(path, flaws):
    """The message about `Flaw`s of a store."""
    return (
        f"{path} is damaged; run the same sweep again, which makes anew what is damaged or "
        f"missing, and keeps the rest:{listed(flaws)}"
    )


def listed(lines, most=20):
    """Lines below a message: the first, and how many more there are."""
    more = [f"and {len(lines) - most} more"] if len(lines) > most else []
    return "".join(f"\n  {line}" for line in [*lines[:most], *more])


class Checked(LocalStore):
    """A store of which each file is checked as zarr reads it.

    Parameters
    ----------
    root : Path
    held : Contents
    """

    def __init__(self, root, *, read_only=True, held=None):
        super().__init__(root, read_only=read_only)
        self.held = held

    def with_read_only(self, read_only=False):
        return type(self)(self.root, read_only=read_only, held=self.held)

    async def get(self, key, prototype=None, byte_range=None):
        content = await super().get(key, prototype, byte_range)
        return content if byte_range else self._checked(key, content)

    def get_sync(self, key, *, prototype=None, byte_range=None):
        content = super().get_sync(key, prototype=prototype, byte_range=byte_range)
        return content if byte_range else self._checked(key, content)

    def _checked(self, key, content):
        """This content of a file, if it is what the file must hold."""
        file = self.held.files.get(key)
        if file is not None and (how := flaw_of(file, content and content.to_bytes())):
            raise StoreError(told(self.root, [Flaw(file, how)]))
        return content
