"""Titles of columns: the name and the unit in them, and the quantities that names stand for."""

import re
import tomllib
import unicodedata
from pathlib import Path

#: the tables of column_names.toml
TABLE = tomllib.loads(Path(__file__).with_name("column_names.toml").read_text("utf-8"))
#: symbol -> least and largest typical size [SI], and a unit to suggest
USUAL = {symbol: tuple(of["usual"]) for symbol, of in TABLE["quantities"].items()}
LIKE = {symbol: of["unit"] for symbol, of in TABLE["quantities"].items()}
#: displacements that are the load point's
NOT_OTHERS = TABLE["parts"]["OTHERS"]
_UNITS = {name: of.split() for name, of in TABLE["units"].items() if name != "words"}
_NAMES = {unit.lower() for unit in _UNITS["names"]}
_CAPITALS: dict[str, str] = {unit.upper(): unit for unit in _UNITS["names"]}
_WORDS = {word: unit for unit, of in TABLE["units"]["words"].items() for word in of.split()}
_OPEN, _CLOSE = r"\[({<\uff08\uff3b\u3010", r"\])}>\uff09\uff3d\u3011"  # also in full width
_BRACKETS = re.compile(
    rf"(.*?)[\s_,:]*[{_OPEN}]\s*([^{_OPEN}{_CLOSE}]*)\s*[{_CLOSE}]\s*(.*)", re.DOTALL
)
#: name, what parts it from the unit, unit: "disp_um" before "t/s", for "speed um/s" is the former
_AFTER = [re.compile(rf"(.*[^\W_].*?){gap}([^\s_,;:]+)") for gap in (r"[\s_,;:]+", r"\s*/\s*")]


def _pattern(ways):
    """One pattern out of several, which may name parts."""
    pattern = "|".join(ways)
    for part, meaning in TABLE["parts"].items():
        pattern = pattern.replace(part, meaning)
    return pattern


#: symbol -> patterns of the letters of a name, the most certain first
PATTERNS = {s: [*map(_pattern, of["names"])] for s, of in TABLE["quantities"].items()}


def split(title):
    """(name, unit) of a title such as "time [s]", "Stress, MPa" or "disp_um"; "" for no unit."""
    title = " ".join(title.split()).strip("'\"")
    if match := _BRACKETS.fullmatch(title):
        name, unit, rest = match.groups()
        return f"{name} {rest}".strip(), unit.strip()
    for pattern in _AFTER:
        match = pattern.fullmatch(title)
        if match and is_unit(match[2]) and match[2].lower() not in _UNITS["short"]:
            return match[1], match[2]
    return title, ""


def is_unit(text):
    """Whether a text can only be a unit (or "-" for none)."""
    return plain(text).lower() in _NAMES


def plain(unit):
    """A unit as files write it, as `ratestate.model.units` may read it; "1" where it says none."""
    unit = unicodedata.normalize("NFKC", unit).strip().strip("[](){}<>").strip()
    unit = unit.replace("\u03bc", "u")  # what all letters mu are, once normalized
    if unit.lower() in _UNITS["none"]:
        return "1"
    words = re.split(r"([\W\d_]+)", unit.partition(" since ")[0])
    return "".join(_unit_word(word) for word in words)


def _unit_word(word):
    """A word of a unit, in whatever language, as the unit it means."""
    return _WORDS.get(_plain_letters(word), _CAPITALS.get(word, word))


def letters(name):
    """A name as it is compared: small letters and digits, nothing else."""
    name = name.translate(str.maketrans(TABLE["letters"]))
    return re.sub(r"[\W_]+", "", _plain_letters(name))


def _plain_letters(text):
    """Small letters of one width, without accents."""
    apart = unicodedata.normalize("NFKD", text.lower())
    return unicodedata.normalize("NFKC", re.sub("[\u0300-\u036f]", "", apart))


def match_rank(name, patterns):
    """Index of the first pattern that matches the letters of a name, None if none does."""
    ranks = (rank for rank, pattern in enumerate(patterns) if re.fullmatch(pattern, name))
    return next(ranks, None)
