"""What the files of a store must hold, its manifest, and the check of a file against it.

``sweep/manifest`` is an array of strings, one for each chunk, and a last one for the files that
were made with the store.  Each is JSON: the number of the chunk, the SHA-256 of each of its files
by its path within the store, and the versions and the processor that made them.  A chunk's entry
reaches the disk before its flag does.  Stores of older versions have no manifest (see `legacy`).
"""

import hashlib
import json
from typing import NamedTuple

from zarr.storage import LocalStore

from ..errors import StoreError
from . import legacy, sentence
from .legacy import SWEEP_GROUP

MANIFEST = f"{SWEEP_GROUP}/manifest"
#: attribute of the group ``sweep``: SHA-256 of the metadata of the arrays of flags and manifest
RECORDS = "sha256"


class File(NamedTuple):
    """A file that a store must have."""

    key: str  # its path within the store
    chunk: int | None = None  # None: made with the store
    digest: str | None = None  # SHA-256; None: not recorded
    flaw: str = ""  # "missing" or "damaged"; "": none, or not checked

    def __str__(self):
        variable, block = legacy.array_and_block(self.key)
        if block is None:
            return f"metadata ({self.key}) is {self.flaw}"
        chunk = block if self.chunk is None else self.chunk
        return f"variable {variable}, chunk {chunk} ({self.key}) is {self.flaw}"

    def checked_against(self, content):
        """The same with the flaw that it has with this content (bytes; None: no such file).

        Without a digest any content is right.
        """
        if content is None:
            return self._replace(flaw="missing")
        right = self.digest in (None, sha256(content))
        return self._replace(flaw="" if right else "damaged")


def content_of(path):
    """The bytes in a file; None if there is none."""
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return None


def sha256(content):
    """SHA-256 of bytes, as text."""
    return hashlib.sha256(content).hexdigest()


def keys_in(path):
    """The keys of all files in a folder."""
    return [file.relative_to(path).as_posix() for file in path.rglob("*") if file.is_file()]


def digests_of(path, keys):
    """Key -> SHA-256, for the files with these keys in the store at a path."""
    return {key: sha256((path / key).read_bytes()) for key in sorted(keys)}


def manifest_entry(path, keys, chunk, origin):
    """The entry, JSON text, for the files with these keys in the store at a path, which it reads.

    chunk : number, or None for files made with the store; origin : as by `origin.origin`
    """
    entry = {"chunk": chunk, "sha256": digests_of(path, keys), **origin}
    return json.dumps(entry, sort_keys=True)


def flaws_among(path, files):
    """Those of these files of the store at a path that have a flaw, with it."""
    flaws = []
    for file in files:
        found = file.checked_against(content_of(path / file.key))
        if not found.flaw and file.digest is None and not legacy.is_whole(path, file.key):
            found = file._replace(flaw="damaged")
        if found.flaw:
            flaws.append(found)
    return flaws


def damage_message(path, flaws):
    """The message (str) about flawed files of a store, a list of `File`."""
    return sentence("damage.files", path=path, lines=as_lines(flaws))


def as_lines(lines, most=20):
    """Text to append to a message: the first of these lines, and how many more; "" for none."""
    more = [f"and {len(lines) - most} more"] if len(lines) > most else []
    return "".join(f"\n  {line}" for line in [*lines[:most], *more])


class Checked(LocalStore):
    """A store that checks each whole file when zarr reads it: StoreError if it has a flaw.

    Files that are not among `files`, and parts of files, are read unchecked.

    files : key -> `File`
    """

    def __init__(self, root, *, read_only=True, files=None):
        super().__init__(root, read_only=read_only)
        self.files = files

    def with_read_only(self, read_only=False):
        """The same store, for reading only or not."""
        return type(self)(self.root, read_only=read_only, files=self.files)

    async def get(self, key, prototype=None, byte_range=None):
        """Content of a file, checked unless only a range is read; None if there is none."""
        content = await super().get(key, prototype, byte_range)
        return content if byte_range else self._checked(key, content)

    def get_sync(self, key, *, prototype=None, byte_range=None):
        """As `get`."""
        content = super().get_sync(key, prototype=prototype, byte_range=byte_range)
        return content if byte_range else self._checked(key, content)

    def _checked(self, key, content):
        """Return the content of a file if it is as recorded; else raise StoreError."""
        file = self.files.get(key)
        if (
            file
            and (file := file.checked_against(None if content is None else content.to_bytes())).flaw
        ):
            raise StoreError(damage_message(self.root, [file]))
        return content
