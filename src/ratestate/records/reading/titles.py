"""Titles of columns: the name and the unit in them, and the quantities that names stand for."""

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
#: words for units, in small letters, and capitals of units that no record means otherwise:
#: "TIME [S]" is not in siemens
_WORDS = dict.fromkeys("mic micron microns micrometer micrometers micrometre".split(), "um")
_WORDS |= dict.fromkeys("sec secs second seconds".split(), "s")
_CAPITALS = {unit.upper(): unit for unit in "s ms us min h m cm mm um nm kPa MPa GPa kN Pa".split()}
_GREEK = str.maketrans(
    {"\u03bc": "mu", "\u00b5": "mu", "\u03c3": "sigma", "\u03c4": "tau", "\u03b4": "delta"}
)

_POINT = r"(?:lp|loadpoint|loadingpoint|loadpt|ram|loading|load|actuator|piston|drive|driver)"
_MOVED = r"(?:disp|displ|displacement|position|pos|dist|distance)"
#: displacements that are not the load point's
NOT_OTHERS = r"(?!.*(?:norm|slip|sample|fault|thick|dilat|compac|layer|ecdt|onboard|internal|lvdt))"

#: symbol -> patterns of the letters of a name, the most certain first
PATTERNS = {
    "time": (
        r"(?:t|time|times)",
        r"(?:elapsed|test|exp|experiment|run|rec|record|sample|lab|total|rel|relative)time"
        r"|time(?:stamp|elapsed|column)?|secs?|seconds?|tsec",
    ),
    "delta_lp": (
        rf"{NOT_OTHERS}.*{_POINT}.*{_MOVED}.*|{NOT_OTHERS}.*{_MOVED}.*(?:lp|loadpoint)"
        rf"|deltalp|ulp|xlp|dlp|lp|loadpoint",
        rf"{NOT_OTHERS}(?:shear|total|cumulative|cum)?{_MOVED}s?(?:shear|mm|um)?",
        rf"{NOT_OTHERS}.*{_MOVED}.*",
    ),
    "V_load": (
        rf"vlp|vload|v0?lp|lpv|{_POINT}(?:point)?(?:vel|velocity|speed|rate)"
        r"|(?:vel|velocity|speed)(?:lp|loadpoint)",
        r"(?!.*(?:slip|sample|fault|norm))(?:shear|sliding|imposed|drive|driving|commanded|set)?"
        r"(?:vel|velocity|speed|displacementrate|disprate)s?|v",
    ),
    "friction": (
        r"mu|cof|friction|frictioncoeff?|frictioncoefficient|coefficientoffriction|coeffriction"
        r"|coeffoffriction|frictionalstrength|coefffriction",
        r"(?:apparent|app|meas|measured|corr|corrected|nominal)(?:mu|friction)\w*"
        r"|(?:mu|friction)(?:app|apparent|meas|measured|corr|corrected)?\d?",
        r".*friction.*|mu\w{0,4}",
    ),
    "tau": (
        r"tau|shearstress",
        r"(?!.*(?:strain|disp|vel|rate|modul|stiff)).*shear.*(?:stress|str|trac|traction).*"
        r"|shear|sstress|taus?\w{0,3}|shr?stress",
        r"(?:shear|shr)(?:force|load)",
    ),
    "sigma": (
        r"(?:effective|eff|e)norm(?:al)?(?:stress|str)\w*|sigma(?:n)?eff|effsigman?"
        r"|norm(?:al)?(?:effective|eff)stress|effectivestress",
        r"sigma|sigman|norm(?:al)?stress|nstress|nstr|sn|normalstr|stressnormal",
        r"(?!.*(?:disp|vel|strain)).*norm(?:al)?.*(?:stress|str|trac).*",
        r"(?:normal|norm|n)(?:force|load)",
    ),
}


def split(title):
    """Name and unit of a title such as "time [s]", "Stress, MPa" or "disp_um"; "" for no unit."""
    title = " ".join(title.split()).strip("'\"")
    if match := _BRACKETS.fullmatch(title):
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


def letters(name):
    """A name as it is compared: small letters and digits, nothing else."""
    return re.sub(r"[\W_]+", "", name.translate(_GREEK).lower())


def match_rank(name, patterns):
    """Index of the first pattern that matches the letters of a name, None if none does."""
    ranks = (rank for rank, pattern in enumerate(patterns) if re.fullmatch(pattern, name))
    return next(ranks, None)
