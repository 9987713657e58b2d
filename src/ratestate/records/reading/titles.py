"""Split titles of columns into name and unit; recognize quantities by column_names.toml."""

import re
import tomllib
import unicodedata
from pathlib import Path

from ...model.units import has_unit

#: the tables of column_names.toml
TABLE = tomllib.loads(Path(__file__).with_name("column_names.toml").read_text("utf-8"))
#: symbol -> least and largest typical size [SI]; symbol -> unit to suggest
TYPICAL_RANGES = {symbol: tuple(row["usual"]) for symbol, row in TABLE["quantities"].items()}
EXAMPLE_UNIT = {symbol: row["unit"] for symbol, row in TABLE["quantities"].items()}
#: kind of word in a title -> pattern to search in `spaced` names
WORDS = {name: re.compile(pattern) for name, pattern in TABLE["words"].items()}
_UNITS = {name: text.split() for name, text in TABLE["units"].items() if name != "words"}
_UNIT_NAMES = {unit.lower() for unit in _UNITS["names"]}
_BY_LOWERCASE: dict[str, str] = {unit.lower(): unit for unit in _UNITS["names"]}
#: unit of mass -> unit of the weight that it stands for
WEIGHTS: dict[str, str] = TABLE["weights"]
#: a mass per area, which is a pressure: "kg/cm2"
_MASS_PER_AREA = re.compile(rf"\b(?:{'|'.join(WEIGHTS)})(?=/(?:mm|cm|m|in|inch|ft)(?:\^|\*\*)?2)")
_UNIT_WORDS = {word: unit for unit, of in TABLE["units"]["words"].items() for word in of.split()}
_OPEN, _CLOSE = r"\[({<\uff08\uff3b\u3010", r"\])}>\uff09\uff3d\u3011"  # also full-width brackets
_BRACKET = re.compile(rf"[{_OPEN}]\s*([^{_OPEN}{_CLOSE}]*)[{_CLOSE}]")
#: a prime at a symbol of normal stress, the mark of an effective stress: "sigma_n'"
_PRIME = re.compile(r"(?i)(?<![^\W_])((?:\u03c3|sigma|s)[ _]?n?)['\u2019\u2032]")
#: patterns of a name, a separator and a unit: "disp_um"; then "t/s", since "speed um/s" is no "t/s"
_UNIT_AFTER = [re.compile(rf"(.*[^\W_].*?){gap}([^\s_,;:]+)") for gap in (r"[\s_,;:]+", r"\s*/\s*")]


def _join_patterns(ways):
    """Join several patterns into one, and replace the names of parts in them."""
    pattern = "|".join(ways)
    for part, meaning in TABLE["parts"].items():
        pattern = pattern.replace(part, meaning)
    return pattern


#: symbol -> patterns of `letters` of a name, the most certain first; number of the certain ones
PATTERNS, CERTAIN = {}, {}
for _symbol, _of in TABLE["quantities"].items():
    _perhaps = [_join_patterns(_of["perhaps"])] if "perhaps" in _of else []
    _forces = [_join_patterns(_of["forces"])] if "forces" in _of else []
    PATTERNS[_symbol] = [*map(_join_patterns, _of["names"]), *_forces, *_perhaps]
    CERTAIN[_symbol] = len(PATTERNS[_symbol]) - len(_perhaps)


def split_title(title):
    """Return (name, unit) of a title: "time [s]", "Stress, MPa", "disp_um"; "" if no unit."""
    title = " ".join(title.split()).strip('"')
    title = title.strip("'") if title.startswith("'") else title
    if matches := [*_BRACKET.finditer(title)]:
        of_unit = next((found for found in matches if is_unit(found[1])), matches[-1])
        name = f"{title[: of_unit.start()].rstrip(' _,:')} {title[of_unit.end() :].strip()}"
        return name.strip(), of_unit[1].strip()
    for pattern in _UNIT_AFTER:
        match = pattern.fullmatch(title)
        if match and is_unit(match[2]) and match[2].lower() not in _UNITS["short"]:
            return match[1], match[2]
    return title, ""


