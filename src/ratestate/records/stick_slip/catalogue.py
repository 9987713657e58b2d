"""All events of a series with their quantities: detection, measurement, status and message.

With delta = delta_lp - tau/K slip in an event is delta_lp's way plus drop/K; the slip rate is
V_lp - (dtau/dt)/K; the spring's work on the block, the integral of tau over slip, is that over
delta_lp plus (tau_max^2 - tau_min^2)/(2 K), the energy that the spring loses.  Slip rate is V_lp at
both ends, so that the kinetic energy is the same, and this work is what friction (and damping, if
there is any) turns into heat.
"""

import math

import numpy as np
import xarray

from ...dynamics.results import flags
from ..kit.results import labelled, with_errors
from ..messages import stick_slip as sentences
from .between_samples import has_several, has_step_down
from .detection import detected, in_gaps, is_whole, loading_phases
from .falls import Found, found_in_record, found_in_run
from .lines import Stiffness, Trend, loading_stiffness, speed_groups, trend

#: scatter of rough drops over their median beyond which events have windows of their own
ALIKE = 0.1
#: the same in standard deviations of the noise, which changes rough drops
BY_NOISE = 3.0
#: shortest loading beside an event, over the median one, of events that share windows
CLOSE = 0.5
#: a drop over the threshold below which such drops may be lost
SAFE = 2.0
#: drop of an event with few samples, over the median one, that several events may make
LARGE = 1.5
#: peak slip rate over the inertial limit, or over V_lp, from which an event is fast
INERTIAL, FAST = 0.5, 100.0
#: most samples of the record that a catalogue carries, for its figure
MOST = 20000
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


def catalogue_of(series):
    """The Dataset of the events of a `Series`, and the `Stiffness`."""
    clean, falls, noise, threshold = detected(series)
    gaps, spans = in_gaps(series.t, falls), _spans(series, falls)
    stiffness = Stiffness(series.K, 0.0, series.K_source)
    if series.K is None:
        phases = loading_phases(series, falls)
        stiffness = loading_stiffness(series, phases, falls[is_whole(falls)], noise)
    found = _found(series, falls, spans, gaps, noise)
    status = _status(clean, falls, spans, gaps, found, noise)
    values = _measured(series, found, stiffness, status == SEVERAL)
    unresolved = values["duration"][0] < _longest_steps(series, falls)
    values["duration"] = tuple(np.where(unresolved, math.nan, x) for x in values["duration"])
    values["recurrence"], why = _recurrence(series, values["event_time"], status)
    reports = _reports(found, values["stress_drop"][0], status, threshold)
    reports |= {"short": unresolved, "lost": _lost(clean, falls, spans, noise)}
    message = _messages(status, why, values["stress_drop"][0], stiffness, reports)
    variables = with_errors("event", values) | labelled(
        "event",
        event_kind=_kinds(values, stiffness.K, series.M),
        samples_in_fall=found.samples,
        event_status=status.astype(np.int8),
        event_message=np.array(message, dtype=str if message else object),
    )
    variables["event_status"][2].update(flags(STATUSES))
    trends = _trends(values, status)
    for name in Trend._fields:
        column = np.array([getattr(line, name) for line in trends.values()])
        variables |= labelled("abscissa", **{f"trend_{name}": column})
    variables |= with_errors((), {"K": (stiffness.K, stiffness.error)})
    numbers = {"tau_noise": noise.sd, "tau_noise_correlation": noise.correlation}
    variables |= labelled((), **numbers, detection_threshold=threshold)
    time, tau = _thinned(series.t, series.tau)
    variables |= labelled("time", tau=tau)
    coords = labelled("event", event=np.arange(1, status.size + 1)) | labelled("time", time=time)
    coords["abscissa"] = ("abscissa", [*trends], {"long_name": "abscissa of the line"})
    return xarray.Dataset(variables, coords), stiffness


def _spans(series, falls):
    """(m, 4) samples of the last trough, of a fall's peak and trough, and of the next peak."""
    last = np.maximum(np.append(0, falls[:, 1])[:-1], 0)
    following = np.append(falls[:, 0], series.t.size - 1)[1:]
    return np.column_stack([last, falls, following])


def _found(series, falls, spans, gaps, noise):
    """`Found` for all falls; NaN for those that the record cuts, but for the time they have.

    gaps : (m,) whether samples are missing during a fall, of which nothing is found then
    """
    whole, found = is_whole(falls) & ~gaps, Found.nothing(len(falls))
    for column, samples in zip((found.peak, found.trough), falls.T, strict=True):
        cut = ~is_whole(falls) & (samples >= 0)
        column[cut, 2] = series.t[samples[cut]]
    rows = np.flatnonzero(whole)
    if series.V is not None:
        groups = [rows] if rows.size else []
    else:
        groups = _groups(series, spans, rows, noise)
    for group in groups:
        if series.V is not None:
            part = found_in_run(series, falls[group])
        else:
            part = found_in_record(series, falls[group], spans[group][:, [0, 3]], noise)
        for column, of_part in zip(found, part, strict=True):
            column[group] = of_part
    return found


