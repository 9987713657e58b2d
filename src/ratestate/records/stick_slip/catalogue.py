"""The catalogue: detect and measure the events of a series, with status and message of each.

The slip is delta = delta_lp - tau/K.  So the slip in an event is the change of delta_lp plus
drop/K, and the slip rate is V_lp - (dtau/dt)/K.  The spring's work on the block is the integral of
tau over slip: the integral over delta_lp plus (tau_max^2 - tau_min^2)/(2 K), the energy that the
spring loses.  At both ends of an event the slip rate is V_lp, so the kinetic energy is equal, and
friction (with any damping) turns all of this work into heat.
"""

import math

import numpy as np
import xarray

from ...dynamics.recipe import versions
from ...dynamics.results import flags
from ...model.names import keywords_checked
from ..kit import labelled
from ..messages import stick_slip as sentences
from .between_samples import has_several, has_step_down
from .detection import detected, in_gaps, is_whole, loading_phases
from .falls import measured_falls, spans_of
from .lines import Stiffness, Trend, loading_stiffness, trend
from .series import series_of

#: stress drop divided by the threshold below which similar drops may be missing
SAFE_RATIO = 2.0
#: stress drop with few samples, as a multiple of the median, that may be several events
LARGE = 1.5
#: least peak slip rate of a fast event: fraction of the inertial limit, or multiple of V_lp
INERTIAL, FAST = 0.5, 100.0
#: most samples of the record that a catalogue keeps, for its figure
MAX_SAMPLES = 20000
#: status of an event -> what it means
STATUSES = {
    0: "whole",
    1: "cut by the start",
    2: "cut by the end",
    3: "V_lp changes",
    4: "undersampled",
    5: "gap in the record",
    6: "several events",
}
WHOLE, CUT_BY_START, CUT_BY_END, LOAD_CHANGES, UNDERSAMPLED, GAP, SEVERAL = STATUSES


