"""The function `machine_stiffness`: stiffness, mass and damping of a machine from a record."""

import json

import numpy as np
import xarray

from ...dynamics.recipe import versions
from ...dynamics.results import provenance
from ...friction.laws import friction_law
from ...model.conversion import in_si
from ...model.names import keywords_checked
from ...model.quantities import power_of, prefixed_unit, with_error
from ...model.slider import SpringSlider
from ...model.units import is_array
from ..kit import kept_attributes, labelled
from ..kit.least_squares import single_blas
from ..kit.regression import mean_with_scatter
from ..kit.sample_noise import rounding
from ..messages import machine as sentences
from ..raw_record import raw_record, segments_of
from ..reading.sizes import constant_in_si, typical_stress
from ..stick_slip.detection import detected, in_gaps, is_whole
from ..stick_slip.series import record_series
from .ring_down import mass_and_damping, ring_down
from .slopes import FEWEST, slopes_of

#: parameters of a slider that are used here
FRICTION = ("a", "b", "Dc")
#: least stress drop, as a fraction of the largest one of a segment; smaller ones are ringing
DROP = 0.3
#: fewest stress drops of a segment, and fraction of it that they last; else it only rings down
CYCLES, LASTING = 3, 0.6
#: measured quantities of a machine, and of each ring-down
SYMBOLS, OF_RINGS = ("K", "M", "damping"), ("omega", "decay", "M", "damping")
#: relative error of K, and scatter divided by errors, above which a remark warns
UNCERTAIN, SCATTERED = 0.2, 2.0


