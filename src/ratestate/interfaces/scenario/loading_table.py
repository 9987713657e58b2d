"""The table [loading]: a speed, with steps or a sinusoid about it, or a record."""

import dataclasses
from pathlib import Path
from typing import Any

from ...model.loading import Loading
from .known_keys import (
    SPEEDS_LIKE,
    TABLES,
    TIMES_LIKE,
    example,
    keys_to_read,
    misplaced_axis,
    note_unknown,
)
from .loading_shapes import SINE_LIKE, STEPS_LIKE, Event, events, sinusoid
from .problems import Problems, shown
from .record import read_record
from .values import as_array, number, read_values

#: keys of a loading beside its speed, of which it may have one
SHAPES = ("steps", "sinusoid", "file", "t")


@dataclasses.dataclass
class LoadingTable:
    """The table [loading]; the loading is built when the sweep and the end of the run are known.

    Attributes
    ----------
    V_lp : float or None
        The speed at the start, or the mean.
    events : list of Event
    sine : dict or None
        The keys of the sinusoid, in SI.
    record : Loading or None
        The loading from a record.
    ends : float or None
        The last speed of a record.
    sound : bool
        Whether the table has no problems.
    given : set of str
        The keys that the file has.
    """

    V_lp: float | None = None
    events: list[Event] = dataclasses.field(default_factory=list)
    sine: dict[str, float] | None = None
    record: Loading | None = None
    ends: float | None = None
    sound: bool = True
    given: frozenset[str] = frozenset()

    @property
    def is_record(self) -> bool:
        """Whether the speeds are those of a record."""
        return bool({"file", "t"} & self.given)

    @property
    def last(self) -> tuple[str, float | None]:
        """The key of the last speed, for messages, and this speed [m/s]."""
        if self.is_record:
            return f"[loading] {'file' if 'file' in self.given else 'V_lp'}", self.ends
        if final := self.final:
            return f"{final.place}.V_lp", final.arguments["V"]
        return "[loading] V_lp", self.V_lp

    @property
    def final(self) -> Event | None:
        """The last event that has a speed."""
        return next((e for e in reversed(self.events) if "V" in e.arguments), None)

    def build(self, V_last: Any, t_end: Any, problems: Problems) -> Loading | None:
        """The loading, or None if there are problems.

        V_last : speed in place of the last one (of a sinusoid, the mean), or None
        t_end : end of the run [s], or None if it is unknown
        """
        before = len(problems)
        built = self._built(V_last, t_end, problems)
        return built if self.sound and len(problems) == before else None

    def _built(self, V_last: Any, t_end: Any, problems: Problems) -> Loading | None:
        if self.is_record:
            return self.record
        first = self.V_lp if V_last is None or self.final else V_last
        if first is None:  # noted elsewhere; the rest can still be checked
            first, self.sound = 1.0, False
        if self.sine is not None:
            if t_end is not None and self.sound:
                how = {"expected": "expected a sinusoid", "like": SINE_LIKE}
                with problems.at("[loading] sinusoid", **how):
                    return Loading.sinusoid(first, **self.sine, t_end=t_end)
            return None
        loading = Loading.constant(first)
        for event in self.events:
            replaced = {"V": V_last} if event is self.final and V_last is not None else {}
            with problems.at(event.place, "t", "expected steps", STEPS_LIKE):
                loading = getattr(loading, event.kind)(**(event.arguments | replaced))
        return loading


def loading_table(table: dict[str, Any], folder: Path, problems: Problems) -> LoadingTable:
    """Read the table [loading]; file names in it are relative to a folder."""
    before = len(problems)
    table = keys_to_read("loading", table, problems)
    for key in table.keys() - {*TABLES["loading"]}:
        note_unknown("loading", key, problems)
    loading = LoadingTable(given=frozenset(table))
    shapes = [key for key in SHAPES if key in table]
    if len(shapes) > 1:
        what = f"has {' and '.join(shapes)}, expected no more than one of them"
        problems.add("[loading]", f"{what} such as {example(shapes[0], 'loading')}")
    if "t" in table:
        _inline(table, loading, problems)
    elif "V_lp" in table:
        loading.V_lp = _speed(table["V_lp"], problems)
    if "file" in table:
        record = read_record(table, folder, problems)
        if record is not None:
            loading.record, loading.ends = record
        if "V_lp" in table:
            what = "is given beside file, whose speeds they are, expected one of them only"
            problems.add("[loading] V_lp", f"{what} such as {example('file', 'loading')}")
    else:
        for key in {"columns", "units"} & table.keys():
            what = (
                f"is given without file, expected beside one such as {example('file', 'loading')}"
            )
            problems.add(f"[loading] {key}", what)
    if "steps" in table:
        loading.events = events(table["steps"], problems)
    if "sinusoid" in table:
        loading.sine = sinusoid(table["sinusoid"], problems)
    loading.sound = len(problems) == before
    return loading


def _speed(value: Any, problems: Problems) -> float | None:
    """The speed at the start."""
    if isinstance(value, dict):
        problems.add("[loading] V_lp", misplaced_axis("V_lp", value))
        return None
    if isinstance(value, list):
        what = f"{shown(value)} makes an axis, expected in [sweep], or here with as many times t"
        problems.add("[loading] V_lp", f"{what} such as {TIMES_LIKE}")
        return None
    with problems.at("[loading] V_lp", "V_lp"):
        return number("V_lp", value, ">= 0")
    return None


def _inline(table: dict[str, Any], loading: LoadingTable, problems: Problems) -> None:
    """A record of times and speeds in the file itself."""
    columns = {}
    for key, bound in (("t", None), ("V_lp", ">= 0")):
        if key not in table:
            what = "is missing, expected a list of as many speeds as t has"
            problems.add("[loading] V_lp", f"{what}, such as {SPEEDS_LIKE}")
        elif not isinstance(table[key], list):
            what = f"{shown(table[key])} is no list, expected as many values in V_lp as in t"
            problems.add(f"[loading] {key}", f"{what} such as {TIMES_LIKE} and {SPEEDS_LIKE}")
        else:
            many = read_values(key, table[key], f"[loading] {key}", problems, bound)
            if many is not None:
                columns[key] = as_array(key, many)
    if len(columns) == 2:
        with problems.at("[loading] t", "t", f"expected times such as {TIMES_LIKE}"):
            loading.record = Loading.series(columns["t"], columns["V_lp"])
            loading.ends = float(columns["V_lp"][-1])
