"""The keys of the table [loading] that change the normal stress: steps, ramps and a sinusoid."""

import dataclasses
import functools
from typing import Any

from ...model.load_point import Call
from ...model.loading import Loading
from ...model.parameters import parameter_to_si
from .known_keys import STRESS_SINUSOID, STRESS_STEP
from .problems import Place, expected
from .values import InlineTable

MOST_STEPS = 1000


@dataclasses.dataclass
class StressTable:
    """What changes the normal stress, read; it is put onto a loading when that is built."""

    place: Place  # of [loading]
    events: list[tuple[Place, Call]] = dataclasses.field(default_factory=list)
    sinusoid: dict[str, Any] = dataclasses.field(default_factory=dict)  # in SI

    def applied(self, loading: Loading) -> Loading:
        """The loading with this normal stress; changes with a problem, noted, are left out."""
        for place, call in self.events:
            make = functools.partial(call.on, loading)
            loading = place.noting(make, "t", "expected steps", STRESS_STEP.like) or loading
        if self.sinusoid:
            make = functools.partial(loading.sigma_sinusoid, **self.sinusoid)
            place = self.place.at("sigma_sinusoid")
            loading = place.noting(make, "", "expected one", STRESS_SINUSOID.like) or loading
        return loading


def stress_table(given: dict[str, Any], place: Place, area: dict[str, Any]) -> StressTable:
    """Read the keys of [loading], of which all are given; problems are noted.

    area : as of `loading_table`
    """
    table = StressTable(place)
    if "sigma_steps" in given:
        table.events = _events(given["sigma_steps"], place.at("sigma_steps"), area)
    if "sigma_sinusoid" in given:
        where = place.at("sigma_sinusoid")
        table.sinusoid = wave(STRESS_SINUSOID, given["sigma_sinusoid"], where)
        _per_area(table.sinusoid, "amplitude", where, area)
    if "sigma" in given and "t" not in given:
        place.at("sigma").add("loading.sigma_without_t", like=STRESS_STEP.like)
    return table


def _per_area(values: dict[str, Any], key: str, place: Place, area: dict[str, Any]) -> None:
    """Divide a value by the area where it is a force, and so is text still; None if that fails."""
    if isinstance(force := values.get(key), str):
        divide = functools.partial(parameter_to_si, "sigma", force, area)
        values[key] = place.at(key).noting(divide, "sigma")


def column_per_area(forces: Any, unit: str, area: dict[str, Any]) -> Any:
    """Forces (n,) in this unit, divided by the area; ParameterError where none is given.

    (n,) [Pa], or a list of DataArrays where the area is one.
    """
    import xarray

    parameter_to_si("sigma", f"{forces[0]:.6g} {unit}", area)  # (an error of text says more)
    rows = xarray.DataArray(forces, dims="row", attrs={"units": unit})
    stress = parameter_to_si("sigma", rows, area)
    return stress.values if stress.ndim == 1 else list(stress.transpose("row", ...))


def _events(steps: Any, place: Place, area: dict[str, Any]) -> list[tuple[Place, Call]]:
    """Steps and ramps; those with a problem are left out."""
    if not isinstance(steps, list) or not 1 <= len(steps) <= MOST_STEPS:
        place.add("steps.no_list", given=steps, most=MOST_STEPS, like=STRESS_STEP.like)
        return []
    events = []
    for i, step in enumerate(steps):
        where = place.at(i)
        values = STRESS_STEP.read(step, where)
        missing = [key for key in ("t", "sigma") if values is not None and key not in values]
        for key in missing:
            where.missing(key)
        _per_area(values or {}, "sigma", where, area)
        if values and not missing and all(x is not None for x in values.values()):
            ramp = {"duration": values["ramp"]} if "ramp" in values else {}
            arguments = {"t": values["t"], "sigma": values["sigma"], **ramp}
            events.append((where, Call("sigma_ramp" if ramp else "sigma_step", arguments)))
    return events


def wave(known: InlineTable, table: Any, place: Place) -> dict[str, Any]:
    """The keys of a periodic history, given by its period or its frequency, in SI."""
    values = known.read(table, place)
    if values is None:
        return {}
    for key, (symbol, _) in known.keys.items():
        if key not in (*values, "period", "frequency"):
            place.missing(key, expected(symbol))
    if ("period" in values) == ("frequency" in values):
        twice = "period" in values
        place.at("period").add("periodic.two_periods" if twice else "periodic.no_period")
    return values
