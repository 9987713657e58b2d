"""Questions and answers as bytes.

A question is one text message of at most `LONGEST` characters, a JSON object::

    {"id": 7, "ask": "picture", "entries": {"a": "0.003", ..., "V_from": null}}

``ask`` is one of `ASKS`; ``id`` is an integer that the answer repeats; entries are strings as
typed, with units or in SI.  A "branch" also has ``along``, one of `branch.ALONG`; a "window" has
``window``, part of the map: [first, last K/K_c_qs, first, last eta]; a "slide-hold-slide" has
``hold``, a time as typed.  A figure or a page may also
have ``pinned``, a list of at most `PINS` such objects of entries: of runs that are kept beside it.

An answer is one binary message, little-endian::

    uint32    length of the header in bytes, padding included: 4 + length is a multiple of 8
    header    JSON object as UTF-8, padded with spaces: "id", "kind", and
              "arrays": [[name, n], ...] where there are any
    float64   the arrays, one after another
    bytes     the content of a file, to the end

All numbers are float64: a small cycle is a part in 1e8 of tau/sigma, and time may be long.
A number that JSON cannot represent is the string "Infinity", "-Infinity" or "NaN" in the header.
"""

import json
import struct
from typing import Any, NamedTuple

import numpy as np
from pydantic_core import to_json

from .branch import ALONG
from .charts import SPAN

#: kind of file -> its name and type
FILES = {
    "scenario": ("ratestate.toml", "application/toml"),
    "python": ("ratestate_run.py", "text/x-python"),
    "csv": ("ratestate_run.csv", "text/csv"),
    "svg": ("ratestate.svg", "image/svg+xml"),
    "pdf": ("ratestate.pdf", "application/pdf"),
    "png": ("ratestate.png", "image/png"),
    "page": ("ratestate.html", "text/html"),
}
#: runs kept beside another, and characters of a question: as many as that takes
PINS = 3
LONGEST = 4096 * (1 + PINS)
ASKS = ("picture", "chart", "window", "branch", "slide-hold-slide", *FILES)
LARGEST_ID = 2**53


class Question(NamedTuple):
    """A question of a page."""

    id: int
    ask: str
    entries: Any
    along: str = ""  # of "branch"
    window: tuple[float, ...] = ()  # of "window"
    pinned: tuple[Any, ...] = ()  # of a figure, and of a page
    hold: Any = None  # of "slide-hold-slide"


class BadQuestion(Exception):
    """A message that is no question."""


def question(text):
    """The `Question` in a message; BadQuestion, with the reason, if it is invalid."""
    message = json_object(text)
    number, ask = message.get("id"), message.get("ask")
    if type(number) is not int or not 0 <= number <= LARGEST_ID:
        raise BadQuestion("id must be a whole number from 0 on")
    if not isinstance(ask, str) or ask not in ASKS:
        raise BadQuestion(f"ask must be one of {', '.join(ASKS)}")
    along = _along(message.get("along")) if ask == "branch" else ""
    window = _window(message.get("window")) if ask == "window" else ()
    pinned = _pinned(message.get("pinned", []))
    return Question(number, ask, message.get("entries"), along, window, pinned, message.get("hold"))


def _along(value):
    """The parameter of a branch."""
    if not isinstance(value, str) or value not in ALONG:
        raise BadQuestion(f"along must be one of {', '.join(ALONG)}")
    return value


def _window(value):
    """The part of the map that is asked for, a tuple: it can be a key of what is cached."""
    numbers = isinstance(value, list) and all(type(x) in (int, float) for x in value)
    if not numbers or len(value) != 4:
        raise BadQuestion("window must be [first, last K/K_c_qs, first, last eta]")
    for name, low, high in (("ratio", *value[:2]), ("eta", *value[2:])):
        first, last = SPAN[name]
        if not first <= low < high <= last:
            raise BadQuestion(f"window must be inside the map, {first:g} to {last:g}")
    return tuple(map(float, value))


def _pinned(value):
    """Entries of runs kept beside another, a tuple."""
    if not isinstance(value, list) or len(value) > PINS:
        raise BadQuestion(f"pinned must be a list of {PINS} objects of entries at most")
    return tuple(value)


def json_object(text):
    """The JSON object in a text, as a dict; BadQuestion, with the reason, if there is none."""
    if len(text) > LONGEST:
        raise BadQuestion(f"a message may have {LONGEST} characters at most")
    try:
        found = json.loads(text, parse_constant=_refuse)
    except (ValueError, RecursionError):
        raise BadQuestion("the message is not JSON") from None
    if not isinstance(found, dict):
        raise BadQuestion("the message is not a JSON object")
    return found


def answer(number, kind, arrays=None, content=b"", **header):
    """An answer's bytes; `number` is the id of the question, None if there was none.

    arrays : name -> (n,) of float or bool
    content : bytes, of a file
    """
    parts = {name: np.ascontiguousarray(a, "<f8") for name, a in (arrays or {}).items()}
    whole = {"id": number, "kind": kind, **header}
    whole["arrays"] = [[name, a.size] for name, a in parts.items()]
    text = json_bytes(whole)
    text += b" " * (-(4 + len(text)) % 8)
    numbers = (a.tobytes() for a in parts.values())
    return b"".join([struct.pack("<I", len(text)), text, *numbers, content])


def json_bytes(value):
    """Return a value, which may have numbers of NumPy in it, as strict JSON."""
    return to_json(value, inf_nan_mode="strings", fallback=lambda number: number.tolist())


def _refuse(constant):
    raise ValueError(constant)
