"""The table [loading]: a speed, with steps or a wave about it, or a record; normal stress too."""

import dataclasses
import functools
from pathlib import Path
from typing import Any

from ...model.load_point import Call
from ...model.loading import Loading
from ...model.parameters import parameter_to_si
from ...model.quantities import QUANTITIES, remedy
from .known_keys import (
    LIKE,
    SINUSOID,
    SPEEDS_LIKE,
    STEP,
    STRESS_SINUSOID,
    STRESS_STEP,
    example,
    known_items,
)
from .problems import Place, Problem, message
from .record import Record, column_per_area, read_record
from .values import InlineTable, as_array, read_number, read_values

#: keys of a loading beside its speed, of which it may have one
ONE_OF = ("steps", "sinusoid", "file", "t")
MOST_STEPS = 1000


@dataclasses.dataclass
class LoadingTable:
    """The table [loading]; the loading is built when the sweep and the end of the run are known."""

    place: Place
    given: dict[str, Any]  # the keys that the file has
    events: list[tuple[Place, Call]]  # the start, and the steps, holds and ramps, in SI
    wave: dict[str, Any] = dataclasses.field(default_factory=dict)  # of the sinusoid, in SI
    record: Record = dataclasses.field(default_factory=Record)
    stress_events: list[tuple[Place, Call]] = dataclasses.field(default_factory=list)
    stress_wave: dict[str, Any] = dataclasses.field(default_factory=dict)  # in SI
    sound: bool = True  # whether the table has no problems

    @property
    def is_record(self) -> bool:
        """Whether the speeds are those of a record."""
        return bool({"file", "t"} & self.given.keys())

    @property
    def final(self) -> int:
        """Index of the last event that has a speed, or else of the start."""
        return max(i for i, (_, call) in enumerate(self.events) if "V" in call.arguments)

    @property
    def last(self) -> tuple[Place, float | None]:
        """The key of the last speed, for messages, and this speed [m/s], None if unknown."""
        if self.is_record:
            return self.place.at("file" if "file" in self.given else "V_lp"), self.record.last
        place, call = self.events[self.final]
        return place.at("V_lp"), call.arguments["V"]

    def build(self, V_last: Any, t_end: float | None) -> Loading | None:
        """The loading up to t_end [s]; None if it has problems, or where it would need an end.

        V_last : speed in place of the last one (of a periodic loading, the mean), or None
        """
        before = len(self.place.problems)
        loading = self._of_speeds(V_last, t_end)
        if loading is not None:
            loading = _applied(self.stress_events, loading)
        if loading is not None and self.stress_wave:
            make = functools.partial(loading.sigma_sinusoid, **self.stress_wave)
            place = self.place.at("sigma_sinusoid")
            loading = place.noting(make)
        return loading if len(self.place.problems) == before else None

    def _of_speeds(self, V_last: Any, t_end: float | None) -> Loading | None:
        """As `build`, under a constant normal stress, or that of a record."""
        if self.is_record:
            return self.record.loading if self.sound else None
        events = self.events.copy()
        if V_last is not None:
            place, call = events[self.final]
            events[self.final] = place, Call(call.method, call.arguments | {"V": V_last})
        (_, first), *later = events
        start = first.arguments["V"]
        sound = self.sound and start is not None  # (a missing speed is noted elsewhere)
        if "sinusoid" in self.given:
            if not sound or t_end is None:
                return None
            make = functools.partial(Loading.sinusoid, start, **self.wave, t_end=t_end)
            place = self.place.at("sinusoid")
            return place.noting(make)
        loading = Loading.constant(1.0 if start is None else start)
        loading = _applied(later, loading)
        return loading if sound else None


def _applied(events: list[tuple[Place, Call]], loading: Loading) -> Loading:
    """The loading with these events; those with a problem, noted, are left out."""
    for place, call in events:
        make = functools.partial(call.apply_to, loading)
        loading = place.noting(make) or loading
    return loading


def loading_table(
    table: dict[str, Any], folder: Path, problems: list[Problem], area: dict[str, Any]
) -> LoadingTable:
    """Read the table [loading]; file names in it are relative to a folder.  Problems are noted.

    area : {"area": of the contact [m^2]}, by which its normal forces are divided; {} if not known
    """
    place, before = Place(("loading",), problems), len(problems)
    given = dict(known_items("loading", table, place))
    loading = LoadingTable(place, given, [])
    shapes = [key for key in ONE_OF if key in given]
    if len(shapes) > 1:
        like = example(shapes[0], "loading")
        place.add("loading.two_shapes", shapes=" and ".join(shapes), like=like)
    V_lp = None
    if "t" in given:
        loading.record = _rows(given, place, area)
    elif "V_lp" in given:
        V_lp = _speed(given["V_lp"], place.at("V_lp"))
    file = example("file", "loading")
    if "file" in given:
        loading.record = read_record(given, folder, place, area)
        if "V_lp" in given:
            place.at("V_lp").add("loading.of_file", like=file)
    else:
        for key in {"columns", "units"} & given.keys():
            place.at(key).add("loading.no_file", like=file)
    loading.events = [(place, Call("constant", {"V": V_lp}))]
    if "steps" in given:
        loading.events += _events(given["steps"], place.at("steps"), STEP, "V_lp", area)
    if "sigma_steps" in given:
        where = place.at("sigma_steps")
        loading.stress_events = _events(given["sigma_steps"], where, STRESS_STEP, "sigma", area)
    if "sigma_sinusoid" in given:
        where = place.at("sigma_sinusoid")
        loading.stress_wave = _wave(STRESS_SINUSOID, given["sigma_sinusoid"], where)
        _per_area(loading.stress_wave, "amplitude", where, area)
    if "sigma" in given and "t" not in given:
        place.at("sigma").add("loading.sigma_without_t", like=STRESS_STEP.like)
    if "sinusoid" in given:
        loading.wave = _wave(SINUSOID, given["sinusoid"], place.at("sinusoid"))
    loading.sound = len(problems) == before
    return loading