@keywords_checked
def events(data, *, K=None, M=None, sigma=None):
    """Find the stick-slip events of a record or a run, with standard errors.

    An event is a fall of the shear stress, from a maximum to the next minimum, that is too large
    for noise.  During the fall slip is faster than the load point.  A smooth oscillation has one
    event in each period.

    Parameters
    ----------
    data : xarray.Dataset
        A record from `read_lab` (``friction`` or ``tau``, ``delta_lp`` or ``V_load``, and perhaps
        ``sigma``), or a run of one slider from `simulate` with many saved times.
    K : float, str or pint.Quantity, optional
        Stiffness per area [Pa/m].  By default the stiffness of the run's slider is used.  For a
        record it is estimated from the loading between events.
    M : float, str or pint.Quantity, optional
        Mass per area [kg/m^2], if it is known.  By default the mass of the run's slider is used.
    sigma : float, str or pint.Quantity, optional
        Normal stress [Pa].  It is needed if the record has friction but no normal stress, and
        replaces a recorded normal stress.

    Returns
    -------
    xarray.Dataset
        Along ``event``, 1 to n in order of time, with standard errors ``NAME_error``:

        - ``event_start`` and ``event_end`` [s]: times of the largest and smallest stress.
        - ``event_time`` [s]: when the stress is midway between them.
        - ``tau_max``, ``tau_min`` and ``stress_drop`` [Pa]; ``friction_drop``, if sigma is known.
        - ``recurrence`` [s]: time since the ``event_time`` of the previous event, if there is one.
        - ``duration`` [s], ``slip`` [m], ``peak_slip_rate`` [m/s], ``V_lp`` [m/s].
        - ``friction_work`` [J/m^2]: the integral of tau over slip.
        - ``spring_energy`` [J/m^2]: the energy that the spring loses.

        Slip, its rate and the energies are NaN if K is unknown.

        Without errors: ``event_kind`` is "fast" if the peak slip rate is at least half the inertial
        limit stress_drop/(2 sqrt(K M)), or at least 100 V_lp if M is unknown.  It is "unknown" if
        the peak slip rate is NaN, and "slow" otherwise, also if M = 0.
        ``samples_in_fall`` is the number of samples in the fall.  ``event_status`` (int8 with CF
        flags) is 0 for a whole event.  ``event_message`` explains NaN and gives remarks.

        Along ``abscissa`` ("recurrence", "V_lp"): the line stress_drop = A + B log10(x), with x in
        SI.  It is fitted to whole events with constant V_lp during the loading before them.
        ``trend_A`` and ``trend_B`` [Pa] have errors.  ``trend_events`` is the number of events,
        and ``trend_message`` explains NaN.

        Scalars: ``K`` and ``K_error`` [Pa/m], NaN if unknown; ``tau_noise`` [Pa] and
        ``tau_noise_correlation`` of neighbouring samples, from the loading;
        ``detection_threshold`` [Pa], the smallest stress drop that can be found.  For a run,
        ``K_error``, noise and correlation are 0.  Along ``time``: ``tau``, thinned if it is long.
        Without events ``event`` has size 0.

    Raises
    ------
    ParameterError
        If the data are not a record or a run of one slider, a value cannot be used, or the record
        has friction but no normal stress.

    Notes
    -----
    In a run, peaks are found on cubics that match tau and its slope.  In a record, a polynomial is
    fitted around each peak, because the largest sample is biased by noise.  The fitted window is as
    wide as possible without a misfit beyond the noise.  Errors follow from the noise in the loading
    phases, white or correlated.  Errors of slip, slip rate and energies include the error of K,
    which all events share.  Every error includes the rounding of stresses and times to the record's
    digits.  A peak or trough may lie between two samples.  If the events show this on average, the
    lines through the samples on either side are extended until they meet.  The extreme is placed
    halfway between its sample and this point, and their distance is its error.  The duration is NaN
    if it is less than one step between samples.

    Two events count as one if the loading between them raises the stress by less than the detection
    threshold.  A fall that slows down and speeds up again is several events (status 6), and its
    errors cover the values of each of them.  A message reports a stress drop with few samples that
    exceeds 1.5 times the median, because it may be several events.  Messages also report a smaller
    fall during the loading before an event, and a stress drop below twice the threshold, because
    similar events may then be missing.

    If the middle half of a fall has fewer than 8 samples, the peak slip rate is the mean slip rate
    there, a lower bound without an error (NaN).

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.005, b=0.008, Dc="10 um", sigma="4 MPa", M=100, K="960 MPa/m")
    >>> run = rs.simulate(slider, rs.Loading.constant("10 um/s"), t_end=200, V_start="5 um/s")
    >>> catalogue = rs.events(run)
    >>> [round(float(x[-1]), 3) for x in (catalogue.friction_drop, catalogue.recurrence)]
    [0.061, 29.975]
    """
    series = series_of(data, K, M, sigma)
    catalogue, stiffness = catalogue_of(series)
    names = ("source", "scenario", "slider")
    kept = {name: data.attrs[name] for name in names if name in data.attrs}
    mass = {} if series.M is None else {"M": series.M}
    return catalogue.assign_attrs(
        title="ratestate events", **kept, **mass, stiffness=stiffness.text, versions=versions()
    )


