"""The table [sweep]: the verb, and the parameters that have many values."""

import math
from typing import Any, NamedTuple

from ...dynamics.continuation.family import PARAMETERS
from ...errors import ParameterError
from .known_keys import SLIDER, VERBS, example, keys_to_read, note_unknown
from .problems import Problems, choice, one_of, shown
from .simple_tables import single_value
from .values import AXIS, Many, as_array, as_axis, ends, read_values

#: cases of a sweep, at most
MOST_CASES = 10**9
ONE_FOR_ALL = {"law", "rtol"}  # keys with one value for all cases
BRANCH = 'K = { from = "700 MPa/m", to = "300 MPa/m" }'


class Sweep(NamedTuple):
    """The table [sweep].

    verb : the function to call: the requested one, or the file's own; "" if that is unknown
    own : the file's own verb
    values : key -> float, law, DataArray of an axis, times, or None for one with a problem
    branch : the keys parameter, start and stop of `continue_cycle`
    """

    verb: str
    own: str
    values: dict[str, Any]
    branch: dict[str, Any]


def sweep_table(
    table: dict[str, Any] | None, requested: str | None, of_run: str | None, problems: Problems
) -> Sweep:
    """Read the table [sweep].

    Parameters
    ----------
    table : dict or None
        None if the file has none.
    requested : str or None
        A function to call in place of the file's own.
    of_run : str or None
        The verb in [run].
    """
    if table is None:
        own = of_run or "simulate"
        verb = requested or own
        if verb == "continue_cycle":
            problems.add("[sweep]", f"is missing, expected what a branch follows, such as {BRANCH}")
        return Sweep(verb, own, {}, {})
    table = keys_to_read("sweep", table, problems)
    own = _verb(table, requested, of_run, problems)
    verb = requested or own
    kinds = [VERBS[own]] if own else list(VERBS.values())
    known = dict.fromkeys([*SLIDER.keys, *(key for kind in kinds for key in kind.keys)])
    values = {k: v for k, v in table.items() if k in known}
    for key in table.keys() - known.keys() - {"verb"}:
        whose = f"the slider or of {own}" if own else "the slider or of any verb"
        if any(key in kind.keys for kind in VERBS.values()):
            problems.add(
                f"[sweep] {key}", f"is no parameter of {whose}, {one_of(known, key, example(key))}"
            )
        else:
            note_unknown("sweep", key, problems, f"is no parameter of {whose}")
    branch = _branch(values, own, problems) if verb == "continue_cycle" else {}
    values_read = _read_values(values, own, problems, bool(branch))
    kept = {*SLIDER.keys, *VERBS[verb].keys} if verb else {*known}
    if own and own != verb:  # the meaning of rtol differs between functions
        kept -= {"rtol"}
    return Sweep(verb, own, {k: v for k, v in values_read.items() if k in kept}, branch)


def _verb(
    table: dict[str, Any], requested: str | None, of_run: str | None, problems: Problems
) -> str:
    """The verb of the file."""
    if "verb" in table:
        with problems.at("[sweep] verb"):
            verb = choice(table["verb"], VERBS)
            if of_run and of_run != verb:
                raise ParameterError(
                    f"{shown(verb)} is not that of [run], expected one such as {shown(of_run)}"
                )
            return verb
    elif of_run or requested:
        return of_run or requested or ""
    else:
        problems.add("[sweep] verb", f"is missing, {one_of(VERBS)}")
    return ""


def _read_values(
    given: dict[str, Any], verb: str, problems: Problems, is_branch: bool
) -> dict[str, Any]:
    """The values of all keys; axes only if there are not too many cases."""
    values: dict[str, Any] = {}
    for key, value in given.items():
        if key in ONE_FOR_ALL:
            values[key] = single_value("sweep", key, value, problems)
        else:
            bound = ">= 0" if key == "V_lp" and verb == "simulate" else None
            values[key] = read_values(key, value, f"[sweep] {key}", problems, bound)
    many = {key for key, value in given.items() if isinstance(value, dict | list)}
    if not is_branch and not many - ONE_FOR_ALL - {"times"}:
        problems.add("[sweep]", f"nothing has many values, expected an axis such as M = {AXIS}")
    if not _few_enough(values, problems):
        return dict.fromkeys(values)
    for key, value in values.items():
        if key == "times" and value is not None:
            values[key] = as_array(key, value)
        elif isinstance(value, Many):
            values[key] = as_axis(key, value)
    return values


def _few_enough(values: dict[str, Any], problems: Problems) -> bool:
    sizes = {k: len(v) for k, v in values.items() if isinstance(v, Many) and k != "times"}
    if (cases := math.prod(sizes.values())) <= MOST_CASES:
        return True
    product = " x ".join(f"{size} {key}" for key, size in sizes.items())
    what = f"{product} are {cases} cases, expected {MOST_CASES} at most, of axes such as {AXIS}"
    problems.add("[sweep]", what)
    return False


def _branch(values: dict[str, Any], own: str, problems: Problems) -> dict[str, Any]:
    """Remove the parameter that a branch follows from the values; its ends, or None each."""
    nothing: dict[str, Any] = dict.fromkeys(("parameter", "start", "stop"))
    followed = [key for key, value in values.items() if isinstance(value, dict)]
    if len(followed) != 1:
        names = " and ".join(followed) or "nothing"
        problems.add("[sweep]", f"{names} between two ends, expected one such as {BRANCH}")
        return nothing
    key = followed[0]
    table = values.pop(key)
    with problems.at(f"[sweep] {key}"):
        if key not in PARAMETERS:
            raise ParameterError(f"cannot be followed, {one_of(PARAMETERS, like=BRANCH)}")
        if own == "continue_cycle" and (more := table.keys() - {"from", "to"}):
            raise ParameterError(
                f"{', '.join(map(shown, sorted(more)))}: a branch chooses its points itself, "
                f"expected from and to only, such as {BRANCH}"
            )
    start, stop = ends(key, table, f"[sweep] {key}", problems)
    return {"parameter": key, "start": start, "stop": stop}