@keywords_checked
def machine_stiffness(data, *, sigma=None, slider=None, loading=None):
    """Measure stiffness, mass and damping of a machine, per area, from a record.

    K follows from the slope of stress against load-point displacement while the spring loads, after
    a hold or a step, or unloads, after a step down.  The fault creeps meanwhile, so the slope is
    less than K.  Each slope is therefore fitted with a curve that includes the creep of the fault
    at constant state, and starts from the friction before the hold or step.  Without such slopes, K
    is the slope between stress drops, a lower bound.  M and the damping follow from free
    oscillations after a step, a hold or a stress drop.

    Parameters
    ----------
    data : xarray.Dataset
        A record from `read_lab`, or a Dataset along ``time`` [s] with ``friction`` (else ``tau``
        with ``sigma`` [Pa]) and ``delta_lp`` [m] or ``V_load`` [m/s] of the load point.
    sigma : float or str, optional
        Normal stress [Pa].  By default the median of the record's normal stress is used.
    slider : SpringSlider, optional
        Slider whose a, b and Dc, single numbers, remove the effect of friction from ring-downs
        during sliding.  Its law must have one state, one slip distance and the friction of eq. 1.
        Its K and M are not used.  Without a slider M is computed as for a machine without friction,
        and the damping includes friction.
    loading : Loading, optional
        The load point's history, with t = 0 at the first sample.  By default the recorded motion is
        used.

    Returns
    -------
    xarray.Dataset
        Scalars: ``K`` [Pa/m], ``M`` [kg/m^2] and ``damping`` [Pa s/m], each with ``_error`` and
        ``_scatter``, or NaN if not found.  ``_scatter`` needs two values.  Without K, M and damping
        are NaN too.  M, damping and ln K are means weighted with the errors.  If values scatter
        significantly more than their errors, ``_scatter`` is above 1, and enlarges the errors.

        Along ``slope``, which has size 0 if no slope is resolved:

        - ``slope_kind``: "reload", "step_up", "step_down" or "stick".
        - ``slope_start`` [s]; ``slope_K`` and ``slope_K_error`` [Pa/m].
        - ``slope_straight`` [Pa/m]: slope of the best straight line.
        - ``slope_creep``: V/V_lp at the start; 0 between stress drops.
        - ``slope_used``: whether K includes the slope.  The curve must describe it, and "stick" is
          used only without other slopes.

        Along ``ring_down``, which has size 0 without free oscillations:

        - ``ring_down_start`` [s]; ``ring_down_V`` [m/s].
        - ``ring_down_omega`` [rad/s] and ``ring_down_decay`` [1/s], with ``_error``.
        - ``ring_down_M`` [kg/m^2] and ``ring_down_damping`` [Pa s/m], with ``_error``.

        Along ``time``: ``friction`` and the fitted curves ``slope_friction`` and
        ``ring_down_friction``, which are NaN outside their windows.  The attribute ``remarks`` is a
        JSON list of remarks.

    Raises
    ------
    ParameterError
        If the record cannot be used, no normal stress is known, neither a slope nor an oscillation
        is resolved, or a setting is out of range.

    Notes
    -----
    While the block slides, friction changes the frequency by a fraction of the order of
    b sigma Dc/(K L^2), with L = V/omega, and adds a damping of about a sigma/V (linear theory:
    eq. 4 at steady sliding).  With a slider both effects are removed.  In this model the direct
    effect overdamps a block at rest.  Ringing while the load point is at rest is thus a mode of the
    machine, and a remark says so.

    Examples
    --------
    >>> import numpy as np, ratestate as rs
    >>> slider = rs.SpringSlider(a=0.01, b=0.012, Dc="5 um", sigma="5 MPa", K="8 GPa/m")
    >>> loading = rs.Loading.steps("10 um/s", (20, 0), (120, "10 um/s"))
    >>> run = rs.simulate(slider, loading, 140.0, times=np.linspace(0, 140, 14001))
    >>> noise = 1e-4 * np.random.default_rng(1).normal(size=14001)
    >>> record = run[["delta_lp"]].assign(friction=run.tau / slider.sigma + noise)
    >>> result = rs.machine_stiffness(record, sigma="5 MPa")
    >>> bool(abs(result.K - 8e9) < 2 * result.K_error), bool(result.K_error < 2e8)
    (True, True)
    """
    _check_slider(slider)
    data = in_si(data)
    sigma = _normal_stress(data, sigma)
    # (stress is divided by the same normal stress by which K is multiplied)
    with_sigma = data.assign(sigma=sigma) if isinstance(data, xarray.Dataset) else data
    raw = raw_record(with_sigma, None)
    segments = segments_of(raw, loading)
    with single_blas():
        drops = stress_drops(raw, sigma, segments)
        oscillations = _ring_downs(raw, segments, drops)
        slopes = slopes_of(raw.time, raw.friction, segments, drops)
    # (a slope that is as fast as the machine's oscillations is not quasi-static)
    period = max((2.0 * np.pi / ring.point[0] for ring in oscillations), default=0.0)
    slopes = [slope for slope in slopes if raw.time[slope.rows[-1]] - slope.start >= period]
    if not slopes and not oscillations:
        raise sentences.refusal("record.nothing", samples=FEWEST)
    origin = {"title": "ratestate machine_stiffness", "versions": versions()}
    if slider is not None:
        origin = provenance("machine_stiffness", slider)
    result = dataset_of(raw, sigma, slider, slopes, oscillations)
    return result.assign_attrs(origin | {"sigma": sigma} | kept_attributes(data))


def _check_slider(slider):
    """Raise ParameterError unless the slider has one a, b and Dc, and a law with one state."""
    if slider is None:
        return
    if not isinstance(slider, SpringSlider):
        raise sentences.refusal("slider.unlike", type=type(slider).__name__)
    for symbol in FRICTION:
        if is_array(getattr(slider, symbol)):
            raise sentences.refusal("slider.array", symbol=symbol)
    if not friction_law(slider.law).one_length or slider.friction_form != "log":
        raise sentences.refusal("slider.two_states", law=slider.law)


def _normal_stress(data, sigma):
    if sigma is not None:
        return constant_in_si("sigma", sigma)
    if "sigma" not in getattr(data, "variables", {}):
        raise sentences.refusal("record.no_sigma")
    return typical_stress(data["sigma"].values)


def _ring_downs(raw, segments, drops):
    t, ring_downs = raw.time, []
    for start, end, V, times in zip(segments.t, segments.ends, segments.V, drops, strict=True):
        rows = np.arange(*np.searchsorted(t, (start, end)))[1:]
        peaks = np.searchsorted(t[rows], times[:, 0])
        parts = np.split(rows, peaks)[1:] if peaks.size else [rows]
        ring_downs += [ring_down(t, raw.friction, part, float(V)) for part in parts if part.size]
    return [found for found in ring_downs if found is not None]


