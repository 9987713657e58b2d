"""What a report says of cases whose motion leaves the domain of the friction law."""

from collections.abc import Sequence

import numpy as np
import xarray

from .tables import place

#: places listed, at most
LISTED = 5


def outside_lines(
    result: xarray.Dataset, cases: str, axes: Sequence[str] | None = None
) -> list[str]:
    """How many cases leave the domain of the friction law, why, and where, if that is short.

    Empty where none does, and of a result without ``outside_domain``.

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
    ways = {1: "mu falls below 0", 2: "the spring pulls back harder than friction can hold"}
    counts = {way: int((outside & (code & bit > 0)).sum()) for bit, way in ways.items()}
    why = ", ".join(f"{way} in {count:,}" for way, count in counts.items() if count)
    first = (
        f"{number:,} of {code.size:,} {cases} leave the domain of the friction law, "
        f"which knows forward slip only: {why}"
    )
    values = [
        result[axis].values if axis in result.variables else np.arange(size)
        for axis, size in zip(axes, code.shape, strict=True)
    ]
    if len(axes) == 1:
        places = _stretches(axes[0], values[0], outside)
    else:
        cells = zip(*(x[i] for x, i in zip(values, outside.nonzero(), strict=True)), strict=True)
        places = [place(dict(zip(axes, cell, strict=True))) for cell in cells]
    return [first, *(f"  {where}" for where in places if len(places) <= LISTED)]


def _stretches(axis: str, values: np.ndarray, outside: np.ndarray) -> list[str]:
    """Where a line of cases is outside: stretches without a gap, from their first to their last."""
    edges = np.flatnonzero(np.diff(np.pad(outside.astype(int), 1)))
    texts = []
    for begin, end in edges.reshape(-1, 2):
        first, last = (place({axis: values[i]}) for i in (begin, end - 1))
        texts.append(first if first == last else f"{first} to {last.partition(' = ')[2]}")
    return texts
