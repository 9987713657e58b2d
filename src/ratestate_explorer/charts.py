"""The map of regimes, with K_c and the atlas, first coarse, then finer, cached by law and b/a."""

import contextlib
import functools

import numpy as np
import xarray

import ratestate as rs

from .deadline import Deadline, TimeUp

#: points along either axis: of a coarse chart, then of a finer one; and of a window
SIZES, WINDOW_SIZE = (24, 72), 49
RTOL = 1e-4
#: seconds that a chart or a window may take, and how many charts are cached
SECONDS, CACHED_CHARTS = 20.0, 80
#: seconds for a chart that is cached
KNOWN = 0.2
#: the range of the map: K/K_c_qs and eta
SPAN = {"ratio": (1e-2, 1e3), "eta": (1e-16, 1e4)}
WHOLE = (*SPAN["ratio"], *SPAN["eta"])
#: points of the line of K_c
POINTS = 241


def line(slider, V_lp, K_c_qs):
    """Return arrays of K_c/K_c_qs along eta, which M changes; empty if K_c_qs <= 0."""
    if K_c_qs <= 0.0:
        return {"line_eta": np.empty(0), "line_ratio": np.empty(0)}
    eta = np.geomspace(*SPAN["eta"], POINTS)
    M = eta * (slider.sigma * slider.a * slider.Dc / V_lp**2)
    K_c = slider.replace(M=xarray.DataArray(M, dims="point")).K_c(V_lp)
    return {"line_eta": eta, "line_ratio": K_c.values / K_c_qs}


def key_of(slider):
    """Return what selects a slider's chart: law, and b/a with (b - a)/a to 3 digits.

    None if b <= a.  The name of the composed law alone if there is no chart for it.
    """
    if not slider.friction_law.one_length:
        return (slider.friction_law.name,)
    weakening = float(f"{(slider.b - slider.a) / slider.a:.3g}")
    return (slider.law, 1.0 + weakening) if 1.0 + weakening > 1.0 else None


def is_mapped(key):
    """Return whether there is an atlas for this `key_of` a slider."""
    return key is not None and len(key) > 1


def size_in_time(slider, deadline):
    """Return the size of a slider's chart that is known or soon computed; None without one."""
    if not is_mapped(key := key_of(slider)):
        return None
    coarse, fine = SIZES
    for size, limit in ((fine, Deadline(KNOWN)), (coarse, deadline)):
        with contextlib.suppress(TimeUp), limit.part():
            survey(*key, size)
            return size
    return None


def chart(slider, size, deadline, limits=WHOLE):
    """Return header and arrays of the answer to "chart" (wire.py); K_fold may be NaN.

    limits : first and last K/K_c_qs, first and last eta

    ParameterError if b <= a, for a law without a chart, and if it takes too long; `Stopped`
    if it was cancelled.
    """
    key = key_of(slider)
    if key is None:
        raise rs.ParameterError("b <= a: friction never weakens, and there are no regimes to map")
    if not is_mapped(key):
        raise rs.ParameterError(
            f"law = {slider.law!r} with friction_form = {slider.friction_form!r} and damping = "
            f"{slider.damping:g} Pa s/m has no map of regimes: the motion does not depend only on "
            f"eta and K/K_c_qs. In Python ratestate.atlas maps laws with parameters of their own."
        )
    try:
        with deadline.part():
            data = survey(*key, size, limits)
    except TimeUp:
        raise rs.ParameterError(
            f"{size} x {size} points of the map take more than {deadline.seconds:g} s at "
            f"b/a = {key[1]:.4g}. In Python atlas has no such limit."
        ) from None
    eta_bautin = float(data.eta_bautin)
    header = {
        "key": key,
        "size": size,
        "window": limits,
        "eta_bautin": None if np.isnan(eta_bautin) else eta_bautin,
        "regimes": [x.replace("_", " ") for x in data.regime.attrs["flag_meanings"].split()],
    }
    names = ("K_over_K_c_qs", "eta", "regime", "K_c_over_K_c_qs", "K_fold_over_K_c_qs")
    return header, {name: data[name].values.ravel() for name in names}


@functools.lru_cache(CACHED_CHARTS)
def survey(law, b_over_a, size, limits=WHOLE):
    """Return the atlas of this size; `Stopped` past the deadline of the part of the work."""
    ratio, eta = limits[:2], limits[2:]
    return rs.atlas(
        b_over_a, law, n=size, rtol=RTOL, eta=eta, K_over_K_c_qs=ratio, transition=False
    )
