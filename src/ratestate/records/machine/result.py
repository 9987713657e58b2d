"""The Dataset of `machine_stiffness`."""

import json

import numpy as np
import xarray

from ..fitting.result import labelled
from ..regression import mean_with_scatter
from .inertia import mass_and_damping
from .messages import message

NONE = (np.nan, np.nan, np.nan)


def dataset_of(raw, sigma, slider, slopes, ring_downs):
    """The Dataset, with the attribute ``remarks``.

    slopes, ring_downs : lists of `Slope` and `RingDown`; sigma [Pa]; slider may be None
    """
    along = _along_slopes(sigma, slopes)
    used = _best_kinds(along["slope_kind"], along["slope_used"])
    k = along["slope_K"][used], along["slope_K_error"][used]
    K = mean_with_scatter(*k) if used.any() else NONE
    of_rings, M, damping = _inertia(K, sigma, slider, ring_downs)
    values: dict = {}
    for name, numbers in (("K", K), ("M", M), ("damping", damping)):
        values |= dict(zip((name, f"{name}_error", f"{name}_scatter"), numbers, strict=True))
    variables = labelled((), **values) | labelled("slope", **along)
    variables |= labelled("ring_down", **of_rings)
    variables |= labelled("time", friction=raw.friction, **_curves(raw, slopes, ring_downs))
    result = xarray.Dataset(variables, labelled("time", time=raw.time))
    result.attrs["remarks"] = json.dumps(_remarks(result, slider))
    return result


def _along_slopes(sigma, slopes):
    """What is known of each slope."""
    curves = [one.curve for one in slopes]
    straight = [np.polyfit(one.x, one.curve.at(one.x), 1)[0] for one in slopes]
    return {
        "slope_kind": np.array([one.kind for one in slopes], str),
        "slope_start": np.array([one.start for one in slopes]),
        "slope_K": sigma * np.array([curve.k for curve in curves]),
        "slope_K_error": sigma * np.array([curve.k_error for curve in curves]),
        "slope_straight": sigma * np.array(straight),
        "slope_creep": np.array([curve.r for curve in curves]),
        "slope_used": np.array([curve.fits for curve in curves], bool),
    }


def _best_kinds(kinds, used):
    """Which slopes are in K: those of stick phases, a lower bound, only for want of others."""
    others = used & (kinds != "stick")
    return others if others.any() else used


def _inertia(K, sigma, slider, ring_downs):
    """Variables along ``ring_down``, and M and damping: mean, error and scatter."""
    n = len(ring_downs)
    values, own, by_K = np.full((n, 2), np.nan), np.full((n, 2), np.nan), np.zeros((n, 2))
    for i, one in enumerate(ring_downs):
        values[i], by, by_K[i] = mass_and_damping(K[0], one, sigma, slider)
        own[i] = np.sqrt(np.einsum("ij,jk,ik->i", by, one.covariance, by))
    errors = np.hypot(own, by_K * K[1])
    point = np.array([[one.omega, one.decay] for one in ring_downs]).reshape(n, 2)
    point_errors = np.sqrt([np.diag(one.covariance) for one in ring_downs]).reshape(n, 2)
    along: dict = {
        "ring_down_start": np.array([one.start for one in ring_downs]),
        "ring_down_V": np.array([one.V for one in ring_downs]),
    }
    for j, name in enumerate(("omega", "decay")):
        along[f"ring_down_{name}"] = point[:, j]
        along[f"ring_down_{name}_error"] = point_errors[:, j]
    means = []
    for j, name in enumerate(("M", "damping")):
        along[f"ring_down_{name}"], along[f"ring_down_{name}_error"] = values[:, j], errors[:, j]
        means.append(_mean(values[:, j], own[:, j], by_K[:, j], K))
    return along, *means


def _mean(values, own, by_K, K):
    """Mean, error and scatter of values (n,), whose errors but those by K's are independent."""
    if not values.size or not np.isfinite(K[0]):
        return NONE
    mean, error, scatter = mean_with_scatter(values, own)
    common = float(np.average(by_K, weights=own**-2.0)) * K[1]
    return mean, float(np.hypot(error, common)), scatter


def _curves(raw, slopes, ring_downs):
    """Fitted curves along time, NaN elsewhere."""
    lines = {name: np.full(raw.time.size, np.nan) for name in CURVES}
    for slope in slopes:
        lines["slope_friction"][slope.rows] = slope.curve.at(slope.x)
    for one in ring_downs:
        lines["ring_down_friction"][one.rows] = one.fitted
    return lines


CURVES = ("slope_friction", "ring_down_friction")


def _remarks(result, slider):
    """What must be known of the result (list of str)."""
    texts = []
    used = result["slope_used"].values
    if not used.all():
        texts.append(message("about.misfit", number=int((~used).sum()), all=used.size))
    if not used.any():
        texts.append(message("about.no_K"))
    elif float(result["K_scatter"]) > 2.0:
        texts.append(message("about.scatter", scatter=float(result["K_scatter"])))
    if used.any() and bool((result["slope_kind"].values[used] == "stick").all()):
        texts.append(message("about.stick"))
    if not result.sizes["ring_down"]:
        texts.append(message("about.no_ring_down"))
    elif slider is None and bool((result["ring_down_V"] > 0.0).any()):
        texts.append(message("about.friction"))
    return texts
