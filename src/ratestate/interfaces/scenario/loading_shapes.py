"""The keys steps and sinusoid of [loading]."""

from typing import Any, NamedTuple

from .problems import Problems, expected, one_of, shown, toml_key
from .values import number

MOST_STEPS = 1000
STEP = ("t", "V_lp", "hold", "ramp")
SINE = ("amplitude", "period", "frequency")
STEPS_LIKE = '[ { t = "1 s", V_lp = "3.2 mm/s" }, { t = "2 s", hold = "100 s" } ]'
SINE_LIKE = '{ amplitude = "0.05 mm/s", period = "2 s" }'


class Event(NamedTuple):
    """A step, hold or ramp: what the methods of `Loading` with these names take."""

    place: str
    kind: str  # "step", "hold", "ramp"
    arguments: dict[str, float]


def events(steps: Any, problems: Problems) -> list[Event]:
    """Steps, holds and ramps; those with a problem are left out."""
    if not isinstance(steps, list) or not 1 <= len(steps) <= MOST_STEPS:
        what = f"{shown(steps)} is no list of 1 to {MOST_STEPS} steps, expected such as"
        problems.add("[loading] steps", f"{what} {STEPS_LIKE}")
        return []
    found = []
    for i, step in enumerate(steps):
        place = f"[loading] steps[{i}]"
        if not isinstance(step, dict):
            problems.add(place, f"{shown(step)} is no table, expected such as {STEPS_LIKE}")
        elif event := _event(step, place, problems):
            found.append(event)
    return found


def _event(step: dict[str, Any], place: str, problems: Problems) -> Event | None:
    """A step, hold or ramp."""
    before = len(problems)
    for key in step.keys() - {*STEP}:
        problems.add(f"{place}.{toml_key(key)}", f"unknown key, {one_of(STEP, key, STEPS_LIKE)}")
    if "t" not in step:
        problems.add(f"{place}.t", f"is missing, {expected('t')}")
    if "hold" in step:
        for key in {"V_lp", "ramp"} & step.keys():
            what = "is given beside hold, which is a rest, expected in a step of its own such as"
            problems.add(f"{place}.{key}", f"{what} {STEPS_LIKE}")
    elif "V_lp" not in step:
        problems.add(f"{place}.V_lp", f"is missing, {expected('V_lp')}; or hold = '100 s'")
    values: dict[str, float] = {}
    for key, symbol in (("t", "t"), ("V_lp", "V_lp"), ("hold", "t"), ("ramp", "t")):
        if key in step:
            with problems.at(f"{place}.{key}", symbol):
                name = {"V_lp": "V", "t": "t"}.get(key, "duration")
                values[name] = number(symbol, step[key], ">= 0" if key == "V_lp" else "> 0")
    kind = "hold" if "hold" in step else "ramp" if "ramp" in step else "step"
    return Event(place, kind, values) if len(problems) == before else None


def sinusoid(table: Any, problems: Problems) -> dict[str, float]:
    """The keys of a sinusoid, in SI."""
    if not isinstance(table, dict):
        what = f"{shown(table)} is no table, expected such as {SINE_LIKE}"
        problems.add("[loading] sinusoid", what)
        return {}
    for key in table.keys() - {*SINE}:
        problems.add(
            f"[loading] sinusoid.{toml_key(key)}", f"unknown key, {one_of(SINE, key, SINE_LIKE)}"
        )
    if "amplitude" not in table:
        problems.add("[loading] sinusoid.amplitude", f"is missing, {expected('V_lp')}")
    if ("period" in table) == ("frequency" in table):
        how = "twice" if "period" in table else "is missing"
        what = f"{how}, expected a period such as '2 s' or a frequency such as '0.5 Hz'"
        problems.add("[loading] sinusoid.period", what)
    values = {}
    for key in [key for key in SINE if key in table]:
        symbol, bound = ("V_lp", ">= 0") if key == "amplitude" else (key, "> 0")
        with problems.at(f"[loading] sinusoid.{key}", symbol):
            values[key] = number(symbol, table[key], bound)
    return values