def catalogue_of(series):
    """Return the Dataset of the events of a `Series`, and the `Stiffness`."""
    cleaned, falls, noise, threshold = detected(series)
    stiffness = Stiffness(series.K, 0.0, series.K_source)
    if series.K is None:
        phases = loading_phases(series, falls)
        stiffness = loading_stiffness(series, phases, falls[is_whole(falls)], noise)
    gaps = in_gaps(series.t, falls)
    measured = measured_falls(series, falls, gaps, noise)
    status, is_lost = _status(cleaned, falls, gaps, measured, noise)
    values = _quantities(series, measured, stiffness, status == SEVERAL)
    steps = np.diff(series.t, prepend=series.t[0])
    longest = [steps[max(i, 0) : max(i, j, 0) + 1].max() for i, j in falls]
    short = values["duration"][0] < longest
    values["duration"] = tuple(np.where(short, math.nan, x) for x in values["duration"])
    values["recurrence"], why = _recurrence(series, values["event_time"], status)
    drop = values["stress_drop"][0]
    typical = np.nanmedian(drop) if np.isfinite(drop).any() else math.inf
    sparse, cut = measured["sparse"], np.isin(status, (CUT_BY_START, CUT_BY_END))
    messages = {
        "start": status == CUT_BY_START,
        "end": status == CUT_BY_END,
        "load": status == LOAD_CHANGES,
        "gap": status == GAP,
        "several": status == SEVERAL,
        "unmeasured": np.isin(status, (WHOLE, UNDERSAMPLED)) & ~np.isfinite(drop),
        "sparse": sparse & np.isfinite(drop) & np.isin(status, (UNDERSAMPLED, SEVERAL)),
        "few": drop < SAFE_RATIO * threshold,
        "lost": is_lost,
        "short": short,
        "large": sparse & (drop > LARGE * typical) & (status != SEVERAL),
        **{name: ~cut & (why == name) for name in ("first", "changed", "after_cut")},
        "no_stiffness": np.full(status.size, not math.isfinite(stiffness.K)),
    }
    texts = [
        "; ".join(sentences(f"message.{name}") for name, holds in messages.items() if holds[k])
        for k in range(status.size)
    ]
    variables = labelled(
        "event",
        **values,
        event_kind=_kinds(values, stiffness.K, series.M),
        samples_in_fall=measured["samples"],
        event_status=status.astype(np.int8),
        event_message=np.array(texts, dtype=str if texts else object),
    )
    variables["event_status"][2].update(flags(STATUSES))
    # whole events with one V_lp since the last event
    is_complete = np.isin(status, (WHOLE, UNDERSAMPLED)) & np.isfinite(values["recurrence"][0])
    steady_drop, V_lp = np.where(is_complete, drop, math.nan), values["V_lp"][0]
    labels = {"recurrence": "the recurrence interval", "V_lp": "V_lp"}
    lines = {name: trend(values[name][0], steady_drop, V_lp, x) for name, x in labels.items()}
    columns = zip(*lines.values(), strict=True)
    names = [f"trend_{name}" for name in Trend._fields]
    variables |= labelled("abscissa", **dict(zip(names, map(np.array, columns), strict=True)))
    variables |= labelled(
        (),
        K=(stiffness.K, stiffness.error),
        tau_noise=noise.sd,
        tau_noise_correlation=noise.correlation,
        detection_threshold=threshold,
    )
    time, tau = _thinned(series.t, series.tau)
    variables |= labelled("time", tau=tau)
    coords = labelled("event", event=np.arange(1, status.size + 1)) | labelled("time", time=time)
    coords["abscissa"] = ("abscissa", [*lines], {"long_name": "abscissa of the line"})
    return xarray.Dataset(variables, coords), stiffness


def _status(series, falls, gaps, measured, noise):
    """Return the status of falls (m,), and whether the loading before has a hidden fall (m,).

    gaps : (m,) whether samples are missing during a fall
    """
    several, changes, lost = np.zeros((3, len(falls)), bool)
    for k, (last, peak, trough, following) in enumerate(spans_of(series, falls)):
        if not is_whole(falls)[k]:
            continue
        changes[k] = series.speed_varies(series.t[peak], series.t[trough])
        if series.V is None:
            several[k] = has_several(series.tau, (last, peak, trough, following), noise)
            drop, rise = series.tau[peak] - series.tau[trough], slice(last, peak)
            lost[k] = k and has_step_down(series.t[rise], series.tau[rise], drop, noise)
    holds = {
        GAP: gaps,
        CUT_BY_START: falls[:, 0] < 0,
        CUT_BY_END: falls[:, 1] < 0,
        LOAD_CHANGES: changes,
        SEVERAL: several,
        UNDERSAMPLED: measured["sparse"],
    }
    return np.select([*holds.values()], [*holds], WHOLE), lost


