"""Reports on many cases: how they ended, ranges of their results, and failures."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray

from ..engine.model import FINISHED, STATUSES, STEADY_SLIDING
from ..model.quantities import QUANTITIES
from .report import (
    ANY_SPEED,
    FEW_DIGITS,
    Blocks,
    Heading,
    TextTable,
    Title,
    Units,
    left,
    place,
    value_text,
)

#: failed cases listed, and places outside the domain of the friction law, at most
FAILED_LISTED, OUTSIDE_LISTED = 20, 5
#: function -> variables whose range is printed
RANGES = {
    "limit_cycle": "amplitude stress_drop period frequency V_max V_min inertia error".split(),
    "simulate": "amplitude stress_drop frequency V_max V_min cycles energy_residual".split(),
    "stability": "K_c V_c eta f_n growth_rate omega".split(),
    "frequency_response": ["resonance", "quality"],
}


def axes_of(result: xarray.Dataset, function: str) -> list[str]:
    """Return the dimensions along which a function's result has cases; none of one slider."""
    if function not in RANGES:
        return []
    names = [name for name in ("status", *RANGES[function]) if name in result]
    return [*dict.fromkeys(str(dim) for name in names for dim in result[name].dims)]


def sweep(result: xarray.Dataset, function: str, units: Units) -> Blocks:
    """Return axes, how cases ended, ranges of finite values, failed cases."""
    axes = axes_of(result, function)
    axes_text = ", ".join(_axis(result, dim, units) for dim in axes)
    cases = int(np.prod([result.sizes[dim] for dim in axes]))
    blocks: Blocks = [Title(f"{cases:,} cases of {function} over {axes_text}")]
    if "status" in result:
        blocks.append(outcomes(result["status"].values, function))
    blocks += [*outside_lines(result, "cases", units), "", _ranges(result, function, units)]
    return [*blocks, *failed_lines(result, units)] if "message" in result else blocks


def _axis(result: xarray.Dataset, dim: str, units: Units) -> str:
    if dim not in result.coords or dim not in QUANTITIES:
        return f"{dim} ({result.sizes[dim]})"
    ends = (result[dim].min(), result[dim].max())
    low, high = (value_text(dim, float(x), units, FEW_DIGITS) for x in ends)
    return f"{dim} ({result.sizes[dim]} from {low} to {high})"


def outcomes(status: np.ndarray, function: str) -> str:
    """Return how many cases ended in which way."""
    codes, counts = np.unique(status, return_counts=True)
    number = dict(zip(codes.tolist(), counts.tolist(), strict=True))
    ways = {"cycles" if function == "limit_cycle" else "finished": number.pop(FINISHED, 0)}
    ways |= {"steady sliding": number.pop(STEADY_SLIDING, 0)}
    ways |= {f"failed ({STATUSES[code][0].replace('_', ' ')})": n for code, n in number.items()}
    return ", ".join(f"{n:,} {outcome}" for outcome, n in ways.items() if n)


def _ranges(result: xarray.Dataset, function: str, units: Units) -> TextTable:
    """Return a table of smallest and largest values, and where they are."""
    rows = []
    for name in filter(result.__contains__, RANGES[function]):
        values = result[name].where(np.isfinite(result[name]))
        if function == "limit_cycle" and name in ("amplitude", "stress_drop"):
            values = values.where(values > 0.0)  # of cycles
        if not bool(values.notnull().any()):
            continue
        ends = values.argmin(...), values.argmax(...)
        rows.append([name, *(cell for at in ends for cell in _value_and_place(values, at, units))])
    place_head = left("at", joined=True)
    heads = [left()]
    heads += [heading for end in ("smallest", "largest") for heading in (Heading(end), place_head)]
    return TextTable(heads, rows, splits=True)


def _value_and_place(values: xarray.DataArray, at: dict[Any, Any], units: Units) -> tuple[str, str]:
    value = values.isel(at)
    coordinates = {dim: value[dim].item() if dim in value.coords else int(at[dim]) for dim in at}
    name, x = str(values.name), float(value)
    text = ANY_SPEED.get(x) if name == "V_c" else None
    return text or value_text(name, x, units), place(coordinates, units)


def failed_lines(result: xarray.Dataset, units: Units) -> list[str]:
    """Return a line for each of the first failed cases, and how many more there are."""
    from ..sweeps.status import failures

    first, number = failures(result, most=FAILED_LISTED)
    lines = [f"  {place(index, units)}: {name}: {message}" for index, name, message in first]
    return lines + ([f"  and {number - len(first)} more"] if number > len(first) else [])


def outside_lines(
    result: xarray.Dataset, cases: str, units: Units, axes: Sequence[str] | None = None
) -> list[str]:
    """Return how many cases leave the domain of the friction law, why, and where, if few.

    The list is empty if none does, and for a result without ``outside_domain``.

    cases : what the cases are called
    axes : names of what tells where a case is, one for each dimension; by default these
    """
    if "outside_domain" not in result:
        return []
    axes = axes or [str(dim) for dim in result["outside_domain"].dims]
    code = result["outside_domain"].values
    outside = code > 0
    if not (number := int(outside.sum())):
        return []
    reasons = {1: "mu falls below 0", 2: "the spring pulls back harder than friction can hold"}
    counts = {reason: int((outside & (code & bit > 0)).sum()) for bit, reason in reasons.items()}
    why = ", ".join(f"{reason} in {count:,}" for reason, count in counts.items() if count)
    first = (
        f"{number:,} of {code.size:,} {cases} leave the domain of the friction law, "
        f"which describes forward slip only: {why}"
    )
    values = [
        result[axis].values if axis in result.variables else np.arange(size)
        for axis, size in zip(axes, code.shape, strict=True)
    ]
    if len(axes) == 1:
        places = _stretches(axes[0], values[0], outside, units)
    else:
        cells = zip(*(x[i] for x, i in zip(values, outside.nonzero(), strict=True)), strict=True)
        places = [place(dict(zip(axes, cell, strict=True)), units) for cell in cells]
    return [first, *(f"  {where}" for where in places if len(places) <= OUTSIDE_LISTED)]


def _stretches(axis: str, values: np.ndarray, outside: np.ndarray, units: Units) -> list[str]:
    """Return the first and last value of each stretch of cases that are outside."""
    edges = np.flatnonzero(np.diff(np.pad(outside.astype(int), 1)))
    texts = []
    for begin, end in edges.reshape(-1, 2):
        first, last = (place({axis: values[i]}, units) for i in (begin, end - 1))
        texts.append(first if first == last else f"{first} to {last.partition(' = ')[2]}")
    return texts
