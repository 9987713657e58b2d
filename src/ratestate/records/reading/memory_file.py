"""A file that is in memory, for readers that take paths."""

import io
from pathlib import PurePath
from types import SimpleNamespace
from typing import NamedTuple


class MemoryFile(NamedTuple):
    """The contents of a file, with what readers use of a path: its name, size and bytes."""

    name: str  # the ending decides the format, and messages have it
    contents: bytes

    def __str__(self):
        return self.name

    @property
    def suffix(self):
        """The ending of the name, with its dot."""
        return PurePath(self.name).suffix

    def stat(self):
        """The size, as ``st_size``."""
        return SimpleNamespace(st_size=len(self.contents))

    def open(self, mode="rb"):
        """The contents as a binary file, to be read."""
        return io.BytesIO(self.contents)

    def read_bytes(self):
        """The contents."""
        return self.contents


def read_into_memory(file):
    """The `MemoryFile` of an open binary file, from where it stands to its end; TypeError of text.

    Its name is "the file" if it has none.
    """
    contents = file.read()
    if not isinstance(contents, bytes):
        raise TypeError("expected a binary file")
    name = getattr(file, "name", None)  # of one without a name a number, or nothing
    return MemoryFile(PurePath(name).name if isinstance(name, str) else "the file", contents)
