"""The coordinates in which a fit moves, their bounds, and their values in SI.

A positive parameter moves as its logarithm, so that steps are relative and no bound is needed at
0.  b is its own coordinate, for it may be negative.  Beside what the user frees, a record brings
unknowns of its own: its level of friction, its trend, and the state in which it begins.
"""

import math
from typing import NamedTuple

import numpy as np

from ...errors import ParameterError

#: parameters of the slider that may be free
PARAMETERS = ("a", "b", "Dc", "K", "M")
#: coordinates that are no logarithms
LINEAR = ("b", "lag", "level", "trend")
#: ln(V/V1) and ln(theta V1/Dc) at the start of a record that begins out of steady sliding at V1
START = ("v_start", "psi_start")
#: coordinates that are no logarithm of a value in SI
PLAIN = (*LINEAR, *START)
#: an estimate this near to a bound, as a part of the distance between both, is at the bound
NEAR = 1e-3


class Unknowns(NamedTuple):
    """Names of the coordinates, in order, and the bounds between which each may move."""

    names: tuple
    low: np.ndarray  # (k,)
    high: np.ndarray  # (k,)

    def index_of(self, name):
        """Index of a coordinate."""
        return self.names.index(name)

    @property
    def reported(self):
        """Names that the result reports: all but those that only describe the record."""
        return tuple(n for n in self.names if n not in (*START, "level", "trend"))


def checked_free(free, slider):
    """The free parameters as a tuple, in the order of `PARAMETERS`.

    Raises
    ------
    ParameterError
        An unknown or repeated name, none at all, or one whose value leaves nothing to start from.
    """
    allowed = (*PARAMETERS, "lag", "mu0")
    try:
        names = (free,) if isinstance(free, str) else tuple(free)
    except TypeError:
        raise ParameterError(
            f"free = {free!r} is no sequence of names; give some of {', '.join(allowed)}"
        ) from None
    if not names:
        raise ParameterError("free is empty; give at least one of " + ", ".join(allowed))
    for name in names:
        if name not in allowed:
            raise ParameterError(f"free has {name!r}, which is none of {', '.join(allowed)}")
    if len(set(names)) < len(names):
        raise ParameterError(f"free = {names!r} names a parameter twice")
    if "K" in names and math.isinf(slider.K):
        raise ParameterError(
            "K is free but starts at K = inf, a rigid machine, whose stiffness has no "
            "effect on friction; give the slider a finite K to start from, or leave K out of free"
        )
    if "M" in names and slider.M == 0.0:
        raise ParameterError(
            "M is free but starts at M = 0 kg/m^2, of which no logarithm exists; give the slider "
            "an M > 0 to start from, or leave M out of free"
        )
    chosen = tuple(n for n in (*PARAMETERS, "lag") if n in names)
    if not chosen:
        raise ParameterError("free has only mu0, which every fit finds; add one of a, b, Dc, K, M")
    return chosen


def to_coordinate(name, value):
    """A value [SI] as the coordinate in which it moves."""
    return value if name in LINEAR else np.log(value)


def to_value(name, coordinate):
    """The value [SI] of a coordinate."""
    if name in LINEAR:
        return coordinate
    with np.errstate(over="ignore"):  # an open end of an interval
        return np.exp(coordinate)


def slope(name, value):
    """d value/d coordinate."""
    return 1.0 if name in LINEAR else value
