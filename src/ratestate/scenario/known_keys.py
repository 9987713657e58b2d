"""The tables of a scenario file and their keys: permitted values, and an example of each.

Whatever depends on the known friction laws is a function, because users add laws.
"""

import dataclasses
import itertools
from collections.abc import Iterator
from typing import Any

from ..engine.model import METHODS
from ..files import NUMBERS
from ..files.place import PICTURES
from ..friction.forms import FORMS
from ..friction.law import FrictionLaw
from ..friction.law_formula import LOG
from ..friction.laws import DEFAULT, LAWS, own_parameters
from ..model.names import nearest, one_of
from ..model.parameters import WHOLE_CONTACT
from ..model.quantities import QUANTITIES
from ..model.slider import SpringSlider
from .problems import Place
from .scenario import FUNCTIONS
from .values import InlineTable

#: in a table with more keys, unknown ones are not listed
MOST_KEYS = 1000
#: parameters of every slider -> defaults
COMMON = {field.name: field.default for field in dataclasses.fields(SpringSlider)}
#: those that must be given
NEEDED = [key for key, default in COMMON.items() if default is dataclasses.MISSING]
#: keys of [sweep] for all functions, those of the function with most of them first
SETTINGS = dict.fromkeys(
    itertools.chain(*sorted((row.keys for row in FUNCTIONS.values()), key=len, reverse=True))
)
_WAVE = {"period": ("period", "> 0"), "frequency": ("frequency", "> 0")}
#: key of [loading] -> the tables that are its value
LOADING_TABLES = {
    "steps": InlineTable(
        {"t": ("t", "> 0"), "V_lp": ("V_lp", ">= 0"), "hold": ("t", "> 0"), "ramp": ("t", "> 0")},
        '[ { t = "1 s", V_lp = "3.2 mm/s" }, { t = "2 s", hold = "100 s" } ]',
    ),
    "sinusoid": InlineTable(
        {"amplitude": ("V_lp", ">= 0"), **_WAVE}, '{ amplitude = "0.05 mm/s", period = "2 s" }'
    ),
    "sigma_steps": InlineTable(
        {"t": ("t", "> 0"), "sigma": ("sigma", "> 0"), "ramp": ("t", "> 0")},
        '[ { t = "1 s", sigma = "2.1 MPa" }, { t = "2 s", sigma = "2 MPa", ramp = "0.5 s" } ]',
    ),
    "sigma_sinusoid": InlineTable(
        {"amplitude": ("sigma", ">= 0"), **_WAVE}, '{ amplitude = "50 kPa", period = "2 s" }'
    ),
}
#: table -> its keys, except those of `slider_keys`
TABLES = {
    "slider": ("law_file",),
    "loading": (
        *("V_lp", "steps", "sinusoid", "file", "columns", "units", "t"),
        *("sigma", "sigma_steps", "sigma_sinusoid"),
    ),
    "run": ("function", "t_end", "V_start", "initial", "times", "rtol", "method", "frequency"),
    "sweep": ("function", *SETTINGS),
    "output": ("file", "plot"),
}
#: key -> the endings that its file may have
ENDINGS = {"file": NUMBERS, "plot": PICTURES}
#: keys of [sweep] that have one value
ONE_VALUE = ("function", "law", "friction_form", "rtol", "times")
SPEEDS_LIKE = "['1 um/s', '1 um/s', '3 um/s', 0]"
#: key, or key and table -> an example of its value, if that is not a quantity
LIKE = {
    "law": repr(DEFAULT),
    "friction_form": "'cut-off'",
    "law_file": "'mylaw.py'",
    "function": "'limit_cycle'",
    "method": "'auto'",
    "initial": "{ theta = '10 s' }",
    "times": "[0.5, '1 s']",
    "file loading": "'record.csv'",
    "columns": '["time [s]", "V_lp [um/s]"]',
    "units": '["s", "um/s"]',
    "t": "[0, 1, 1, '5 s']",
    "sigma loading": '["2 MPa", "2 MPa", "2.1 MPa", "2.1 MPa"]',
    "file": "'out.nc'",
    "plot": "'out.png'",
    **{key: table.like for key, table in LOADING_TABLES.items()},
}


def parameter_keys() -> tuple[str, ...]:
    """Return the parameters of all sliders, also those that only some laws have, and then need."""
    return (*COMMON, *own_keys())


def own_keys() -> tuple[str, ...]:
    """Return the parameters that only some laws, or forms of friction, have."""
    of_forms = (symbol for form in FORMS.values() for symbol in form.OWN_PARAMETERS)
    return (*own_parameters(LAWS.values()), *of_forms)


def slider_keys() -> tuple[str, ...]:
    """Return the keys of [slider] and [sweep] that describe a slider, per area or in whole."""
    return (*parameter_keys(), *WHOLE_CONTACT)


def keys_of(table: str) -> tuple[str, ...]:
    """Return the keys of a table."""
    match table:
        case "slider":
            return (*slider_keys(), *TABLES[table])
        case "sweep":
            return (*TABLES[table], *slider_keys())
        case _:
            return TABLES[table]


def is_axis(key: str) -> bool:
    """Return whether a key may have many values in [sweep]."""
    return key in keys_of("sweep") and key not in ONE_VALUE


def choices(key: str) -> tuple[str, ...]:
    """Return the names that a key may have as a value; () if its value is not a name."""
    names = {"law": LAWS, "friction_form": (LOG, *FORMS), "method": METHODS, "function": FUNCTIONS}
    return tuple(names.get(key, ()))


def initial(law: FrictionLaw | None) -> InlineTable:
    """Return the table of values at t = 0, with the states of all laws.

    law : the slider's, or None; V may be 0 or backwards if it lets slip reverse
    """
    states = (state for known in LAWS.values() for state in known.states)
    bounds = {"V": ""} if law is None or law.reverses else {}
    symbols = ("V", *states, "tau")
    return InlineTable(
        {symbol: (symbol, bounds.get(symbol)) for symbol in symbols}, LIKE["initial"]
    )


def example(key: str, table: str = "") -> str:
    """Return a line that sets a known key, as an example; it may depend on the table."""
    return f"{key} = {LIKE.get(f'{key} {table}') or LIKE.get(key) or QUANTITIES[key].example}"


def known_items(
    table: str, given: dict[str, Any], place: Place, function: str = ""
) -> Iterator[tuple[str, Any]]:
    """Yield the known keys of a table with their values; note the others, unless too many."""
    keys = keys_of(table)
    if len(given) > MOST_KEYS:
        like = example(keys[0], table)
        place.add("table.too_long", n=len(given), keys=", ".join(keys), like=like)
    for key, value in given.items():
        if key in keys:
            yield key, value
        elif len(given) > MOST_KEYS:
            continue
        elif homes := tables_with(key):
            place.at(key).add("key.misplaced", tables=homes, like=example(key))
        else:
            near_key = nearest(key, keys)
            near = None if near_key else nearest(key, {k for t in TABLES for k in keys_of(t)})
            meant = f" Did you mean {near} in {tables_with(near)}?" if near else ""
            wanted = one_of(keys, key, example(near_key or keys[0], table)) + meant
            place.at(key).add(
                "key.no_parameter" if function else "key.unknown", function=function, wanted=wanted
            )


def tables_with(key: str) -> str:
    """Return the names of the tables that have a key; "" if there are none."""
    return " or ".join(f"[{name}]" for name in TABLES if key in keys_of(name))
