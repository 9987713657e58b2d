"""The encoding of a text file, which is read once to find it."""

import codecs
import contextlib

from ..messages import reading as sentences
from .titles import TABLE

BLOCK = 1 << 24  # bytes
HEAD = 1 << 16  # bytes in which words are looked for
#: encoding of two bytes for a letter -> words that titles have
_WORDS = TABLE["encodings"]


def examined(path):
    """(encoding, most lines) of a text file; ParameterError if it is binary.

    UTF-16 by its first bytes, and UTF-8 if it is; else, if words of titles appear in it, an
    encoding of Japanese or Chinese; else that of Windows in western Europe.
    """
    with path.open("rb") as file:
        head = file.read(HEAD)
    utf_16 = head.startswith((b"\xff\xfe", b"\xfe\xff"))
    ends = 0
    for block in _blocks(path):
        if b"\0" in block and not utf_16:
            raise sentences.refusal("text.binary", name=path.name)
        ends += block.count(b"\n") + block.count(b"\r")
    eastern = [name for name, words in _WORDS.items() if _has_any(head, name, words)]
    for encoding in ["utf-16"] if utf_16 else ["utf-8-sig", *eastern, "cp1252", "latin-1"]:
        if _decodes(path, encoding):
            return encoding, ends + 1
    raise sentences.refusal("text.encoding", name=path.name)


def _blocks(path):
    with path.open("rb") as file:
        while block := file.read(BLOCK):
            yield block


def _decodes(path, encoding):
    """Whether all of the file is of this encoding."""
    decoder = codecs.getincrementaldecoder(encoding)()
    try:
        for block in _blocks(path):
            decoder.decode(block)
        decoder.decode(b"", final=True)
    except UnicodeDecodeError:
        return False
    return True


def _has_any(head, encoding, words):
    """Whether the beginning of a file has any of these words if it is of this encoding."""
    with contextlib.suppress(UnicodeDecodeError):
        text = codecs.getincrementaldecoder(encoding)().decode(head)
        return any(word in text for word in words)
    return False
