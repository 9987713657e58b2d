"""The table [loading], of which a `Loading` is made when the sweep and t_end are known.

Its speeds have steps or an oscillation, or are a record, in the file itself or in columns of
another one, which the reader of laboratory records opens.
"""

import dataclasses
import functools
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import ParameterError
from ..model.load_point import Call
from ..model.loading import Loading
from ..model.parameters import parameter_to_si, quantity_of
from ..model.quantities import QUANTITIES
from ..model.units import to_si
from ..records.reading.columns import Column, Table, requested_column
from ..records.reading.open_table import open_table
from ..records.reading.titles import plain_unit
from .known_keys import LIKE, LOADING_TABLES, SPEEDS_LIKE, example, known_items
from .problems import Place, Problem, message, refusal
from .values import LONGEST, read_number, read_values, refuse_unusual

#: keys that describe the speeds, of which a table may have one
SHAPES = ("steps", "sinusoid", "file", "t")
MOST_STEPS = 1000
MOST_CELLS = 5  # without a number that are listed
#: columns of a record; the last may be absent
COLUMNS = {"t": None, "V_lp": ">= 0", "sigma": "> 0"}


@dataclasses.dataclass
class LoadingTable:
    """The table [loading]; `build` makes the loading."""

    place: Place
    given: dict[str, Any]  # the keys that the file has
    calls: list[tuple[Place, Call]] = dataclasses.field(default_factory=list)  # in SI
    record: Loading | None = None  # comes before the calls
    is_sound: bool = True  # False if the table has problems

    @property
    def is_record(self) -> bool:
        """Whether the speeds come from a record."""
        return bool({"file", "t"} & self.given.keys())

    @property
    def final(self) -> int:
        """Index of the last call that sets a speed."""
        return max(i for i, (_, call) in enumerate(self.calls) if "V_lp" in call.arguments)

    @property
    def last(self) -> tuple[Place, float | None]:
        """The key of the last speed, for messages, and this speed [m/s], None if unknown."""
        if self.is_record:
            key = "file" if "file" in self.given else "V_lp"
            columns = self.record.calls[0].arguments if self.record else {"V_lp": [None]}
            return self.place.at(key), columns["V_lp"][-1]
        place, call = self.calls[self.final]
        return (place if self.final else self.place).at("V_lp"), call.arguments["V_lp"]

    def build(self, V_last: Any, t_end: float | None) -> Loading | None:
        """Return the loading up to t_end [s]; None if it has problems, or needs an unknown end.

        V_last : speed that replaces the last one (of a sinusoid, the mean), or None
        """
        before, calls, loading = len(self.place.problems), [*self.calls], self.record
        is_known = self.is_sound
        if not self.is_record:
            if V_last is not None:
                place, call = calls[self.final]
                arguments = call.arguments | {"V_lp": V_last}
                calls[self.final] = place, Call(call.method, arguments)
            (place, first), *calls = calls
            # (a missing speed is noted elsewhere)
            is_known &= first.arguments["V_lp"] is not None
            if first.method == "constant" and not is_known:
                first = Call("constant", {"V_lp": 1.0})  # for problems of the steps
            elif first.method == "sinusoid":
                if t_end is None or not is_known:
                    return None
                first = Call("sinusoid", first.arguments | {"t_end": t_end})
            make = functools.partial(first.apply_to, Loading)
            loading = place.attempt(make)
        if loading is None or (self.is_record and not self.is_sound):
            return None
        for place, call in calls:
            make = functools.partial(call.apply_to, loading)
            loading = place.attempt(make) or loading
        return loading if is_known and len(self.place.problems) == before else None


def loading_table(
    table: dict[str, Any], folder: Path, problems: list[Problem], area: dict[str, Any]
) -> LoadingTable:
    """Read the table [loading]; file names in it are relative to a folder.  Note problems.

    area : {"area": of the contact [m^2]}, which divides normal forces; {} if it is unknown
    """
    place, before = Place(("loading",), problems), len(problems)
    given = dict(known_items("loading", table, place))
    loading = LoadingTable(place, given)
    shapes, file = [key for key in SHAPES if key in given], example("file", "loading")
    if len(shapes) > 1:
        like = example(shapes[0], "loading")
        place.add("loading.two_shapes", shapes=" and ".join(shapes), like=like)
    if "file" in given:
        loading.record = _from_file(given, folder, place, area)
        if "V_lp" in given and "t" not in given:
            place.at("V_lp").add("loading.of_file", like=file)
    elif "t" in given:
        loading.record = _from_rows(given, place, area)
    else:
        V = _first_speed(given["V_lp"], place.at("V_lp")) if "V_lp" in given else None
        loading.calls = [(place, Call("constant", {"V_lp": V}))]
    for key in {"columns", "units"} & given.keys() if "file" not in given else ():
        place.at(key).add("loading.no_file", like=file)
    if "sigma" in given and "t" not in given:
        like = LOADING_TABLES["sigma_steps"].like
        place.at("sigma").add("loading.sigma_without_t", like=like)
    for key in [key for key in LOADING_TABLES if key in given]:
        read = _wave if "amplitude" in LOADING_TABLES[key].keys else _steps
        calls = read(key, given[key], place.at(key), area)
        if key != "sinusoid":
            loading.calls += calls
        elif calls and not loading.is_record:
            wave_place, wave = calls[0]
            loading.calls = [(wave_place, Call("sinusoid", {"V_lp": V} | wave.arguments))]
    loading.is_sound = len(problems) == before
    return loading


