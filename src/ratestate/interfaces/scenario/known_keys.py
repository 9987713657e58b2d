"""The tables of a scenario file, their keys, and which of them each function needs.

What depends on the friction laws that are known is a function: users add laws.
"""

import dataclasses
import itertools
from collections.abc import Iterator
from typing import Any

from ...engine.model import METHODS
from ...errors import ParameterError
from ...files import NUMBERS, PICTURES
from ...friction.composition import composed
from ...friction.forms import FORMS, form_name
from ...friction.law import FrictionLaw
from ...friction.law_formula import LOG
from ...friction.laws import DEFAULT, LAWS, friction_law, own_parameters
from ...model.names import nearest, one_of
from ...model.parameters import WHOLE_CONTACT
from ...model.quantities import example as example_of
from ...model.slider import SpringSlider
from .model import FUNCTIONS
from .problems import Place
from .values import InlineTable

#: in a table with more keys only known ones are read
MOST_KEYS = 1000
#: parameters of every slider -> defaults
COMMON = {field.name: field.default for field in dataclasses.fields(SpringSlider)}
#: those that must be given
NEEDED = [key for key, default in COMMON.items() if default is dataclasses.MISSING]
#: keys of [sweep] for all functions, those of the function with most of them first
SETTINGS = dict.fromkeys(
    itertools.chain(*sorted((row.keys for row in FUNCTIONS.values()), key=len, reverse=True))
)
#: table -> its keys, but for those of `slider_keys`
TABLES = {
    "slider": ("law_file",),
    "loading": (
        *("V_lp", "steps", "sinusoid", "file", "columns", "units", "t"),
        *("sigma", "sigma_steps", "sigma_sinusoid"),
    ),
    "run": ("verb", "t_end", "V_start", "initial", "times", "rtol", "method", "frequency"),
    "sweep": ("verb", *SETTINGS),
    "output": ("file", "plot"),
}
#: key -> the endings that its file may have
ENDINGS = {"file": NUMBERS, "plot": PICTURES}
#: keys of [sweep] that have one value
ONE_VALUE = ("verb", "law", "friction", "rtol", "times")
STEP = InlineTable(
    {"t": ("t", "> 0"), "V_lp": ("V_lp", ">= 0"), "hold": ("t", "> 0"), "ramp": ("t", "> 0")},
    '[ { t = "1 s", V_lp = "3.2 mm/s" }, { t = "2 s", hold = "100 s" } ]',
)
STRESS_STEP = InlineTable(
    {"t": ("t", "> 0"), "sigma": ("sigma", "> 0"), "ramp": ("t", "> 0")},
    '[ { t = "1 s", sigma = "2.1 MPa" }, { t = "2 s", sigma = "2 MPa", ramp = "0.5 s" } ]',
)
STRESS_SINUSOID = InlineTable(
    {
        "amplitude": ("sigma", ">= 0"),
        "period": ("period", "> 0"),
        "frequency": ("frequency", "> 0"),
    },
    '{ amplitude = "50 kPa", period = "2 s" }',
)
SINUSOID = InlineTable(
    STRESS_SINUSOID.keys | {"amplitude": ("V_lp", ">= 0")},
    '{ amplitude = "0.05 mm/s", period = "2 s" }',
)
INITIAL_LIKE = "{ theta = '10 s' }"
SPEEDS_LIKE = "['1 um/s', '1 um/s', '3 um/s', 0]"
#: key, or key and table -> an example of its value, where that is no quantity
LIKE = {
    "law": repr(DEFAULT),
    "friction": "'cut-off'",
    "law_file": "'mylaw.py'",
    "verb": "'limit_cycle'",
    "method": "'auto'",
    "initial": INITIAL_LIKE,
    "times": "[0.5, '1 s']",
    "steps": STEP.like,
    "sinusoid": SINUSOID.like,
    "file loading": "'record.csv'",
    "columns": '["time [s]", "V_lp [um/s]"]',
    "units": '["s", "um/s"]',
    "t": "[0, 1, 1, '5 s']",
    "sigma loading": '["2 MPa", "2 MPa", "2.1 MPa", "2.1 MPa"]',
    "sigma_steps": STRESS_STEP.like,
    "sigma_sinusoid": STRESS_SINUSOID.like,
    "file": "'out.nc'",
    "plot": "'out.png'",
}


