"""The axes of a sweep: where its cases lie on them, and in which unit."""

from typing import Any, NamedTuple

import numpy as np

from ...model.quantities import QUANTITIES
from ..labels import label, prefixed

# Ratio of smallest to largest value from which a logarithmic scale pays.
WIDE = 10.0


class Axis(NamedTuple):
    """Abscissae of the cases along a dimension, and what stands at them."""

    values: np.ndarray
    text: str
    logarithmic: bool
    names: Any  # what is written at each case, where values are no numbers in order; else None

    @property
    def edges(self):
        """Where the cells of a map begin and end, one more than there are cases."""
        values = np.log(self.values) if self.logarithmic else self.values
        middle = 0.5 * (values[1:] + values[:-1])
        half = 0.5 * np.diff(values) if values.size > 1 else np.full(1, 0.5)
        edges = np.concatenate([[values[0] - half[0]], middle, [values[-1] + half[-1]]])
        return np.exp(edges) if self.logarithmic else edges

    def each(self, dim):
        """What a legend says of each value."""
        unit = self.text.rpartition(" [")[2].rstrip("]") if "[" in self.text else ""
        values = self.names or [f"{value:.4g}" for value in self.values]
        return [f"{label(dim)} = {value} {unit}".rstrip() for value in values]

    def dress(self, axis):
        """Give a matplotlib axis its label and scale, or its names."""
        axis.set_label_text(self.text)
        if self.logarithmic:
            axis.axes.set(**{f"{axis.axis_name}scale": "log"})
        if self.names:
            axis.set_ticks(self.values, self.names)


def axis_of(result, dim):
    """`Axis` of a dimension of a result."""
    size = result.sizes[dim]
    values = result[dim].values if dim in result.coords else np.arange(size)
    quantity = QUANTITIES.get(dim)
    name = f"{quantity.long_name.capitalize()} {label(dim)}" if quantity else str(dim)
    if values.dtype.kind not in "iuf":
        return Axis(np.arange(size), name, False, [str(value) for value in values])
    steps = np.diff(values) if np.isfinite(values).all() else np.array([np.nan])
    fitted, unit, _ = fitting(values, quantity.unit if quantity else "1")
    if not ((steps > 0).all() or (steps < 0).all()):
        return Axis(np.arange(size), name + unit, False, [f"{value:.4g}" for value in fitted])
    even = size > 2 and values.min() > 0.0 and _uneven(np.log(values)) < _uneven(values)
    return Axis(fitted, name + unit, bool(even), None)


def fitting(values, unit):
    """Values in a unit that fits the largest; that unit, for a label; whether to use logarithms."""
    known = values[np.isfinite(values)]
    factor, text = prefixed(unit, float(np.abs(known).max(initial=0.0)))
    wide = known.size and known.min() > 0.0 and known.max() > WIDE * known.min()
    return factor * values, f" [{text}]" if text else "", bool(wide)


def _uneven(values):
    """How far from evenly spaced values are."""
    steps = np.diff(values)
    return np.std(steps) / np.abs(np.mean(steps))
