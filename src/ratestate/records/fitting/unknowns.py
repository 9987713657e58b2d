"""The parameters that a fit may move: their coordinates, bounds, and where searches for them start.

`parameter` gives the row of each; whatever else names parameters derives from it.  A positive
parameter moves as its logarithm, so that steps are relative and no bound is needed at 0.  b moves
as itself, for it may be negative.  How a parameter of the law's own moves follows from the unit and
the bound that the law gives it.  Beside what the user frees, a record brings parameters of its own:
its level of friction, its trend, and the velocity and states in which it begins.
"""

import math
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np

from ...friction.composition import EXTRAS
from ...friction.forms import FORMS
from ...friction.laws import LAWS, laws_with, own_parameters
from ..messages import fitting as sentences

#: step of a difference in a logarithm, or over the size of what moves as itself
STEP = 3e-5
#: size of alpha, of which 0.2 is typical
ALPHA = 0.2
#: ln of the ratio of speeds that a hold counts as
HOLD = 5.0
#: an estimate this near to a bound, as a part of the distance between both, is at the bound
NEAR = 1e-3


class Parameter(NamedTuple):
    """How a fit moves a parameter; its bounds and starts are over its size, as of `sizes_of`."""

    #: "slider", or "record", if the user may free it; else of the record: "start", or "linear",
    #: in which friction is a linear function
    group: str
    is_log: bool = False  # it moves as its logarithm
    bounds: tuple[float, float] = (-math.inf, math.inf)
    starts: tuple[float, float] | None = None  # of a logarithm in powers of ten; None: 0 alone
    #: step of a difference in the coordinate, from the record and the size of what is no logarithm
    step: Callable[[Any, float], float] = lambda record, size: STEP * size
    irrelevant: int = 0  # -1 or 1: it ceases to matter where it is small, or large
    reported_as: str = ""  # if it is reported, but not among the free parameters
    no_part_in_cycles: str = ""  # what of it has no effect on cycles

    @property
    def least(self):
        """The coordinate below which no value exists."""
        return 0.0 if self.bounds[0] == 0.0 else -math.inf


#: name -> `Parameter` of those that there are under any law
PARAMETERS = {
    "a": Parameter("slider", is_log=True, bounds=(1e-3, 1e2), starts=(-0.5, 0.5)),
    "b": Parameter("slider", bounds=(-1e2, 1e2), starts=(-1.0, 3.0)),
    "Dc": Parameter("slider", is_log=True, bounds=(1e-3, 1e3), starts=(-1.5, 0.7)),
    "K": Parameter("slider", is_log=True, bounds=(1e-4, 1e6), starts=(-0.5, 1.5), irrelevant=1),
    "M": Parameter("slider", is_log=True, bounds=(1e-8, 1e4), starts=(-3.0, 1.0), irrelevant=-1),
    "alpha": Parameter("slider", bounds=(0.0, 1e2), starts=(0.0, 1.0)),
    "lag": Parameter(
        "record",
        bounds=(-0.1, 0.1),
        step=lambda record, size: 0.1 * record.spacing,
        no_part_in_cycles="a delay of a load point that moves steadily",
    ),
    # ln(V/V1), at the start of a record that begins out of steady sliding at V1
    "V_start": Parameter("start", bounds=(-20.0, 20.0)),
    "level": Parameter("linear"),
    "trend": Parameter("linear", reported_as="trend_{along}"),
}
#: a state at such a start, as ln(theta/theta_ss)
STATE_START = Parameter("start", bounds=(-20.0, 20.0))
LINEAR = ("level", "trend")
#: parameters of the slider, or of its record, that are the machine's, not the law's
OF_MACHINE = ("K", "M", "lag")
#: what results report beside the free parameters
TRENDS = ("trend_slip", "trend_time")
SUMS = ("mu0", "a_minus_b", *TRENDS)


def parameter(name):
    """The `Parameter` of this name, under any law; KeyError for none."""
    if name in PARAMETERS:
        return PARAMETERS[name]
    if any(name in starts_of(law) for law in LAWS.values()):
        return STATE_START
    of_forms = (form.OWN_PARAMETERS for form in FORMS.values())
    for own in (*(law.parameters for law in LAWS.values()), *of_forms, EXTRAS):
        if name in own:
            return _of_law(own[name])
    raise KeyError(name)


def _of_law(own):
    """The `Parameter` of a law's own parameter, from its unit and its bound.

    A length moves as Dc does, and what may have either sign as b does.
    """
    if own.bound == ">= 0":
        return Parameter("slider", bounds=(0.0, 1e3), starts=(0.0, 3.0))
    if own.bound == "> 0" and own.unit != "m":
        return Parameter("slider", is_log=True, bounds=(1e-6, 1e6), starts=(-2.0, 1.0))
    return PARAMETERS["Dc" if own.bound else "b"]


def of_slider(*laws):
    """Symbols of the slider's parameters that motion under these laws depends on, but for sigma."""
    return ("a", "b", "Dc", *own_parameters(laws), "K", "M")


