"""The tables whose keys have a value each, [slider], [run] and [output], and [sweep]."""

import math
from pathlib import Path
from typing import Any, NamedTuple

from ...dynamics.continuation.family import PARAMETERS
from ...friction.composition import EXTRAS
from ...friction.law import FrictionLaw
from ...friction.law_formula import HASH_MARK
from ...friction.laws import find_law_name
from ...model.names import one_of
from ...model.parameters import WHOLE_CONTACT
from ...model.quantities import QUANTITIES
from .known_keys import (
    ENDINGS,
    SETTINGS,
    choices,
    example,
    initial,
    is_axis,
    known_items,
    own_keys,
    slider_keys,
)
from .model import FUNCTIONS
from .problems import Place, Problem, choice, message, refusal, shown
from .values import AXIS, Many, as_array, as_axis, read_ends, read_number, read_values

LONGEST_PATH = 255  # characters
#: cases of a sweep, at most
MOST_CASES = 10**9
BRANCH = 'K = { from = "700 MPa/m", to = "300 MPa/m" }'


def plain_table(
    name: str, table: dict[str, Any], problems: list[Problem], law: FrictionLaw | None = None
) -> dict[str, Any]:
    """The values of such a table: key -> value, or None for one with a problem.

    law : the slider's, for its values at t = 0; None where it is not known
    """
    place = Place((name,), problems)
    items = known_items(name, table, place)
    values = {key: read_value(key, value, place.at(key), law) for key, value in items}
    return _per_area(values, place)


def _per_area(values: dict[str, Any], place: Place) -> dict[str, Any]:
    """The values, with mass = 6 as M = "6.0 kg", and so on; a parameter given twice is noted."""
    for name in WHOLE_CONTACT.keys() & values.keys():
        symbol, value = WHOLE_CONTACT[name], values.pop(name)
        if symbol in values:
            place.at(name).add("key.twice", symbol=symbol, like=example(name))
        if isinstance(value, Many):
            values[symbol] = value._replace(quantity=name)
        else:  # (None has a problem)
            values[symbol] = None if value is None else f"{value!r} {QUANTITIES[name].unit}"
    return values


def read_value(key: str, value: Any, place: Place, law: FrictionLaw | None = None) -> Any:
    """The value of a known key that has no axis here: float [SI], str, Path, dict or (n,) array.

    Frequencies are a DataArray along themselves.

    None if it has a problem, which is noted.
    """
    if key == "initial":
        before = len(place.problems)
        values = initial(law).read(value, place)
        return values if len(place.problems) == before else None
    if key == "times":
        many = read_values(key, value, place)
        return None if many is None else as_array(key, many)
    if key == "frequency":
        many = read_values(key, value, place)
        return as_axis(key, many) if isinstance(many, Many) else many
    if isinstance(value, dict | list) and is_axis(key):
        place.add("key.no_axis", given=value, like=example(key))
        return None
    if key == "law":
        value = find_law_name(value) or value
        if isinstance(value, str) and HASH_MARK in value and not find_law_name(value):
            place.add("law_file.unknown", given=value, own=value.partition(HASH_MARK)[0])
            return None
    if names := choices(key):
        return place.noting(lambda: choice(value, names))
    if key in ENDINGS:
        return place.noting(lambda: _path(key, value))
    return read_number(key, value, place)


def _path(key: str, value: Any) -> Path:
    """The path of a file that can be written; ParameterError if it cannot."""
    endings = ENDINGS[key]
    wanted = message("output.wanted", names=" or ".join(endings), ending=endings[0])
    if not isinstance(value, str):
        raise refusal("output.no_text", given=value, wanted=wanted)
    if len(value) > LONGEST_PATH or not value.isprintable():
        raise refusal("output.no_name", given=value, wanted=wanted)
    path = Path(value)
    if path.suffix.lower() not in endings:
        raise refusal("output.ending", given=value, wanted=wanted)
    if not path.parent.is_dir():
        raise refusal("output.no_folder", given=value, wanted=wanted)
    return path


class Sweep(NamedTuple):
    """The table [sweep]."""

    verb: str  # the function to call: the requested one, or the file's own; "" if that is unknown
    own: str  # the file's own verb
    values: dict[str, Any]  # floats, DataArrays of axes, times, law; None for one with a problem
    branch: dict[str, Any]  # the keys parameter, start and stop of `continue_cycle`


