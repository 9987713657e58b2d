"""Titles of columns: the name and the unit in them, and the quantities that names stand for."""

import re
import tomllib
from pathlib import Path

_TABLE = tomllib.loads(Path(__file__).with_name("column_names.toml").read_text("utf-8"))
#: symbol -> least and largest typical size [SI], and a unit to suggest
USUAL = {symbol: tuple(of["usual"]) for symbol, of in _TABLE["quantities"].items()}
LIKE = {symbol: of["unit"] for symbol, of in _TABLE["quantities"].items()}
#: displacements that are the load point's
NOT_OTHERS = _TABLE["parts"]["OTHERS"]
_UNITS = {name: of.split() for name, of in _TABLE["units"].items()}
_NAMES = {unit.lower() for unit in _UNITS["names"]}
_CAPITALS: dict[str, str] = {unit.upper(): unit for unit in _UNITS["names"]}
_WORDS = {word: unit for unit in ("um", "s") for word in _UNITS[unit]}
_BRACKETS = re.compile(r"(.*?)[\s_,:]*[\[({<]\s*([^\[\](){}<>]*)\s*[\])}>]\s*(.*)", re.DOTALL)
#: name, what parts it from the unit, unit: "disp_um" before "t/s", for "speed um/s" is the former
_AFTER = [re.compile(rf"(.*[^\W_].*?){gap}([^\s_,;:]+)") for gap in (r"[\s_,;:]+", r"\s*/\s*")]


def _pattern(ways):
    """One pattern out of several, which may name parts."""
    pattern = "|".join(ways)
    for part, meaning in _TABLE["parts"].items():
        pattern = pattern.replace(part, meaning)
    return pattern


#: symbol -> patterns of the letters of a name, the most certain first
PATTERNS = {s: [*map(_pattern, of["names"])] for s, of in _TABLE["quantities"].items()}


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
    unit = unit.strip().strip("[](){}<>").strip().replace("\u03bc", "u").replace("\u00b5", "u")
    if unit.lower() in (".", "-", "--", "none", "unitless", "dimensionless"):
        return "1"
    words = re.split(r"([^A-Za-z]+)", unit.partition(" since ")[0])
    return "".join(_WORDS.get(word.lower(), _CAPITALS.get(word, word)) for word in words)


def letters(name):
    """A name as it is compared: small letters and digits, nothing else."""
    return re.sub(r"[\W_]+", "", name.translate(str.maketrans(_TABLE["letters"])).lower())


def match_rank(name, patterns):
    """Index of the first pattern that matches the letters of a name, None if none does."""
    ranks = (rank for rank, pattern in enumerate(patterns) if re.fullmatch(pattern, name))
    return next(ranks, None)
