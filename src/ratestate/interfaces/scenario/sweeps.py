"""The table [sweep]: the verb, and the parameters that have many values."""

import math
from typing import Any, NamedTuple

from ...dynamics.continuation.family import PARAMETERS
from ...errors import ParameterError
from .problems import Problems, choice, one_of, shown
from .simple import one
from .tables import SLIDER, VERBS, example, fewer, unknown
from .values import AXIS, Many, array, axis, ends, read

#: cases of a sweep, at most
MOST_CASES = 10**9
ONE_FOR_ALL = {"law", "rtol"}  # keys with one value for all cases
BRANCH = 'K = { from = "700 MPa/m", to = "300 MPa/m" }'


class Sweep(NamedTuple):
    """What [sweep] asks for.

    verb : of the file, or the one that is asked of it; "" where the file's is no verb
    own : the verb of the file
    values : key -> float, law, DataArray of an axis, times, or None for one with a problem
    branch : the keys parameter, start and stop of `continue_cycle`
    """

    verb: str
    own: str
    values: dict[str, Any]
    branch: dict[str, Any]


def sweep_table(
    table: dict[str, Any] | None, asked: str | None, of_run: str | None, problems: Problems
) -> Sweep:
    """What the table [sweep] asks for.

    Parameters
    ----------
    table : dict or None
        None if the file has none.
    asked : str or None
        A verb that is asked of the file in place of its own.
    of_run : str or None
        The verb that [run] asks for.
    """
    if table is None:
        own = of_run or "simulate"
        verb = asked or own
        if verb == "continue_cycle":
            problems.add("[sweep]", f"is missing, expected what a branch follows, such as {BRANCH}")
        return Sweep(verb, own, {}, {})
    table = fewer("sweep", table, problems)
    own = _verb(table, asked, of_run, problems)
    verb = asked or own
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
            unknown("sweep", key, problems, f"is no parameter of {whose}")
    branch = _branch(values, own, problems) if verb == "continue_cycle" else {}
    found = _values(values, own, problems, bool(branch))
    kept = {*SLIDER.keys, *VERBS[verb].keys} if verb else {*known}
    if own and own != verb:  # rtol does not mean the same to all verbs
        kept -= {"rtol"}
    return Sweep(verb, own, {k: v for k, v in found.items() if k in kept}, branch)


def _verb(table: dict[str, Any], asked: str | None, of_run: str | None, problems: Problems) -> str:
    """The verb of the file."""
    if "verb" in table:
        with problems.at("[sweep] verb"):
            verb = choice(table["verb"], VERBS)
            if of_run and of_run != verb:
                raise ParameterError(
                    f"{shown(verb)} is not that of [run], expected one such as {shown(of_run)}"
                )
            return verb
    elif of_run or asked:
        return of_run or asked or ""
    else:
        problems.add("[sweep] verb", f"is missing, {one_of(VERBS)}")
    return ""


def _values(
    given: dict[str, Any], verb: str, problems: Problems, is_branch: bool
) -> dict[str, Any]:
    """The values of all keys; axes only if there are not too many cases."""
    values: dict[str, Any] = {}
    for key, value in given.items():
        if key in ONE_FOR_ALL:
            values[key] = one("sweep", key, value, problems)
        else:
            bound = ">= 0" if key == "V_lp" and verb == "simulate" else None
            values[key] = read(key, value, f"[sweep] {key}", problems, bound)
    many = {key for key, value in given.items() if isinstance(value, dict | list)}
    if not is_branch and not many - ONE_FOR_ALL - {"times"}:
        problems.add("[sweep]", f"nothing has many values, expected an axis such as M = {AXIS}")
    if not _few_enough(values, problems):
        return dict.fromkeys(values)
    for key, value in values.items():
        if key == "times" and value is not None:
            values[key] = array(key, value)
        elif isinstance(value, Many):
            values[key] = axis(key, value)
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
    """Take the parameter that a branch follows out of the values; its ends, or None each."""
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
    found = ends(key, table, f"[sweep] {key}", problems)
    return nothing | {"parameter": key} | dict(zip(("start", "stop"), found, strict=True))