def sweep_table(
    table: dict[str, Any] | None,
    requested: str | None,
    of_run: str | None,
    problems: list[Problem],
    law: FrictionLaw | None,
) -> Sweep:
    """Read the table [sweep], if any; `requested` replaces its verb, which may be that of [run].

    Problems are noted; keys that the function does not take are checked, but left out.

    law : the slider's, along whose own parameters a branch may go; None where it is not known
    """
    place = Place(("sweep",), problems)
    if table is None:
        own = of_run or "simulate"
        verb = requested or own
        if verb == "continue_cycle":
            place.add("branch.missing", like=BRANCH)
        return Sweep(verb, own, {}, {})
    own = _verb(table, requested, of_run, place)
    verb = requested or own
    of_slider = slider_keys()
    of_verb = {name: [*of_slider, *function.keys] for name, function in FUNCTIONS.items()}
    known = of_verb.get(own) or [*SETTINGS, *of_slider]
    given = {}
    for key, value in known_items("sweep", table, place, own or "any verb"):
        if key in known:
            given[key] = value
        elif key != "verb":
            wanted = one_of(known, key, example(key))
            place.at(key).add("key.no_parameter", verb=own, wanted=wanted)
    branch = _branch(given, own, place, law) if verb == "continue_cycle" else {}
    values = _read(given, own, place, bool(branch))
    kept = {*of_verb.get(verb, known)}
    if own and own != verb:  # their meaning differs between functions
        kept -= {"rtol", "V_start"}
    return Sweep(verb, own, {k: v for k, v in values.items() if k in kept}, branch)


def _verb(table: dict[str, Any], requested: str | None, of_run: str | None, place: Place) -> str:
    """The verb of the file."""
    if "verb" not in table:
        if not (of_run or requested):
            place.missing("verb", one_of(FUNCTIONS))
        return of_run or requested or ""
    verb = place.at("verb").noting(lambda: choice(table["verb"], FUNCTIONS))
    if verb and of_run not in (None, verb):
        place.at("verb").add("table.two_verbs", given=verb, own=of_run)
        return ""
    return verb or ""


def _read(given: dict[str, Any], verb: str, place: Place, is_branch: bool) -> dict[str, Any]:
    """The values of all keys; axes only if there are not too many cases."""
    values: dict[str, Any] = {}
    for key, value in given.items():
        if is_axis(key):
            bound = ">= 0" if key == "V_lp" and verb == "simulate" else None
            values[key] = read_values(key, value, place.at(key), bound)
        else:
            values[key] = read_value(key, value, place.at(key))
    values = _per_area(values, place)
    many = [key for key, value in given.items() if isinstance(value, dict | list)]
    if not is_branch and not any(map(is_axis, many)):
        place.add("sweep.no_axis", like=AXIS)
    axes = {k: v for k, v in values.items() if isinstance(v, Many) and is_axis(k)}
    if (cases := math.prod(axis.size for axis in axes.values())) > MOST_CASES:
        product = " x ".join(f"{axis.size} {key}" for key, axis in axes.items())
        place.add("sweep.too_many", product=product, cases=cases, most=MOST_CASES, like=AXIS)
        return dict.fromkeys(values)
    return values | {key: as_axis(key, axis) for key, axis in axes.items()}


def _branch(
    values: dict[str, Any], own: str, place: Place, law: FrictionLaw | None
) -> dict[str, Any]:
    """Remove the parameter that a branch follows from the values; its ends, or None each."""
    nothing: dict[str, Any] = dict.fromkeys(("parameter", "start", "stop"))
    followed = [key for key, value in values.items() if isinstance(value, dict)]
    if len(followed) != 1:
        names = " and ".join(followed) or "nothing"
        place.add("branch.not_one", names=names, like=BRANCH)
        return nothing
    (key,) = followed
    table = values.pop(key)
    known = (*PARAMETERS, *((*own_keys(), *EXTRAS) if law is None else law.parameters))
    if key not in known:
        place.at(key).add("branch.cannot_follow", wanted=one_of(known, like=BRANCH))
        return nothing
    if own == "continue_cycle" and (more := table.keys() - {"from", "to"}):
        keys = ", ".join(map(shown, sorted(more)))
        place.at(key).add("branch.own_points", keys=keys, like=BRANCH)
    start, stop = read_ends(key, table, place.at(key))
    return {"parameter": key, "start": start, "stop": stop}
