"""Tables about a sweep: its axes, how cases ended, ranges, failed cases."""

from typing import Any

import numpy as np
import xarray
from rich.table import Column
from rich.text import Text

from ..engine.model import FINISHED, STATUSES, STEADY_SLIDING
from ..model.quantities import QUANTITIES, readable
from .domain import outside_lines
from .tables import ANY_SPEED, FirstThatFits, Units, place, plain_table, shown

LISTED = 20  # failed cases, at most
#: function -> variables whose range is printed
RANGES = {
    "limit_cycle": ("amplitude", "period", "frequency", "V_max", "V_min", "inertia", "error"),
    "simulate": ("amplitude", "frequency", "V_max", "V_min", "cycles", "energy_residual"),
    "stability": ("K_c", "V_c", "eta", "f_n", "growth_rate", "omega"),
    "frequency_response": ("resonance", "quality"),
}


def cases(result: xarray.Dataset, units: Units) -> list[Any]:
    """All about a sweep: its axes, how cases ended, ranges of finite values, failed cases."""
    verb = result.attrs["title"].removeprefix("ratestate ")
    status = result["status"]
    axes = [str(dim) for dim in status.dims]
    over = ", ".join(_axis(result, dim) for dim in axes)
    title = f"{status.size:,} cases of {verb} over {over}"
    about = [_outcomes(status.values, verb), *outside_lines(result, "cases"), ""]
    lines = [Text(title, style="bold"), *map(Text, about)]
    return [*lines, _ranges(result, verb, units), *map(Text, failed_lines(result))]


def _axis(result: xarray.Dataset, dim: str) -> str:
    if dim not in result.coords or dim not in QUANTITIES:
        return f"{dim} ({result.sizes[dim]})"
    low, high = (readable(dim, float(x)) for x in (result[dim].min(), result[dim].max()))
    return f"{dim} ({result.sizes[dim]} from {low} to {high})"


def _outcomes(status: np.ndarray, verb: str) -> str:
    """How many cases ended in which way."""
    codes, counts = np.unique(status, return_counts=True)
    number = dict(zip(codes.tolist(), counts.tolist(), strict=True))
    ways = {"cycles" if verb == "limit_cycle" else "finished": number.pop(FINISHED, 0)}
    ways |= {"steady sliding": number.pop(STEADY_SLIDING, 0)}
    ways |= {f"failed ({STATUSES[code][0].replace('_', ' ')})": n for code, n in number.items()}
    return ", ".join(f"{n:,} {how}" for how, n in ways.items() if n)


def _ranges(result: xarray.Dataset, verb: str, units: Units) -> FirstThatFits:
    """Smallest and largest values, and where they are: side by side, or below each other."""
    smallest, largest, value = (
        Column(name, justify="right", no_wrap=True) for name in ("smallest", "largest", "value")
    )
    beside = plain_table("", smallest, "at", largest, "at")
    below = plain_table("", "", value, "at")
    for name in RANGES[verb]:
        values = result[name].where(np.isfinite(result[name]))
        if verb == "limit_cycle" and name == "amplitude":
            values = values.where(values > 0.0)  # of cycles
        if not bool(values.notnull().any()):
            continue
        least, most = (
            _cells(values, index, units) for index in (values.argmin(...), values.argmax(...))
        )
        beside.add_row(name, *least, *most)
        below.add_row(name, "smallest", *least)
        below.add_row("", "largest", *most)
    return FirstThatFits([beside], [below])


def _cells(values: xarray.DataArray, index: dict[Any, Any], units: Units) -> tuple[str, str]:
    """A value, and where it is."""
    one = values.isel(index)
    where = {dim: one[dim].item() if dim in one.coords else int(index[dim]) for dim in index}
    name, x = str(values.name), float(one)
    text = ANY_SPEED.get(x) if name == "V_c" else None
    return text or shown(name, x, units), place(where)


def failed_lines(result: xarray.Dataset) -> list[str]:
    """The first `LISTED` failed cases, a line each, and how many more there are; may be empty."""
    from ..sweeps.status import failures

    first, number = failures(result, most=LISTED)
    lines = [f"  {place(where)}: {name}: {message}" for where, name, message in first]
    return lines + ([f"  and {number - len(first)} more"] if number > len(first) else [])
