"""The function `machine_stiffness`: stiffness, mass and damping of a machine from a record."""

import numpy as np
import xarray

from ...dynamics.recipe import versions
from ...dynamics.results import provenance
from ...friction.laws import friction_law
from ...model.conversion import in_si
from ...model.names import keywords_checked
from ...model.slider import SpringSlider
from ...model.units import is_array
from ..kit.least_squares import single_blas
from ..kit.results import kept_attributes
from ..kit.sample_noise import rounding
from ..loading import segments_of
from ..messages import machine as sentences
from ..raw_record import raw_record
from ..reading.sizes import constant_in_si, typical_stress
from ..stick_slip.detection import detected, in_gaps, is_whole
from ..stick_slip.series import record_series
from .means import dataset_of
from .ring_down import ring_down
from .slopes import FEWEST, slopes_of

#: parameters of a slider that are used here
FRICTION = ("a", "b", "Dc")
#: least stress drop, as a fraction of the largest one of a segment; smaller ones are ringing
DROP = 0.3
#: fewest stress drops of a segment, and fraction of it that they last; else it only rings down
CYCLES, LASTING = 3, 0.6


@keywords_checked
def machine_stiffness(data, *, sigma=None, slider=None, loading=None):
    """Measure stiffness, mass and damping of a machine, per area, from a record.

    K follows from the slope of stress against load-point displacement while the spring loads, after
    a hold or a step, or unloads, after a step down.  The fault creeps meanwhile, so the slope is
    less than K.  Each slope is therefore fitted with a curve that includes the creep of the fault
    at constant state, and starts from the friction before the hold or step.  Without such slopes, K
    is the slope between stress drops.  M and the damping follow from free oscillations after a
    step, a hold or a stress drop.

    Parameters
    ----------
    data : xarray.Dataset
        A record from `read_lab`, or a Dataset along ``time`` [s] with ``friction`` (else ``tau``
        with ``sigma`` [Pa]) and ``delta_lp`` [m] or ``V_load`` [m/s] of the load point.
    sigma : float or str, optional
        Normal stress [Pa].  By default the median of the record's normal stress is used.
    slider : SpringSlider, optional
        Slider whose a, b and Dc remove the effect of friction from ring-downs during sliding.  Its
        law must have one state.  Without a slider M is computed as for a machine without friction,
        and the damping includes friction.
    loading : Loading, optional
        The load point's history, with t = 0 at the first sample.  By default it is as recorded.

    Returns
    -------
    xarray.Dataset
        Scalars: ``K`` [Pa/m], ``M`` [kg/m^2] and ``damping`` [Pa s/m], each with ``_error`` and
        ``_scatter``, or NaN if not found.  They are means weighted with the errors (for K, of
        ln K).  If values scatter significantly more than their errors, ``_scatter`` is above 1, and
        the errors are enlarged by it.

        Along ``slope``:

        - ``slope_kind``: "reload", "step_up", "step_down" or "stick".
        - ``slope_start`` [s]; ``slope_K`` and ``slope_K_error`` [Pa/m].
        - ``slope_straight`` [Pa/m]: slope of the best straight line.
        - ``slope_creep``: V/V_lp at the start; 0 between stress drops.
        - ``slope_used``: whether K includes the slope.  The curve must describe it, and "stick" is
          used only without other slopes.

        Along ``ring_down``: ``ring_down_start`` [s] and ``ring_down_V`` [m/s], and with ``_error``
        ``ring_down_omega`` [rad/s], ``ring_down_decay`` [1/s], ``ring_down_M`` and
        ``ring_down_damping``.  Along ``time``: ``friction`` and the fitted curves
        ``slope_friction`` and ``ring_down_friction``, NaN elsewhere.  The attribute ``remarks`` is
        a JSON list of remarks.

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
    period = max((2.0 * np.pi / one.point[0] for one in oscillations), default=0.0)
    slopes = [one for one in slopes if raw.time[one.rows[-1]] - one.start >= period]
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
    return [one for one in ring_downs if one is not None]


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