def _groups(series, spans, whole, noise):
    """Rows of events that are alike: at one V_lp, with much the same drop; else each by itself.

    spans : (m, 4) of `_spans`; whole : rows of whole events
    """
    if not whole.size:
        return []
    t, (peaks, troughs) = series.t, spans[whole, 1:3].T
    drop = series.tau[peaks] - series.tau[troughs]
    # (loading that the record cuts does not count)
    beside = np.diff(t[spans[whole]], axis=1)[:, ::2]
    is_end = (whole == 0) | (whole == len(spans) - 1)
    loading = np.where(is_end, beside.max(axis=1), beside.min(axis=1))
    speed = speed_groups(series.at(0.5 * (t[peaks] + t[troughs]), series.V_lp))
    groups = []
    for number in range(speed.max() + 1):
        at = np.flatnonzero(speed == number)
        off = np.abs(drop[at] - np.median(drop[at]))
        near = off <= math.hypot(ALIKE * np.median(drop[at]), BY_NOISE * noise.sd)
        near &= loading[at] > CLOSE * np.median(loading[at])
        groups += [whole[at[near]]] if near.any() else []
        groups += [whole[[i]] for i in at[~near]]
    return groups


def _status(series, falls, spans, gaps, found, noise):
    """(m,) status of all falls."""
    several, changes = np.zeros((2, len(falls)), bool)
    for k in np.flatnonzero(is_whole(falls)):
        changes[k] = series.speed_varies(*series.t[falls[k]])
        several[k] = series.V is None and has_several(series.tau, spans[k], noise)
    holds = {
        GAP: gaps,
        CUT_BY_START: falls[:, 0] < 0,
        CUT_BY_END: falls[:, 1] < 0,
        LOAD_CHANGES: changes,
        SEVERAL: several,
        UNDERSAMPLED: found.sparse,
    }
    return np.select([*holds.values()], [*holds], WHOLE)


def _measured(series, found, stiffness, several):
    """Return name -> (values (m,), standard errors (m,)) of all quantities of whole events.

    several : (m,) whether an event is several; the errors then hold for each of them, which has at
        least nothing and at most all of what is measured
    """
    K, K_error = stiffness.K, stiffness.error
    (high, high_error, start, start_error), (low, low_error, end, end_error) = (
        found.peak.T,
        found.trough.T,
    )
    V_lp, V_lp_error = (series.at(found.middle[:, 0], x) for x in (series.V_lp, series.V_lp_error))
    drop, drop_error = high - low, np.hypot(high_error, low_error)
    amounts = {"stress_drop": (drop, drop_error)}
    if series.sigma is not None:
        sigma = series.at(np.stack([start, end]), series.sigma)
        error = np.hypot(high_error / sigma[0], low_error / sigma[1])
        amounts["friction_drop"] = high / sigma[0] - low / sigma[1], error
    duration, duration_error = end - start, np.hypot(start_error, end_error)
    amounts["duration"] = duration, duration_error
    error = np.hypot(np.hypot(drop_error, drop * K_error / K) / K, V_lp * duration_error)
    amounts["slip"] = series.moved(start, end) + drop / K, error
    fall, fall_error = found.slope.T
    error = np.hypot(np.hypot(fall_error, fall * K_error / K) / K, V_lp_error)
    amounts["peak_slip_rate"] = V_lp + fall / K, error
    # of a whole event the place of an extreme, and its value, err independently
    released = (high**2 - low**2) / (2.0 * K)
    error = np.hypot(np.hypot(high * high_error, low * low_error) / K, released * K_error / K)
    amounts["spring_energy"] = released, error
    load_error = 0.5 * (high + low) * V_lp * duration_error
    work = _load_work(series, start, end) + released
    amounts["friction_work"] = work, np.hypot(load_error, error)
    time, time_error = found.middle.T
    return {
        "event_time": (time, np.hypot(time_error, np.where(several, 0.5 * duration, 0.0))),
        "event_start": (start, start_error),
        "event_end": (end, end_error),
        "tau_max": (high, high_error),
        "tau_min": (low, low_error),
        "V_lp": (V_lp, V_lp_error),
        **{
            name: (value, np.hypot(error, np.where(several, 0.5 * value, 0.0)))
            for name, (value, error) in amounts.items()
        },
    }


def _load_work(series, start, end):
    """(m,) integral of tau over delta_lp between two times [J/m^2]."""
    steps = 0.5 * (series.tau[1:] + series.tau[:-1]) * np.diff(series.delta_lp)
    total = np.append(0.0, np.cumsum(steps))
    return series.at(end, total) - series.at(start, total)