def stress_drops(raw, sigma, segments):
    """Return starts and ends [s] of the stress drops (m, 2) in each of the `Segments`.

    They are times of samples, which is enough: the fits begin and end well between stress drops.
    """
    tau, resolution = raw.friction * sigma, rounding(raw.friction) * sigma
    series, falls, *_ = detected(record_series(raw.time, tau, segments, resolution))
    samples = falls[is_whole(falls) & ~in_gaps(series.t, falls)]
    times, drops = series.t[samples], series.tau[samples] @ (1.0, -1.0)
    chosen = []
    for begin, end in zip(segments.t, segments.ends, strict=True):
        inside = (times[:, 0] >= begin) & (times[:, 1] <= end)
        large = inside & (drops > DROP * drops[inside].max(initial=0.0))
        continues = large.sum() >= CYCLES and times[large, 0][-1] > begin + LASTING * (end - begin)
        chosen.append(times[large & continues])
    return chosen


def dataset_of(raw, sigma, slider, slopes, ring_downs):
    """Return the Dataset with the attribute ``remarks``.

    slopes, ring_downs : lists of `Slope` and `RingDown`; sigma [Pa]; slider may be None
    """
    fits = np.array([slope.is_explained for slope in slopes], bool)
    # (slopes of stick phases give only a lower bound of K)
    not_stick = fits & np.array([slope.kind != "stick" for slope in slopes], bool)
    used = not_stick if not_stick.any() else fits
    # (the mean is of ln K, whose errors do not depend on its value)
    columns = [(slope.point[1], slope.independent_error, slope.shared_error) for slope in slopes]
    mean, error, scatter = _mean(*np.array(columns).reshape(-1, 3)[used].T)
    stiffness = sigma * float(np.exp(mean))
    K = stiffness, stiffness * error, scatter
    variables, M, damping = _inertia(K, sigma, slider, ring_downs)
    for name, (value, error, scatter) in zip(SYMBOLS, (K, M, damping), strict=True):
        variables |= labelled((), **{name: (value, error), f"{name}_scatter": scatter})
    errors = sigma * np.array([slope.k_error for slope in slopes])
    variables |= labelled(
        "slope",
        slope_K=(sigma * np.array([slope.k for slope in slopes]), errors),
        slope_kind=np.array([slope.kind for slope in slopes], str),
        slope_start=np.array([slope.start for slope in slopes]),
        slope_straight=sigma * np.array([slope.straight for slope in slopes]),
        slope_creep=np.array([slope.r for slope in slopes]),
        slope_used=used,
    )
    lines: dict = {"slope_friction": slopes, "ring_down_friction": ring_downs}
    variables |= labelled("time", friction=raw.friction)
    for name, found in lines.items():
        line = np.full(raw.time.size, np.nan)
        for fit in found:
            line[fit.rows] = fit.fitted
        variables |= labelled("time", **{name: line})
    result = xarray.Dataset(variables, labelled("time", time=raw.time))
    return result.assign_attrs(remarks=json.dumps(_remarks(result, slider, np.sum(~fits))))


def _inertia(K, sigma, slider, ring_downs):
    """Return variables along ``ring_down``, and mean, error and scatter of M and of damping."""
    values, independent, shared = np.full((3, 2, len(ring_downs)), np.nan)
    for i, ring in enumerate(ring_downs):
        values[:, i], jacobian = mass_and_damping(K[0], ring, sigma, slider)
        rates = jacobian[:, :2]
        independent[:, i] = np.sqrt(np.einsum("ij,jk,ik->i", rates, ring.covariance, rates))
        shared[:, i] = jacobian[:, 2] * K[1]
    rates = np.array([ring.point for ring in ring_downs]).reshape(-1, 2).T
    errors = np.sqrt([np.diag(ring.covariance) for ring in ring_downs]).reshape(-1, 2).T
    pairs = zip([*rates, *values], [*errors, *np.hypot(independent, shared)], strict=True)
    variables = labelled(
        "ring_down",
        ring_down_start=np.array([ring.start for ring in ring_downs]),
        ring_down_V=np.array([ring.V for ring in ring_downs]),
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
    if slider is None and at_rest < rings and np.isfinite(result["damping"]):
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
