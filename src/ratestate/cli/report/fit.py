"""Tables about a fit."""

import json
from typing import TYPE_CHECKING, Any

from .estimates import lines, noise

if TYPE_CHECKING:
    import xarray


def fit(result: "xarray.Dataset") -> list[Any]:
    """The estimates under each law with 95 % intervals, the noise, and what must be known."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    from ...fitting.each import each_law

    laws = each_law(result)
    made = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)
    made.add_column("")
    for law in laws:
        made.add_column(f"{law} law", justify="right", no_wrap=True)
        made.add_column("95 % interval", justify="right", no_wrap=True)
    made.add_column("")
    for line in lines(laws):
        cells = [text for one in line.each for text in (one.value, (one.intervals or ("",))[-1])]
        made.add_row(*map(Text, (line.label, *cells, line.meaning)))
    size = result.sizes["time"]
    shown = [Text(f"{size:,} samples, {' and '.join(laws)} law", style="bold"), made, Text("")]
    if found := result.attrs.get("found"):
        shown.insert(0, Text(found))
    for law, part in laws.items():
        shown.append(Text(f"{law} law: {_quality(part)}"))
    if words := result.attrs.get("comparison"):
        shown.append(Text(words))
    notes = [f"note: {text}" for text in json.loads(result.attrs.get("notes", "[]"))]
    said = [f"{law} law: {text}" for law, part in laws.items() for text in part.attrs["warnings"]]
    return [*shown, *map(Text, notes), *(Text(f"warning: {text}", style="bold") for text in said)]


def _quality(part: "xarray.Dataset") -> str:
    """How well a law fits, in words."""
    if "chi2" in part:
        features = int(part["used"].sum())
        return f"chi-square {float(part['chi2']):.3g} for {features} features of cycles"
    return f"r.m.s. {float(part['rms']):.3g}, noise {noise(part)}"