def _kinds(values, K, M):
    """(m,) "fast", "slow", or "unknown" if neither M nor a slip rate is known.

    A block that inertia alone limits slips as half a cosine in the natural half-period
    pi sqrt(M/K), at drop/(2 sqrt(K M)) at most (Johnson & Scholz 1976,
    doi:10.1029/JB081i005p00881; Rice & Tse 1986, doi:10.1029/JB091iB01p00521).
    """
    rate, drop = values["peak_slip_rate"][0], values["stress_drop"][0]
    if M is None:
        fast = rate >= FAST * values["V_lp"][0]
    else:
        fast = (M > 0.0) & (rate * 2.0 * math.sqrt(K * M) >= INERTIAL * drop)
    return np.where(np.isfinite(rate), np.where(fast, "fast", "slow"), "unknown")


def _longest_steps(series, falls):
    """(m,) longest step between samples in each fall [s]."""
    steps = np.diff(series.t, prepend=series.t[0])
    return np.array([steps[max(i, 0) : max(i, j, 0) + 1].max() for i, j in falls])


def _lost(series, falls, spans, noise):
    """(m,) whether the loading before each fall has a smaller fall that noise does not make."""
    lost = np.zeros(len(falls), bool)
    for k in np.flatnonzero(is_whole(falls)) if series.V is None else ():
        last, peak, trough, _ = spans[k]
        drop = series.tau[peak] - series.tau[trough]
        rise = series.t[last:peak], series.tau[last:peak]
        lost[k] = k > 0 and has_step_down(*rise, drop, noise)
    return lost


def _recurrence(series, event_time, status):
    """(values, errors) (m,) of times since the last event, and why one is NaN (list of names)."""
    time, error = event_time
    why = ["first"][: time.size]
    for k in range(1, time.size):
        if not np.isfinite(time[k - 1]) or status[k - 1] == LOAD_CHANGES:
            why.append("after_cut")
        elif np.isfinite(time[k]) and series.speed_varies(time[k - 1], time[k]):
            why.append("changed")
        else:
            why.append("")
    since = np.diff(time, prepend=math.nan), np.hypot(error, np.append(math.nan, error)[:-1])
    known = np.array([not text for text in why], bool)
    return tuple(np.where(known, x, math.nan) for x in since), why


def _reports(found, drop, status, threshold):
    """Name of a message -> (m,) whether it holds, for those on drops and on few samples."""
    usual = np.nanmedian(drop) if np.isfinite(drop).any() else math.inf
    bounded = np.isfinite(drop) & np.isin(status, (UNDERSAMPLED, SEVERAL))
    return {
        "sparse": found.sparse & bounded,
        "few": drop < SAFE * threshold,
        "large": found.sparse & (drop > LARGE * usual) & (status != SEVERAL),
    }


def _messages(status, why, drop, stiffness, reports):
    """What must be known of each event (list of str).

    reports : name of a message -> (m,) whether it holds
    """
    cut = np.isin(status, (CUT_BY_START, CUT_BY_END))
    holds = {
        "start": status == CUT_BY_START,
        "end": status == CUT_BY_END,
        "load": status == LOAD_CHANGES,
        "gap": status == GAP,
        "several": status == SEVERAL,
        "unmeasured": np.isin(status, (WHOLE, UNDERSAMPLED)) & ~np.isfinite(drop),
        **{name: reports[name] for name in ("sparse", "few", "lost", "short", "large")},
        **{name: ~cut & (np.array(why) == name) for name in ("first", "changed", "after_cut")},
        "no_stiffness": np.full(status.size, not math.isfinite(stiffness.K)),
    }
    return [
        "; ".join(sentences(f"message.{name}") for name, own in holds.items() if own[k])
        for k in range(status.size)
    ]


def _trends(values, status):
    """Name of the abscissa -> `Trend`, of events that were loaded at one V_lp from the last on."""
    whole = np.isin(status, (WHOLE, UNDERSAMPLED)) & np.isfinite(values["recurrence"][0])
    drop, V_lp = np.where(whole, values["stress_drop"][0], math.nan), values["V_lp"][0]
    abscissae = {"recurrence": "the recurrence interval", "V_lp": "V_lp"}
    return {name: trend(values[name][0], drop, V_lp, what) for name, what in abscissae.items()}


def _thinned(t, tau):
    """A record with the largest and smallest of so many samples in turn, if it has more."""
    if t.size <= MOST:
        return t, tau
    every = -(-2 * t.size // MOST)
    rows = t.size // every * every
    blocks = tau[:rows].reshape(-1, every)
    first = np.arange(blocks.shape[0]) * every
    at = np.concatenate([first + blocks.argmin(1), first + blocks.argmax(1), [0, t.size - 1]])
    at = np.unique(at)
    return t[at], tau[at]