def _first_speed(value: Any, place: Place) -> float | None:
    if isinstance(value, dict):
        place.add("key.no_axis", given=value, like=example("V_lp"))
    elif isinstance(value, list):
        place.add("loading.no_axis", given=value, like=LIKE["t"])
    else:
        return read_number("V_lp", value, place, ">= 0")
    return None


def _steps(key: str, steps: Any, place: Place, area: dict[str, Any]) -> list[tuple[Place, Call]]:
    """Return steps, holds and ramps of speed or normal stress, without those with a problem."""
    known = LOADING_TABLES[key]
    symbol = "sigma" if "sigma" in known.keys else "V_lp"
    if not isinstance(steps, list) or not 1 <= len(steps) <= MOST_STEPS:
        place.add("steps.no_list", given=steps, most=MOST_STEPS, like=known.like)
        return []
    calls = []
    for i, step in enumerate(steps):
        step_place, before = place.at(i), len(place.problems)
        values = known.read(step, step_place)
        if values is None:
            continue
        kind = "hold" if "hold" in values else "ramp" if "ramp" in values else "step"
        if "t" not in values:
            step_place.missing("t")
        if kind == "hold":
            for extra in {"V_lp", "ramp"} & values.keys():
                step_place.at(extra).add("steps.beside_hold", like=known.like)
        elif symbol not in values:
            of_speed = message("steps.speed_wanted", wanted=QUANTITIES["V_lp"].remedy)
            step_place.missing(symbol, of_speed if symbol == "V_lp" else "")
        _divide_force(values, "sigma", step_place, area)
        if len(place.problems) == before:
            order = ("t", "V_lp", "sigma", kind)
            arguments = {
                "duration" if key == kind else key: values[key] for key in order if key in values
            }
            method = f"sigma_{kind}" if symbol == "sigma" else kind
            calls.append((step_place, Call(method, arguments)))
    return calls


def _wave(key: str, table: Any, place: Place, area: dict[str, Any]) -> list[tuple[Place, Call]]:
    """Return the oscillation of speed or normal stress, [] if it has a problem."""
    before, known = len(place.problems), LOADING_TABLES[key]
    values = known.read(table, place)
    if values is None:
        return []
    if "amplitude" not in values:
        place.missing("amplitude", QUANTITIES[known.keys["amplitude"][0]].remedy)
    if ("period" in values) == ("frequency" in values):
        has_both = "period" in values
        place.at("period").add("periodic.two_periods" if has_both else "periodic.no_period")
    _divide_force(values, "amplitude", place, area)
    return [(place, Call(key, values))] if len(place.problems) == before else []


def _divide_force(values: dict[str, Any], key: str, place: Place, area: dict[str, Any]) -> None:
    """Divide a value by the area if it is a force, which is still a text."""
    if isinstance(force := values.get(key), str):
        divide = functools.partial(parameter_to_si, "sigma", force, area)
        values[key] = place.at(key).attempt(divide, "sigma")


def _from_rows(given: dict[str, Any], place: Place, area: dict[str, Any]) -> Loading | None:
    """Return the record that stands in the scenario file itself, None if it has problems."""
    before, columns = len(place.problems), dict[str, Any]()
    for key, bound in COLUMNS.items():
        at = place.at(key)
        if key not in given:
            if key != "sigma":
                place.missing(key, message("loading.speeds_wanted", like=SPEEDS_LIKE))
        elif not isinstance(given[key], list):
            at.add("loading.no_list", given=given[key], t=LIKE["t"], V_lp=SPEEDS_LIKE)
        elif values := read_values(key, given[key], at, bound):
            columns[key] = values.array()
            if values.quantity != key:
                unit = QUANTITIES[values.quantity].unit
                divide = functools.partial(_per_area, columns[key], unit, area)
                columns[key] = at.attempt(divide)
    if len(place.problems) > before:
        return None
    return place.at("t").attempt(lambda: Loading.series(**columns))


