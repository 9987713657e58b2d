"""Read the tables [slider], [run], [output] and [sweep] of a scenario file."""

import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..dynamics.continuation.family import PARAMETERS
from ..friction.composition import EXTRAS
from ..friction.law import FrictionLaw
from ..friction.law_formula import HASH_MARK
from ..friction.laws import find_law_name
from ..model.names import one_of
from ..model.parameters import WHOLE_CONTACT
from ..model.quantities import QUANTITIES
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
from .problems import Place, Problem, choice, message, refusal, shown
from .scenario import FUNCTIONS
from .values import AXIS, Many, read_ends, read_number, read_values

LONGEST_PATH = 255  # characters
#: cases of a sweep, at most
MOST_CASES = 10**9
BRANCH = 'K = { from = "700 MPa/m", to = "300 MPa/m" }'


def plain_table(
    name: str, table: dict[str, Any], problems: list[Problem], law: FrictionLaw | None = None
) -> dict[str, Any]:
    """Return the values of such a table: key -> value, or None for one with a problem, noted.

    law : the slider's, for its values at t = 0; None if it is unknown
    """
    place = Place((name,), problems)
    items = known_items(name, table, place)
    return _per_area({key: read_value(key, x, place.at(key), law) for key, x in items}, place)


def _per_area(values: dict[str, Any], place: Place) -> dict[str, Any]:
    """Return values with mass = 6 as M = "6.0 kg" and so on; note parameters given twice."""
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
    """Return the value of a known key that has no axis here; None for a problem, noted.

    It is a float [SI], a str, a Path, a dict, an array (n,) of times, or frequencies as a DataArray
    along themselves.
    """
    before = len(place.problems)
    if key == "initial":
        values = initial(law).read(value, place)
        return values if len(place.problems) == before else None
    if key in ("times", "frequency"):
        axis = read_values(key, value, place)
        if key == "times" and isinstance(axis, float):
            return np.array([axis])
        if isinstance(axis, Many):
            return axis.array() if key == "times" else axis.axis(key)
        return axis
    if isinstance(value, dict | list) and is_axis(key):
        place.add("key.no_axis", given=value, like=example(key))
        return None
    if key == "law":
        value = find_law_name(value) or value
        if isinstance(value, str) and HASH_MARK in value and not find_law_name(value):
            place.add("law_file.unknown", given=value, own=value.partition(HASH_MARK)[0])
            return None
    if names := choices(key):
        return place.attempt(lambda: choice(value, names))
    if key in ENDINGS:
        return place.attempt(lambda: _path(key, value))
    return read_number(key, value, place)


def _path(key: str, value: Any) -> Path:
    """Return the path of a file that can be written; ParameterError if it cannot."""
    endings = ENDINGS[key]
    wanted = message("output.wanted", names=" or ".join(endings), ending=endings[0])
    if not isinstance(value, str):
        problem = "output.no_text"
    elif len(value) > LONGEST_PATH or not value.isprintable():
        problem = "output.no_name"
    elif (path := Path(value)).suffix.lower() not in endings:
        problem = "output.ending"
    elif not path.parent.is_dir():
        problem = "output.no_folder"
    else:
        return path
    raise refusal(problem, given=value, wanted=wanted)


class Sweep(NamedTuple):
    """The table [sweep]."""

    function: str  # to call: the requested one, or the file's own; "" if unknown
    file_function: str  # the file's own function
    values: dict[str, Any]  # floats, DataArrays of axes, times, law; None for one with a problem
    branch: dict[str, Any]  # the keys parameter, start and stop of `continue_cycle`


