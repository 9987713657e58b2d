"""The state of the page: a slider, speeds and an experiment; and typed texts as values."""

import re
from typing import NamedTuple

import numpy as np

import ratestate as rs

#: characters of a value and of a protocol, and segments of a protocol
LONGEST, LONGEST_PROTOCOL, MOST_SEGMENTS = 64, 1000, 20
# Magnitudes [SI] beyond which nothing exists, and numbers overflow.
SMALLEST, LARGEST = 1e-20, 1e20
_DIGIT = re.compile(r"^[-+]?[0.]*[1-9]")  # the beginning of a number that is not 0
_BARE = re.compile(r"[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|inf)")
#: what `ParameterError` says that a segment should be
WANTED = "Give 'V for T' or 'V at SIGMA for T', such as '0 m/s for 100 s'"

#: parameters that links may lack -> their text in that case
NONE = {symbol: rs.readable(symbol, 0.0) for symbol in ("damping", "alpha")}
#: entry for the time before time 0 -> the quantity that it is a value of
BEFORE = {"V_from": "V_lp", "sigma_from": "sigma"}
#: all entries of an experiment; each may be absent
EXPERIMENT = (*BEFORE, "protocol", "kick")


# Typed texts


def with_unit(symbol, text):
    """Return the text of a quantity, with its SI unit if it is a number without a unit."""
    text, unit = text.strip(), rs.QUANTITIES[symbol].unit
    return f"{text} {unit}" if unit != "1" and _BARE.fullmatch(text) else text


def value_of(symbol, text, label, bound=None):
    """Return the value [SI] of a quantity in a text; a number without a unit is in SI.

    ParameterError, which names the `label`, for any other text and beyond the `bound` (`to_si`).
    """
    if not isinstance(text, str) or len(text) > LONGEST:
        raise rs.ParameterError(
            f"has no text of at most {LONGEST} characters",
            rs.QUANTITIES[symbol].remedy,
            symbol=label,
        )
    found = rs.to_si(symbol, with_unit(symbol, text), label=label, bound=bound)
    text = text.strip()
    exact = (found == 0.0 and not _DIGIT.search(text)) or (np.isinf(found) and "inf" in text)
    if exact or SMALLEST <= abs(found) <= LARGEST:
        return found
    raise rs.ParameterError(
        "is out of range", rs.QUANTITIES[symbol].remedy, symbol=label, value=repr(text)
    )


def factor_of(text, label):
    """Return the factor in a text, a number > 0 but not 1; ParameterError for any other text."""
    number = np.nan
    if isinstance(text, str) and len(text) <= LONGEST and _BARE.fullmatch(text.strip()):
        number = float(text)
    if number == 1.0 or not SMALLEST <= number <= LARGEST:
        shown = text[:LONGEST] if isinstance(text, str) else text
        raise rs.ParameterError(
            "is not usable",
            "Give a number > 0 that is not 1, such as 10.",
            symbol=label,
            value=repr(shown),
        )
    return number


# Protocols: speeds of the load point and normal stresses from time 0 on


class Segment(NamedTuple):
    """A part of a protocol; without a normal stress it keeps the stress before it."""

    V: float  # m/s, of the load point, >= 0
    sigma: float | None  # Pa
    duration: float  # s


def rows_of(text):
    """Return the texts of a protocol's segments, with units: list of [V, sigma, duration].

    sigma is None if it does not change; any other part that is missing is "".
    """
    rows: list[list[str | None]] = []
    for part in text[: LONGEST_PROTOCOL + 1].split(";"):
        conditions, _, duration = " ".join(part.split()).partition(" for ")
        V, at, sigma = f"{conditions} ".partition(" at ")
        stress = with_unit("sigma", sigma) if at else None
        rows.append([with_unit("V_lp", V), stress, with_unit("t", duration)])
    return rows


