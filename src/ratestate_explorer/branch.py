"""The bifurcation diagram: steady sliding and limit cycles along one parameter."""

import functools
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import xarray

import ratestate as rs

from .deadline import TimeUp

#: parameters along which the page may ask for it
ALONG = ("K", "V_lp", "M")
#: seconds that it may take, and how many are cached
SECONDS, CACHED_BRANCHES = 20.0, 60
# Accuracies: first one that is enough for a drawing; where branches are steep, as beside a Hopf
# point at small eta, only the finer one is followed to its end.
RTOL, FINE_RTOL = 1e-4, 1e-6
# Decades shown to either side: of a Hopf point, where sliding is stable and where it is not, and of
# the slider where no Hopf point is within REACH; the range reaches beyond the slider by half that.
STABLE_SIDE, UNSTABLE_SIDE, SIDE, REACH = 1.0, 1.5, 1.5, 4.0
# Places per decade at which the stability of steady sliding is looked at.
DENSITY = 40
#: kinds of `special` that the page marks
MARKED = ("fold", "period_doubling", "torus")


class ParameterRange(NamedTuple):
    """The range of the parameter [SI], and where steady sliding is stable in it."""

    low: float
    high: float
    hopf: tuple[float, ...]  # where stability changes, in ascending order
    stable_at_low: bool

    def courses(self):
        """Return where to follow branches, list of (start, stop): over each unstable interval.

        From the stable side of a Hopf point, or from end to end where there is none.  Between two
        Hopf points the branches from both meet in the middle.
        """
        ends = [self.low, *self.hopf, self.high]
        middles = [float(np.sqrt(left * right)) for left, right in pairwise(ends)]
        begin = [self.low, *middles[1:-1], self.high]  # in each interval, if it is stable
        found = []
        for i in range(int(self.stable_at_low), len(middles), 2):
            sides = [begin[k] for k in (i - 1, i + 1) if 0 <= k < len(middles)]
            if len(sides) == 2:
                found += [(side, middles[i]) for side in sides]
            elif sides:
                found.append((sides[0], self.low if i == 0 else self.high))
            else:
                found.append((self.low, self.high))
        return found


def branch(state, along, deadline):
    """Return header and arrays of the answer to "branch" (wire.py).

    The arrays hold all pieces of branches, one after another: the parameter, amplitude, V_max, and
    whether the cycles between a point and the next are stable.  What could not be followed is
    named in the header's note.  `Stopped` if it was cancelled.
    """
    slider, V_lp = state.slider, state.V_lp
    axis = axis_of(slider, V_lp, along)
    header = {"along": along, **axis._asdict()}
    try:
        with deadline.part():
            # The parameter's own value changes nothing, and is left out of what is cached.
            pieces, note = _pieces(*_at(slider, V_lp, along, 1.0), along, axis)
    except TimeUp:
        pieces = ()
        note = (
            f"The cycles take more than {deadline.seconds:g} s. In Python continue_cycle has no "
            f"such limit."
        )
    special = [
        {"kind": piece.special.values[i].item()}
        | {name: values[i].item() for name, values in _columns(piece, along).items()}
        for piece in pieces
        for i in np.flatnonzero(np.isin(piece.special, MARKED))
    ]
    header |= {"sizes": [piece.sizes["point"] for piece in pieces], "special": special}
    return header | {"note": note}, _curves(pieces, along)


def axis_of(slider, V_lp, along):
    """Return the `ParameterRange` of the diagram of a slider at a speed."""
    value = V_lp if along == "V_lp" else getattr(slider, along)
    has_value = 0.0 < value < np.inf
    anchor = value if has_value else _scale(slider, V_lp, along)
    wide = anchor * 10.0 ** np.array([-REACH, REACH])
    changes, stable = _stability(slider, V_lp, along, *wide)
    if changes:
        nearest = int(np.argmin(np.abs(np.log(np.array(changes) / anchor))))
        rises = stable == (nearest % 2 == 1)  # whether sliding is stable above, and not below
        below, above = (UNSTABLE_SIDE, STABLE_SIDE) if rises else (STABLE_SIDE, UNSTABLE_SIDE)
        low, high = changes[nearest] / 10.0**below, changes[nearest] * 10.0**above
    else:
        low, high = _rounded_decades(anchor, SIDE)
    if has_value and not low <= value <= high:
        ends = _rounded_decades(value, SIDE / 2.0)
        low, high = min(low, ends[0]), max(high, ends[1])
    changes, stable = _stability(slider, V_lp, along, low, high)
    return ParameterRange(low, high, tuple(changes), stable)