def _speed(value: Any, place: Place) -> float | None:
    """The speed at the start."""
    if isinstance(value, dict):
        place.add("key.no_axis", given=value, like=example("V_lp"))
    elif isinstance(value, list):
        place.add("loading.no_axis", given=value, like=LIKE["t"])
    else:
        return read_number("V_lp", value, place, ">= 0")
    return None


def _rows(given: dict[str, Any], place: Place, area: dict[str, Any]) -> Record:
    """A record of times and speeds, and maybe normal stresses, in the file itself."""
    columns: dict[str, Any] = {}
    wanted = {"t": None, "V_lp": ">= 0"} | ({"sigma": "> 0"} if "sigma" in given else {})
    for key, bound in wanted.items():
        if key not in given:
            place.missing(key, message("loading.speeds_wanted", like=SPEEDS_LIKE))
        elif not isinstance(given[key], list):
            place.at(key).add("loading.no_list", given=given[key], t=LIKE["t"], V_lp=SPEEDS_LIKE)
        elif (many := read_values(key, given[key], place.at(key), bound)) is not None:
            columns[key] = as_array(key, many)
            if unit := QUANTITIES[many.quantity].unit if many.quantity else "":
                divide = functools.partial(column_per_area, columns[key], unit, area)
                columns[key] = place.at(key).noting(divide)
    if columns.keys() != wanted.keys() or any(column is None for column in columns.values()):
        return Record()
    loading = place.at("t").noting(lambda: Loading.series(**columns))
    return Record(loading, float(columns["V_lp"][-1]) if loading else None)


def _events(
    steps: Any, place: Place, known: InlineTable, symbol: str, area: dict[str, Any]
) -> list[tuple[Place, Call]]:
    """Steps, holds and ramps of a speed or normal stress; those with a problem are left out."""
    if not isinstance(steps, list) or not 1 <= len(steps) <= MOST_STEPS:
        place.add("steps.no_list", given=steps, most=MOST_STEPS, like=known.like)
        return []
    places = [place.at(i) for i in range(len(steps))]
    events = [_event(*one, known, symbol, area) for one in zip(steps, places, strict=True)]
    return [(where, event) for where, event in zip(places, events, strict=True) if event]


def _event(
    step: Any, place: Place, known: InlineTable, symbol: str, area: dict[str, Any]
) -> Call | None:
    """A step, hold or ramp; None if it has a problem."""
    before = len(place.problems)
    values = known.read(step, place)
    if values is None:
        return None
    kind = "hold" if "hold" in values else "ramp" if "ramp" in values else "step"
    if "t" not in values:
        place.missing("t")
    if kind == "hold":
        for key in {"V_lp", "ramp"} & values.keys():
            place.at(key).add("steps.beside_hold", like=known.like)
    elif symbol not in values:
        of_speed = message("steps.speed_wanted", wanted=remedy("V_lp"))
        place.missing(symbol, of_speed if symbol == "V_lp" else "")
    _per_area(values, "sigma", place, area)
    if len(place.problems) > before:
        return None
    names = {"t": "t", "V_lp": "V", "sigma": "sigma", kind: "duration"}
    arguments = {name: values[key] for key, name in names.items() if key in values}
    return Call(f"sigma_{kind}" if symbol == "sigma" else kind, arguments)


def _per_area(values: dict[str, Any], key: str, place: Place, area: dict[str, Any]) -> None:
    """Divide a value by the area where it is a force, and so is text still; None if that fails."""
    if isinstance(force := values.get(key), str):
        divide = functools.partial(parameter_to_si, "sigma", force, area)
        values[key] = place.at(key).noting(divide, "sigma")


def _wave(known: InlineTable, table: Any, place: Place) -> dict[str, Any]:
    """The keys of a periodic history, given by its period or its frequency, in SI."""
    values = known.read(table, place)
    if values is None:
        return {}
    for key, (symbol, _) in known.keys.items():
        if key not in (*values, "period", "frequency"):
            place.missing(key, remedy(symbol))
    if ("period" in values) == ("frequency" in values):
        twice = "period" in values
        place.at("period").add("periodic.two_periods" if twice else "periodic.no_period")
    return values
