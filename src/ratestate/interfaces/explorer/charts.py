"""What is behind the map: K_c, and the atlas, which is coarse, and cached for each law and b/a."""

import functools

import numpy as np
import xarray

from ...dynamics.atlas import ETA, STIFFNESS, atlas
from ...dynamics.refusals import check_one_length
from ...errors import ParameterError
from .budget import TimeUp

#: points along either axis: first a coarse chart, then a finer one
SIZES = (24, 72)
RTOL = 1e-4
#: seconds that a chart may take, and how many are cached
SECONDS, CACHED_CHARTS = 8.0, 40


#: the range of the map
SPAN = {"eta": ETA, "ratio": STIFFNESS}
#: points of the line of K_c
POINTS = 241


def line(slider, V_lp, K_c_qs):
    """Arrays of K_c over K_c_qs > 0 along eta, which M changes; empty where K_c_qs <= 0."""
    if K_c_qs <= 0.0:
        return {"line_eta": np.empty(0), "line_ratio": np.empty(0)}
    eta = np.geomspace(*ETA, POINTS)
    M = xarray.DataArray(eta * (slider.sigma * slider.a * slider.Dc / V_lp**2), dims="eta")
    return {"line_eta": eta, "line_ratio": slider.replace(M=M).K_c(V_lp).values / K_c_qs}


def key_of(slider):
    """What selects a slider's chart: law, and b/a with (b - a)/a to 3 digits; None where b <= a.

    The name of the law, with what it is composed with, alone where there is no chart for it.
    """
    if not slider.friction_law.one_length:
        return (slider.friction_law.name,)
    weakening = float(f"{(slider.b - slider.a) / slider.a:.3g}")
    return (slider.law, 1.0 + weakening) if 1.0 + weakening > 1.0 else None


def chart(slider, size, deadline):
    """Header and arrays of the answer to "chart" (wire.py).

    ParameterError where b <= a, for a law that has no chart, and where it takes too long;
    backend.Stopped if it was cancelled.
    """
    check_one_length("the map of regimes", slider.friction_law.name)
    if (key := key_of(slider)) is None:
        raise ParameterError("b <= a: friction never weakens, and there are no regimes to map")
    try:
        with deadline.part():
            return {"key": key, "size": size}, _arrays(*key, size)
    except TimeUp:
        raise ParameterError(
            f"{size} x {size} points of the map take more than {deadline.seconds:g} s at "
            f"b/a = {key[1]:.4g}; atlas in Python has no such limit"
        ) from None


@functools.lru_cache(CACHED_CHARTS)
def _arrays(law, b_over_a, size):
    """What the map shows of the atlas of this size."""
    data = atlas(b_over_a, law, n=size, rtol=RTOL)
    names = ("K_over_K_c_qs", "eta", "regime", "K_c_over_K_c_qs")
    arrays = {name: data[name].values.ravel() for name in names}
    return arrays | {"jumps": data.type.values == "subcritical"}
