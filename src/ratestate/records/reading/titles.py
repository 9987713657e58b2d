"""Titles of columns: the name and the unit in them."""

import re

#: spellings of units by which one is known beside a name: "time_s", "Shear stress, MPa"
UNITS = frozenset(
    "s ms msec us min mins minutes h hr hrs hours days "
    "m cm mm um nm inch m/s mm/s um/s nm/s cm/s mm/min um/min "
    "pa kpa mpa gpa bar psi n kn v mv volt volts - 1".split()
)
#: units so short that after a name they are perhaps a part of it: "normal_n", "v"
_SHORT = frozenset("m n v h 1".split())
_BRACKETS = re.compile(r"(.*?)[\s_,:]*[\[({<]\s*([^\[\](){}<>]*)\s*[\])}>]\s*(.*)", re.DOTALL)
#: name, what parts it from the unit, unit: "disp_um" before "t/s", for "speed um/s" is the former
_AFTER = [re.compile(rf"(.*[^\W_].*?){gap}([^\s_,;:]+)") for gap in (r"[\s_,;:]+", r"\s*/\s*")]


def split(title):
    """Name and unit of a title such as "time [s]", "Stress, MPa" or "disp_um"; "" for no unit."""
    title = " ".join(title.split()).strip("'\"")
    match = _BRACKETS.fullmatch(title)
    if match:
        name, unit, rest = match.groups()
        return f"{name} {rest}".strip(), unit.strip()
    for pattern in _AFTER:
        match = pattern.fullmatch(title)
        if match and is_unit(match[2]) and match[2].lower() not in _SHORT:
            return match[1], match[2]
    return title, ""


def is_unit(text):
    """Whether a text can only be a unit (or "-" for none)."""
    return plain(text).lower() in UNITS


def plain(unit):
    """A unit as `ratestate.model.units` reads it, out of the ways in which files write it."""
    unit = unit.strip().strip("[](){}<>").strip().replace("\u03bc", "u").replace("\u00b5", "u")
    if unit.lower() in (".", "-", "--", "none", "unitless", "dimensionless"):
        return "1"
    words = re.split(r"([^A-Za-z]+)", unit.partition(" since ")[0])
    return "".join(_WORDS.get(word.lower(), _CAPITALS.get(word, word)) for word in words)


#: words for units, in small letters and capitals
_WORDS = dict.fromkeys(
    ["mic", "micron", "microns", "micrometer", "micrometers", "micrometre"], "um"
)
_WORDS |= dict.fromkeys(["sec", "secs", "second", "seconds"], "s")
#: capitals of units that no record means otherwise: "TIME [S]" is not in siemens
_CAPITALS = {unit.upper(): unit for unit in "s ms us min h m cm mm um nm kPa MPa GPa kN".split()}
_CAPITALS["PA"] = "Pa"


def letters(name):
    """A name as it is compared: small letters and digits, nothing else."""
    name = name.replace("\u03bc", "mu").replace("\u00b5", "mu").replace("\u03c3", "sigma")
    name = name.replace("\u03c4", "tau").replace("\u03b4", "delta")
    return re.sub(r"[\W_]+", "", name.lower())
