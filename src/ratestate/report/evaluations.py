"""Reports on evaluations of records: events, healing, and the stiffness of a machine."""

import json
import math
from typing import Any

import numpy as np
import xarray

from ..dynamics.recipe import attribute_text
from ..model.quantities import QUANTITIES, power_of, prefixed_unit, readable, with_error
from ..records.healing.healing import HEADINGS, RATES, rate_text
from ..records.kit import checked_result
from ..records.machine.machine_stiffness import OF_RINGS, SYMBOLS, estimate, value_with_unit
from .report import Blocks, Heading, TextTable, Title, left, numbers_by_text

#: relative error that is not shown
EXACT = 1e-6
#: numbers of events that a message lists
MOST = 12
#: quantities in the table -> their headings
SHOWN = {
    "event_time": "time",
    "V_lp": "V_lp",
    "stress_drop": "stress drop",
    "recurrence": "recurrence",
    "duration": "duration",
    "slip": "slip",
    "peak_slip_rate": "peak slip rate",
}


def events(catalogue: xarray.Dataset) -> Blocks:
    """Return the events, the stiffness, and the lines of stress drop."""
    count = catalogue.sizes["event"]
    if not count:
        text = (
            "no stick-slip: the stress has no falls that exceed its noise and are regular or much "
            "faster than its rises"
        )
        return [Title(text)]
    units = {name: _unit_of(name, catalogue[name].values) for name in SHOWN}
    heads = [Heading(f"{text} [{units[name][1]}]") for name, text in SHOWN.items()]
    columns = [_pairs(catalogue, name, 1.0 / units[name][0]) for name in SHOWN]
    kinds = catalogue.event_kind.values.tolist()
    numbers = map(str, catalogue.event.values.astype(int).tolist())
    rows = [list(row) for row in zip(numbers, *columns, kinds, strict=True)]
    table = TextTable([left(), *heads, left("kind")], rows, splits=True)
    threshold = readable("stress_drop", float(catalogue.detection_threshold))
    return [
        Title(f"{count} event{'' if count == 1 else 's'}"),
        table,
        *_messages(catalogue),
        f"Stress drops below {threshold} are not found. If the stress rises by less between two "
        "events, they count as one.",
        _stiffness(catalogue),
        *_trends(catalogue),
    ]


def _messages(catalogue: xarray.Dataset) -> list[str]:
    """Return a sentence for each message on events, with their numbers."""
    messages = (str(text).split("; ") if text else [] for text in catalogue.event_message.values)
    pairs = zip(catalogue.event.values, messages, strict=True)
    return [f"{events}: {text}" for events, text in numbers_by_text("event", pairs, MOST)]


def _unit_of(name: str, values: np.ndarray) -> tuple[float, str]:
    """Size in SI, and text, of the unit that fits the median of values."""
    unit, finite = QUANTITIES[name].unit, np.abs(values[np.isfinite(values)])
    power = power_of(unit, float(np.median(finite))) if finite.size else 0
    return 10.0**power, prefixed_unit(unit, power)


def _stiffness(catalogue: xarray.Dataset) -> str:
    K, error = float(catalogue["K"]), float(catalogue["K_error"])
    if not np.isfinite(K):
        return f"K: {catalogue.attrs['stiffness']}"
    return f"K = {value_with_unit(K, error, 'Pa/m')}, {catalogue.attrs['stiffness']}"


def _trends(catalogue: xarray.Dataset) -> list[str]:
    """Return a sentence for each line of stress drop against a logarithm."""
    texts = []
    for abscissa in catalogue.abscissa.values:
        line = catalogue.sel(abscissa=abscissa)
        message = str(line.trend_message.item())
        text = f"stress drop against log10 {abscissa}: "
        if np.isfinite(line.trend_B):
            size, unit = _unit_of("stress_drop", catalogue.stress_drop.values)
            B = with_error(float(line.trend_B) / size, float(line.trend_B_error) / size)
            text += f"{B} {unit} a decade, {int(line.trend_events)} events"
            message = f" ({message})" if message else ""
        texts.append(text + message)
    return texts


