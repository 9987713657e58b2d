"""Questions and answers as bytes.

A question is one text message of at most `LONGEST` characters, a JSON object::

    {"id": 7, "ask": "picture", "entries": {"a": "0.003", ..., "V_from": null}}

``ask`` is one of `ASKS`; ``id`` is an integer that the answer repeats; entries are strings as
typed, with units or in SI.  A "branch" also has ``along``, one of `branch.ALONG`; a "window" has
``window``, part of the map: [first, last K/K_c_qs, first, last eta]; a "slide-hold-slide" has
``hold``, a time as typed.  A figure or a page may also have ``pinned``, a list of at most `PINS`
such objects of entries, of runs that are kept for comparison.

An answer is one binary message, little-endian::

    uint32    length of the header in bytes, padding included: 4 + length is a multiple of 8
    header    JSON object as UTF-8, padded with spaces: "id", "kind", and
              "arrays": [[name, n], ...] where there are any
    float64   the arrays, one after another
    bytes     the content of a file, to the end

All numbers are float64: a small cycle is a part in 1e8 of tau/sigma, and time may be long.
A number that JSON cannot represent is the string "Infinity", "-Infinity" or "NaN" in the header.
"""

import struct
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import ConfigDict, Field, TypeAdapter, ValidationError, model_validator
from pydantic.dataclasses import dataclass
from pydantic_core import to_json

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


class BadQuestion(Exception):
    """A message that is not a question."""


@dataclass(frozen=True, config=ConfigDict(strict=True))
class Question:
    """A question of a page."""

    id: Annotated[int, Field(ge=0, le=2**53)]
    ask: str
    entries: Any = None
    along: Literal["", "K", "V_lp", "M"] = ""  # of "branch"
    window: tuple[float, float, float, float] | tuple[()] = ()  # of "window"
    pinned: Annotated[tuple[Any, ...], Field(max_length=PINS)] = ()  # of a figure, and of a page
    hold: Any = None  # of "slide-hold-slide"

    @model_validator(mode="after")
    def _fits(self):
        if self.ask not in ASKS:
            raise ValueError(f"ask must be one of {', '.join(ASKS)}")
        if self.ask == "branch" and not self.along:
            raise ValueError("a branch needs along")
        if self.ask == "window" and not _is_in_map(*self.window):
            raise ValueError("window must be [first, last K/K_c_qs, first, last eta] in the map")
        return self


def _is_in_map(*limits):
    if not limits:
        return False
    ends = zip((SPAN["ratio"], SPAN["eta"]), (limits[:2], limits[2:]), strict=True)
    return all(first <= low < high <= last for (first, last), (low, high) in ends)


def checked(kind, text):
    """Return what a JSON text holds, of a kind that pydantic knows; BadQuestion if it does not."""
    if len(text) > LONGEST:
        raise BadQuestion(f"a message may have {LONGEST} characters at most")
    try:
        return TypeAdapter(kind).validate_json(text)
    except ValidationError as error:
        first = error.errors()[0]
        raise BadQuestion(" ".join([*map(str, first["loc"]), first["msg"]])) from None


def answer(number, kind, arrays=None, content=b"", **header):
    """Return an answer as bytes; `number` is the id of the question, None if there was none.

    arrays : name -> (n,) of float or bool
    content : bytes, of a file
    """
    parts = {name: np.ascontiguousarray(a, "<f8") for name, a in (arrays or {}).items()}
    head = {"id": number, "kind": kind, **header}
    head["arrays"] = [[name, a.size] for name, a in parts.items()]
    text = json_bytes(head)
    text += b" " * (-(4 + len(text)) % 8)
    numbers = (a.tobytes() for a in parts.values())
    return b"".join([struct.pack("<I", len(text)), text, *numbers, content])


def json_bytes(value):
    """Return a value, which may have numbers of NumPy in it, as strict JSON."""
    return to_json(value, inf_nan_mode="strings", fallback=lambda number: number.tolist())
