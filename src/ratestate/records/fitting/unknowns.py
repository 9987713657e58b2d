"""The parameters that a fit may move: coordinates, bounds, and ranges of starting points.

`parameter` gives the row of each parameter, and everything else about parameters derives from
it.  The coordinate of a positive parameter is its logarithm, so that steps are relative and 0
needs no bound.  The coordinate of b is b, because b may be negative.  A law's additional
parameters are treated as their unit and bound require.  A record adds parameters: its level of
friction, its trend, and the velocity and states at its start.
"""

import math
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np

from ...friction.composition import EXTRAS
from ...friction.forms import FORMS
from ...friction.laws import LAWS, laws_with, own_parameters
from ..messages import fitting as sentences

#: step of finite differences in a logarithm; else relative to the parameter's size
STEP = 3e-5
#: size of alpha: 0.2 is typical
ALPHA = 0.2
#: ln of the speed ratio that stands for a hold
LOG_RATIO_OF_HOLD = 5.0


class FitParameter(NamedTuple):
    """How a fit moves a parameter.  Bounds and starts are multiples of `sizes_of`."""

    #: "slider" or "record": the user may free it.  "start": velocity or state at the start of a
    #: record.  "linear": friction is linear in it
    group: str
    is_log: bool = False  # whether the coordinate is the logarithm
    bounds: tuple[float, float] = (-math.inf, math.inf)
    starts: tuple[float, float] | None = None  # exponents of ten if `is_log`; None: 0 only
    #: step of a finite difference, from the record and the size (1 if `is_log`)
    step: Callable[[Any, float], float] = lambda record, size: STEP * size
    no_effect: int = 0  # -1 or 1: small or large values all give the same friction

    @property
    def least(self):
        """The lowest value of the coordinate."""
        return 0.0 if self.bounds[0] == 0.0 else -math.inf


#: name -> `FitParameter` of parameters under every law
PARAMETERS = {
    "a": FitParameter("slider", is_log=True, bounds=(1e-3, 1e2), starts=(-0.5, 0.5)),
    "b": FitParameter("slider", bounds=(-1e2, 1e2), starts=(-1.0, 3.0)),
    "Dc": FitParameter("slider", is_log=True, bounds=(1e-3, 1e3), starts=(-1.5, 0.7)),
    "K": FitParameter("slider", is_log=True, bounds=(1e-4, 1e6), starts=(-0.5, 1.5), no_effect=1),
    "M": FitParameter("slider", is_log=True, bounds=(1e-8, 1e4), starts=(-3.0, 1.0), no_effect=-1),
    "alpha": FitParameter("slider", bounds=(0.0, 1e2), starts=(0.0, 1.0)),
    "lag": FitParameter("record", bounds=(-0.1, 0.1), step=lambda record, _: 0.1 * record.spacing),
    # if the record does not begin in steady sliding at its first speed V1: ln(V/V1); the row also
    # serves ln(theta/theta_ss) of the states
    "V_start": FitParameter("start", bounds=(-20.0, 20.0)),
    "level": FitParameter("linear"),
    "trend": FitParameter("linear"),
}
LINEAR = ("level", "trend")
#: parameters of the machine, not of the friction law
MACHINE_PARAMETERS = ("K", "M", "lag")
#: quantities that results report besides the free parameters
TRENDS = ("trend_slip", "trend_time")
DERIVED = ("mu0", "a_minus_b", *TRENDS)


def parameter(name):
    """Return the `FitParameter` of this name, under any law; KeyError if unknown."""
    if name in PARAMETERS:
        return PARAMETERS[name]
    if any(name in start_names(law) for law in LAWS.values()):
        return PARAMETERS["V_start"]
    of_forms = (form.OWN_PARAMETERS for form in FORMS.values())
    for own in (*(law.parameters for law in LAWS.values()), *of_forms, EXTRAS):
        if name in own:
            bound, unit = own[name].bound, own[name].unit
            if bound == ">= 0":
                return FitParameter("slider", bounds=(0.0, 1e3), starts=(0.0, 3.0))
            if bound == "> 0" and unit != "m":
                return FitParameter("slider", is_log=True, bounds=(1e-6, 1e6), starts=(-2.0, 1.0))
            return PARAMETERS["Dc" if bound else "b"]
    raise KeyError(name)


def motion_symbols(*laws):
    """Return symbols of the slider's parameters, except sigma, that affect motion."""
    return ("a", "b", "Dc", *own_parameters(laws), "K", "M")


def start_names(law):
    """Return the names of velocity and states at the start of a record, under a law."""
    return ("V_start", *(f"{state}_start" for state in law.states))


def free_under(laws):
    """Return the parameters, except mu0, that may be free under any of these laws."""
    return (*motion_symbols(*laws), "alpha", "lag")