def text_of_rows(rows):
    """Return the text of a protocol, from the texts of its segments."""
    return "; ".join(
        f"{V} for {duration}" if sigma is None else f"{V} at {sigma} for {duration}"
        for V, sigma, duration in rows
    )


def segments_of(text):
    """Return the `Segment`s, a tuple, of a protocol, or ParameterError with all its problems.

    text : such as "0 m/s for 100 s; 1 um/s at 5 MPa for 20 s"
    """
    if not isinstance(text, str) or not text.strip():
        raise rs.ParameterError(f"protocol is empty. {WANTED}, with segments separated by ';'.")
    rows = rows_of(text)
    if len(text) > LONGEST_PROTOCOL or len(rows) > MOST_SEGMENTS:
        raise rs.ParameterError(
            f"protocol has {len(rows)} segments in {len(text)} characters, and a page may have "
            f"{MOST_SEGMENTS} in {LONGEST_PROTOCOL}. Leave some out, or write a scenario file."
        )
    segments, problems = [], []
    for number, (row, part) in enumerate(zip(rows, text.split(";"), strict=True), 1):
        try:
            segments.append(_segment(row, " ".join(part.split()), number))
        except rs.ParameterError as error:
            problems.append(str(error))
    if problems:
        raise rs.ParameterError("; ".join(problems))
    return tuple(segments)


def _segment(row, text, number):
    """Return the `Segment` of a row; ParameterError, which quotes the text."""
    V, sigma, duration = row
    if not duration:
        raise rs.ParameterError(
            f"segment {number} = {text[:LONGEST]!r} is not a segment. {WANTED}."
        )
    return Segment(
        value_of("V_lp", V, f"V of segment {number}", ">= 0"),
        value_of("sigma", sigma, f"sigma of segment {number}") if sigma is not None else None,
        value_of("t", duration, f"duration of segment {number}", "> 0"),
    )


def text_of(segments, digits=6):
    """Return the text that `segments_of` reads, with values rounded to `digits`."""
    readable = rs.readable
    return text_of_rows(
        (
            readable("V_lp", V, digits),
            None if sigma is None else readable("sigma", sigma, digits),
            readable("t", duration, digits),
        )
        for V, sigma, duration in segments
    )


# The state


class PageState(NamedTuple):
    """A slider and a speed, at the end of an experiment if there is one.

    The experiment begins at time 0 with the motion that has settled before.  Without an experiment
    the run starts in steady sliding, see run_plan.START.
    """

    slider: rs.SpringSlider
    V_lp: float
    V_from: float | None = None  # before time 0; None if it is V_lp
    sigma_from: float | None = None
    protocol: tuple[Segment, ...] = ()
    kick: float | None = None  # by which V is multiplied at time 0

    @property
    def values(self):
        """dict of the values of all fields, in SI."""
        of_all = {symbol: getattr(self.slider, symbol) for symbol in NONE}
        names = {"law": self.slider.law, "friction_form": self.slider.friction_form}
        experiment = {name: getattr(self, name) for name in EXPERIMENT}
        return of_all | self.slider.values | {"V_lp": self.V_lp} | experiment | names

    @property
    def before(self):
        """The `PageState` before time 0; None if there is no experiment."""
        if (self.V_from, self.sigma_from, self.protocol, self.kick) == (None, None, (), None):
            return None
        sigma = self.slider.sigma if self.sigma_from is None else self.sigma_from
        V_lp = self.V_lp if self.V_from is None else self.V_from
        return PageState(self.slider.replace(sigma=sigma), V_lp)

    @property
    def segments(self):
        """The `Segment`s of the protocol, each with its normal stress."""
        sigma, known = self.sigma_from or self.slider.sigma, []
        for segment in self.protocol:
            sigma = segment.sigma or sigma
            known.append(segment._replace(sigma=sigma))
        return known

    @property
    def sigma_varies(self):
        """Whether the normal stress changes."""
        first = self.sigma_from or self.slider.sigma
        return any(x != first for x in (*(s.sigma for s in self.segments), self.slider.sigma))
