"""The tables of a catalogue of stick-slip events."""

from typing import Any

import numpy as np
import xarray
from rich.table import Column
from rich.text import Text

from ....model.quantities import QUANTITIES, power_of, prefixed_unit, readable, with_error
from .rows import plain_table

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


def tables(catalogue: xarray.Dataset) -> list[Any]:
    """The events, the stiffness, and the lines of stress drop, as rich prints them."""
    units = {name: _unit(name, catalogue[name].values) for name in SHOWN}
    heads = [f"{text} [{units[name][1]}]" for name, text in SHOWN.items()]
    made = plain_table("", *(Column(Text(head), justify="right") for head in heads), "kind")
    for i in range(catalogue.sizes["event"]):
        one = catalogue.isel(event=i)
        cells = [_cell(one, name, units[name][0]) for name in SHOWN]
        made.add_row(str(int(one.event)), *cells, str(one.event_kind.item()))
    count = catalogue.sizes["event"]
    if not count:
        text = (
            "no stick-slip: no falls of the stress are beyond its noise, and regular or much "
            "faster than its rises"
        )
        return [Text(text, style="bold")]
    title = Text(f"{count} event{'' if count == 1 else 's'}", style="bold")
    below = [
        *_messages(catalogue),
        _threshold(catalogue),
        _stiffness(catalogue),
        *_lines(catalogue),
    ]
    return [title, made, *below]


def _messages(catalogue: xarray.Dataset) -> list[Text]:
    """A text for each thing to be known of events, with their numbers."""
    numbers: dict[str, list[str]] = {}
    for number, message in zip(catalogue.event.values, catalogue.event_message.values, strict=True):
        for part in filter(None, str(message).split("; ")):
            numbers.setdefault(part, []).append(str(number))
    return [
        Text(f"event{'s' if len(of) > 1 else ''} {_listed(of)}: {text}")
        for text, of in numbers.items()
    ]


def _listed(numbers: list[str]) -> str:
    """Numbers, the first few if they are many."""
    more = f" and {len(numbers) - MOST} more" if len(numbers) > MOST else ""
    return ", ".join(numbers[:MOST]) + more


def _unit(name: str, values: np.ndarray) -> tuple[float, str]:
    """Size in SI, and text, of the unit that fits the median of values."""
    unit, finite = QUANTITIES[name].unit, np.abs(values[np.isfinite(values)])
    power = power_of(unit, float(np.median(finite))) if finite.size else 0
    return 10.0**power, prefixed_unit(unit, power)


def _cell(one: xarray.Dataset, name: str, size: float) -> str:
    """A value with its error, "-" where there is none."""
    value, error = float(one[name]), float(one[f"{name}_error"])
    if not np.isfinite(value):
        return "-"
    return with_error(value / size, error / size if error > EXACT * abs(value) else 0.0)


def _threshold(catalogue: xarray.Dataset) -> Text:
    """The smallest stress drop that is found."""
    threshold = float(catalogue.detection_threshold)
    text = f"Stress drops below {readable('stress_drop', threshold)} are not found."
    return Text(f"{text} Events between which the stress rises by less are one fall.")


def _stiffness(catalogue: xarray.Dataset) -> Text:
    """The stiffness, and where it comes from."""
    K, error = float(catalogue["K"]), float(catalogue["K_error"])
    if not np.isfinite(K):
        return Text(f"K: {catalogue.attrs['stiffness']}")
    size, unit = _unit("K", np.array([K]))
    return Text(f"K = {with_error(K / size, error / size)} {unit}, {catalogue.attrs['stiffness']}")


def _lines(catalogue: xarray.Dataset) -> list[Text]:
    """A text for each line of stress drop against a logarithm."""
    texts = []
    for abscissa in catalogue.abscissa.values:
        line = catalogue.sel(abscissa=abscissa)
        message = str(line.trend_message.item())
        text = f"stress drop against log10 {abscissa}: "
        if np.isfinite(line.trend_B):
            size, unit = _unit("stress_drop", catalogue.stress_drop.values)
            B = with_error(float(line.trend_B) / size, float(line.trend_B_error) / size)
            text += f"{B} {unit} a decade, {int(line.trend_events)} events"
            message = f" ({message})" if message else ""
        texts.append(Text(text + message))
    return texts