def _from_file(
    given: dict[str, Any], folder: Path, place: Place, area: dict[str, Any]
) -> Loading | None:
    """Return the record in two or three columns of a file, None if it has problems."""
    before, units = len(place.problems), None
    wanted = _names("columns", given, str | int, (2, 3), place)
    if "units" in given and wanted:
        units = _names("units", given, str, (len(wanted),), place)
    table = place.at("file").attempt(lambda: _open(given["file"], folder))
    if table is None or wanted is None:
        return None
    columns = []
    for i, (symbol, request) in enumerate(zip(COLUMNS, wanted, strict=False)):
        at = place.at("columns").at(i)
        find = functools.partial(requested_column, table, symbol, request)
        if (index := at.attempt(find, f"columns: {symbol}")) is not None:
            column = table.columns[index]
            columns.append(column._replace(unit=units[i] if units else plain_unit(column.unit)))
            _check_unit(symbol, columns[-1], place.at("units").at(i) if units else at, area)
    at = place.at("file")
    bad = [(row, x) for x in columns for row in np.flatnonzero(~np.isfinite(x.values)).tolist()]
    if len(place.problems) == before:
        for row, x in bad[:MOST_CELLS]:
            position = {"row": table.row_label(row), "column": x.title}
            at.add("record.no_number", cell=table.cell(row, x), **position)
        if len(bad) > MOST_CELLS:
            at.add("record.more_no_numbers", n=len(bad) - MOST_CELLS)
    if len(place.problems) > before:
        return None
    return at.attempt(lambda: _series(columns, area))


def _names(
    key: str, given: dict[str, Any], kinds: Any, lengths: tuple[int, ...], place: Place
) -> list[Any] | None:
    """Return two or three strings, or integers if `kinds` has them; None for a problem, noted."""
    wanted, value = message("columns.pair_wanted", like=LIKE[key]), given.get(key)
    if value is None:
        place.missing(key, wanted)
        return None
    is_list = isinstance(value, list) and len(value) in lengths
    if not is_list or not all(isinstance(x, kinds) and not isinstance(x, bool) for x in value):
        place.at(key).add("columns.no_pair", given=value, wanted=wanted)
        return None
    return list(value)


def _open(file: Any, folder: Path) -> Table:
    """Return the table in a file; ParameterError if it cannot be read or has too many rows."""
    if not isinstance(file, str) or not file.isprintable():
        raise refusal("record.no_name", given=file)
    try:
        table: Table = open_table(folder / file)
    except ParameterError as error:
        raise refusal("record.unreadable", problem=error.problem) from None
    if max(column.values.size for column in table.columns) > LONGEST:
        raise refusal("record.too_many_rows", given=file, most=LONGEST)
    return table


def _check_unit(symbol: str, column: Column, place: Place, area: dict[str, Any]) -> None:
    """Note that a column has no unit, or one of another quantity."""
    unit = column.unit
    if not unit:
        place.add("columns.no_unit", given=column.title)
        return
    try:
        parameter_to_si(symbol, f"1 {unit}", area)
    except ParameterError as error:
        error.value = repr(unit)
        error.problem = error.problem.replace(f"has an unknown unit {unit!r}", "is unknown")
        place.note(error, error.symbol)


def _series(columns: list[Column], area: dict[str, Any]) -> Loading:
    """Return the columns of a file as a loading; ParameterError if it cannot be one."""
    import xarray

    arrays = {}
    for symbol, column in zip(COLUMNS, columns, strict=False):
        array = xarray.DataArray(column.values, dims="row", attrs={"units": column.unit})
        quantity = quantity_of(symbol, array)
        largest = float(np.abs(to_si(quantity, array, bound="")).max())
        text = f"{quantity} = {largest:.6g} {QUANTITIES[quantity].unit}"
        refuse_unusual(quantity, max(largest, 1.0), text)
        is_force = quantity == "normal_force"
        arrays[symbol] = _per_area(column.values, column.unit, area) if is_force else array
    try:
        return Loading.series(**arrays)
    except ParameterError as error:
        error.problem += " (rows are counted from 0, without the header)"
        raise


def _per_area(forces: Any, unit: str, area: dict[str, Any]) -> Any:
    """Return forces (n,) divided by the area: (n,) [Pa], or n DataArrays if the area is one."""
    import xarray

    parameter_to_si("sigma", f"{forces[0]:.6g} {unit}", area)  # (an error of text says more)
    rows = xarray.DataArray(forces, dims="row", attrs={"units": unit})
    stress = parameter_to_si("sigma", rows, area)
    return stress.values if stress.ndim == 1 else list(stress.transpose("row", ...))