def _quantities(series, measured, stiffness, several):
    """Return name -> (values (m,), standard errors (m,)) of the quantities of events.

    several : (m,) whether an event is several events; the standard errors then cover all values
        between zero and the measured amount
    """
    K, K_error = stiffness.K, stiffness.error
    (high, high_error), (start, start_error) = measured["tau_max"], measured["event_start"]
    (low, low_error), (end, end_error) = measured["tau_min"], measured["event_end"]
    (time, time_error), (fall, fall_error) = measured["event_time"], measured["fall_rate"]
    V_lp, V_lp_error = (series.at(time, column) for column in (series.V_lp, series.V_lp_error))
    drop, drop_error = high - low, np.hypot(high_error, low_error)
    duration, duration_error = end - start, np.hypot(start_error, end_error)
    amounts = {"stress_drop": (drop, drop_error), "duration": (duration, duration_error)}
    if series.sigma is not None:
        before, after = series.at(np.stack([start, end]), series.sigma)
        error = np.hypot(high_error / before, low_error / after)
        amounts["friction_drop"] = high / before - low / after, error
    error = np.hypot(np.hypot(drop_error, drop * K_error / K) / K, V_lp * duration_error)
    load_point_slip = series.at(end, series.delta_lp) - series.at(start, series.delta_lp)
    amounts["slip"] = load_point_slip + drop / K, error
    error = np.hypot(np.hypot(fall_error, fall * K_error / K) / K, V_lp_error)
    amounts["peak_slip_rate"] = V_lp + fall / K, error
    # errors of the time and of the value of an extreme are independent
    released = (high**2 - low**2) / (2.0 * K)
    error = np.hypot(np.hypot(high * high_error, low * low_error) / K, released * K_error / K)
    amounts["spring_energy"] = released, error
    load_error = 0.5 * (high + low) * V_lp * duration_error
    steps = 0.5 * (series.tau[1:] + series.tau[:-1]) * np.diff(series.delta_lp)
    start_work, end_work = series.at([start, end], np.append(0.0, np.cumsum(steps)))
    amounts["friction_work"] = end_work - start_work + released, np.hypot(load_error, error)
    return {
        "event_time": (time, np.hypot(time_error, np.where(several, 0.5 * duration, 0.0))),
        **{name: measured[name] for name in ("event_start", "event_end", "tau_max", "tau_min")},
        "V_lp": (V_lp, V_lp_error),
        **{
            name: (value, np.hypot(error, np.where(several, 0.5 * value, 0.0)))
            for name, (value, error) in amounts.items()
        },
    }


def _kinds(values, K, M):
    """Classify events (m,) as "fast" or "slow"; "unknown" if the peak slip rate is unknown.

    If only inertia limits a block, its slip is half a cosine and lasts half a natural period,
    pi sqrt(M/K).  Its largest slip rate is drop/(2 sqrt(K M)) (Johnson & Scholz 1976,
    doi:10.1029/JB081i005p00881; Rice & Tse 1986, doi:10.1029/JB091iB01p00521).
    """
    rate, drop = values["peak_slip_rate"][0], values["stress_drop"][0]
    if M is None:
        fast = rate >= FAST * values["V_lp"][0]
    else:
        fast = (M > 0.0) & (rate * 2.0 * math.sqrt(K * M) >= INERTIAL * drop)
    return np.where(np.isfinite(rate), np.where(fast, "fast", "slow"), "unknown")


def _recurrence(series, event_time, status):
    """Return (values, errors) (m,) of recurrence [s], and the message if one is NaN (m,), or ""."""
    time, error = event_time
    why = np.full(time.size, "first", object)
    for k in range(1, time.size):
        if not np.isfinite(time[k - 1]) or status[k - 1] == LOAD_CHANGES:
            why[k] = "after_cut"
        elif np.isfinite(time[k]) and series.speed_varies(time[k - 1], time[k]):
            why[k] = "changed"
        else:
            why[k] = ""
    interval = np.diff(time, prepend=math.nan), np.hypot(error, np.append(math.nan, error)[:-1])
    return tuple(np.where(why == "", x, math.nan) for x in interval), why


def _thinned(t, tau):
    """Reduce more than `MAX_SAMPLES` samples to the largest and the smallest of each block."""
    if t.size <= MAX_SAMPLES:
        return t, tau
    block = -(-2 * t.size // MAX_SAMPLES)
    rows = t.size // block * block
    blocks = tau[:rows].reshape(-1, block)
    first = np.arange(blocks.shape[0]) * block
    at = np.concatenate([first + blocks.argmin(1), first + blocks.argmax(1), [0, t.size - 1]])
    at = np.unique(at)
    return t[at], tau[at]