def name_and_units(title, unit=""):
    """Return (name, unit, contradicting unit) of a column; missing units are "".

    unit : unit apart from the title, in a row of units or an attribute
    """
    name, unit_text = split_title(title)
    in_words = any(pattern.search(spaced(unit_text)) for pattern in WORDS.values())
    plain = plain_unit(unit_text)
    known = is_unit(unit_text) or any(has_unit(symbol, plain) for symbol in EXAMPLE_UNIT)
    if unit_text and (unit or in_words) and not known:
        return title, unit, ""
    name_in_title, inner = split_title(name)
    if not is_unit(inner):
        name_in_title, inner = name, ""
    first, *others = [text for text in (unit, unit_text, inner) if text] or [""]
    other = next((text for text in others if plain_unit(text) != plain_unit(first)), "")
    return name_in_title, first, other


def is_recognized(title):
    """Return whether a title is a unit, has a unit, or names a quantity."""
    name, unit = split_title(title)
    named = any(match_rank(name, symbol) is not None for symbol in EXAMPLE_UNIT)
    return named or is_unit(title) or is_unit(unit)


def is_unit(text):
    """Return whether a text is one of the units (or "-" for none) in column_names.toml."""
    return plain_unit(text).lower().replace("^", "") in _UNIT_NAMES


def plain_unit(unit):
    """Convert a unit from a file to the spelling of `ratestate.model.units`; "1" for "none"."""
    unit = unicodedata.normalize("NFKC", unit).strip().strip("[](){}<>").strip()
    unit = unit.replace("\u03bc", "u")  # normalization turned every letter mu into this one
    if unit.lower() in _UNITS["none"]:
        return "1"
    words = re.split(r"([\W\d_]+)", unit.partition(" since ")[0])
    text = "".join(_translate_unit(word) for word in words)
    return _MASS_PER_AREA.sub(lambda mass: WEIGHTS[mass[0]], text)


def _translate_unit(word):
    if word in _UNITS["names"]:
        return word
    has_free_case = word.islower() or word.isupper() or word.istitle() or word.startswith("K")
    known = _BY_LOWERCASE.get(word.lower(), word) if has_free_case else word
    return _UNIT_WORDS.get(_without_accents(word), known)


def letters(name):
    """Reduce a name to its lower-case letters and digits, for comparison."""
    return re.sub(r"[\W_]+", "", spaced(name))


def spaced(name):
    """Split a name into lower-case words with blanks between: "LPDisp_um" -> "lp disp um"."""
    name = _PRIME.sub(r"\1 eff ", name).translate(str.maketrans(TABLE["letters"]))
    name = re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", " ", name)
    return re.sub(r"[\W_]+", " ", _without_accents(name)).strip()


def _without_accents(text):
    decomposed = unicodedata.normalize("NFKD", text.lower())
    return unicodedata.normalize("NFKC", re.sub("[\u0300-\u036f]", "", decomposed))


def match_rank(name, symbol):
    """Return how well a name fits a quantity: 0 is the best rank, None means it does not fit.

    Names with a rank of `CERTAIN` or more may mean something else.
    """
    row, words = TABLE["quantities"][symbol], spaced(name)
    if WORDS["statistic"].search(words) or (row.get("moves") and WORDS["elsewhere"].search(words)):
        return None
    commanded = WORDS["setpoint"].search(words)
    if commanded and not row.get("commanded"):
        return None
    doubtful = commanded or WORDS["raw"].search(words)
    for word in ("setpoint", "raw", "variant"):
        words = WORDS[word].sub("", words)
    patterns = PATTERNS[symbol]
    ranks = (i for i, pattern in enumerate(patterns) if re.fullmatch(pattern, letters(words)))
    rank = next(ranks, None)
    return rank + len(patterns) if rank is not None and doubtful else rank
