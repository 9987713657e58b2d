"""Cells of the table of steps: estimates in a unit that fits all, and what changes at a step."""

import numpy as np

from ....friction.laws import friction_law
from ....model.quantities import (
    QUANTITIES,
    concise,
    power_of,
    prefixed_unit,
    readable,
    readable_change,
    short,
)
from ..table import rate_dependence_text
from ..unknowns import SUMS, to_value

#: pure numbers below this are given in thousandths
SMALL = 0.1
#: in place of an estimate
NONE = "-"


class Column:
    """An estimate along the steps under a law, in a unit that fits it under all laws."""

    def __init__(self, parts, law, symbol):
        self.part, self.symbol = parts[law], symbol
        unit = QUANTITIES[symbol].unit
        sizes = [np.abs(part[symbol].values) for part in parts.values()]
        typical = max(float(np.median(size[np.isfinite(size)])) for size in sizes if _has(size))
        power = power_of(unit, typical)
        text = f" [{prefixed_unit(unit, power)}]"
        if unit == "1":
            power, text = (-3, " [1e-3]") if typical < SMALL else (0, "")
        self.factor = 10.0**-power
        is_rate = symbol == "a_minus_b"
        self.head = (rate_dependence_text([friction_law(law)]) if is_rate else symbol) + text

    def cell(self, i):
        """The estimate of a step with its error, or its bound where that is all that is known."""
        here = self.part.isel(step=i).sel(parameter=self.symbol)
        value, error = float(here[self.symbol]), float(here["standard_error"])
        return self._bound(here["interval"].values[-1]) or self._text(value, error)

    def of_all(self, name, error):
        """What all steps tell: a variable along ``parameter``, with its error if there is one."""
        here = self.part.sel(parameter=self.symbol)
        own = np.nan if error is None else float(here[error])
        if name == "up_over_down":
            return _concise(float(here[name]), own)
        return self._text(float(here[name]), own)

    def _bound(self, ends):
        """Such as "< 0.16", of an interval that is open on one side; else ""."""
        infinite = np.array([-np.inf, np.inf])
        at = infinite if self.symbol in SUMS else to_value(self.symbol, infinite)
        is_open = ends == at
        if is_open.sum() != 1:
            return ""
        return f"{'>' if is_open[1] else '<'} {short(self.factor * ends[~is_open][0])}"

    def _text(self, value, error):
        return _concise(self.factor * value, self.factor * error)


def _has(values):
    """Whether any is a number."""
    return bool(np.isfinite(values).any())


def _concise(value, error):
    """A number with its error where that is finite; `NONE` for NaN."""
    if not np.isfinite(value):
        return NONE
    return concise(value, error) if 0.0 < error < np.inf else f"{value:.3g}"


def change_text(step):
    """What changes: "3 -> 10 um/s", "hold 30 s, 3 um/s" or "sigma 8 -> 8.8 MPa"."""
    before, after = float(step["V_before"]), float(step["V_after"])
    kind = str(step["kind"].item())
    if kind == "hold":
        then = readable("V_lp", after, 3) if np.isfinite(after) else "to the record's end"
        return f"hold {readable('t', float(step['t_hold']), 3)}, {then}"
    if kind == "normal stress":
        ends = (float(step[name]) for name in ("sigma", "sigma_after"))
        return f"sigma {readable_change('sigma', *ends)}"
    return readable_change("V_lp", before, after)
