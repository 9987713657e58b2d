"""The axis along a dimension of a sweep: its values, unit, scale and names."""

from typing import Any, NamedTuple

import numpy as np

from ..dynamics.results import contact_area
from ..model.parameters import OF_CONTACT
from ..model.quantities import QUANTITIES
from .labels import fitting_unit, in_unit, label, name_and_symbol
from .layout import plain_ticks


class SweepAxis(NamedTuple):
    """Abscissae of the cases along a dimension, and what stands at them."""

    values: np.ndarray
    name: str
    unit: str = ""
    logarithmic: bool = False
    names: Any = None  # what is written at each case, where values are no numbers in order

    @property
    def edges(self):
        """(n + 1,) where the cells of a map of n cases begin and end, in `unit`."""
        values = self.even
        middle = 0.5 * (values[1:] + values[:-1])
        half = 0.5 * np.diff(values) if values.size > 1 else np.full(1, 0.5)
        return self.at(np.concatenate([[values[0] - half[0]], middle, [values[-1] + half[-1]]]))

    @property
    def even(self):
        """The values on the scale of the axis, on which they are evenly spaced if on any."""
        return np.log(self.values) if self.logarithmic else self.values

    def at(self, even):
        """Abscissae of such values."""
        return np.exp(even) if self.logarithmic else even

    def labels(self, dim):
        """What a legend says of each value (list of str)."""
        values = self.names or [f"{value:.4g}" for value in self.values]
        return [f"{label(dim)} = {value} {self.unit}".rstrip() for value in values]

    def format_axis(self, axis):
        """Give a matplotlib axis its label and scale, or its names."""
        axis.set_label_text(in_unit(self.name, self.unit))
        if self.logarithmic:
            axis.axes.set(**{f"{axis.axis_name}scale": "log"})
            plain_ticks(axis, self.values)
        if self.names:
            axis.set_ticks(self.values, self.names)


def axis_of(result, dim):
    """`SweepAxis` of a dimension of a result, in a unit that fits.

    Values that are not finite numbers, or not in order, stand by name at 0, 1, 2 ..., which are
    also the values of a dimension without coordinate.
    """
    size = result.sizes[dim]
    values = result[dim].values if dim in result.coords else np.arange(size)
    symbol = dim if dim in QUANTITIES else "number"
    area = contact_area(result) if dim in OF_CONTACT else None
    name = name_and_symbol(dim, area) if dim in QUANTITIES else str(dim)
    if values.dtype.kind not in "iuf":
        return SweepAxis(np.arange(size), name, names=[str(value) for value in values])
    factor, unit = fitting_unit(symbol, values, area)
    fitted = factor * values
    steps = np.diff(values) if np.isfinite(values).all() else np.array([np.nan])
    if not ((steps > 0).all() or (steps < 0).all()):
        return SweepAxis(np.arange(size), name, unit, names=[f"{value:.4g}" for value in fitted])
    even = size > 2 and values.min() > 0.0 and _uneven(np.log(values)) < _uneven(values)
    return SweepAxis(fitted, name, unit, bool(even))


def _uneven(values):
    steps = np.diff(values)
    return np.std(steps) / np.abs(np.mean(steps))
