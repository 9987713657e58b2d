"""The table [loading]: a speed, with steps or a sinusoid about it, or a record."""

import dataclasses
import functools
from pathlib import Path
from typing import Any

from ...model.loading import Loading
from ...model.loading.written import Event
from .known_keys import LIKE, SINUSOID, SPEEDS_LIKE, STEP, example, known_items, misplaced_axis
from .problems import Place, expected, shown
from .record import read_record
from .values import as_array, read_number, read_values

#: keys of a loading beside its speed, of which it may have one
SHAPES = ("steps", "sinusoid", "file", "t")
MOST_STEPS = 1000


@dataclasses.dataclass
class LoadingTable:
    """The table [loading]; the loading is built when the sweep and the end of the run are known.

    Attributes
    ----------
    place : Place
    given : dict
        The keys that the file has, and their values as it has them.
    V_lp : float or None
        The speed at the start, or the mean.
    events : list of (Place, Event)
        Steps, holds and ramps, in SI.
    sine : dict
        The keys of the sinusoid, in SI.
    record : Loading or None
        The loading from a record.
    ends : float or None
        The last speed of a record.
    sound : bool
        Whether the table has no problems.
    """

    place: Place
    given: dict[str, Any]
    V_lp: float | None = None
    events: list[tuple[Place, Event]] = dataclasses.field(default_factory=list)
    sine: dict[str, Any] = dataclasses.field(default_factory=dict)
    record: Loading | None = None
    ends: float | None = None
    sound: bool = True

    @property
    def is_record(self) -> bool:
        """Whether the speeds are those of a record."""
        return bool({"file", "t"} & self.given.keys())

    @property
    def last(self) -> tuple[Place, float | None]:
        """The key of the last speed, for messages, and this speed [m/s]."""
        if self.is_record:
            return self.place.at("file" if "file" in self.given else "V_lp"), self.ends
        if self.final:
            place, event = self.final
            return place.at("V_lp"), event.V
        return self.place.at("V_lp"), self.V_lp

    @property
    def final(self) -> tuple[Place, Event] | None:
        """The last event that has a speed."""
        return next((pair for pair in reversed(self.events) if pair[1].V is not None), None)

    def build(self, V_last: Any, t_end: Any) -> Loading | None:
        """The loading, or None if there are problems.

        V_last : speed in place of the last one (of a sinusoid, the mean), or None
        t_end : end of the run [s], or None if it is unknown
        """
        if self.is_record:
            return self.record if self.sound else None
        first = self.V_lp if V_last is None or self.final else V_last
        sound = self.sound and first is not None  # (what is missing is noted elsewhere)
        if "sinusoid" in self.given:
            if not sound or t_end is None:
                return None
            return self.place.at("sinusoid").noting(
                lambda: Loading.sinusoid(first, **self.sine, t_end=t_end),
                wanted="expected a sinusoid",
                like=SINUSOID.like,
            )
        loading = Loading.constant(1.0 if first is None else first)
        before = len(self.place.problems)
        for place, event in self.events:
            swept = V_last is not None and (place, event) == self.final
            V = V_last if swept else event.V
            arguments = [x for x in (event.t, V, event.duration) if x is not None]
            make = functools.partial(getattr(loading, event.kind), *arguments)
            loading = place.noting(make, "t", "expected steps", STEP.like) or loading
        return loading if sound and len(self.place.problems) == before else None


