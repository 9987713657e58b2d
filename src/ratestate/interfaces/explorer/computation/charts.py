"""What is behind the map: K_c, the atlas, coarse, and finer parts; cached for each law and b/a."""

import contextlib
import functools

import numpy as np
import xarray

from ....dynamics.atlas import ETA, STIFFNESS, atlas
from ....dynamics.continuation.coexistence import folds
from ....dynamics.cycles.limit_cycle import limit_cycle
from ....dynamics.cycles.regimes import REGIMES, classify
from ....dynamics.hopf import bautin
from ....dynamics.refusals import check_one_length
from ....errors import ParameterError
from ....friction.linear_stability import K_c
from ....friction.stability import call_elementwise
from ....model.slider import SpringSlider
from .budget import Deadline, TimeUp

#: points along either axis: first a coarse chart, then a finer one; and of a window
SIZES, WINDOW_SIZE = (24, 72), 48
RTOL = 1e-4
#: seconds that a chart or a window may take, and how many of either are cached
SECONDS, CACHED_CHARTS = 20.0, 40
#: seconds for a chart that is cached
KNOWN = 0.2


#: the range of the map
SPAN = {"eta": ETA, "ratio": STIFFNESS}
#: points of the line of K_c
POINTS = 241


def line(slider, V_lp, K_c_qs):
    """Arrays of K_c over K_c_qs > 0 along eta, which M changes; empty where K_c_qs <= 0."""
    if K_c_qs <= 0.0:
        return {"line_eta": np.empty(0), "line_ratio": np.empty(0)}
    eta = np.geomspace(*ETA, POINTS)
    law, M = slider.friction_law, eta * (slider.sigma * slider.a * slider.Dc / V_lp**2)
    given = {symbol: slider.values[symbol] for symbol in (*law.symbols, "sigma")}
    found = call_elementwise(functools.partial(K_c, law), {"V": V_lp, **given, "M": M})
    return {"line_eta": eta, "line_ratio": found / K_c_qs}


def key_of(slider):
    """What selects a slider's chart: law, and b/a with (b - a)/a to 3 digits; None where b <= a.

    The name of the law, with what it is composed with, alone where there is no chart for it.
    """
    if not slider.friction_law.one_length:
        return (slider.friction_law.name,)
    weakening = float(f"{(slider.b - slider.a) / slider.a:.3g}")
    return (slider.law, 1.0 + weakening) if 1.0 + weakening > 1.0 else None


def is_mapped(key):
    """Whether there is an atlas for this `key_of` a slider."""
    return key is not None and len(key) > 1


def size_in_time(slider, deadline):
    """The size of a slider's chart that is known, or else soon computed; None without one."""
    if not is_mapped(key := key_of(slider)):
        return None
    coarse, fine = SIZES
    for size, limit in ((fine, Deadline(KNOWN)), (coarse, deadline)):
        with contextlib.suppress(TimeUp), limit.part():
            survey(*key, size)
            return size
    return None


def chart(slider, size, deadline):
    """Header and arrays of the answer to "chart" (wire.py): K_fold is NaN where there is none.

    ParameterError where b <= a, for a law that has no chart, and where it takes too long;
    backend.Stopped if it was cancelled.
    """
    return _mapped(slider, size, deadline, {}, lambda key: _arrays(survey(*key, size)))


def window(slider, limits, deadline):
    """The same for the answer to "window": a part of the map.

    limits : first and last K/K_c_qs, first and last eta
    """
    header = {"window": limits}
    return _mapped(slider, WINDOW_SIZE, deadline, header, lambda key: _part(*key, limits))


def _mapped(slider, size, deadline, header, compute):
    """Header and arrays of size x size points, which `compute` gives for the slider's key."""
    check_one_length("the map of regimes", slider.friction_law.name)
    if (key := key_of(slider)) is None:
        raise ParameterError("b <= a: friction never weakens, and there are no regimes to map")
    try:
        with deadline.part():
            header |= {"key": key, "size": size, "eta_bautin": bautin(*key)}
            return header, compute(key)
    except TimeUp:
        raise ParameterError(
            f"{size} x {size} points of the map take more than {deadline.seconds:g} s at "
            f"b/a = {key[1]:.4g}; atlas in Python has no such limit"
        ) from None


@functools.lru_cache(CACHED_CHARTS)
def survey(law, b_over_a, size):
    """The atlas of this size; backend.Stopped past the deadline of the part of the work."""
    return atlas(b_over_a, law, n=size, rtol=RTOL)


def _arrays(data):
    """What the map shows of an atlas."""
    names = ("K_over_K_c_qs", "eta", "regime", "K_c_over_K_c_qs", "K_fold_over_K_c_qs")
    arrays = {name: data[name].values.ravel() for name in names}
    return arrays | {"line_eta": arrays["eta"]}


@functools.lru_cache(CACHED_CHARTS)
def _part(law, b_over_a, limits):
    """The same of a part of the map: regimes of cells, and K_c and K_fold along their edges."""
    pairs = limits[:2], limits[2:]
    edges = [np.geomspace(first, last, WINDOW_SIZE + 1) for first, last in pairs]
    ratio, eta = (np.sqrt(edge[1:] * edge[:-1]) for edge in edges)
    K_c_qs = b_over_a - 1.0
    # As in the atlas: a slider that is its own dimensionless form, and M is eta.
    slider = SpringSlider(
        a=1.0,
        b=b_over_a,
        Dc=1.0,
        sigma=1.0,
        K=xarray.DataArray(K_c_qs * ratio, dims="column"),
        M=xarray.DataArray(eta, dims="row"),
        law=law,
    )
    regime = classify(limit_cycle(slider, 1.0, rtol=RTOL)).regime.transpose("row", "column")
    along = slider.replace(M=xarray.DataArray(edges[1], dims="row"))
    return {
        "K_over_K_c_qs": ratio,
        "eta": eta,
        "regime": np.vectorize(REGIMES.index, otypes=[float])(regime).ravel(),
        "line_eta": edges[1],
        "K_c_over_K_c_qs": along.K_c(1.0).values / K_c_qs,
        "K_fold_over_K_c_qs": folds(law, b_over_a, edges[1]).kappa / K_c_qs,
    }