def _scale(slider, V_lp, along):
    """Return K_c [Pa/m] in place of K = inf, or the M of eta = 1 in place of M = 0."""
    if along == "K":
        return max(float(slider.K_c(V_lp)), slider.sigma * slider.a / slider.Dc)
    return slider.a * slider.sigma * slider.Dc / V_lp**2


def _rounded_decades(value, side):
    """Return ends so many decades or more to either side of a value, on half decades."""
    at = np.log10(value)
    ends = np.floor(2.0 * (at - side)) / 2.0, np.ceil(2.0 * (at + side)) / 2.0
    return tuple(float(10.0**end) for end in ends)


def _at(slider, V_lp, along, value):
    """Return the slider and the speed with this value of the parameter, a float or an array."""
    return (slider, value) if along == "V_lp" else (slider.replace(**{along: value}), V_lp)


def _stability(slider, V_lp, along, low, high):
    """Return where the stability of steady sliding changes, a list; and whether low is stable."""

    def stable(p):
        at, V = _at(slider, V_lp, along, xarray.DataArray(np.exp(p), dims="parameter"))
        return np.broadcast_to(np.asarray(at.K_c(V) < at.K), p.shape)

    first, last = np.log([low, high]).tolist()
    p = np.linspace(first, last, int(np.log10(high / low) * DENSITY) + 2)
    is_stable = stable(p)
    change = np.flatnonzero(is_stable[1:] != is_stable[:-1])
    left, right, before = p[change], p[change + 1], is_stable[change]
    while len(left) and (right - left > 1e-15 * np.maximum(np.abs(left), 1.0)).any():
        middle = 0.5 * (left + right)
        keeps_side = stable(middle) == before
        left, right = np.where(keeps_side, middle, left), np.where(keeps_side, right, middle)
    # Rounded, so that diagrams of the same slider are the same, wherever the search began.
    return [float(f"{value:.12g}") for value in np.exp(right)], bool(is_stable[0])


@functools.lru_cache(CACHED_BRANCHES)
def _pieces(slider, V_lp, along, axis):
    """Return the pieces of branches along an axis, a tuple of Datasets, and their problems."""
    courses = axis.courses()
    if not courses:
        return (), "Steady sliding is stable along the whole axis, and no limit cycle begins there."
    try:
        found = [_followed(slider, V_lp, along, *course) for course in courses]
    except rs.ParameterError as error:
        return (), str(error)
    pieces = tuple(piece for piece, _ in found if piece is not None and piece.sizes["point"] > 1)
    return pieces, " ".join(dict.fromkeys(filter(None, (note for _, note in found))))


def _followed(slider, V_lp, along, start, stop):
    """Return a branch as far as it was found, or None; and a sentence if it is not complete.

    If it cannot be followed from the Hopf point, it is followed from the other end.
    """
    best, note = None, ""
    for first, last, rtol in ((start, stop, RTOL), (start, stop, FINE_RTOL), (stop, start, RTOL)):
        V = None if along == "V_lp" else V_lp
        try:
            return rs.continue_cycle(slider, along, first, last, V_lp=V, rtol=rtol), ""
        except rs.NotConverged as error:
            note = note or str(error).splitlines()[0]
            found = error.best
            if found is not None and (best is None or found.sizes["point"] > best.sizes["point"]):
                best = found
    return best, note


def _columns(piece, along):
    names = {"parameter": along, "amplitude": "amplitude", "V_max": "V_max"}
    return {name: piece[column].values for name, column in names.items()}


def _stable(piece):
    """Return (n,) whether the cycles between a point and the next are stable; False at the last.

    At a bifurcation a multiplier is on the unit circle, and rounding decides ``stable`` there.
    """
    firm = piece.stable.values.astype(bool) | np.isin(piece.special.values, ("hopf", *MARKED))
    return np.append(firm[:-1] & firm[1:], False)


def _curves(pieces, along):
    all_columns = [_columns(piece, along) | {"stable": _stable(piece)} for piece in pieces]
    names = ("parameter", "amplitude", "V_max", "stable")
    return {name: np.concatenate([[], *(c[name] for c in all_columns)]) for name in names}