def starts_of(law):
    """Names of the velocity and the states at the start of a record, under a law."""
    return ("V_start", *(f"{state}_start" for state in law.states))


def free_under(laws):
    """What the user may free under any of these laws; each fit estimates mu0 anyway."""
    return (*of_slider(*laws), "alpha", "lag")


def sizes_of(record, slider):
    """name -> order of magnitude that the record suggests [SI]; 1 of what is not the slider's.

    Of the law's own parameters a length has the size of Dc, a speed that of the slowest sliding,
    and a pure number of either sign that of b, or of its value if this is larger; others have the
    size of their value, 1 if that is 0.
    """
    speeds = record.loading.V[record.loading.V > 0.0]
    ratio = max(float(np.abs(np.log(speeds / record.loading.V[0])).max()), 1.0)
    if speeds.size < record.loading.V.size:  # in a hold the slider slows by orders of magnitude
        ratio = max(ratio, HOLD)
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
        known = {"m": sizes["Dc"], "m/s": slow, "1": value if own.bound else max(scale, value)}
        sizes[name] = known.get(own.unit, value) or 1.0
    return sizes | dict.fromkeys((*starts_of(slider.friction_law), *LINEAR), 1.0)


class Unknowns(NamedTuple):
    """Names of the coordinates, in order, and the bounds between which each may move."""

    names: tuple
    low: np.ndarray  # (k,)
    high: np.ndarray  # (k,)

    def sides(self, point, near=NEAR):
        """Return name -> -1 or 1 if a point (k,) is at the lower or upper bound, else 0.

        near : distance from a bound that counts as none, as a fraction of the range
        """
        width = self.high - self.low
        bounded = np.isfinite(width)
        part = np.full(len(self.names), 0.5)
        part[bounded] = (point[bounded] - self.low[bounded]) / width[bounded]
        sides = np.where(part < near, -1, np.where(part > 1.0 - near, 1, 0))
        return dict(zip(self.names, sides.tolist(), strict=True))


def unknowns_of(record, slider, free, *, start):
    """`Unknowns` of a record: free parameters, the start if that is free, level, trend."""
    names = (*free, *(starts_of(slider.friction_law) if start else ()), *record.regressors())
    sizes = sizes_of(record, slider)
    bounds = [
        [to_coordinate(name, end * sizes[name]) for end in parameter(name).bounds] for name in names
    ]
    low, high = np.array(bounds).T
    return Unknowns(names, low, high)


def distinct(points, distance, most=None):
    """Indices (list) of points (n, k), each away from all before, in some coordinate.

    distance : farther than this; one for all coordinates, or (k,)
    most : largest number of them; None for any
    """
    kept: list[int] = []
    for i, point in enumerate(points):
        if len(kept) != most and all(np.any(np.abs(point - points[j]) > distance) for j in kept):
            kept.append(i)
    return kept


def checked_free(free, sliders):
    """The free parameters as a tuple, in the order of `free_under`, without mu0.

    sliders : that of each law; what is free must be a parameter of one of them

    ParameterError for what cannot be free, twice the same, and a law with none beside mu0.
    """
    laws = [slider.friction_law for slider in sliders]
    allowed = (*free_under(laws), "mu0")
    listed = ", ".join(allowed)
    is_one = isinstance(free, str) or not isinstance(free, Iterable)
    names = (free,) if is_one else tuple(free)
    if not names:
        raise sentences.refusal("free.empty", allowed=listed)
    if not all(isinstance(name, str) for name in names):
        raise sentences.refusal("free.no_sequence", free=free, allowed=listed)
    for name in (name for name in names if name not in allowed):
        if name in EXTRAS:
            raise sentences.refusal("free.undamped")
        if not laws_with(name):
            raise sentences.refusal("free.unknown", name=name, allowed=listed)
        known = {"laws": [law.name for law in laws], "owners": laws_with(name)}
        known = {key: " and ".join(map(repr, some)) for key, some in known.items()}
        raise sentences.refusal("free.of_other_law", name=name, **known)
    if len(set(names)) < len(names):
        raise sentences.refusal("free.twice", names=names)
    if "K" in names and math.isinf(sliders[0].K):
        raise sentences.refusal("free.rigid")
    if "M" in names and sliders[0].M == 0.0:
        raise sentences.refusal("free.massless")
    for law in laws:
        if not set(names) & set(free_under([law])):
            raise sentences.refusal("free.only_mu0", law=law.name, slider=", ".join(of_slider(law)))
    return tuple(name for name in allowed[:-1] if name in names)


def to_coordinate(name, value):
    """A value [SI] as the coordinate in which it moves."""
    return np.log(value) if parameter(name).is_log else value


def to_value(name, coordinate):
    """The value [SI] of a coordinate; the least there is for one below, an open end."""
    row = parameter(name)
    if not row.is_log:
        return np.maximum(coordinate, row.least)
    with np.errstate(over="ignore"):  # an open end of an interval
        return np.exp(coordinate)