def healing(result: xarray.Dataset) -> Blocks:
    """The holds with healing, relaxation and predictions [1e-3]; the rates; messages on holds."""
    result = checked_result(result, "healing", "delta_mu")
    source = attribute_text(result, "source", "")
    laws: Any = result.get("law", [])
    holds, evaluated = result.sizes["hold"], int((result["hold_status"] == 0).sum())
    columns: dict[str, list[str]] = {
        "start": [readable("t", value, 6) for value in result["hold_start"].values],
        "hold": [readable("t", value) for value in result["t_hold"].values],
    }
    for side in ("before", "after"):
        speeds = result[f"V_{side}"].values
        columns[side] = ["-" if V != V else readable("V_lp", V, 3) for V in speeds]
    rates = []
    for name, heading in HEADINGS.items():
        columns[f"{heading} [1e-3]"] = _pairs(result, name, 1e3)
        rates.append(rate_text(result, name))
        for law in laws:
            part = result.sel(law=law)
            columns[f"{law.item()} law: {heading}"] = _pairs(part, f"{name}_predicted", 1e3)
            if part[RATES[name]].notnull():
                (rate,) = _pairs(part, f"{RATES[name]}_predicted")
                rates.append(f"  {law.item()} law predicts {rate}")
    title = f"Healing{f' in {source}' if source else ''}: {evaluated} of {holds} holds evaluated"
    texts = enumerate(result["hold_message"].values.tolist(), start=1)
    messages = [f"hold {number}: {text}" for number, text in texts if text]
    return [Title(title), _numbered(columns), "", *rates, *messages]


def machine(result: xarray.Dataset) -> Blocks:
    """K, M and the damping; tables of the slopes and ring-downs; remarks."""
    result = checked_result(result, "machine_stiffness", "slope_K")
    slopes: dict[str, list[str]] = {
        "kind": result["slope_kind"].values.astype(str).tolist(),
        "start": [readable("t", value, 6) for value in result["slope_start"].values],
        "K": _in_units(result, "slope_K"),
        "straight line": [readable("K", value) for value in result["slope_straight"].values],
        "used": ["yes" if used else "no" for used in result["slope_used"].values],
    }
    ring_downs = {
        "start": [readable("t", value, 6) for value in result["ring_down_start"].values],
        "V_lp": [readable("V_lp", value, 3) for value in result["ring_down_V"].values],
        **{name: _in_units(result, f"ring_down_{name}") for name in OF_RINGS},
    }
    blocks: Blocks = [Title(estimate(result, symbol)) for symbol in SYMBOLS]
    for columns in (slopes, ring_downs):
        blocks += ["", _numbered(columns)] if len(columns["start"]) else []
    remarks = json.loads(result.attrs["remarks"])
    return [*blocks, *([""] if remarks else []), *remarks]


def _numbered(columns: dict[str, list[str]]) -> TextTable:
    cells = zip(*columns.values(), strict=True)
    rows = [[str(number), *row] for number, row in enumerate(cells, 1)]
    return TextTable([left(heading) for heading in ("", *columns)], rows, splits=True)


def _pairs(result: xarray.Dataset, name: str, factor: float = 1.0) -> list[str]:
    """Values with errors, times a factor.  An error below `EXACT` times the value is not shown."""
    pairs = factor * np.column_stack([result[name], result[f"{name}_error"]])
    return [
        "-"
        if not math.isfinite(value)
        else with_error(value, error if error > EXACT * abs(value) else 0.0)
        for value, error in pairs
    ]


def _in_units(result: xarray.Dataset, name: str) -> list[str]:
    """Values with errors, each in a unit that fits."""
    pairs = zip(result[name].values, result[f"{name}_error"].values, strict=True)
    return [value_with_unit(value, error, QUANTITIES[name].unit) for value, error in pairs]


#: function -> the table of its result
TABLES = {"events": events, "healing": healing, "machine_stiffness": machine}