def sizes_of(record, slider):
    """Return name -> order of magnitude that the record suggests [SI].

    Among a law's additional parameters, lengths are as large as Dc, and speeds as large as the
    slowest sliding.  A pure number of either sign is as large as b, or as its value if that is
    larger.  Others are as large as their value, or 1 if the value is 0.  Level, trend and start
    have size 1.
    """
    speeds = record.loading.V[record.loading.V > 0.0]
    ratio = max(float(np.abs(np.log(speeds / record.loading.V[0])).max()), 1.0)
    if speeds.size < record.loading.V.size:  # in a hold the slider slows by orders of magnitude
        ratio = max(ratio, LOG_RATIO_OF_HOLD)
    scale = record.scale / ratio
    t, slow = record.t, float(speeds.min())
    distance = float(record.loading.delta_lp(t[-1:])[0] - record.loading.delta_lp(t[:1])[0])
    distance = max(distance, 10.0 * slow * record.spacing)
    K = 10.0 * slider.sigma * record.scale / distance
    M = K * (t[-1] / 50.0) ** 2
    sizes = {
        "a": scale,
        "b": scale,
        "Dc": 0.05 * distance,
        "K": K,
        "M": M,
        "alpha": ALPHA,
        "lag": t[-1],
    }
    for name, own in slider.friction_law.parameters.items():
        value = abs(getattr(slider, name))
        usual = {"m": sizes["Dc"], "m/s": slow, "1": value if own.bound else max(scale, value)}
        sizes[name] = usual.get(own.unit, value) or 1.0
    return sizes | dict.fromkeys((*start_names(slider.friction_law), *LINEAR), 1.0)


class Unknowns(NamedTuple):
    """Names of the coordinates, in order, and the bounds of each."""

    names: tuple
    low: np.ndarray  # (k,)
    high: np.ndarray  # (k,)

    @property
    def ranges(self):
        """Distances (k,) between both bounds; 0 if a bound is infinite."""
        ranges = self.high - self.low
        return np.where(np.isfinite(ranges), ranges, 0.0)

    def sides(self, point, near):
        """Return name -> -1 or 1 if a point (k,) is at the lower or upper bound, else 0.

        near : (k,) distance from a bound below which a coordinate counts as at the bound
        """
        sides = np.where(point - self.low < near, -1, np.where(self.high - point < near, 1, 0))
        return dict(zip(self.names, sides.tolist(), strict=True))


def unknowns_of(record, slider, free, *, start):
    """Return the `Unknowns` of a record; `start` tells whether its start is free."""
    names = (*free, *(start_names(slider.friction_law) if start else ()), *record.regressors())
    sizes = sizes_of(record, slider)
    bounds = [
        [to_coordinate(name, end * sizes[name]) for end in parameter(name).bounds] for name in names
    ]
    low, high = np.array(bounds).T
    return Unknowns(names, low, high)


def distinct(points, distance, most=None):
    """Return the indices (list) of points (n, k) that differ from all points before.

    distance : by more than this in at least one coordinate; one number, or (k,)
    most : largest number of indices; None for any
    """
    kept: list[int] = []
    for i, point in enumerate(points):
        if len(kept) != most and all(np.any(np.abs(point - points[j]) > distance) for j in kept):
            kept.append(i)
    return kept


def checked_free(free, sliders):
    """Return the free parameters (tuple) without mu0, in the order of `free_under`.

    sliders : one for each law; a free parameter must belong to at least one of them
    """
    laws = [slider.friction_law for slider in sliders]
    allowed = (*free_under(laws), "mu0")
    listed = ", ".join(allowed)
    is_one = isinstance(free, str) or not isinstance(free, Iterable)
    names = (free,) if is_one else tuple(free)
    if not names or not all(isinstance(name, str) for name in names):
        raise sentences.refusal("free.no_names", free=free, allowed=listed)
    for name in (name for name in names if name not in allowed):
        if name in EXTRAS:
            raise sentences.refusal("free.undamped")
        if not laws_with(name):
            raise sentences.refusal("free.unknown", name=name, allowed=listed)
        under = " and ".join(repr(law.name) for law in laws)
        owners = " and ".join(map(repr, laws_with(name)))
        raise sentences.refusal("free.of_other_law", name=name, laws=under, owners=owners)
    if len(set(names)) < len(names):
        raise sentences.refusal("free.twice", names=names)
    if "K" in names and math.isinf(sliders[0].K):
        raise sentences.refusal("free.rigid")
    if "M" in names and sliders[0].M == 0.0:
        raise sentences.refusal("free.massless")
    for law in laws:
        if not set(names) & set(free_under([law])):
            listed = ", ".join(motion_symbols(law))
            raise sentences.refusal("free.only_mu0", law=law.name, slider=listed)
    return tuple(name for name in allowed[:-1] if name in names)


def to_coordinate(name, value):
    """Return the coordinate of a value [SI]."""
    return np.log(value) if parameter(name).is_log else value


def to_value(name, coordinate):
    """Return the value [SI] of a coordinate, or of an interval's open end."""
    row = parameter(name)
    if not row.is_log:
        return np.maximum(coordinate, row.least)
    with np.errstate(over="ignore"):  # at an open end
        return np.exp(coordinate)
