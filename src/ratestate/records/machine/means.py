"""Build the Dataset that `machine_stiffness` returns, with means over holds and steps."""

import json

import numpy as np
import xarray

from ...model.quantities import power_of, prefixed_unit, with_error
from ..kit.regression import mean_with_scatter
from ..kit.results import labelled
from ..messages import machine as sentences
from .ring_down import mass_and_damping

#: measured quantities of a machine, and of each ring-down
SYMBOLS, OF_RINGS = ("K", "M", "damping"), ("omega", "decay", "M", "damping")
#: relative error of K, and scatter divided by errors, above which a remark warns
UNCERTAIN, SCATTERED = 0.2, 2.0


def dataset_of(raw, sigma, slider, slopes, ring_downs):
    """Return the Dataset with the attribute ``remarks``.

    slopes, ring_downs : lists of `Slope` and `RingDown`; sigma [Pa]; slider may be None
    """
    fits = np.array([one.is_explained for one in slopes], bool)
    # (slopes of stick phases give only a lower bound of K)
    others = fits & np.array([one.kind != "stick" for one in slopes], bool)
    used = others if others.any() else fits
    # (the mean is of ln K, whose errors do not depend on its value)
    columns = [(one.point[1], one.independent_error, one.shared_error) for one in slopes]
    mean, error, scatter = _mean(*np.array(columns).reshape(-1, 3)[used].T)
    stiffness = sigma * float(np.exp(mean))
    K = stiffness, stiffness * error, scatter
    variables, M, damping = _inertia(K, sigma, slider, ring_downs)
    for name, (value, error, scatter) in zip(SYMBOLS, (K, M, damping), strict=True):
        variables |= labelled((), **{name: (value, error), f"{name}_scatter": scatter})
    errors = sigma * np.array([one.k_error for one in slopes])
    variables |= labelled(
        "slope",
        slope_K=(sigma * np.array([one.k for one in slopes]), errors),
        slope_kind=np.array([one.kind for one in slopes], str),
        slope_start=np.array([one.start for one in slopes]),
        slope_straight=sigma * np.array([one.straight for one in slopes]),
        slope_creep=np.array([one.r for one in slopes]),
        slope_used=used,
    )
    lines: dict = {"slope_friction": slopes, "ring_down_friction": ring_downs}
    variables |= labelled("time", friction=raw.friction)
    for name, found in lines.items():
        line = np.full(raw.time.size, np.nan)
        for one in found:
            line[one.rows] = one.fitted
        variables |= labelled("time", **{name: line})
    result = xarray.Dataset(variables, labelled("time", time=raw.time))
    return result.assign_attrs(remarks=json.dumps(_remarks(result, slider, np.sum(~fits))))


def _inertia(K, sigma, slider, ring_downs):
    """Return variables along ``ring_down``, and mean, error and scatter of M and of damping."""
    values, independent, shared = np.full((3, 2, len(ring_downs)), np.nan)
    for i, one in enumerate(ring_downs):
        values[:, i], jacobian = mass_and_damping(K[0], one, sigma, slider)
        rates = jacobian[:, :2]
        independent[:, i] = np.sqrt(np.einsum("ij,jk,ik->i", rates, one.covariance, rates))
        shared[:, i] = jacobian[:, 2] * K[1]
    rates = np.array([one.point for one in ring_downs]).reshape(-1, 2).T
    errors = np.sqrt([np.diag(one.covariance) for one in ring_downs]).reshape(-1, 2).T
    pairs = zip([*rates, *values], [*errors, *np.hypot(independent, shared)], strict=True)
    variables = labelled(
        "ring_down",
        ring_down_start=np.array([one.start for one in ring_downs]),
        ring_down_V=np.array([one.V for one in ring_downs]),
        **{f"ring_down_{name}": pair for name, pair in zip(OF_RINGS, pairs, strict=True)},
    )
    return variables, *map(_mean, values, independent, shared)


def _mean(values, independent, shared):
    """Return mean, error and scatter of values (n,) with independent and shared errors (n,)."""
    if not values.size or not np.isfinite(values).all():
        return np.nan, np.nan, np.nan
    mean, error, scatter = mean_with_scatter(values, independent)
    return mean, float(np.hypot(error, np.average(shared, weights=independent**-2.0))), scatter


def _remarks(result, slider, misfits):
    """Return remarks (list of str) on the result.

    misfits : number of slopes that the curve does not describe
    """
    rings, at_rest = result.sizes["ring_down"], int((result["ring_down_V"] == 0.0).sum())
    texts = [*stiffness_remarks(result)]
    if misfits:
        texts.insert(0, sentences("about.misfit", number=misfits, all=result.sizes["slope"]))
    if not rings:
        texts.append(sentences("about.no_ring_down"))
    if at_rest:
        texts.append(sentences("about.at_rest", number=at_rest, all=rings))
    if slider is None and at_rest < rings:
        texts.append(sentences("about.friction"))
    return texts


def stiffness_remarks(result):
    kinds = result["slope_kind"].values[result["slope_used"].values]
    if not kinds.size:
        yield sentences("about.no_K")
        return
    if float(result["K_scatter"]) > SCATTERED:
        yield sentences("about.scatter", scatter=float(result["K_scatter"]))
    error = float(result["K_error"] / result["K"])
    if kinds.size == 1:
        yield sentences("about.single", error=100.0 * error)
    elif error > UNCERTAIN:
        yield sentences("about.uncertain", slopes=kinds.size, error=100.0 * error)
    if "stick" in kinds:
        yield sentences("about.stick")


def estimate(result, symbol):
    """Return a line such as ``K = 20.03 +- 0.07 GPa/m``."""
    value, error = float(result[symbol]), float(result[f"{symbol}_error"])
    if value != value:
        return f"{symbol}: not found"
    return f"{symbol} = {value_with_unit(value, error, result[symbol].attrs['units'])}"


def value_with_unit(value, error, unit, power=None):
    """Format value +- error in a readable unit, or with this power of ten; "-" for NaN."""
    if value != value:
        return "-"
    power = power_of(unit, value) if power is None else power
    number = with_error(value / 10.0**power, error / 10.0**power)
    return f"{number} {prefixed_unit(unit, power)}"