def sweep_table(
    table: dict[str, Any] | None,
    requested: str | None,
    of_run: str | None,
    problems: list[Problem],
    law: FrictionLaw | None,
) -> Sweep:
    """Read the table [sweep], if there is one, and note problems.

    Keys that the function does not take are checked, but left out.

    requested : the function that replaces the one that the file names, or None
    of_run : the function that [run] names, or None
    law : the slider's, along whose own parameters a branch may go; None if it is unknown
    """
    place = Place(("sweep",), problems)
    if table is None:
        file_function = of_run or "simulate"
        if (function := requested or file_function) == "continue_cycle":
            place.add("branch.missing", like=BRANCH)
        return Sweep(function, file_function, {}, {})
    file_function = _function_of(table, requested, of_run, place)
    function = requested or file_function
    known = (*slider_keys(), *(FUNCTIONS[file_function].keys if file_function else SETTINGS))
    given = {}
    for key, value in known_items("sweep", table, place, file_function or "any function"):
        if key in known:
            given[key] = value
        elif key != "function":
            wanted = one_of(known, key, example(key))
            place.at(key).add("key.no_parameter", function=file_function, wanted=wanted)
    branch = _branch(given, file_function, place, law) if function == "continue_cycle" else {}
    values = _read(given, file_function, place, bool(branch))
    if file_function and file_function != function:
        taken = {*slider_keys(), *FUNCTIONS[function].keys} - {"rtol", "V_start"}  # they differ
        values = {key: value for key, value in values.items() if key in taken}
    return Sweep(function, file_function, values, branch)


def _function_of(
    table: dict[str, Any], requested: str | None, of_run: str | None, place: Place
) -> str:
    """Return the function that the file names; "" for a problem, noted."""
    if "function" not in table:
        if not (of_run or requested):
            place.missing("function", one_of(FUNCTIONS))
        return of_run or requested or ""
    function = place.at("function").attempt(lambda: choice(table["function"], FUNCTIONS))
    if function and of_run not in (None, function):
        place.at("function").add("table.two_functions", given=function, own=of_run)
        return ""
    return function or ""


def _read(given: dict[str, Any], function: str, place: Place, is_branch: bool) -> dict[str, Any]:
    """Return the values of all keys; make axes only if there are not too many cases."""
    values: dict[str, Any] = {}
    for key, value in given.items():
        if is_axis(key):
            bound = ">= 0" if key == "V_lp" and function == "simulate" else None
            values[key] = read_values(key, value, place.at(key), bound)
        else:
            values[key] = read_value(key, value, place.at(key))
    values = _per_area(values, place)
    if not is_branch and not any(
        isinstance(x, dict | list) and is_axis(k) for k, x in given.items()
    ):
        place.add("sweep.no_axis", like=AXIS)
    axes = {key: value for key, value in values.items() if isinstance(value, Many)}
    if (cases := math.prod(axis.size for axis in axes.values())) > MOST_CASES:
        product = " x ".join(f"{axis.size} {key}" for key, axis in axes.items())
        place.add("sweep.too_many", product=product, cases=cases, most=MOST_CASES, like=AXIS)
        return dict.fromkeys(values)
    return values | {key: axis.axis(key) for key, axis in axes.items()}


def _branch(
    values: dict[str, Any], file_function: str, place: Place, law: FrictionLaw | None
) -> dict[str, Any]:
    """Remove the parameter that a branch follows from the values; return its ends, or None each."""
    no_branch: dict[str, Any] = dict.fromkeys(("parameter", "start", "stop"))
    followed = [key for key, value in values.items() if isinstance(value, dict)]
    if len(followed) != 1:
        names = " and ".join(followed) or "nothing"
        place.add("branch.not_one", names=names, like=BRANCH)
        return no_branch
    (key,) = followed
    table = values.pop(key)
    known = (*PARAMETERS, *((*own_keys(), *EXTRAS) if law is None else law.parameters))
    if key not in known:
        place.at(key).add("branch.cannot_follow", wanted=one_of(known, like=BRANCH))
        return no_branch
    if file_function == "continue_cycle" and (extra := table.keys() - {"from", "to"}):
        keys = ", ".join(map(shown, sorted(extra)))
        place.at(key).add("branch.own_points", keys=keys, like=BRANCH)
    start, stop = read_ends(key, table, place.at(key))
    return {"parameter": key, "start": start, "stop": stop}