def loading_table(table: dict[str, Any], folder: Path, problems: list[str]) -> LoadingTable:
    """Read the table [loading]; file names in it are relative to a folder."""
    place, before = Place("[loading]", problems), len(problems)
    given = dict(known_items("loading", table, place))
    loading = LoadingTable(place, given)
    shapes = [key for key in SHAPES if key in given]
    if len(shapes) > 1:
        what = f"has {' and '.join(shapes)}, expected no more than one of them"
        place.add(f"{what} such as {example(shapes[0], 'loading')}")
    if "t" in given:
        _read_rows(loading)
    elif "V_lp" in given:
        loading.V_lp = _speed(given["V_lp"], place.at("V_lp"))
    file = example("file", "loading")
    if "file" in given:
        loading.record, loading.ends = read_record(given, folder, place)
        if "V_lp" in given:
            what = "is given beside file, whose speeds they are, expected one of them only"
            place.at("V_lp").add(f"{what} such as {file}")
    else:
        for key in {"columns", "units"} & given.keys():
            place.at(key).add(f"is given without file, expected beside one such as {file}")
    if "steps" in given:
        loading.events = _events(given["steps"], place.at("steps"))
    if "sinusoid" in given:
        loading.sine = _sinusoid(given["sinusoid"], place.at("sinusoid"))
    loading.sound = len(problems) == before
    return loading


def _speed(value: Any, place: Place) -> float | None:
    """The speed at the start."""
    if isinstance(value, dict):
        place.add(misplaced_axis("V_lp", value))
    elif isinstance(value, list):
        what = f"{shown(value)} makes an axis, expected in [sweep], or here with as many times t"
        place.add(f"{what} such as {LIKE['t']}")
    else:
        return read_number("V_lp", value, place, ">= 0")
    return None


def _read_rows(loading: LoadingTable) -> None:
    """Read a record of times and speeds in the file itself."""
    columns = {}
    for key, bound in (("t", None), ("V_lp", ">= 0")):
        place, value = loading.place.at(key), loading.given.get(key)
        if key not in loading.given:
            wanted = f"expected a list of as many speeds as t has, such as {SPEEDS_LIKE}"
            loading.place.missing(key, wanted)
        elif not isinstance(value, list):
            what = f"{shown(value)} is no list, expected as many values in V_lp as in t"
            place.add(f"{what} such as {LIKE['t']} and {SPEEDS_LIKE}")
        elif (many := read_values(key, value, place, bound)) is not None:
            columns[key] = as_array(key, many)
    if len(columns) == 2:
        wanted = f"expected times such as {LIKE['t']}"
        place = loading.place.at("t")
        loading.record = place.noting(lambda: Loading.series(**columns), "t", wanted)
        loading.ends = float(columns["V_lp"][-1]) if loading.record else None


def _events(steps: Any, place: Place) -> list[tuple[Place, Event]]:
    """Steps, holds and ramps; those with a problem are left out."""
    if not isinstance(steps, list) or not 1 <= len(steps) <= MOST_STEPS:
        what = f"{shown(steps)} is no list of 1 to {MOST_STEPS} steps, expected such as"
        place.add(f"{what} {STEP.like}")
        return []
    events = [(place.at(i), _event(step, place.at(i))) for i, step in enumerate(steps)]
    return [(where, event) for where, event in events if event]


def _event(step: Any, place: Place) -> Event | None:
    """A step, hold or ramp; None if it has a problem."""
    before = len(place.problems)
    values = STEP.read(step, place)
    if values is None:
        return None
    kind = "hold" if "hold" in values else "ramp" if "ramp" in values else "step"
    if "t" not in values:
        place.missing("t")
    if kind == "hold":
        for key in {"V_lp", "ramp"} & values.keys():
            what = "is given beside hold, which is a rest, expected in a step of its own such as"
            place.at(key).add(f"{what} {STEP.like}")
    elif "V_lp" not in values:
        place.missing("V_lp", f"{expected('V_lp')}; or hold = '100 s'")
    if len(place.problems) > before:
        return None
    return Event(kind, values["t"], values.get("V_lp"), values.get(kind))


def _sinusoid(table: Any, place: Place) -> dict[str, Any]:
    """The keys of a sinusoid, in SI."""
    values = SINUSOID.read(table, place)
    if values is None:
        return {}
    if "amplitude" not in values:
        place.missing("amplitude", expected("V_lp"))
    if ("period" in values) == ("frequency" in values):
        how = "twice" if "period" in values else "is missing"
        what = f"{how}, expected a period such as '2 s' or a frequency such as '0.5 Hz'"
        place.at("period").add(what)
    return values
