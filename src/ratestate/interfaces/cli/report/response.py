"""Tables about the response of a slider to small oscillations."""

from typing import Any

import numpy as np
import xarray
from rich.table import Column
from rich.text import Text

from ....dynamics.results import parameter
from ....model.quantities import readable
from .rows import FEW_DIGITS, Units, plain_table, row, shown, table

MOST = 16  # frequencies of a table


def response(result: xarray.Dataset, units: Units) -> list[Any]:
    """The resonance, and gains and phases at some of the frequencies."""
    V, sigma = float(result.V_lp), float(parameter(result, "sigma"))
    law = parameter(result, "law")
    title = f"The response of steady sliding at {readable('V_lp', V)}, {law} law"
    known = np.isfinite(float(result.resonance))
    rows = [
        row("resonance", result.resonance, "" if known else "the slider does not oscillate"),
        row("quality", result.quality),
    ]
    every = result if "frequency" in result.dims else result.expand_dims("frequency")
    n = every.sizes["frequency"]
    some = every.isel(frequency=np.unique(np.linspace(0, n - 1, min(n, MOST)).round().astype(int)))
    low, high = (readable("frequency", float(x)) for x in (every.frequency[0], every.frequency[-1]))
    note = f"{n} frequencies from {low} to {high}" if n > 1 else f"One frequency, {low}"
    note += f", {some.sizes['frequency']} of them shown" if n > MOST else ""
    of_size = {"V": V, "tau": sigma, "mu": 1.0}
    tables = []
    for given, size in (("V_lp", V), ("sigma", sigma)):
        tables += [
            Text(""),
            Text(f"Per relative change of {given}; phases in degrees", style="bold"),
        ]
        tables.append(_table(some, given, {out: size / x for out, x in of_size.items()}, units))
    return [*table(title, rows, units), Text(""), Text(note), *tables]


def _table(result: xarray.Dataset, given: str, factors: dict[str, float], units: Units) -> Any:
    """Gains, times these factors, and phases in degrees."""
    heads = {"V": "V/V_lp", "tau": "tau/sigma", "mu": "mu"}
    names = ["frequency", *(part for head in heads.values() for part in (head, "phase"))]
    made = plain_table(*(Column(name, justify="right", no_wrap=True) for name in names))
    for i, frequency in enumerate(result.frequency.values):
        one = result.isel(frequency=i)
        cells = [shown("frequency", float(frequency), units, FEW_DIGITS)]
        for out, factor in factors.items():
            gain, phase = (float(one[f"{out}_by_{given}_{x}"]) for x in ("gain", "phase"))
            cells += [f"{gain * factor:.{FEW_DIGITS}g}", f"{np.degrees(phase):.1f}"]
        made.add_row(*map(Text, cells))
    return made
