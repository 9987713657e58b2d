"""The atlas behind the map: coarse, and cached for each law and b/a."""

import functools

import numpy as np

from ...dynamics.atlas import ETA, STIFFNESS, atlas
from ...errors import ParameterError
from ...friction.stability import K_c
from .budget import TimeUp

#: points along either axis: first a coarse chart, then a finer one
SIZES = (24, 72)
RTOL = 1e-4
#: seconds that a chart may take, and how many are cached
SECONDS, CACHED_CHARTS = 8.0, 40


def frame():
    """Header and arrays common to all maps: the range, and K_c over K_c_qs along eta (eq. 6)."""
    eta = np.geomspace(*ETA, 241)
    # a = Dc = sigma = V = 1 and b = 2: K_c_qs is 1, and M is eta.
    ratio = K_c(1.0, a=1.0, b=2.0, Dc=1.0, sigma=1.0, M=eta)
    return {"eta": ETA, "ratio": STIFFNESS}, {"line_eta": eta, "line_ratio": ratio}


def key_of(slider):
    """(law, b/a with (b - a)/a to 3 digits), which select a slider's chart; None where b <= a."""
    weakening = float(f"{(slider.b - slider.a) / slider.a:.3g}")
    return (slider.law, 1.0 + weakening) if 1.0 + weakening > 1.0 else None


def chart(slider, size, deadline):
    """Header and arrays of the answer to "chart" (wire.py).

    ParameterError where b <= a, and where it takes too long; backend.Stopped if it was cancelled.
    """
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