def parameter_keys() -> tuple[str, ...]:
    """Parameters of any slider: with those that only some laws have, and then need."""
    return (*COMMON, *own_keys())


def own_keys() -> tuple[str, ...]:
    """Parameters that only some laws, or forms of friction, have."""
    of_forms = (symbol for form in FORMS.values() for symbol in form.OWN_PARAMETERS)
    return (*own_parameters(LAWS.values()), *of_forms)


def slider_keys() -> tuple[str, ...]:
    """What describes a slider, in [slider] and [sweep]: its parameters, per area or in whole."""
    return (*parameter_keys(), *WHOLE_CONTACT)


def keys_of(table: str) -> tuple[str, ...]:
    """The keys of a table."""
    match table:
        case "slider":
            return (*slider_keys(), *TABLES[table])
        case "sweep":
            return (*TABLES[table], *slider_keys())
        case _:
            return TABLES[table]


def is_axis(key: str) -> bool:
    """Whether a key may have many values in [sweep]."""
    return key in keys_of("sweep") and key not in ONE_VALUE


def choices(key: str) -> tuple[str, ...]:
    """The names that a key may have as a value; () if it has no name."""
    names = {"law": LAWS, "friction": (LOG, *FORMS), "method": METHODS, "verb": FUNCTIONS}
    return tuple(names.get(key, ()))


def composed_law_of(slider: dict[str, Any]) -> FrictionLaw | None:
    """The law of a slider with its form of friction and damping, by its keys; None if unknown."""
    try:
        law = friction_law(slider.get("law", DEFAULT))
        form = form_name(slider.get("friction", law.form))
        return composed(law, form, bool(slider.get("damping")))
    except ParameterError:  # noted where the slider is read, or made
        return None


def initial(law: FrictionLaw | None) -> InlineTable:
    """The table of values at t = 0, with the states of all laws.

    law : the slider's, as V may be 0 or backwards where it lets slip reverse; None: not known
    """
    states = (state for known in LAWS.values() for state in known.states)
    bounds = {"V": ""} if law is None or law.reverses else {}
    symbols = ("V", *states, "tau")
    return InlineTable({symbol: (symbol, bounds.get(symbol)) for symbol in symbols}, INITIAL_LIKE)


def example(key: str, table: str = "") -> str:
    """An example of a line that sets a known key, of this table if its value differs there."""
    return f"{key} = {LIKE.get(f'{key} {table}') or LIKE.get(key) or example_of(key)}"


def known_items(
    table: str, given: dict[str, Any], place: Place, verb: str = ""
) -> Iterator[tuple[str, Any]]:
    """The known keys of a table with their values; others are noted, unless there are too many."""
    keys = keys_of(table)
    if len(given) > MOST_KEYS:
        like = example(keys[0], table)
        place.add("table.too_long", n=len(given), keys=", ".join(keys), like=like)
    for key, value in given.items():
        if key in keys:
            yield key, value
        elif len(given) <= MOST_KEYS:
            _note_unknown(table, key, place.at(key), verb)


def _note_unknown(table: str, key: str, place: Place, verb: str) -> None:
    """Note an unknown key: with the table where it belongs, or a similar key."""
    if homes := tables_with(key, table):
        place.add("key.misplaced", tables=homes, like=example(key))
        return
    keys = keys_of(table)
    own = nearest(key, keys)
    near = None if own else nearest(key, {k for t in TABLES for k in keys_of(t)})
    meant = f" Did you mean {near} in {tables_with(near, table)}?" if near else ""
    wanted = one_of(keys, key, example(own or keys[0], table)) + meant
    place.add("key.no_parameter" if verb else "key.unknown", verb=verb, wanted=wanted)


def tables_with(key: str, but: str = "") -> str:
    """The tables that have a key, except one; "" if there are none."""
    homes = [f"[{name}]" for name in TABLES if key in keys_of(name) and name != but]
    return " or ".join(homes)
