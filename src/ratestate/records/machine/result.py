"""The Dataset of `machine_stiffness`."""

import json

import numpy as np
import xarray

from ..kit.regression import mean_with_scatter
from ..kit.results import labelled
from ..messages import machine as sentences
from .inertia import mass_and_damping

NONE = (np.nan, np.nan, np.nan)
#: relative error of K above which a remark warns
UNCERTAIN = 0.2
CURVES = ("slope_friction", "ring_down_friction")


def dataset_of(raw, sigma, slider, slopes, ring_downs):
    """The Dataset, with the attribute ``remarks``.

    slopes, ring_downs : lists of `Slope` and `RingDown`; sigma [Pa]; slider may be None
    """
    used = _used(slopes)
    K = _stiffness(sigma, [slopes[i].curve for i in np.flatnonzero(used)])
    of_rings, M, damping = _inertia(K, sigma, slider, ring_downs)
    values: dict = {}
    for name, numbers in (("K", K), ("M", M), ("damping", damping)):
        values |= dict(zip((name, f"{name}_error", f"{name}_scatter"), numbers, strict=True))
    variables = labelled((), **values) | labelled(
        "slope", **_along_slopes(sigma, slopes), slope_used=used
    )
    variables |= labelled("ring_down", **of_rings)
    variables |= labelled("time", friction=raw.friction, **_curves(raw, slopes, ring_downs))
    result = xarray.Dataset(variables, labelled("time", time=raw.time))
    misfits = sum(not one.curve.fits for one in slopes)
    result.attrs["remarks"] = json.dumps(_remarks(result, slider, misfits))
    return result


def _along_slopes(sigma, slopes):
    """What is known of each slope."""
    curves = [one.curve for one in slopes]
    return {
        "slope_kind": np.array([one.kind for one in slopes], str),
        "slope_start": np.array([one.start for one in slopes]),
        "slope_K": sigma * np.array([curve.k for curve in curves]),
        "slope_K_error": sigma * np.array([curve.k_error for curve in curves]),
        "slope_straight": sigma * np.array([one.straight for one in slopes]),
        "slope_creep": np.array([curve.r for curve in curves]),
    }


def _used(slopes):
    """Which slopes are in K: those of stick phases, a lower bound, only for want of others."""
    fits = np.array([one.curve.fits for one in slopes], bool)
    others = fits & np.array([one.kind != "stick" for one in slopes], bool)
    return others if others.any() else fits


def _stiffness(sigma, curves):
    """K, its error and scatter: of the mean of ln K, whose errors do not depend on its value."""
    ln_k, own, shared = (
        np.array([getattr(one, name) for one in curves])
        for name in ("ln_k", "own_error", "shared_error")
    )
    mean, error, scatter = _mean(ln_k, own, shared)
    K = sigma * float(np.exp(mean))
    return K, K * error, scatter


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
        means.append(_mean(values[:, j], own[:, j], by_K[:, j] * K[1]))
    return along, *means


def _mean(values, own, shared):
    """Mean, error and scatter of values (n,) with independent errors, and shared ones (n,)."""
    if not values.size or not np.isfinite(values).all():
        return NONE
    mean, error, scatter = mean_with_scatter(values, own)
    return mean, float(np.hypot(error, np.average(shared, weights=own**-2.0))), scatter


def _curves(raw, slopes, ring_downs):
    """Fitted curves along time, NaN elsewhere."""
    lines = {name: np.full(raw.time.size, np.nan) for name in CURVES}
    for slope in slopes:
        lines["slope_friction"][slope.rows] = slope.fitted
    for one in ring_downs:
        lines["ring_down_friction"][one.rows] = one.fitted
    return lines


def _remarks(result, slider, misfits):
    """What must be known of the result (list of str).

    misfits : how many slopes the curve does not describe
    """
    texts = [*stiffness_remarks(result)]
    if misfits:
        texts.insert(0, sentences("about.misfit", number=misfits, all=result.sizes["slope"]))
    if not result.sizes["ring_down"]:
        texts.append(sentences("about.no_ring_down"))
        return texts
    at_rest = int((result["ring_down_V"] == 0.0).sum())
    if at_rest:
        texts.append(sentences("about.at_rest", number=at_rest, all=result.sizes["ring_down"]))
    if slider is None and at_rest < result.sizes["ring_down"]:
        texts.append(sentences("about.friction"))
    return texts


def stiffness_remarks(result):
    """What must be known of K (iterator of str)."""
    kinds = result["slope_kind"].values[result["slope_used"].values]
    if not kinds.size:
        yield sentences("about.no_K")
        return
    if float(result["K_scatter"]) > 2.0:
        yield sentences("about.scatter", scatter=float(result["K_scatter"]))
    error = float(result["K_error"] / result["K"])
    if kinds.size == 1:
        yield sentences("about.single", error=100.0 * error)
    elif error > UNCERTAIN:
        yield sentences("about.uncertain", slopes=kinds.size, error=100.0 * error)
    if "stick" in kinds:
        yield sentences("about.stick")
