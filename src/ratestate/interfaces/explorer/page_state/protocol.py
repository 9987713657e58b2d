"""A protocol: what the load point and the normal stress do from time 0 on, as text and back."""

from typing import NamedTuple

from ....errors import ParameterError
from ....model.quantities import readable
from . import typed

#: characters of a text, and segments
LONGEST, MOST = 1000, 20
WANTED = "expected 'V for T' or 'V at SIGMA for T', such as '0 m/s for 100 s'"


class Segment(NamedTuple):
    """A part of a protocol; without a normal stress this stays as it was before."""

    V: float  # m/s, of the load point, >= 0
    sigma: float | None  # Pa
    duration: float  # s


def segments_of(text):
    """The `Segment`s, a tuple, of a text such as "0 m/s for 100 s; 1 um/s at 5 MPa for 20 s".

    ParameterError with all that is wrong with them.
    """
    if not isinstance(text, str) or not text.strip():
        raise ParameterError(f"protocol has no text; {WANTED}, segments separated by ';'")
    parts = text.split(";")
    if len(text) > LONGEST or len(parts) > MOST:
        raise ParameterError(
            f"protocol has {len(parts)} segments in {len(text)} characters, and a page may have "
            f"{MOST} in {LONGEST}; leave some out, or give more as steps in a scenario file"
        )
    segments, problems = [], []
    for number, part in enumerate(parts, 1):
        try:
            segments.append(_segment(" ".join(part.split()), number))
        except ParameterError as error:
            problems.append(str(error))
    if problems:
        raise ParameterError("; ".join(problems))
    return tuple(segments)


def _segment(text, number):
    """The `Segment` in a text with single spaces."""
    conditions, _, duration = text.partition(" for ")
    V, at, sigma = f"{conditions} ".partition(" at ")
    if not duration:
        raise ParameterError(f"segment {number} = {text[: typed.LONGEST]!r} is none; {WANTED}")
    return Segment(
        typed.value("V_lp", V, f"V of segment {number}", ">= 0"),
        typed.value("sigma", sigma, f"sigma of segment {number}") if at else None,
        typed.value("t", duration, f"duration of segment {number}", "> 0"),
    )


def text_of(segments, digits=6):
    """The text that `segments_of` reads, with values rounded to `digits`."""
    return "; ".join(
        readable("V_lp", V, digits)
        + ("" if sigma is None else f" at {readable('sigma', sigma, digits)}")
        + f" for {readable('t', duration, digits)}"
        for V, sigma, duration in segments
    )
